# SPDX-License-Identifier: Apache-2.0
"""`make report`: one HTML page, and its figures as PNG: latency, throughput, depth, error, cost, extremes.

Takes OUT=folder and SHORT=1. It measures the contacts of the bench through the RTL of both solvers, over a thousand
frames without a pause, the sweep, which continues where it stopped, and the extremes. It takes the results of `make
budget`, `make reflex` and `make baselines` from build/, and runs the commands if there are none. It takes existing
results of `make trade`, `make synth`, `make fpga` and `make asic`. Each figure names the command that makes it again.

SHORT=1 measures the RTL alone: error budget and software are those of build/ or, without, of docs/figures.json; sweep
and extremes are left out, and the reflex where build/ has none.
"""

import json
import os
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from commands.common import recorded, run_request, variables
from commands.common.progress import duration
from commands.common.published import CLOCK_MHZ, FIRST_DEPTH_CYCLES, RMS_PERCENT
from commands.common.repository import ROOT
from commands.common.tabular import Table, shown
from commands.hardware import asic, synth
from commands.run import reflex, reflex_tables, sim
from commands.study import baselines, budget, extremes, study, sweep, trade, trade_front
from commands.study.report_lanes import lanes_section
from commands.study.report_page import LOOKS, PUBLISHED_LOOK, Section, page, results, saved
from commands.study.report_summary import SIZE, UM_PER_MM, Run, exact_mm, summary
from commands.study.transform_noise import Compliance
from tactile_depth.base import files
from tactile_depth.chip.configuration import COEFFICIENT, STORED, Configuration
from tactile_depth.chip.latency import first_depth_latency, last_pixel_to_first_depth
from tactile_depth.chip.limits import COLUMNS
from tactile_depth.sensor.scenes import BENCH

DEFAULT_OUT = ROOT / "build" / "report"
PAGE = "report.html"
RECORDED = "recorded at"  # commit of a document from docs/figures.json
INTERRUPTED = "the rows of the sweep are kept, run it again to go on"
CONSECUTIVE = 1000  # frames, at least
RTL_S, EXTREMES_S, BUDGET_S, REFLEX_S, PAGE_S = 100, 30, 45, 150, 15  # on two cores of 2.5 GHz
COMMANDS = {"budget": budget, "reflex": reflex, "baselines": baselines}  # those that the report runs, by result
LEFT_OUT = (
    "SHORT=1 left out word lengths, depth lanes and the extremes, and the reflex unless `make reflex` has run. `make "
    "report` has them."
)
EXTREMES_SIZE = 64
EXTREMES_COMMAND = f"make extremes N={EXTREMES_SIZE} SHORT=1"


