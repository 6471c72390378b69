# SPDX-License-Identifier: Apache-2.0
"""`make figures`: write the tables of figures in PAGES of docs/ and that of promises (promises.py), and draw.

Cycles, multipliers, bits and errors of the arithmetic are computed here, by the models that the RTL is compared with.
Figures of runs that take minutes come from docs/figures.json, each with its commit, and with "changed" where the RTL,
parameters and tables of the run, or the code that was timed, are no longer those of that commit. Waveforms and diagrams
of pages are drawn from docs/waves/*.json and docs/*.dot, docs/film.png from real presses where they are.
"""

import json
import re
import subprocess
import sysconfig
from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import partial
from math import prod
from pathlib import Path
from typing import Any

import numpy as np
import wavedrom

from commands.common import published, recorded, run_request
from commands.common.repository import GENERATED, ROOT
from commands.common.tabular import Table, span
from commands.common.zero_offset import untouched
from commands.cost.cost import CAMERAS, KINDS, XCZU7EV, cost
from commands.hardware import estimate, lut_runs, memory_model, synth, synthesis
from commands.hardware.targets import DEFAULT_TARGET, SEVEN_SERIES, TARGETS
from commands.run.sim_table import coefficient_words
from commands.study import baselines, budget, press_film, presses, promises, trade_front
from commands.study.accuracy import errors
from commands.study.press_map import press_map
from tactile_depth.chip import latency
from tactile_depth.chip.configuration import COLOURS, DEFAULTS, NUMBERS, STORED, Configuration
from tactile_depth.chip.latency import first_depth_latency, last_pixel_to_first_depth, last_pixel_to_last_depth
from tactile_depth.chip.limits import most_lanes
from tactile_depth.depth.twin import Twin

NAMES = ("make-sim", "architecture", "results", "hardware", "software", "error-budget", "accuracy")
PAGES = [ROOT / "docs" / f"{name}.md" for name in NAMES]
TABLE = re.compile(r"(<!-- figures: ([^\n]+) -->\n).*?(\n<!-- end of figures -->)", re.DOTALL)
GRIDS = (64, 128, 256)
LANE_GRIDS = (*GRIDS, 512)
FEWEST_LANES_AGAINST_SOFTWARE = 16
FRAMES = "FRAMES=contacts"
REAL_SENSOR = COLOURS | {"neumann": True, "zero_offset": True}
BUILDS = {  # of docs/architecture.md, 128 x 128
    "tridiagonal, real sensor": Configuration(solver="tridiagonal", **REAL_SENSOR),
    "tridiagonal, as sent": Configuration(solver="tridiagonal"),
    "spectral, as sent": Configuration(),
}
NODES = {  # formats of a configuration, by build and signal
    "tridiagonal, as sent": {
        "slope": "gradient",
        "divergence": "divergence",
        "forward transform of a row": "row_forward",
        "elimination": "elimination",
        "stored word of the frame store": "elimination_store",
        "inverse transform of a row": "row_inverse",
        "depth": "depth",
    },
    "spectral, as sent": {
        "slope": "gradient",
        "divergence": "divergence",
        "forward transform of a row": "row_forward",
        "stored word of the first frame store": "row_modes",
        "forward transform of a column": "column_forward",
        "inverse transform of a column": "column_inverse",
        "stored word of the second frame store": "depth_modes",
        "inverse transform of a row": "row_inverse",
        "depth": "depth",
    },
}
SOURCE = ("commit", "sources since")  # heads of the last columns of recorded figures


def error_percent(arguments: list[str]) -> tuple[Configuration, str]:
    """Return the configuration of `make sim` with these variables, and its RMS error in % of peak: mean (worst)."""
    request = run_request.parse(arguments)
    frames, calibration, config = synthesis.design(request)
    twin = Twin(calibration, config, untouched(request, frames))
    codes, light, _ = twin.played(frames.pixels)
    exact = twin.exact_px(frames.pixels, None if light is None else light[0])
    rms = [value for value in errors(codes[0] * config.depth_lsb_px, exact)["rms_percent_of_peak"] if value is not None]
    return config, f"{np.mean(rms):.4f} ({max(rms):.4f})"


