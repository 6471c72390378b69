# SPDX-License-Identifier: Apache-2.0
"""Measurements of a run of `make sim`: latencies, the hardware's own counters, and the table that is printed."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from commands.common.tabular import counts
from commands.run import bench
from tactile_depth.base.errors import counted
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.poisson.spectral_divide import reciprocal_rom
from tactile_depth.chip.poisson.tridiagonal_solver import tables

ROWS_SHOWN = 16


def latencies(played: bench.Played) -> dict[str, list[int | None]]:
    """Return the latencies of each frame in cycles, from the events of the bench."""
    taken, depth, end = (played.clocks(letter) for letter in "tde")
    first, last = taken[::2], taken[1::2]
    contact = [*map(played.by_frame("c").get, range(len(end)))]

    def between(start: Sequence[int | None], stop: Sequence[int | None]) -> list[int | None]:
        return [None if a is None or b is None else b - a for a, b in zip(start, stop, strict=True)]

    return {
        "first_depth_latency_cycles": between(first, depth),
        "last_depth_latency_cycles": between(first, end),
        "last_pixel_to_first_depth_cycles": between(last, depth),
        "last_pixel_to_last_depth_cycles": between(last, end),
        "frame_interval_cycles": between([None, *depth[:-1]], depth),
        "contact_latency_cycles": between(first, contact),
        "last_pixel_to_contact_cycles": between(last, contact),
    }


def check_registers(played: bench.Played, total: int, clips: Mapping[str, int], timed: bool) -> list[str]:
    """Compare the counters of the hardware with the events at the pins; return one line for each difference.

    `timed`: there are no stalls, and no camera, with which the latency counts from the first pixel of the grid.
    """
    clipped = min(sum(clips.values()), 2**32 - 1)
    expected: dict[str, int | None] = {
        "frames_in": total,
        "frames_out": total,
        "frames_dropped": 0,
        "saturations": clipped,
    }
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
    return sum(table.words.size for table in tables(config)) + config.columns


def table(report: dict, labels: tuple[str, ...]) -> str:
    """Return the printed table: one line per frame of the sequence, then the lines about all frames."""

    def known(column: str) -> list[Any]:
        return [value for value in report[column] if value is not None]

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
        lines.append(f"and {counted(report['frames'] - shown, 'frame')} more: report.json")
    if rms := known("rms_percent_of_peak"):
        lines.append(f"mean RMS {np.mean(rms):.5f} % of peak, worst {max(rms):.5f} %")
    if camera := report.get("camera"):
        lost = known("camera_rms_percent_of_peak")
        height, width = camera["picture"]
        lines.append(
            f"{camera['pixel_format']} of {width} x {height} against RGB of the grid: "
            + (f"mean RMS {np.mean(lost):.3f} % of peak, worst {max(lost):.3f} %" if lost else "no contact")
        )
    for column in list(columns)[:4]:
        if values := known(column):
            spread = f"{min(values):,}" if min(values) == max(values) else f"{min(values):,} to {max(values):,}"
            lines.append(f"{column.removesuffix('_cycles').replace('_', ' ')}: {spread} cycles, all frames")
    clipped = report["saturations"]
    lines.append(f"saturated: {counts(clipped)}" if clipped else "no saturation")
    return "\n".join(lines)
