# SPDX-License-Identifier: Apache-2.0
"""`make sim`: streams frames through the RTL, checks every code, prints a table, draws.

Takes the variables of the README's table as KEY=VALUE arguments. Exit status: 0 bit-exact, 1 not, 2 bad input.
"""

from __future__ import annotations

import fcntl
import hashlib
import json
import math
import os
import shutil
import sys
import tempfile
import threading
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from tqdm import tqdm

from commands import simulator as simulation
from commands.draw import draw_depth
from models import latency, reference
from models.accuracy import errors
from models.calibration import Calibration, load
from models.certificate import deepest
from models.configuration import COLUMNS, Configuration
from models.errors import InputError
from models.frames import Frames, load_frames
from models.round_saturate import Monitor
from models.scenes import NOISE, SENSOR_WIDTH_MM, Press
from models.spectral_divide import reciprocal_rom
from models.tactile_depth import tactile_depth, top_parameters, write_roms
from models.thomas_table import thomas_table

BENCH = "frame_bench"
DEFAULT_SCENE = "ball"
WORST = "worst"  # a depth range that no slopes can leave
SOLVERS = tuple(COLUMNS)
BOUNDARIES = ("dirichlet", "neumann")
CONTACT_THRESHOLD = 1 / 128  # of the shorter side: one pixel at 128
ROWS_SHOWN = 16


@dataclass(frozen=True)
class Request:
    """What the user asked for, checked as far as it can be without reading files."""

    rows: int
    columns: int
    solver: str
    boundary: str
    simulator: str
    data_width: int
    coefficient_width: int
    depth_range_mm: float | None  # infinite: as deep as any slopes can make it
    frames: str
    press: Press
    reference: str | None
    calibration: str
    repeat: int
    seed: int
    gaps: float
    stalls: float
    waves: bool
    out: Path | None


def parse(arguments: list[str]) -> Request:
    """KEY=VALUE arguments to a Request; an empty value means the default.

    Raises
    ------
    InputError
    """
    accepted = (
        "N ROWS COLS SOLVER BOUNDARY SIM DATA_WIDTH COEFF_WIDTH DEPTH_RANGE FRAMES PRESS AT NOISE REFERENCE "
        "CALIBRATION REPEAT SEED GAPS STALLS WAVES CONFIG OUT"
    )
    given: dict[str, str] = {}
    for argument in arguments:
        key, equals, value = argument.partition("=")
        if not equals or key not in accepted.split():
            raise InputError(f"{argument}: unknown variable: accepted are {accepted.replace(' ', ', ')}")
        if value:
            given[key] = value
    if "CONFIG" in given:
        given = from_file(Path(given.pop("CONFIG")), given, accepted.replace("CONFIG ", "").split()) | given

    def number(key: str, default: float, low: float, high: float, kind: type = int) -> float:
        if key not in given:
            return default
        try:
            value = kind(given[key])
        except ValueError:
            value = math.nan
        if not low <= value <= high:
            what = "a whole number" if kind is int else "a number"
            to = f" from {low:,g} to {high:,g}" if math.isfinite(high) else ""
            raise InputError(f"{key}={given[key]}: accepted is {what}{to}")
        return value

    def choice(key: str, accepted: tuple[str, ...]) -> str:
        value = given.get(key, accepted[0])
        if value not in accepted:
            raise InputError(f"{key}={value} is unknown: accepted are {', '.join(accepted)}")
        return value

    def position(key: str) -> tuple[float, float]:
        try:
            x, y = (float(part) for part in given.get(key, "0,0").split(","))
        except ValueError:
            x = y = math.nan
        if not max(abs(x), abs(y)) <= SENSOR_WIDTH_MM:
            raise InputError(f"{key}={given[key]}: accepted is x,y in mm from the middle of the frame, as 2.5,-1")
        return x, y

    both = number("N", 128, -math.inf, math.inf)
    return Request(
        rows=int(number("ROWS", both, -math.inf, math.inf)),  # the configuration says which
        columns=int(number("COLS", both, -math.inf, math.inf)),
        solver=choice("SOLVER", SOLVERS),
        boundary=choice("BOUNDARY", BOUNDARIES),
        simulator=choice("SIM", simulation.SIMULATORS),
        data_width=int(number("DATA_WIDTH", 24, -math.inf, math.inf)),
        coefficient_width=int(number("COEFF_WIDTH", 18, -math.inf, math.inf)),
        depth_range_mm=math.inf
        if given.get("DEPTH_RANGE") == WORST
        else number("DEPTH_RANGE", 0, 1e-6, 1e6, float) or None,
        frames=given.get("FRAMES", DEFAULT_SCENE),
        press=Press(
            number("PRESS", 0, 1e-3, SENSOR_WIDTH_MM, float) or None,
            position("AT"),
            number("NOISE", NOISE, 0, 255, float),
        ),
        reference=given.get("REFERENCE"),
        calibration=given.get("CALIBRATION", "synthetic"),
        repeat=int(number("REPEAT", 1, 1, 100_000)),
        seed=int(number("SEED", 1, 0, 10**9)),
        gaps=number("GAPS", 0, 0, 0.99, float),
        stalls=number("STALLS", 0, 0, 0.99, float),
        waves=bool(number("WAVES", 0, 0, 1)),
        out=Path(given["OUT"]) if "OUT" in given else None,
    )