def configurations(*arguments: str, neumann: bool = False) -> Table:
    """Return the table of a configuration over GRIDS; with `neumann` the error with that boundary too."""
    runs = [error_percent([*arguments, FRAMES, f"N={size}"]) for size in GRIDS]
    configs = [config for config, _ in runs]
    costs = [cost(config) for config in configs]
    rows = {
        "first pixel to first depth, cycles": [f"{first_depth_latency(config):,}" for config in configs],
        "last pixel to first depth, cycles": [f"{last_pixel_to_first_depth(config):,}" for config in configs],
        "frame interval, cycles": [f"{config.rows * config.columns:,}" for config in configs],
        "error, % of peak": [error for _, error in runs],
    }
    if neumann:
        with_slopes = [error_percent([*arguments, "BOUNDARY=neumann", FRAMES, f"N={size}"])[1] for size in GRIDS]
        rows["error, `BOUNDARY=neumann`"] = with_slopes
    rows |= {
        "multipliers 27 x 18": [str(one.tiles) for one in costs],
        "all memories, bits": [f"{one.memory_bits:,}" for one in costs],
        "coefficients of the solver, words": [f"{coefficient_words(config):,}" for config in configs],
    }
    return Table((f"`make sim {' '.join(arguments)} N=..`", *map(str, GRIDS)), [(n, *r) for n, r in rows.items()])


def numbers() -> Table:
    rows = [
        (f"`{number.variable}`, `{number.option.split()[0]}`, `{number.argument}`",
         "{} ({} to {})".format(DEFAULTS[name], *number.accepted),
         f"{number.meaning}{', with a `REFERENCE`' if number.colours else ''}")
        for name, number in NUMBERS.items()
    ]  # fmt: skip
    return Table(("variable, option, argument", "default", "meaning"), rows)


def cycles_by_core() -> Iterator[Table]:
    """Yield for each build unit, core and cycles from the last pixel of a frame to its first depth, and their sum."""
    for name, config in BUILDS.items():
        rows = [row for row in latency.by_core(config) if row[2]]
        whole = ("", "**sum**", f"**{sum(row[2] for row in rows):,}**")
        yield Table(("unit", "core", "cycles"), [*rows, whole], f"Build: {name}.")


def number_formats() -> Iterator[Table]:
    for name, nodes in NODES.items():
        formats = {signal: getattr(BUILDS[name], node) for signal, node in nodes.items()}
        rows = [(s, form.width, form.fraction, f"{form.limit:g}", f"2^-{form.fraction}") for s, form in formats.items()]
        yield Table(("signal", "bits", "fraction", "full scale", "step"), rows, f"Build: {name}.")


def costs_by_build() -> Table:
    costs = {name: cost(config) for name, config in BUILDS.items()}
    rows = [
        (name, one.tiles, *(f"{one.bits_of(kind):,}" for kind in KINDS), f"{one.memory_bits:,}")
        for name, one in costs.items()
    ]
    return Table(("build", "multipliers", *(f"{kind}, bits" for kind in KINDS), "all memories, bits"), rows)


def costs_by_core() -> Table:
    """Return the table of multipliers / bits of memory of each core in each build."""
    counts = [cost(config).by_core() for config in BUILDS.values()]
    rows = [
        (core, *("{} / {:,}".format(*count[core]) if core in count else "" for count in counts))
        for core in dict.fromkeys(core for count in counts for core in count)
    ]
    return Table(("core", *BUILDS), rows)


def lane_configurations(fewest: int = 1) -> Iterator[Configuration]:
    """Yield the tridiagonal solver with each number of lanes that is a power of two, colours as sent."""
    for size in LANE_GRIDS:
        lanes = fewest
        while lanes <= most_lanes(size):
            yield Configuration(columns=size, solver="tridiagonal", lanes=lanes)
            lanes *= 2


