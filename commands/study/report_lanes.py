# SPDX-License-Identifier: Apache-2.0
"""The section of `make report` on depth lanes: what each number of lanes takes, and how early the whole map comes.

Latencies, multipliers and memories are those of the sweep. LUTs and the routed clock are those of the results of `make
synth` and `make fpga` in build/, where there are any for the same configuration.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

from commands.common import run_request
from commands.common.published import CLOCK_MHZ
from commands.common.tabular import Table
from commands.study import sweep
from commands.study.report_page import Section, results, saved
from commands.study.sweep import Row
from tactile_depth.chip.configuration import Configuration

CELLS = ("DSP48E2", "LUT", "FF", "BRAM36", "UltraRAM")
HEAD = (
    *("grid", "lanes", "last pixel to first depth, cycles", "last pixel to last depth, cycles"),
    *(f"the same at {CLOCK_MHZ:g} MHz, us", "multipliers of 27 x 18", "memory, Mbit"),
    *(*CELLS, "routed on the ULX3S, MHz"),
)


def cells(row: Row, designs: Sequence[dict[str, Any]], routed: Sequence[dict[str, Any]]) -> tuple[str, ...]:
    """Return a line of the table; "-" where a flow has not run on this configuration."""
    columns, lanes = row.columns, row.lanes
    wanted = run_request.described(Configuration(columns=columns, solver="tridiagonal", lanes=lanes))
    whole = row.last_pixel_to_last_depth_cycles
    synthesized = [design["totals"] for design in designs if wanted.items() <= design["configuration"].items()]
    clocks = [report["fmax_mhz"] for report in routed if wanted.items() <= report.items()]
    return (
        *(f"{columns} x {columns}", str(lanes), f"{row.last_pixel_to_first_depth_cycles:,}", f"{whole:,}"),
        *(f"{whole / CLOCK_MHZ:.1f}", *sweep.area(row)),
        *(f"{synthesized[-1][name]:,g}" if synthesized else "-" for name in CELLS),
        f"{clocks[-1]:.1f}" if clocks else "-",
    )


def lanes_section(rows: Sequence[Row], folder: Path) -> Section:
    """Plot the whole map's latency against multipliers and memory, a point for each number of lanes."""
    figure = Figure(figsize=(11, 4), layout="constrained")
    axes = figure.subplots(1, 2, sharey=True)
    designs = [design for document in results("synth") for design in document["designs"]]
    routed = results("fpga")
    lines = []
    for columns, colour in zip(sweep.LANE_GRIDS, ("#08306b", "#e6550d"), strict=True):
        points = sweep.with_lanes(rows, columns)
        lines += [cells(row, designs, routed) for row in points]
        micros = [row.last_pixel_to_last_depth_cycles / CLOCK_MHZ for row in points]
        areas: tuple[list[float], ...] = [row.multipliers for row in points], [row.memory_bits / 1e6 for row in points]
        for axis, area in zip(axes, areas, strict=True):
            axis.plot(area, micros, color=colour, marker="o", label=f"{columns} x {columns}")
            for row, x, y in zip(points, area, micros, strict=True):
                axis.annotate(str(row.lanes), (x, y), textcoords="offset points", xytext=(4, 4), fontsize=8)
    for axis, name in zip(axes, ("multipliers of 27 x 18", "memory, Mbit"), strict=True):
        axis.set(xlabel=name, yscale="log")
        axis.set_xlim(left=0)
        axis.grid(alpha=0.3)
    axes[0].set_ylabel(f"last pixel to last depth, us at {CLOCK_MHZ:g} MHz")
    axes[0].legend()
    text = (
        "The tridiagonal solver with 1, 2, 4, .. depth values per clock (LANES, beside the points). More of them bring "
        "the last depth earlier and take area; from 2 on all give the same codes. Resources of an FPGA and the routed "
        "clock are shown where `make synth` and `make fpga` have run with this grid and LANES."
    )
    title, command = "Depth lanes: speed against area", "make sweep; make synth LANES=.."
    return Section("lanes", title, text, command, [Table(HEAD, lines)], saved(figure, folder, "lanes"))