def run_rtl(solver: str, folder: Path) -> Run:
    """Run at least CONSECUTIVE frames without a pause. Raises Mismatch: the RTL differs from the model."""
    repeat = -(-CONSECUTIVE // len(BENCH))
    words = [f"SOLVER={solver}", "FRAMES=bench", f"REPEAT={repeat}", f"N={SIZE}"]
    out = folder / solver
    if sim.run(run_request.parse([*words, f"OUT={out}"])):
        raise variables.Mismatch(f"the RTL of the {solver} solver differs from its model: see {out / 'report.json'}")
    report = json.loads((out / "report.json").read_text())
    depth = np.load(out / "depth.npy", mmap_mode="r")[: len(BENCH)] * report["depth_lsb_mm"]
    return Run("make sim " + " ".join(words), report, depth)


def of_commit(document: dict[str, Any]) -> str:
    """Return a sentence on the origin of recorded results."""
    return f" Recorded at commit {document[RECORDED]}." if RECORDED in document else ""


def run_extremes(folder: Path) -> None:
    """Run `make extremes`. Raises Mismatch: a row is out of bounds."""
    if extremes.run(EXTREMES_SIZE, "verilator", folder, short=True):
        raise variables.Mismatch(f"a row of the extremes is out of bounds: see {folder}")


def file_of(command: Any, name: str) -> Path:
    """Return the file of results of make budget, make reflex or make baselines."""
    path: Path = command.DEFAULT_OUT / f"{name}.json"
    return path


def recorded_document(command: Any, name: str) -> dict[str, Any] | None:
    """Return the results that a command left in build/, or those in docs/figures.json; None without any."""
    file = file_of(command, name)
    if file.exists():
        return dict(json.loads(file.read_text()))
    entry = recorded.latest(name)
    if entry is None:
        return None
    document = entry["figures"] | {RECORDED: entry["commit"]}
    if name == "baselines":  # what is recorded leaves out the cycles of the present RTL
        sizes = sorted({row["grid"] for row in document["software"]})
        document["pipeline"] = baselines.pipeline(sizes, document["clock_mhz"])
    return dict(document)


def document_of(command: Any, name: str) -> dict[str, Any]:
    """Return the results of make budget, make reflex or make baselines; run the command first if it left none."""
    file = file_of(command, name)
    if not file.exists():
        words = [
            f"OUT={command.DEFAULT_OUT}",
            *(["MAX_LOAD=10000"] if name == "baselines" else []),
        ]  # it prints the load
        variables.read(command.run, words)
    return json.loads(file.read_text())


def latency_section(runs: dict[str, Run], folder: Path) -> Section:
    figure = Figure(figsize=(11, 3.6), layout="constrained")
    left, right = figure.subplots(1, 2)
    for solver, run in runs.items():
        look = LOOKS[solver] | {"marker": "", "label": solver}
        left.plot(run.report["first_depth_latency_cycles"], **look)
        right.plot(run.report["frame_interval_cycles"][1:], **look)
    left.set(xlabel="frame", ylabel="cycles", title="first pixel to first depth", ylim=(0, None))
    right.set(xlabel="frame", ylabel="cycles", title="first depth to the next frame's", ylim=(0, None))
    left.legend()
    frames = min(run.report["frames"] for run in runs.values())
    spread = {
        solver: len(set(run.report["first_depth_latency_cycles"])) for solver, run in runs.items()
    }  # different values
    text = (
        f"{frames:,} consecutive frames without a pause, through the RTL. Different latencies seen: "
        + ", ".join(f"{solver} {count}" for solver, count in spread.items())
        + f". One frame every {SIZE * SIZE:,} cycles is one pixel per clock, {CLOCK_MHZ * 1e6 / SIZE**2:,.0f} frames/s "
        f"at {CLOCK_MHZ:g} MHz."
    )
    commands = "; ".join(run.command for run in runs.values())
    return Section("latency", "Latency and throughput", text, commands, picture=saved(figure, folder, "latency"))


def grid_section(folder: Path) -> Section:
    figure = Figure(figsize=(6.5, 4.2), layout="constrained")
    axis = figure.subplots()
    for solver, (low, high) in COLUMNS.items():
        grids = [1 << bits for bits in range(low.bit_length() - 1, high.bit_length())]
        configs = [Configuration(columns=columns, solver=solver) for columns in grids]
        axis.plot(
            grids, [first_depth_latency(c) for c in configs], **LOOKS[solver], label=f"{solver}, from the first pixel"
        )
        dotted = LOOKS[solver] | {"linestyle": ":", "fillstyle": "none"}
        axis.plot(
            grids, [last_pixel_to_first_depth(c) for c in configs], **dotted, label=f"{solver}, from the last pixel"
        )
    axis.plot(list(FIRST_DEPTH_CYCLES), list(FIRST_DEPTH_CYCLES.values()), **PUBLISHED_LOOK)
    axis.set_xscale("log", base=2)
    axis.set_yscale("log")
    shown = sorted({int(grid) for line in axis.get_lines() for grid in np.asarray(line.get_xdata())})
    axis.set_xticks(shown, [str(grid) for grid in shown])
    axis.set(xlabel="grid (N x N)", ylabel="cycles to the first depth")
    axis.grid(alpha=0.3)
    axis.legend(fontsize=8)
    text = "Fixed by the structure (latency.py), the same in every run of the RTL, whatever the gaps in the input."
    picture = saved(figure, folder, "grids")
    return Section("grids", "Latency against grid", text, "make sim N=.. SOLVER=..", picture=picture)


def depth_sections(runs: dict[str, Run], folder: Path) -> list[Section]:
    want = exact_mm()
    sections = []
    for solver, run in runs.items():
        figure = Figure(figsize=(11, 12), layout="constrained")
        axes = figure.subplots(3 * 2, 5)
        residual = (run.depth_mm - want) * UM_PER_MM
        limit = float(np.abs(residual).max())
        top = float(want.max())
        for index, name in enumerate(BENCH):
            above, below = axes[index // 5 * 2, index % 5], axes[index // 5 * 2 + 1, index % 5]
            depth = above.imshow(run.depth_mm[index], cmap="cividis", vmin=0, vmax=top)
            error = below.imshow(residual[index], cmap="PuOr", vmin=-limit, vmax=limit)
            above.set_title(name.replace("_", " "), fontsize=9)
            for axis in (above, below):
                axis.set_axis_off()
        figure.colorbar(depth, ax=axes[:3, :], label="depth, mm", shrink=0.7)  # they hold for all rows, one above
        figure.colorbar(error, ax=axes[3:, :], label="residual, um", shrink=0.7)  # the other
        text = f"Depth out of the RTL, and below it what differs from double precision: at most {limit:.3f} um."
        name = f"depth-{solver}"
        picture = saved(figure, folder, name)
        sections.append(Section(name, f"The contacts, {solver}", text, run.command, picture=picture))
    return sections


def error_section(runs: dict[str, Run], folder: Path) -> Section:
    figure = Figure(figsize=(11, 3.8), layout="constrained")
    axis = figure.subplots()
    places, hatches = np.arange(len(BENCH)), ("", "///")
    for index, (solver, run) in enumerate(runs.items()):
        at = places + 0.4 * (index - 0.5)
        axis.bar(
            at,
            run.rms_percent,
            0.38,
            color=LOOKS[solver]["color"],
            hatch=hatches[index],
            edgecolor="white",
            label=solver,
        )
    axis.axhline(RMS_PERCENT, color="black", linestyle=":", label=f"published, mean of 15 contacts: {RMS_PERCENT} %")
    axis.set_yscale("log")
    axis.set_xticks(places, [name.replace("_", " ") for name in BENCH], rotation=35, ha="right")
    axis.set_ylabel("RMS, % of peak")
    axis.legend(fontsize=8)
    text = (
        "Against double precision over the whole frame, no scale or offset fitted. The error itself is nearly the same "
        "for all contacts, so a shallow one shows a larger percentage."
    )
    commands = "; ".join(run.command for run in runs.values())
    return Section("errors", "Error of each contact", text, commands, picture=saved(figure, folder, "errors"))


def curve(
    rows: Sequence[sweep.Row], point: sweep.Point, varied: str, measured: str = "rms_percent_mean"
) -> tuple[list[int], list[float]]:
    """Return the widths that vary and an error at each, of the rows that are otherwise `point`."""
    found = sorted((getattr(row, varied), getattr(row, measured)) for row in sweep.like(rows, point, varied))
    return [width for width, _ in found], [error for _, error in found]


def word_section(rows: Sequence[sweep.Row], folder: Path) -> Section:
    figure = Figure(figsize=(11, 4), layout="constrained")
    left, right = figure.subplots(1, 2, sharey=True)
    default = Configuration()
    for solver in COLUMNS:
        look, point = LOOKS[solver], sweep.square(solver=solver)
        for axis, varied in ((left, STORED), (right, COEFFICIENT)):
            axis.plot(*curve(rows, point, varied), **look, label=solver, markersize=4)
            thin = look | {"marker": "", "linewidth": 0.7}
            axis.plot(*curve(rows, point, varied, "rms_percent_worst"), **thin)
        safe = look | {"marker": "", "linestyle": (0, (1, 1.5)), "label": f"{solver}, {sweep.SAFE_WORD}"}
        left.plot(*curve(rows, point.but(**sweep.SAFE), STORED), **safe)
    for axis, name in ((left, "bits of a stored word"), (right, "bits of a coefficient")):
        axis.axhline(RMS_PERCENT, color="black", linestyle=":")
        axis.set(yscale="log", xlabel=name)
        axis.xaxis.set_major_locator(MaxNLocator(integer=True))
        axis.grid(alpha=0.3)
    left.set_ylabel("RMS, % of peak")
    left.legend()
    text = (
        f"Mean of the contacts at {SIZE} (with marks), and the worst (thin). Left with {default.coefficient.width}-bit "
        f"coefficients, right with {default.depth.width}-bit words. Dotted and level: the published {RMS_PERCENT} %; "
        "dotted and falling: the mean where no slopes can saturate anything."
    )
    return Section("words", "Word lengths", text, "make sweep", picture=saved(figure, folder, "words"))


def budget_section(document: dict[str, Any], folder: Path) -> Section:
    text = (
        "What a user gets, in mm, and what it is made of: one cause after the other is switched off, or replaced by "
        "the truth. Quantisation is the part of the arithmetic; all others are those of the sensor."
    ) + of_commit(document)
    picture = folder / "budget.png"
    budget.plot(picture, document)
    whole, *parts = budget.tables(document)
    tables = [whole._replace(title="The whole error"), *parts]
    return Section("budget", "The error of a real sensor", text, "make budget", tables, picture)


def trade_sections() -> list[Section]:
    """Return the figure of `make trade`, if it was run: it needs real presses."""
    path = trade.DEFAULT_OUT / "trade.csv"
    if not path.exists():
        return []
    front = trade_front.front_of(study.read(path, trade_front.Row))
    text = (
        "Real presses, by calibrations that were not fitted to them. Grey: each configuration; line: the best for its "
        f"cost. Finer arithmetic than that of the knee buys nothing that can be seen. {front.sentence}."
    )
    title, picture = "Accuracy against silicon and latency", trade.DEFAULT_OUT / "trade.png"
    return [Section("trade", title, text, "make trade", [Table(trade_front.HEAD, front.changes)], picture)]


def extremes_sections(folder: Path) -> list[Section]:
    """Return the figures that `make extremes` left in a folder."""
    document = json.loads((folder / "extremes.json").read_text())
    text = (
        "Errors against double precision; where there is no depth to speak of, in codes. Where values are clipped the "
        "sticky status bit says so; none wraps."
    )
    rows = [shown(extremes.Row, document["extremes"])]
    edges = Section("extremes", "At the extremes", text, EXTREMES_COMMAND, rows)
    blocks = [shown(Compliance, document["compliance"])]
    text = (
        "Peak, mean square and mean error of the transform cores over blocks of random words, in codes of their output."
    )
    return [edges, Section("transforms", "The transforms, in the manner of IEEE 1180", text, EXTREMES_COMMAND, blocks)]


def reflex_section(document: dict[str, Any]) -> Section:
    rows, columns = document["grid"]
    text = (
        f"{rows} x {columns}, {document['clock_mhz']:g} MHz, a pin at {document['speed_mm_s']:g} mm/s. Every command "
        "near the sensor is the clock in which the RTL's pin `contact` rises. Diamonds: mean and standard deviation. "
    )
    text += ". ".join(reflex_tables.sentences(document)) + "."
    command = f"make reflex N={rows} CLOCK_MHZ={document['clock_mhz']:g} SEED={document['seed']}"
    picture = reflex.DEFAULT_OUT / "reflex.png"
    return Section("reflex", "The reflex", text, command, reflex_tables.tables(document), picture)


def baselines_section(document: dict[str, Any]) -> Section:
    text = f"{baselines.setting(document)}. {'. '.join(baselines.sentences(document))}.{of_commit(document)}"
    picture = None if RECORDED in document else baselines.DEFAULT_OUT / "baselines.png"
    return Section("baselines", "The solve in software", text, "make baselines", baselines.tables(document), picture)


def synth_section(document: dict[str, Any]) -> Section:
    text = "On an XCZU7EV, as Yosys maps it, beside the published design. " + " ".join(synth.NOTES)
    return Section("synth", "Resources of an FPGA", text, document["command"], [synth.resources_of(document)])


def fpga_section(document: dict[str, Any]) -> Section:
    rows = [
        *((f"clock, seed {seed}", f"{mhz:.1f} MHz") for seed, mhz in document["fmax_mhz_by_seed"].items()),
        *((name, f"{use['used']:,} of {use['available']:,}") for name, use in document["utilization"].items()),
    ]
    text = (
        f"{' x '.join(map(str, document['grid']))}, {document['solver']}, placed and routed: "
        f"{document['fmax_mhz']:.1f} MHz is the median of {len(document['fmax_mhz_by_seed'])}; "
        f"{document['clock_mhz']:g} MHz is the board's clock."
    )
    return Section("fpga", "On a board: the ULX3S", text, document["command"], [Table(("", ""), rows)])


def asic_section(document: dict[str, Any]) -> Section:
    tables = [asic.area_and_power(document)]
    return Section("asic", "In standard cells", document["method"], document["command"], tables)


def hardware_sections() -> list[Section]:
    """Return the latest result of each flow; a flow takes minutes, so a page does not run it."""
    flows = {"synth": synth_section, "fpga": fpga_section, "asic": asic_section}
    return [figure(documents[-1]) for flow, figure in flows.items() if (documents := results(flow))]


def seconds(short: bool) -> dict[str, float]:
    """Return the time that each part of the report takes, by its name, without parts that are there already."""
    parts: dict[str, float] = {f"{CONSECUTIVE:,} frames through the RTL of each solver": RTL_S, "page": PAGE_S}
    if not short:
        parts |= {"sweep": sweep.SWEEP.seconds_left(sweep.plan(), sweep.DEFAULT_OUT), "extremes": EXTREMES_S}
        takes = {"budget": BUDGET_S, "reflex": REFLEX_S, "baselines": baselines.SECONDS}
        parts |= {name: takes[name] for name, command in COMMANDS.items() if not file_of(command, name).exists()}
    return {name: time for name, time in parts.items() if time >= 1}


def announce(parts: dict[str, float]) -> None:
    """Print how long the report takes."""
    each = ", ".join(f"{name} {duration(time)}" for name, time in parts.items())
    print(f"report takes about {duration(sum(parts.values()))} on two cores ({each})", flush=True)


def build(folder: Path, short: bool = False) -> Path:
    """Measure and write the page; returns its path. Raises InputError, Mismatch or RuntimeError."""
    files.make(folder, [PAGE])
    announce(seconds(short))

    def step(name: str, call: Callable[..., Any], *arguments: Any) -> Any:
        print(f"{name} ..", flush=True)
        return call(*arguments)

    runs = {s: step(f"{s}: {CONSECUTIVE} frames through the RTL", run_rtl, s, folder) for s in COLUMNS}
    of = recorded_document if short else document_of
    documents = {name: step(name, of, command, name) for name, command in COMMANDS.items()}
    sections = [
        summary(dict(reversed(runs.items())), folder),
        *([budget_section(documents["budget"], folder)] if documents["budget"] else []),
        latency_section(runs, folder),
        grid_section(folder),
        *depth_sections(runs, folder),
        error_section(runs, folder),
        *trade_sections(),
    ]
    if not short:
        rows = step("sweep", sweep.SWEEP.complete, sweep.plan(), sweep.DEFAULT_OUT)
        step("extremes", run_extremes, folder / "extremes")
        sections += [word_section(rows, folder), lanes_section(rows, folder)]
        sections += extremes_sections(folder / "extremes")
    sections += hardware_sections()
    sections += [reflex_section(documents["reflex"])] if documents["reflex"] else []
    sections += [baselines_section(documents["baselines"])] if documents["baselines"] else []
    with files.workspace(folder) as work:
        (work / PAGE).write_text(page(sections, LEFT_OUT if short else ""))
        files.replace(work, [PAGE], folder)
    return folder / PAGE


def main(out: variables.Place = DEFAULT_OUT, short: variables.Flag = False) -> None:
    print(f"report: {os.path.relpath(build(out, short))}")