def lanes() -> Table:
    rows = []
    for config in lane_configurations():
        if config.lanes.bit_length() % 2 == 0:
            continue  # 1, 4, 16, 64: what lies between is as one expects
        last, one = last_pixel_to_last_depth(config), cost(config)
        cells = (f"{last_pixel_to_first_depth(config):,}", f"{last:,}", f"{last / published.CLOCK_MHZ:,.1f}")
        grid = f"{config.rows} x {config.columns}"
        rows.append((grid, config.lanes, *cells, one.tiles, f"{one.memory_bits / 1e6:.2f}"))
    head = ("grid", "lanes", "first depth", "last depth", "last depth, us", "multipliers", "memory, Mbit")
    return Table(head, rows)


def published_design() -> Table:
    def of_grids(values: dict[int, int]) -> list[str]:
        return [f"{values[size]:,}" if size in values else "-" for size in GRIDS]

    dsp = {size: known["DSP48E2"] for size, known in published.RESOURCES.items() if "DSP48E2" in known}
    error = f"{published.RMS_PERCENT} ({published.WORST_RMS_PERCENT})"
    rows = [
        ("first pixel to first depth, cycles", *of_grids(published.FIRST_DEPTH_CYCLES)),
        ("error, % of peak, mean over 15 contacts (worst)", "-", error, "-"),
        ("DSP48E2", *of_grids(dsp)),
        ("as an ASIC, 45 nm", "-", f"{published.ASIC_AREA_MM2:.2f} mm2, {published.ASIC_POWER_MW:.0f} mW", "-"),
    ]
    for name, one in {name: one for name, _, one, _ in estimate.designs() if name != "chip"}.items():
        area, power = span(one.placed_mm2, ".2f"), span(one.placed_mw, ".0f")
        rows.append((f"this design, {name}: estimate at 45 nm", "-", f"{area} mm2, {power} mW", "-"))
    return Table(("published", *map(str, GRIDS)), rows)


def runs(command: str) -> Iterator[tuple[str, dict[str, Any], tuple[str, str]]]:
    """Yield name, figures and source cells of each recorded run of a command, with its TARGET or without."""
    for line, entry in sorted(recorded.load().items()):
        if {*command.split()} <= {*line.split()} and "figures" in entry:
            yield entry.get("name", f"`{line}`"), entry["figures"], (entry["commit"], recorded.since(line, entry))


def synthesized(over_grids: bool, target: str = DEFAULT_TARGET) -> Table:
    head: Sequence[str] = ("make synth",)
    rows: list[Sequence[object]] = []
    for name, figures, source in runs("synth"):
        if (len(figures["designs"]) > 1) != over_grids or figures.get("target", DEFAULT_TARGET) != target:
            continue
        columns, cells, _ = synth.resources_of(figures)
        if over_grids:
            head = (*columns[:-1], *SOURCE)
            rows += [(*each[:-1], *(("stated", "-") if each[0] == "published" else source)) for each in cells]
        else:
            last = -1 if target == DEFAULT_TARGET else -2  # without the column of UltraRAM
            head = ("design", *columns[1:last], *SOURCE)
            rows += [(name, *each[1:last], *source) for each in cells if each[0] != "published"]
    return Table(head, rows)


def on_7_series() -> Table:
    """Return the table of designs on Artix-7 and Zynq-7000, each resource with its share of the device."""
    rows, head = [], ("design", "grid", *SEVEN_SERIES["xc7z020"].has, *SOURCE)
    for name, figures, source in runs("synth"):
        if target := SEVEN_SERIES.get(figures.get("target", "")):
            for design in figures["designs"]:
                used = design["totals"]
                cells = (f"{used[cell]:,g} ({100 * used[cell] / has:.0f} %)" for cell, has in target.has.items())
                rows.append((name, "{} x {}".format(*design["configuration"]["grid"]), *cells, *source))
    return Table(head, rows)


