# SPDX-License-Identifier: Apache-2.0
"""Measurements of a run of `make sim`: latencies, the hardware's own counters, and the table that is printed."""

from collections.abc import Mapping

import numpy as np

from commands.run import bench
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.poisson.spectral_divide import reciprocal_rom
from tactile_depth.chip.poisson.thomas_table import thomas_table

ROWS_SHOWN = 16


def latencies(played: bench.Played) -> dict[str, list[int | None]]:
    """Return the latencies of each frame in cycles, from the events of the bench."""
    taken, depth, end = (played.clocks(letter) for letter in "tde")
    first, last = taken[::2], taken[1::2]
    contact = played.by_frame("c")
    frames = range(len(end))
    return {
        "first_depth_latency_cycles": [depth[i] - first[i] for i in frames],
        "last_depth_latency_cycles": [end[i] - first[i] for i in frames],
        "last_pixel_to_first_depth_cycles": [depth[i] - last[i] for i in frames],
        "last_pixel_to_last_depth_cycles": [end[i] - last[i] for i in frames],
        "frame_interval_cycles": [depth[i] - depth[i - 1] if i else None for i in frames],
        "contact_latency_cycles": [contact[i] - first[i] if i in contact else None for i in frames],
        "last_pixel_to_contact_cycles": [contact[i] - last[i] if i in contact else None for i in frames],
    }


def check_registers(played: bench.Played, total: int, clips: Mapping[str, int], timed: bool) -> list[str]:
    """Compare the counters of the hardware with the events at the pins; return one line for each difference.

    `timed`: there are no stalls, and no camera, with which the latency counts from the first pixel of the grid.
    """
    clipped = min(sum(clips.values()), 2**32 - 1)
    expected: dict[str, int | None]
    expected = {"frames_in": total, "frames_out": total, "frames_dropped": 0, "saturations": clipped}
    if timed:
        expected["first_depth_latency"] = latencies(played)["first_depth_latency_cycles"][-1]
    return [
        f"register {name.upper()} is {played.registers[name]}, expected {value}"
        for name, value in expected.items()
        if played.registers[name] != value
    ]


def coefficient_words(config: Configuration) -> int:
    """Return the words of the table along the columns: reciprocals, or coefficients of Thomas's algorithm."""
    if config.solver == "spectral":
        return len(reciprocal_rom(config))
    return len(thomas_table(config).words) + config.columns


def table(report: dict, labels: tuple[str, ...]) -> str:
    """Return the printed table: one line per frame of the sequence, then the lines about all frames."""

    def cell(value: float | None, digits: int = 5) -> str:
        return "-" if value is None else f"{value:,}" if isinstance(value, int) else f"{value:.{digits}f}"

    columns = {
        "first_depth_latency_cycles": "first depth",
        "last_pixel_to_first_depth_cycles": "last px > depth",
        "last_pixel_to_last_depth_cycles": "last px > map",
        "frame_interval_cycles": "interval",
        "contact_latency_cycles": "contact",
        "rms_percent_of_peak": "RMS % peak",
        "max_percent_of_peak": "max % peak",
    }
    lines = ["".join([f"{'frame':<20}", *(f"{name:>17}" for name in columns.values())])]
    shown = min(len(labels), ROWS_SHOWN)
    for i in range(shown):
        cells = "".join(f"{cell(report[column][i]):>17}" for column in columns)
        lines.append(f"{labels[i][:19]:<20}{cells}")
    if report["frames"] > shown:
        lines.append(f"and {report['frames'] - shown:,} frames more: report.json")
    rms = [value for value in report["rms_percent_of_peak"] if value is not None]
    if rms:
        lines.append(f"mean RMS {np.mean(rms):.5f} % of peak, worst {max(rms):.5f} %")
    if camera := report.get("camera"):
        lost = [value for value in report["camera_rms_percent_of_peak"] if value is not None]
        height, width = camera["picture"]
        lines.append(
            f"{camera['pixel_format']} of {width} x {height} against RGB of the grid: "
            + (f"mean RMS {np.mean(lost):.3f} % of peak, worst {max(lost):.3f} %" if lost else "no contact")
        )
    for column in list(columns)[:4]:
        values = {value for value in report[column] if value is not None}
        if values:
            spread = f"{min(values):,}" if len(values) == 1 else f"{min(values):,} to {max(values):,}"
            lines.append(f"{column.removesuffix('_cycles').replace('_', ' ')}: {spread} cycles, all frames")
    clipped = report["saturations"]
    lines.append(
        f"saturated: {', '.join(f'{node} {count:,}' for node, count in clipped.items())}"
        if clipped
        else "no saturation"
    )
    return "\n".join(lines)