def from_file(path: Path, given: dict[str, str], accepted: list[str]) -> dict[str, str]:
    """Variables of a configuration file, a JSON object; an N that is `given` replaces rows and columns of the file.

    Raises
    ------
    InputError
    """
    try:
        values = json.loads(path.read_text())
    except (OSError, ValueError) as error:
        reason = (error.strerror if isinstance(error, OSError) else None) or "not JSON"
        raise InputError(f"CONFIG={path}: cannot be read ({reason}): give a file of `make tune`") from error
    if not isinstance(values, dict):
        raise InputError(f"CONFIG={path}: accepted is one JSON object of variables")
    for key, value in values.items():
        if key not in accepted:
            raise InputError(f"CONFIG={path}: unknown variable {key}: accepted are {', '.join(accepted)}")
        if isinstance(value, bool) or not isinstance(value, str | int | float):
            raise InputError(f"CONFIG={path}: {key} is {json.dumps(value)}: accepted is a number or a string")
    replaced = ("ROWS", "COLS") if "N" in given else ()
    return {key: str(value) for key, value in values.items() if key not in replaced}


def configure(request: Request, calibration: Calibration, pixel_pitch_mm: float) -> Configuration:
    """The pipeline for a request; the depth range becomes grid pixels."""
    neumann = request.boundary == "neumann"
    depth_range = request.depth_range_mm
    if depth_range == math.inf:
        Configuration(columns=request.columns, rows=request.rows, solver=request.solver)  # refuses a grid first
        depth_range_px = deepest(request.rows, request.columns, neumann) * calibration.gradient_limit
    else:
        depth_range_px = None if depth_range is None else depth_range / pixel_pitch_mm
    return Configuration(
        columns=request.columns,
        rows=request.rows,
        solver=request.solver,
        neumann=neumann,
        data_width=request.data_width,
        coefficient_width=request.coefficient_width,
        depth_range_px=depth_range_px,
        gradient_limit=calibration.gradient_limit,
        bits_per_channel=calibration.bits_per_channel,
    )