def clocks(figures: dict[str, Any]) -> str:
    """Return the routed clock in MHz: the median (and that of each seed)."""
    each = ", ".join(f"{mhz:.1f}" for mhz in figures["fmax_mhz_by_seed"].values())
    return f"{figures['fmax_mhz']:.1f} ({each})"


def routed() -> Table:
    rows = []
    for name, figures, source in runs("fpga TARGET=ulx3s"):
        delays = figures.get("crossing_ns_by_seed", {}).values()
        crossing = f"{max(delays):.2f} ns" if delays else "-"
        used = (f"{figures['utilization'][cell]['used']:,}" for cell in ULX3S_CELLS)
        rows.append((name, clocks(figures), figures["clock_mhz"], crossing, *used, *source))
    head = (
        "build",
        "routed clock, MHz: median (each seed)",
        "asked",
        "bits that cross, at most",
        *ULX3S_CELLS.values(),
    )
    return Table((*head, *SOURCE), rows)


ULX3S_CELLS = {"MULT18X18D": "MULT18X18D", "DP16KD": "DP16KD", "TRELLIS_COMB": "LUT", "TRELLIS_FF": "registers"}


def routed_alone() -> Table:
    rows = []
    for _, figures, source in runs("fpga TARGET=nexus"):
        used = (f"{figures['utilization'][cell]['used']:,}" for cell in NEXUS_CELLS)
        words = (figures[STORED], figures["lanes"], figures["device"], figures["products_in_luts"])
        rows.append((*words, clocks(figures), f"{figures['clock_mhz']:g}", *used, *source))
    head = ("bits of a word", "lanes P", "device", "products in LUTs", "routed clock, MHz: median (each seed)")
    return Table((*head, "assumed elsewhere, MHz", *NEXUS_CELLS.values(), *SOURCE), rows)


NEXUS_CELLS = {"MULT18_CORE": "18 x 18", "OXIDE_EBR": "block memories", "OXIDE_COMB": "LUT", "OXIDE_FF": "registers"}


def measured() -> list[tuple[str, dict[str, Any], tuple[str, str]]]:
    """Return the runs of `make asic`, the published configuration first, in the order of the recorded ones at 45 nm."""
    order = list(estimate.recorded_runs())
    return sorted(runs("asic"), key=lambda run: order.index(run[0]) if run[0] in order else len(order))


def in_cells() -> Table:
    rows = []
    for name, figures, source in measured():
        logic, (cells, memory, _), largest = figures["logic"], figures["figures"], figures["cores"][0]
        frames = f"{cells['power_mw']:,.0f}"
        if len(by_frame := figures["power_mw_by_frame"]) > 1:
            frames += f" ({span(by_frame, ',.0f')})"
        area, power = (f"{memory['area_mm2']:.2f}", f"{memory['power_mw']:,.0f}")
        part = f"{largest['area_um2'] / 1e6:.2f}, {largest['with_delays_mw']:,.0f}, {largest['delay_factor']:.2f}"
        row = (name, f"{cells['area_mm2']:.2f}", area, frames, power, part, f"{logic['worst_slack_ns']:.2f}")
        rows.append((*row, *source))
    head = ("`make asic`", "logic, mm2", "memories", "logic, mW (each frame)", "memories")
    return Table((*head, "`td_multiply`: mm2, mW, by delays", "slack, ns", *SOURCE), rows)


def recorded_at_45_nm() -> Table:
    rows = []
    for name, run in estimate.recorded_runs().items():
        logic, ratios = run["at_45"], estimate.ratios(name)
        figures = (f"{logic['area_mm2']:.3f}", f"{logic['power_mw']:.1f}", f"{logic['worst_slack_ns']:.2f}")
        each = (f"{ratios.area:.4f}", f"{ratios.clock:.4f}", f"{ratios.toggling:.4f}", f"{ratios.leakage:.1f}")
        rows.append((name, *figures, *each, run["commit"]))
    head = ("logic", "mm2", "mW", "slack, ns", "ratio of area", "of clock pins", "of toggling", "leakage, mW per mm2")
    return Table((*head, "commit"), rows)


