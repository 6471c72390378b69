# SPDX-License-Identifier: Apache-2.0
"""`make sim`: streams frames through the RTL, checks every code, prints a table, draws.

Takes the variables of the README's table as KEY=VALUE arguments. Exit status: 0 bit-exact, 1 not, 2 bad input.
"""

from __future__ import annotations

import errno
import json
import math
import os
import shutil
import sys
import tempfile
import threading
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np
from tqdm import tqdm

from commands import bench, variables
from commands import simulator as simulation
from commands.draw import draw_depth
from models import latency, reference
from models.accuracy import errors
from models.auto_zero import exact_zero
from models.calibration import Calibration, load
from models.certificate import deepest
from models.configuration import COLUMNS, GRADIENT_MODELS, Configuration
from models.errors import InputError
from models.floor_capture import LARGEST_LOG2, captured_floor
from models.frames import Frames, load_frames
from models.npy import is_file
from models.round_saturate import Monitor
from models.scenes import NOISE, SCENES, SENSOR_WIDTH_MM, Press
from models.spectral_divide import reciprocal_rom
from models.tactile_depth import tactile_depth
from models.thomas_table import thomas_table

DEFAULT_SCENE = "ball"
WORST = "worst"  # a depth range that no slopes can leave
SOLVERS = tuple(COLUMNS)
BOUNDARIES = ("dirichlet", "neumann")
CONTACT_THRESHOLD = 1 / 128  # of the shorter side: one pixel at 128
ROWS_SHOWN = 16
LARGEST_CONFIG = 65_536  # bytes of a configuration file


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
    floor: str | None
    calibration: str
    gradient: str  # a model; "": the calibration's own
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
        "N ROWS COLS SOLVER BOUNDARY SIM DATA_WIDTH COEFF_WIDTH DEPTH_RANGE FRAMES PRESS AT NOISE REFERENCE FLOOR "
        "CALIBRATION GRADIENT REPEAT SEED GAPS STALLS WAVES CONFIG OUT"
    )
    given = variables.given(arguments, accepted.split())
    if "CONFIG" in given:
        given = from_file(Path(given.pop("CONFIG")), given, accepted.replace("CONFIG ", "").split()) | given

    number = partial(variables.number, given)

    def choice(key: str, accepted: tuple[str, ...]) -> str:
        value = given.get(key, accepted[0])
        if value not in accepted:
            raise InputError(f"{key}={value} is unknown: accepted are {', '.join(filter(None, accepted))}")
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
        floor=given.get("FLOOR"),
        calibration=given.get("CALIBRATION", "synthetic"),
        gradient=choice("GRADIENT", ("", *GRADIENT_MODELS)),
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
        if not is_file(path):
            raise FileNotFoundError(errno.ENOENT, "no such file")
        with path.open("rb") as file:
            text = file.read(LARGEST_CONFIG + 1)
        if len(text) > LARGEST_CONFIG:
            raise ValueError
        values = json.loads(text)
    except (OSError, ValueError, RecursionError) as error:
        reason = (error.strerror if isinstance(error, OSError) else None) or "not JSON of a few lines"
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


def configure(request: Request, calibration: Calibration) -> Configuration:
    """The pipeline for a request and a calibration on its grid; the depth range becomes grid pixels."""
    model = request.gradient or (calibration.model if calibration.reference is not None else GRADIENT_MODELS[0])
    if model not in calibration.models:
        raise InputError(f"GRADIENT={model}: {calibration.name} holds only {', '.join(calibration.models)}")
    neumann = request.boundary == "neumann"
    depth_range = request.depth_range_mm
    if depth_range == math.inf:
        Configuration(columns=request.columns, rows=request.rows, solver=request.solver)  # refuses a grid first
        depth_range_px = deepest(request.rows, request.columns, neumann) * calibration.gradient_limit
    else:
        depth_range_px = None if depth_range is None else depth_range / calibration.pixel_pitch_mm
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
        flat_field=calibration.reference is not None,
        gradient_model=model,
        auto_zero=request.floor is not None,
    )


def untouched(request: Request, frames: Frames) -> np.ndarray | None:
    """Frames of `FLOOR`, a power of two of them, uint8 (n, rows, columns, 3); None without it.

    Raises
    ------
    InputError
    """
    if request.floor is None:
        return None
    reference = request.reference if request.floor in SCENES else None
    rest = load_frames(request.floor, frames.pixels.shape[1:3], reference, request.seed)
    if rest.pixel_scale != frames.pixel_scale:
        raise InputError(f"FLOOR={request.floor}: not of the size of {frames.name}: give frames of the same camera")
    return rest.pixels[: 1 << min(LARGEST_LOG2, len(rest.pixels).bit_length() - 1)]


def floor_of(rest: np.ndarray | None, calibration: Calibration, config: Configuration) -> np.ndarray | None:
    """What a capture of those frames measures, codes (node rows, node columns)."""
    if rest is None:
        return None
    return captured_floor(tactile_depth(rest, calibration, replace(config, auto_zero=False)), config)


