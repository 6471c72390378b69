# SPDX-License-Identifier: Apache-2.0
"""First screen of `make report`: one table beside the published figures, and one picture."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from math import prod
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from commands.common import published, recorded
from commands.common.published import CLOCK_MHZ
from commands.common.tabular import Table, span
from commands.cost.cost import XCZU7EV, cost
from commands.hardware import estimate
from commands.study.report_page import LOOKS, PUBLISHED_LOOK, Section, saved
from tactile_depth.chip.configuration import Configuration
from tactile_depth.depth import reference
from tactile_depth.sensor.scenes import BENCH, SENSOR_WIDTH_MM, render
from tactile_depth.sensor.synthetic import synthetic

SIZE = 128
MARKS = {  # of the table and of the picture, by list of the report of `make sim`
    "first pixel to first depth": "first_depth_latency_cycles",
    "last pixel to first depth": "last_pixel_to_first_depth_cycles",
    "last pixel to the whole map": "last_pixel_to_last_depth_cycles",
}
CONTACT = "last_pixel_to_contact_cycles"
SENSOR = "tridiagonal"  # solver of the calibration that is shipped
SHOWN = "star_relief"  # contact in the picture
UM_PER_MM = 1000
SPACE = "\N{NO-BREAK SPACE}"  # before a unit


@dataclass(frozen=True)
class Run:
    """Repeated contacts of the bench through the RTL."""

    command: str
    report: dict[str, Any]
    depth_mm: np.ndarray  # of the contacts, once

    @property
    def rms_percent(self) -> list[float]:
        """RMS error of each contact, in % of its peak."""
        rms: list[float] = self.report["rms_percent_of_peak"][: len(BENCH)]
        return rms

    def spread(self, name: str) -> int:
        """Return by how many cycles a latency differs, at most, among the frames of one contact."""
        values = self.report[name]
        return max(max(each) - min(each) for each in (values[shape :: len(BENCH)] for shape in range(len(BENCH))))


@lru_cache(maxsize=1)
def exact_mm() -> np.ndarray:
    """Return the depth of the contacts in double precision, in mm."""
    return reference.depth(render("bench", SIZE).frames, synthetic()) * SENSOR_WIDTH_MM / SIZE


def timed(cycles: Sequence[int]) -> str:
    """Return cycles and microseconds, or the least and the greatest of both."""
    least, most = min(cycles), max(cycles)
    if least == most:
        return f"{least:,} ({least / CLOCK_MHZ:,.1f}{SPACE}us)"
    return f"{least:,} to {most:,} ({least / CLOCK_MHZ:,.0f} to {most / CLOCK_MHZ:,.0f}{SPACE}us)"


def sensor_error_mm() -> str:
    """Return the recorded error of heights of real presses, in the middle of the picture and at its sides."""
    entry = recorded.latest("presses")
    if entry is None:
        return "-"
    places = entry["figures"]["places"][:-1]
    return ", ".join(f"{each['height_um'] / UM_PER_MM:.4f} mm {each['place']}" for each in places)


def design_cells(solver: str, run: Run) -> list[str]:
    """Return the column of a solver."""
    config = Configuration(columns=SIZE, solver=solver)
    counted = cost(config)
    placed = {name: one for name, _, one, _ in estimate.designs()}[solver]
    report = run.report
    error_mm = float(np.sqrt(((run.depth_mm - exact_mm()) ** 2).mean()))
    spreads = [run.spread(name) for name in (*MARKS.values(), CONTACT)]
    codes = report["frames"] * SIZE * SIZE
    return [
        *(timed(report[name]) for name in MARKS.values()),
        timed(report[CONTACT]),
        "0 cycles" if not any(spreads) else "; ".join(map(str, spreads)) + " cycles",
        f"{1e6 * CLOCK_MHZ / max(report['frame_interval_cycles'][1:]):,.0f}",
        f"{error_mm:.5f} mm; {np.mean(run.rms_percent):.4f} % ({max(run.rms_percent):.4f})",
        sensor_error_mm() if solver == SENSOR else "-",
        f"{counted.tiles}",
        f"{counted.memory_bits / 1e6:.2f} Mbit",
        f"{span(placed.placed_mm2, '.2f')} mm2, {span(placed.placed_mw, '.0f')} mW",
        f"{codes:,} of {codes:,}",
    ]


def published_cells() -> list[str]:
    """Return the column of the published design."""
    ultra = published.RESOURCES[SIZE]["UltraRAM"]
    bits = ultra * prod(XCZU7EV.ultra_shape or ())
    dsp = [f"{known['DSP48E2']} at {size}" for size, known in published.RESOURCES.items() if "DSP48E2" in known]
    return [
        timed([published.FIRST_DEPTH_CYCLES[SIZE]]),
        *"----",
        f"{published.FRAMES_PER_SECOND[SIZE]:,}",
        f"{published.RMS_PERCENT} % ({published.WORST_RMS_PERCENT})",
        "-",
        ", ".join(dsp),
        f"{ultra} UltraRAM: {bits / 1e6:.1f} Mbit",
        f"{published.ASIC_AREA_MM2:.2f} mm2, {published.ASIC_POWER_MW:.0f} mW",
        "-",
    ]


def summary_table(runs: Mapping[str, Run]) -> Table:
    """Return the table: a column for each solver, that of the published design beside the first."""
    frames = min(run.report["frames"] for run in runs.values())
    names = [
        *MARKS,
        f"last pixel to contact, {len(BENCH)} shapes",
        f"their spread over {frames:,} frames, of a shape",
        "frames/s",
        "error of the arithmetic; % of peak (worst)",
        "error of heights, real presses",
        "multipliers 27 x 18 (DSP48E2)",
        "memories",
        "ASIC at 45 nm (ours: estimate)",
        "codes equal to the model's",
    ]
    (first, run), *others = runs.items()
    columns = [names, design_cells(first, run), published_cells(), *(design_cells(*other) for other in others)]
    head = (f"{SIZE} x {SIZE}, {CLOCK_MHZ:g} MHz", first, "published design", *(solver for solver, _ in others))
    return Table(head, list(zip(*columns, strict=True)))


def summary_picture(runs: Mapping[str, Run], folder: Path) -> Path:
    """Draw a contact with its depth out of the RTL and what that lacks, and when depths leave."""
    figure = Figure(figsize=(5.4, 5.0), layout="constrained")
    axes = figure.subplot_mosaic("abc;ddd", height_ratios=(1, 1.05))
    solver = SENSOR if SENSOR in runs else next(iter(runs))
    number = tuple(BENCH).index(SHOWN)
    depth_mm = runs[solver].depth_mm[number]
    error_um = UM_PER_MM * (depth_mm - exact_mm()[number])
    limit = float(np.abs(error_um).max())
    left, middle, right, below = axes.values()
    camera = left.imshow(render("bench", SIZE).frames[number])
    left.set_title("camera (drawn)", fontsize=9)
    depth = middle.imshow(depth_mm, cmap="cividis", vmin=0)
    middle.set_title("depth out of the RTL", fontsize=9)
    error = right.imshow(error_um, cmap="PuOr", vmin=-limit, vmax=limit)
    right.set_title("less double precision", fontsize=9)
    for axis in (left, middle, right):
        axis.set_axis_off()
    for axis, image, unit in ((left, camera, ""), (middle, depth, "mm"), (right, error, "um")):
        scale = figure.colorbar(image, ax=axis, orientation="horizontal", shrink=0.9, ticks=MaxNLocator(2))
        scale.set_label(unit or "-")
        scale.ax.set_visible(bool(unit))  # that of the camera keeps its panel level with the others
    timeline(below, runs)
    return saved(figure, folder, "summary")


def timeline(axis: Any, runs: Mapping[str, Run]) -> None:
    """Draw when the pixels of a frame arrive and its depths leave, in us from its first pixel."""
    arrive = SIZE * SIZE / CLOCK_MHZ
    rows = {"published": len(runs)} | {solver: row for row, solver in enumerate(reversed([*runs]))}
    for name, row in rows.items():
        axis.barh(row, arrive, 0.55, color="#cccccc", label="pixels arrive" if row == 0 else None)
        if name not in runs:
            axis.plot(published.FIRST_DEPTH_CYCLES[SIZE] / CLOCK_MHZ, row, **PUBLISHED_LOOK | {"label": None})
            continue
        report = runs[name].report
        first, last, contact = (
            np.array(report[key][: len(BENCH)]) / CLOCK_MHZ
            for key in ("first_depth_latency_cycles", "last_depth_latency_cycles", "contact_latency_cycles")
        )
        axis.barh(row, last[0] - first[0], 0.3, left=first[0], color=LOOKS[name]["color"])
        axis.plot(first[0], row, marker="*", color="black", markersize=13)
        axis.plot(contact, np.full(len(contact), row), "|", color="white", markersize=9)
    axis.plot([], [], "*", color="black", markersize=11, label="first depth")
    axis.plot([], [], "s", color="#666666", markersize=8, label="depths leave; white: contact of each shape")
    axis.set_yticks(list(rows.values()), list(rows))
    axis.set_ylim(-0.6, len(rows) - 0.4)
    axis.set_xlabel(f"us from the first pixel of a frame, at {CLOCK_MHZ:g} MHz")
    axis.grid(axis="x", alpha=0.3)
    axis.set_axisbelow(True)
    axis.legend(loc="lower center", bbox_to_anchor=(0.45, 1), ncols=2, fontsize=9, frameon=False)


def summary(runs: Mapping[str, Run], folder: Path) -> Section:
    """Return the first section of the page."""
    text = (
        f"RTL in simulation, not on a chip: {SIZE} x {SIZE}, 24-bit words, 18-bit coefficients, {len(BENCH)} drawn "
        f"contacts again and again. Latencies are in cycles, and in us at {CLOCK_MHZ:g} MHz, the clock of the "
        "published design. Errors are RMS: of the arithmetic to double precision, where the published figures have a "
        "scale and an offset fitted, ours none; of heights on a GelSight Mini, in the configuration of a real sensor, "
        "as `make presses` has recorded. Multipliers and memories are those of the cost model. A dash: not published, "
        "or not measured."
    )
    picture = summary_picture(runs, folder)
    title, commands = "In short", "; ".join(run.command for run in runs.values())
    return Section("summary", title, text, commands, [summary_table(runs)], picture, describe(runs))


def describe(runs: Mapping[str, Run]) -> str:
    """Return the picture of the first screen in words."""
    firsts = [f"{name} {run.report['first_depth_latency_cycles'][0] / CLOCK_MHZ:.0f}" for name, run in runs.items()]
    firsts.append(f"published {published.FIRST_DEPTH_CYCLES[SIZE] / CLOCK_MHZ:.0f}")
    return (
        "A drawn camera picture of a star, its depth out of the RTL and the difference to double precision. Below, "
        f"when depths leave: the first one {', '.join(firsts)} us after the first pixel."
    )