def estimated() -> Table:
    rows: list[tuple[str, ...]] = []
    for name, known, one, commit in estimate.designs():
        area = (f"{one.logic_mm2:.2f}", span(one.memory_mm2, ".2f"), span(one.placed_mm2, ".2f"))
        power = (f"{one.logic_mw:.0f}", f"{one.memory_mw:.0f}", span(one.placed_mw, ".0f"))
        rows.append((f"{name}{known}", *area, *power, commit))
    bits = published.RESOURCES[128]["UltraRAM"] * prod(XCZU7EV.ultra_shape or ())
    per_bit = min(ram.area_um2 / ram.bits for ram in memory_model.RAMS)
    stores = f"its UltraRAMs, {bits / 1e6:.2f} Mbit, at {per_bit:.2f} um2 a bit"
    whole = (f"{published.ASIC_AREA_MM2:.2f}", "-", "-", f"{published.ASIC_POWER_MW:.0f}")
    rows[1:1] = [
        ("published", "-", "-", *whole, "-"),
        (stores, "-", f"{bits * per_bit / 1e6:.2f}", *"-----"),
    ]
    head = ("45 nm, 166 MHz", "logic, mm2", "memories", "placed", "logic, mW", "memories", "placed")
    return Table((*head, "commit"), rows)


def against_software() -> Iterator[Table]:
    """Yield the table of the whole map against the fastest software, with present cycles at the published clock."""
    for name, document, source in runs("baselines"):
        rows = []
        best = {(row["grid"], row["from_pixels"]): row for row in baselines.fastest(document["software"])}
        for config in lane_configurations(FEWEST_LANES_AGAINST_SOFTWARE):
            solve, pixels = (best[config.columns, from_pixels] for from_pixels in (False, True))
            cycles = last_pixel_to_last_depth(config)
            micros = cycles / published.CLOCK_MHZ
            times = (", ".join(baselines.times_of(row)) for row in (solve, pixels))
            earlier = (f"{row['p50_us'] / micros:.1f}" for row in (solve, pixels))
            grid = f"{config.rows} x {config.columns}"
            equal = f"{cycles / solve['p50_us']:.0f}"
            rows.append((grid, config.lanes, f"{cycles:,}", f"{micros:.1f}", *times, *earlier, equal))
        head = (
            *("grid", "lanes", "last pixel to last depth, cycles", f"us at {published.CLOCK_MHZ:g} MHz"),
            *("the solve in software, us: p50, p99, maximum", "from the pixels, us: p50, p99, maximum"),
            *("the solve / pipeline", "from the pixels / pipeline", "clock at which map and solve are equal, MHz"),
        )
        setting = f"{name}: {baselines.setting(document)} (commit {source[0]}, {SOURCE[1]}: {source[1]})."
        yield Table(head, rows, setting)


def trade() -> Iterator[Table]:
    for name, figures, (commit, since) in runs("trade"):
        line = f"{name}, commit {commit}, {SOURCE[1]}: {since}. {trade_front.Front(**figures).sentence}."
        yield Table(trade_front.HEAD, figures["changes"], line)


def camera_front_end() -> Table:
    known = json.loads(CAMERAS.read_text())
    devices = [target.device for target in TARGETS.values()]
    rows = [
        (f"`{name}`", *(f"{count:,}" for device in devices for count in known[device.name][name]))
        for name in known[devices[0].name]
    ]
    return Table(("camera front end", *(n for d in devices for n in (d.multiplier, d.block, "LUT"))), rows)