def build(request: Request, config: Configuration) -> Path:
    """The simulator for a configuration, built once for each state of the sources."""
    bench = simulation.ROOT / "tb" / BENCH
    sources = [*simulation.sources(), bench.with_suffix(".vlt"), bench.with_suffix(".sv")]
    parameters = top_parameters(config)
    key = hashlib.sha256(json.dumps([request.simulator, request.waves, parameters, simulation.versions()]).encode())
    for source in sources:
        key.update(source.read_bytes())
    folder = simulation.ROOT / "build" / "simulators" / key.hexdigest()[:16]
    complete = folder / "complete"
    folder.parent.mkdir(parents=True, exist_ok=True)
    with folder.with_suffix(".lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)  # another run may be building the same
        if complete.exists():
            return folder
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir()
        print(f"building the {request.simulator} model (once for this configuration) ..", flush=True)
        try:
            simulation.build(
                request.simulator,
                BENCH,
                sources,
                parameters,
                folder,
                fast=not request.waves,
                waves=request.waves,
                log=folder / "build.log",
            )
        except (RuntimeError, SystemExit) as error:
            raise RuntimeError(f"the build failed: see {folder / 'build.log'}") from error
        complete.touch()
    return folder


def simulate(request: Request, config: Configuration, frames: Frames, calibration: Calibration, folder: Path) -> None:
    """Run the bench in `folder`, which then holds depth.bin, events.txt and registers.json."""
    write_roms(folder, calibration, config)
    frames.pixels[..., [0, 2, 1]].tofile(folder / "frames.bin")
    total = len(frames.pixels) * request.repeat
    wanted = {
        "sequence_frames": len(frames.pixels),
        "total_frames": total,
        "pixels": config.rows * config.columns,
        "gap": request.gaps,
        "stall": request.stalls,
        "seed": request.seed * 2 + 1,
        "threshold": round(CONTACT_THRESHOLD * min(config.rows, config.columns) / config.depth_lsb_px),
    }
    built = build(request, config)
    finished = threading.Event()

    def watch() -> None:
        depth = folder / "depth.bin"
        with tqdm(total=total, unit="frame", desc="simulating", leave=False, disable=None) as bar:
            while not finished.wait(0.2):
                if depth.exists():
                    bar.update(min(depth.stat().st_size // (4 * config.rows * config.columns), total) - bar.n)

    watcher = threading.Thread(target=watch)
    watcher.start()
    try:
        count, failed = simulation.run(
            BENCH,
            f"tb_{BENCH}",
            built,
            folder,
            simulator=request.simulator,
            seed=request.seed,
            environment={"FRAME_BENCH": json.dumps(wanted)},
            waves=request.waves,
            log=folder / "simulation.log",
        )
    except RuntimeError:  # it ended without results
        count, failed = 0, 0
    finally:
        finished.set()
        watcher.join()
    if failed or not count:
        log = shutil.copy(folder / "simulation.log", built / "simulation.log")
        raise RuntimeError(f"the simulation failed: see {log}")


def measure(events: Path) -> dict[str, list[int | None]]:
    """Latencies of each frame, in clocks, from the events of the bench."""
    clocks: dict[str, list[int]] = {letter: [] for letter in "plde"}
    contact: dict[int, int] = {}
    for line in events.read_text().splitlines():
        letter, clock = line.split()
        if letter == "c":
            contact[len(clocks["d"]) - 1] = int(clock)
        else:
            clocks[letter].append(int(clock))
    first, last, depth, end = (clocks[letter] for letter in "plde")
    frames = range(len(end))
    return {
        "first_depth_latency_cycles": [depth[i] - first[i] for i in frames],
        "last_depth_latency_cycles": [end[i] - first[i] for i in frames],
        "last_pixel_to_first_depth_cycles": [depth[i] - last[i] for i in frames],
        "frame_interval_cycles": [depth[i] - depth[i - 1] if i else None for i in frames],
        "contact_latency_cycles": [contact[i] - first[i] if i in contact else None for i in frames],
    }


def check_registers(registers: dict[str, int], report: dict, stalls: float) -> list[str]:
    """What the hardware counted against what was seen from outside; one line for each that differs."""
    total = report["frames"]
    clipped = sum(report["saturations"].values())
    expected = {
        "frames_in": total,
        "frames_out": total,
        "frames_dropped": 0,
        "saturations": min(clipped, 2**32 - 1),
    }
    if not stalls:
        expected["first_depth_latency"] = report["first_depth_latency_cycles"][-1]
    return [
        f"register {name.upper()} says {registers[name]}, expected {value}"
        for name, value in expected.items()
        if registers[name] != value
    ]


def coefficient_words(config: Configuration) -> int:
    """Words of the table along the columns: reciprocals (spectral), or coefficients of Thomas's algorithm."""
    if config.solver == "spectral":
        return len(reciprocal_rom(config))
    return len(thomas_table(config).words) + config.columns


def table(report: dict, labels: tuple[str, ...]) -> str:
    """One line a frame, the sequence once; then what holds for all."""

    def cell(value: float | None, digits: int = 5) -> str:
        return "-" if value is None else f"{value:,}" if isinstance(value, int) else f"{value:.{digits}f}"

    head = ("frame", "first depth", "last px > depth", "interval", "contact", "RMS % peak", "max % peak")
    columns = (
        "first_depth_latency_cycles",
        "last_pixel_to_first_depth_cycles",
        "frame_interval_cycles",
        "contact_latency_cycles",
        "rms_percent_of_peak",
        "max_percent_of_peak",
    )
    lines = ["".join(f"{name:>17}" if i else f"{name:<20}" for i, name in enumerate(head))]
    shown = min(len(labels), ROWS_SHOWN)
    for i in range(shown):
        cells = "".join(f"{cell(report[column][i]):>17}" for column in columns)
        lines.append(f"{labels[i][:19]:<20}{cells}")
    if report["frames"] > shown:
        lines.append(f"and {report['frames'] - shown:,} frames more: report.json")
    rms = [value for value in report["rms_percent_of_peak"] if value is not None]
    if rms:
        lines.append(f"mean RMS {np.mean(rms):.5f} % of peak, worst {max(rms):.5f} %")
    for column in columns[:3]:
        values = {value for value in report[column] if value is not None}
        if values:
            spread = f"{min(values):,}" if len(values) == 1 else f"{min(values):,} to {max(values):,}"
            lines.append(f"{column.removesuffix('_cycles').replace('_', ' ')}: {spread} cycles, all frames")
    clipped = report["saturations"]
    lines.append(
        f"saturated: {', '.join(f'{node} {count:,}' for node, count in clipped.items())}"
        if clipped
        else "no saturation"
    )
    return "\n".join(lines)


def run(request: Request, frames: Frames | None = None) -> int:
    """Everything after parsing; returns the exit status. `frames`: in place of those that the request names."""
    simulation.check(request.simulator)
    calibration = load(request.calibration)
    # Refuse a grid before frames are read.
    Configuration(columns=request.columns, rows=request.rows, solver=request.solver)
    grid = (request.rows, request.columns)
    if frames is None:
        frames = load_frames(request.frames, grid, request.reference, request.seed, request.press)
    pixel_pitch_mm = calibration.pixel_pitch_mm * frames.pixel_scale
    config = configure(request, calibration, pixel_pitch_mm)
    shape = f"{config.rows}x{config.columns}"
    widths = f"d{config.data_width}-c{config.coefficient_width}"
    name = f"{request.solver}-{request.boundary}-{shape}-{widths}-{request.simulator}"
    out = request.out or simulation.ROOT / "build" / "sim" / name
    if out.exists() and not out.is_dir():
        raise InputError(f"OUT={out} is a file: give a folder")
    try:
        out.parent.mkdir(parents=True, exist_ok=True)
        work = Path(tempfile.mkdtemp(prefix=f".{out.name}-", dir=out.parent)).resolve()
    except OSError as error:
        raise InputError(f"OUT={out} cannot be written ({error.strerror}): give a folder that can") from error
    try:
        simulate(request, config, frames, calibration, work)
        monitor = Monitor()
        codes = tactile_depth(frames.pixels, calibration, config, monitor)
        reference_px = reference.depth(frames.pixels, calibration, config.neumann)
        seen = np.fromfile(work / "depth.bin", dtype="<i4").reshape(request.repeat, *codes.shape)
        depth = seen.reshape(-1, *codes.shape[1:])
        bit_exact = bool((seen == codes).all())
        if config.solver == "tridiagonal":  # it puts the bottom row out first; results are in input order
            seen, depth = seen[..., ::-1, :], depth[..., ::-1, :]
        per_frame = errors(seen[0] * config.depth_lsb_px, reference_px)
        report = {
            "grid": [config.rows, config.columns],
            "solver": request.solver,
            "boundary": request.boundary,
            "simulator": request.simulator,
            "data_width": config.data_width,
            "coeff_width": config.coefficient_width,
            "frames": len(depth),
            "depth_lsb_mm": config.depth_lsb_px * pixel_pitch_mm,
            "pixel_pitch_mm": pixel_pitch_mm,
            "depth_range_mm": config.depth_range_px * pixel_pitch_mm,
            "gradient_lsb": config.gradient_lsb,
            "coefficient_table_words": coefficient_words(config),
            "contact_threshold_mm": CONTACT_THRESHOLD * min(config.rows, config.columns) * pixel_pitch_mm,
            "calibration": calibration.name,
            "source": frames.name,
            "expected_last_pixel_to_first_depth_cycles": latency.last_pixel_to_first_depth(config),
            **measure(work / "events.txt"),
            **{key: values * request.repeat for key, values in per_frame.items()},
            "bit_exact": bit_exact,
            "saturations": {node: count * request.repeat for node, count in sorted(monitor.saturations.items())},
        }
        report["registers"] = json.loads((work / "registers.json").read_text())
        differences = check_registers(report["registers"], report, request.stalls)
        report["registers_agree"] = not differences

        result = work / "result"
        result.mkdir()
        np.save(result / "depth.npy", depth.astype(np.int32))
        (result / "report.json").write_text(json.dumps(report, indent=1) + "\n")
        draw_depth(
            result / "depth.png",
            frames,
            seen[0] * config.depth_lsb_px * pixel_pitch_mm,
            reference_px * pixel_pitch_mm,
            pixel_pitch_mm,
            f"{request.solver}, {request.boundary}, {shape}, {config.data_width}-bit words, {calibration.name}",
        )
        if request.waves:
            for dump in (*work.glob("*.vcd"), *build(request, config).glob("*.fst")):  # Verilator's, Icarus'
                shutil.move(dump, result / dump.name)
        out.mkdir(exist_ok=True)
        for file in result.iterdir():
            os.replace(file, out / file.name)
    finally:
        shutil.rmtree(work, ignore_errors=True)

    print(table(report, frames.labels))
    for line in differences:
        print(line)
    verdict = "RTL equals the model on every code" if bit_exact else "RTL DIFFERS from the model"
    print(f"{verdict}: {depth.size:,} codes in {len(depth):,} frames")
    print(f"results: {os.path.relpath(out)}")
    return 0 if bit_exact and not differences else 1


def main() -> None:
    try:
        sys.exit(run(parse(sys.argv[1:])))
    except InputError as error:
        print(f"make sim: {error}", file=sys.stderr)
        sys.exit(2)
    except RuntimeError as error:
        print(f"make sim: {error}", file=sys.stderr)
        sys.exit(1)


if __name__ == "__main__":
    main()