def exact_depth(
    frames: np.ndarray, rest: np.ndarray | None, calibration: Calibration, config: Configuration
) -> np.ndarray:
    """Depth in double precision, grid pixels, rows from the top."""
    depth = reference.depth_of(frames, calibration, config)
    if rest is None:
        return depth
    down = -1 if config.solver == "tridiagonal" else 1  # blocks are counted as depth leaves
    at_rest = reference.depth_of(rest, calibration, config)[..., ::down, :]
    return exact_zero(depth[..., ::down, :], at_rest, config)[..., ::down, :]


def simulate(
    request: Request,
    config: Configuration,
    frames: Frames,
    calibration: Calibration,
    folder: Path,
    floor: np.ndarray | None = None,
) -> bench.Played:
    """Run the bench in `folder`, with a bar that shows how far it is."""
    total = len(frames.pixels) * request.repeat
    pixels = config.rows * config.columns
    # Twice the clocks that gaps and stalls make likely: a pipeline that hangs ends with a failure.
    clocks = int(2 * (total + 4) * pixels / (1 - request.gaps) / (1 - request.stalls))
    profiles = [
        bench.entry(side, bench.chance(no)) for side, no in (("sink", request.stalls), ("source", request.gaps))
    ]
    finished = threading.Event()

    def watch() -> None:
        depth = folder / "depth.bin"
        with tqdm(total=total, unit="frame", desc="simulating", leave=False, disable=None) as bar:
            while not finished.wait(0.2):
                if depth.exists():
                    bar.update(min(depth.stat().st_size // (4 * pixels), total) - bar.n)

    bench.build(request.simulator, config, request.waves)
    watcher = threading.Thread(target=watch)
    watcher.start()
    try:
        return bench.play(
            request.simulator,
            config,
            calibration,
            np.concatenate([np.array(profiles, np.uint32), bench.frame_entries(frames.pixels)]),
            folder,
            clocks=clocks,
            passes=request.repeat,
            total_frames=total,
            registers={"THRESHOLD": round(CONTACT_THRESHOLD * min(config.rows, config.columns) / config.depth_lsb_px)},
            seed=request.seed,
            waves=request.waves,
            floor=floor,
        )
    finally:
        finished.set()
        watcher.join()


def measure(played: bench.Played) -> dict[str, list[int | None]]:
    """Latencies of each frame, in clocks, from the events of the bench."""
    taken, depth, end = (played.clocks(letter) for letter in "tde")
    first, last = taken[::2], taken[1::2]
    contact: dict[int, int] = {}
    frame = -1
    for letter, numbers in played.events:
        if letter == "d":
            frame += 1
        elif letter == "c":
            contact[frame] = numbers[0]
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
    calibration = calibration.on_grid(frames.pixel_scale, frames.reference)
    pixel_pitch_mm = calibration.pixel_pitch_mm
    config = configure(request, calibration)
    shape = f"{config.rows}x{config.columns}"
    widths = f"d{config.data_width}-c{config.coefficient_width}"
    rest = untouched(request, frames)
    floor = floor_of(rest, calibration, config)
    colours = f"-{config.gradient_model}" if config.flat_field else ""
    colours += "-zero" if config.auto_zero else ""
    name = f"{request.solver}-{request.boundary}-{shape}-{widths}{colours}-{request.simulator}"
    out = request.out or simulation.ROOT / "build" / "sim" / name
    if out.exists() and not out.is_dir():
        raise InputError(f"OUT={out} is a file: give a folder")
    try:
        out.parent.mkdir(parents=True, exist_ok=True)
        work = Path(tempfile.mkdtemp(prefix=f".{out.name}-", dir=out.parent)).resolve()
    except OSError as error:
        raise InputError(f"OUT={out} cannot be written ({error.strerror}): give a folder that can") from error
    try:
        played = simulate(request, config, frames, calibration, work, floor)
        monitor = Monitor()
        codes = tactile_depth(frames.pixels, calibration, config, monitor, floor=floor)
        reference_px = exact_depth(frames.pixels, rest, calibration, config)
        seen = played.codes.reshape(request.repeat, *codes.shape)
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
            "gradient_model": config.gradient_model,
            "flat_field": config.flat_field,
            "auto_zero": config.auto_zero,
            "source": frames.name,
            "expected_last_pixel_to_first_depth_cycles": latency.last_pixel_to_first_depth(config),
            **measure(played),
            **{key: values * request.repeat for key, values in per_frame.items()},
            "bit_exact": bit_exact,
            "saturations": {node: count * request.repeat for node, count in sorted(monitor.saturations.items())},
        }
        report["registers"] = played.registers
        differences = check_registers(played.registers, report, request.stalls)
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
            for dump in (
                *work.glob("*.vcd"),
                *bench.build(request.simulator, config, True).glob("*.fst"),
            ):  # Verilator's, Icarus'
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
    with variables.reported("sim"):
        sys.exit(run(parse(sys.argv[1:])))


if __name__ == "__main__":
    main()