def accuracy() -> Iterator[Table]:
    for _, document, (commit, since) in runs("presses"):
        table = presses.accuracy_table(document)
        yield table._replace(title=f"{table.title} Commit {commit}, {SOURCE[1]}: {since}.")


def depth_error() -> Iterator[Table]:
    for _, document, (commit, since) in runs("budget"):
        line = f"{budget.setting(document)}. Commit {commit}, {SOURCE[1]}: {since}."
        yield budget.whole_errors(document)._replace(title=line)


def error_parts() -> list[Table]:
    return [budget.shares(each) for _, document, _ in runs("budget") for each in document["sources"][::-1]]


def software_throughput() -> list[Table]:
    return [baselines.throughput(document)._replace(title="") for _, document, _ in runs("baselines")]


def software_methods() -> Table:
    head = ("128 x 128", "threads", "p50, us", "p99, us", "maximum, us", "error, % of peak")
    rows = [
        (row["method"], row["threads"], *baselines.times_of(row),
         f"{row['error_percent']:.6f}")
        for _, document, _ in runs("baselines")
        for row in document["software"]
        if row["grid"] == 128
    ]  # fmt: skip
    return Table(head, rows)


TABLES: dict[str, Callable[[], Table | Iterable[Table]]] = {
    "numbers": numbers,
    "cycles": cycles_by_core,
    "formats": number_formats,
    "costs": costs_by_build,
    "cores": costs_by_core,
    "real sensor, tridiagonal": partial(configurations, "PRESET=sensor", "SOLVER=tridiagonal"),
    "real sensor, spectral": partial(configurations, "PRESET=sensor", "SOLVER=spectral"),
    "colours as sent, tridiagonal": partial(configurations, "SOLVER=tridiagonal", neumann=True),
    "colours as sent, spectral": partial(configurations, "SOLVER=spectral", neumann=True),
    "lanes": lanes,
    "published design": published_design,
    "make synth over grids": partial(synthesized, True),
    "make synth": partial(synthesized, False),
    "make synth TARGET=ecp5": partial(synthesized, False, "ecp5"),
    "make synth on the 7 series": on_7_series,
    "make fpga": routed,
    "make fpga TARGET=nexus": routed_alone,
    "make asic": in_cells,
    "recorded at 45 nm": recorded_at_45_nm,
    "estimate at 45 nm": estimated,
    "whole map against software": against_software,
    "cost model": lut_runs.runs_and_model,
    "camera front end": camera_front_end,
    "trade": trade,
    "accuracy": accuracy,
    "depth error": depth_error,
    "parts of the depth error": error_parts,
    "throughput of software": software_throughput,
    "methods at 128": software_methods,
}


def document(page: Path) -> str:
    """Return a page with fresh tables."""

    def fresh(found: re.Match[str]) -> str:
        made = TABLES[found[2]]()
        tables = [made] if isinstance(made, Table) else made
        text = "\n".join(table.markdown() for table in tables)
        return f"{found[1]}\n{text}{found[3]}"

    return TABLE.sub(fresh, page.read_text())


def drawings() -> dict[Path, str]:
    """Return each waveform and diagram that pages show, as SVG."""
    draw = [f"{sysconfig.get_path('scripts')}/graphviz-pure", "-Tsvg"]
    docs = ROOT / "docs"
    waves = {file: wavedrom.render(file.read_text()).tostring() + "\n" for file in docs.glob("waves/*.json")}
    diagrams = {
        file: subprocess.run([*draw, file], capture_output=True, text=True, check=True).stdout
        for file in docs.glob("*.dot")
    }
    digit = docs / "digit.csv"
    drawn = waves | diagrams | {digit: press_map(digit)}
    return {GENERATED / f"{file.stem}.svg": text for file, text in drawn.items()}


def main() -> None:
    for drawing, text in drawings().items():
        drawing.write_text(text)
    for page in PAGES:
        page.write_text(document(page))
    promises.PAGE.write_text(promises.document())
    if reason := press_film.draw_if_there():
        print(reason)
