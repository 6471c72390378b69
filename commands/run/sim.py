# SPDX-License-Identifier: Apache-2.0
"""`make sim`: streams frames through the RTL, checks every code, prints a table, draws.

Takes the variables of docs/make-sim.md as KEY=VALUE arguments. Exit status: docs/exit-status.md.
"""

from __future__ import annotations

import errno
import json
import math
import os
import re
import shutil
import sys
import threading
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np
from tqdm import tqdm

from commands.common import repository, results, variables
from commands.common import simulator as simulation
from commands.run import bench
from commands.run.compare import compare, warnings
from commands.run.draw import draw_depth
from commands.run.flags import flags
from commands.run.sim_table import check_registers, coefficient_words, measure, table
from tactile_depth import latency, reference
from tactile_depth.accuracy import errors
from tactile_depth.calibration.auto_zero import exact_zero
from tactile_depth.calibration.floor_capture import LARGEST_LOG2, captured_floor
from tactile_depth.certificate import deepest
from tactile_depth.common.round_saturate import Monitor
from tactile_depth.configuration import COLUMNS, GRADIENT_MODELS, Configuration
from tactile_depth.errors import InputError
from tactile_depth.frames import Frames, load_frames
from tactile_depth.npy import is_file
from tactile_depth.scenes import NOISE, SCENES, SENSOR_WIDTH_MM, Press
from tactile_depth.sensor import BUILT_IN, Sensor, load
from tactile_depth.tactile_depth import tactile_depth

DEFAULT_SCENE = "ball"
WORST = "worst"  # a depth range that no slopes can leave
SOLVERS = tuple(COLUMNS)
BOUNDARIES = ("dirichlet", "neumann")
CONTACT_THRESHOLD = 1 / 128  # of the shorter side: one pixel at 128
ACCEPTED = (
    *("N", "ROWS", "COLS", "SOLVER", "BOUNDARY", "SIM", "DATA_WIDTH", "COEFF_WIDTH", "DEPTH_RANGE", "FRAMES", "PRESS"),
    *(
        "AT",
        "NOISE",
        "REFERENCE",
        "FLOOR",
        "CALIBRATION",
        "CAMERA_SIZE",
        "GRADIENT",
        "REPEAT",
        "SEED",
        "GAPS",
        "STALLS",
        "WAVES",
    ),
    *("CONFIG", "OUT"),
)
RESULTS = ("depth.npy", "depth.png", "report.json")
DUMPS = (".vcd", ".fst")
LARGEST_CONFIG = 65_536  # bytes of a configuration file


@dataclass(frozen=True)
class Request:
    """Request of the user, checked as far as possible without reading files."""

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
    camera_size: tuple[int, int] | None  # rows, columns
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
    given = variables.given(arguments, ACCEPTED)
    if "CONFIG" in given:
        given = from_file(Path(given.pop("CONFIG")), given, [name for name in ACCEPTED if name != "CONFIG"]) | given

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
        if not (abs(x) <= SENSOR_WIDTH_MM and abs(y) <= SENSOR_WIDTH_MM):
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
        calibration=_calibration(given),
        camera_size=_camera_size(given),
        gradient=choice("GRADIENT", ("", *GRADIENT_MODELS)),
        repeat=int(number("REPEAT", 1, 1, 100_000)),
        seed=int(number("SEED", 1, 0, 10**9)),
        gaps=number("GAPS", 0, 0, 0.99, float),
        stalls=number("STALLS", 0, 0, 0.99, float),
        waves=bool(number("WAVES", 0, 0, 1)),
        out=Path(given["OUT"]) if "OUT" in given else None,
    )


def _calibration(given: dict[str, str]) -> str:
    """The calibration that is named. Scenes are drawn for the synthetic sensor; a picture needs that of its sensor."""
    if "CALIBRATION" in given:
        return given["CALIBRATION"]
    for key in ("FRAMES", "REFERENCE", "FLOOR"):
        if key in given and given[key] not in SCENES and os.path.exists(given[key]):
            raise InputError(
                f"{key}={given[key]} needs CALIBRATION, that of the sensor that took it: {', '.join(BUILT_IN)}, or the "
                ".npz of `make calibrate`"
            )
    return BUILT_IN[0]


def _camera_size(given: dict[str, str]) -> tuple[int, int] | None:
    """Rows and columns of CAMERA_SIZE=320x240, which gives columns first, as cameras do."""
    if "CAMERA_SIZE" not in given:
        return None
    size = re.fullmatch(r"([0-9]{1,5})x([0-9]{1,5})", given["CAMERA_SIZE"])
    if not size:
        raise InputError(f"CAMERA_SIZE={given['CAMERA_SIZE']}: accepted is columns x rows in pixels, as 320x240")
    return int(size[2]), int(size[1])


def load_sensor(request: Request) -> Sensor:
    """The calibration of a request.

    Raises
    ------
    InputError
    """
    try:
        return load(request.calibration, request.camera_size)
    except InputError as error:
        if request.camera_size is None:
            raise
        rows, columns = request.camera_size
        given = f"CAMERA_SIZE={columns}x{rows}"
        raise InputError(str(error).replace(f"camera_size={request.camera_size}", given)) from error


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
        if isinstance(value, str) and not variables.usable(value):
            raise InputError(f"CONFIG={path}: {key} is {json.dumps(value)}: it holds a character that no path can hold")
    replaced = ("ROWS", "COLS") if "N" in given else ()
    return {key: str(value) for key, value in values.items() if key not in replaced}


def configure(request: Request, calibration: Sensor) -> Configuration:
    """The pipeline for a request and a calibration on its grid; the depth range becomes grid pixels."""
    neumann = request.boundary == "neumann"
    depth_range = request.depth_range_mm
    depth_range_px: float | None
    if depth_range == math.inf:
        Configuration(columns=request.columns, rows=request.rows, solver=request.solver)  # refuses a grid first
        depth_range_px = deepest(request.rows, request.columns, neumann) * calibration.gradient_limit
    else:
        depth_range_px = None if depth_range is None else depth_range / calibration.pixel_pitch_mm
    return calibration.configuration(
        request.gradient,
        columns=request.columns,
        rows=request.rows,
        solver=request.solver,
        neumann=neumann,
        data_width=request.data_width,
        coefficient_width=request.coefficient_width,
        depth_range_px=depth_range_px,
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


def floor_of(rest: np.ndarray | None, calibration: Sensor, config: Configuration) -> np.ndarray | None:
    """Return the zero offset that a capture of these frames measures, codes (node rows, node columns)."""
    if rest is None:
        return None
    return captured_floor(tactile_depth(rest, calibration, replace(config, auto_zero=False)), config)


def exact_depth(frames: np.ndarray, rest: np.ndarray | None, calibration: Sensor, config: Configuration) -> np.ndarray:
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
    calibration: Sensor,
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


def run(request: Request, frames: Frames | None = None) -> int:
    """Everything after parsing; returns the exit status. `frames`: in place of those that the request names."""
    simulation.check(request.simulator)
    calibration = load_sensor(request)
    # Refuse a grid before frames are read.
    Configuration(columns=request.columns, rows=request.rows, solver=request.solver)
    grid = (request.rows, request.columns)
    if frames is None:
        frames = load_frames(request.frames, grid, request.reference, request.seed, request.press)
    calibration = calibration.on_grid(frames)
    config = configure(request, calibration)
    flagged = flags(frames.pixels, calibration, config, request.reference)
    rest = untouched(request, frames)
    floor = floor_of(rest, calibration, config)
    out = request.out or default_folder(request, config)
    with results.workspace(out, RESULTS) as work:
        played = simulate(request, config, frames, calibration, work, floor)
        monitor = Monitor()
        codes = tactile_depth(frames.pixels, calibration, config, monitor, floor=floor)
        reference_px = exact_depth(frames.pixels, rest, calibration, config)
        seen = played.codes.reshape(request.repeat, *codes.shape)
        if config.solver == "tridiagonal":  # it puts the bottom row out first; results are in input order
            seen, codes = seen[..., ::-1, :], codes[..., ::-1, :]
        difference = compare(seen, codes)
        percent = errors(seen[0] * config.depth_lsb_px, reference_px)
        result = work / "result"
        result.mkdir()
        dumps = take_dumps(request, config, work, result)
        clips = {node: count * request.repeat for node, count in sorted(monitor.saturations.items())}
        report = {
            **describe(request, config, calibration, frames),
            **measure(played),
            **{key: values * request.repeat for key, values in percent.items()},
            "bit_exact": not difference.count,
            "differing_codes": difference.count,
            "saturations": clips,
            "registers": played.registers,
            "waves": dumps,
            **flagged.report(request.repeat),
        }
        differences = check_registers(played.registers, report, request.stalls)
        report["registers_agree"] = not differences
        report["warnings"] = [] if difference.count else warnings(config, report["rms_percent_of_peak"], clips)
        report["warnings"] += flagged.warnings()
        np.save(result / "depth.npy", seen.reshape(-1, *grid).astype(np.int32))
        (result / "report.json").write_text(json.dumps(report, indent=1) + "\n")
        pitch = calibration.pixel_pitch_mm
        draw_depth(
            result / "depth.png",
            frames,
            seen[0] * config.depth_lsb_px * pitch,
            reference_px * pitch,
            pitch,
            f"{request.solver}, {request.boundary}, {config.rows}x{config.columns}, {config.data_width}-bit words, "
            f"{calibration.name}",
            np.asarray(difference.differing.reshape(seen.shape).any(axis=0)),
            flagged,
        )
        results.replace(result, (*RESULTS, *dumps), out, earlier_dumps(out))

    print(table(report, frames.labels))
    for line in differences:
        print(line)
    print(difference.sentence())
    print(f"results: {os.path.relpath(out)}")
    for line in report["warnings"]:
        print(f"make sim: warning: {line}", file=sys.stderr)
    return variables.MISMATCH if difference.count or differences else variables.EQUAL


def default_folder(request: Request, config: Configuration) -> Path:
    """Folder of results when OUT is not given: one for each configuration."""
    widths = f"d{config.data_width}-c{config.coefficient_width}"
    colours = f"-{config.gradient_model}" if config.flat_field else ""
    colours += "-zero" if config.auto_zero else ""
    shape = f"{config.rows}x{config.columns}"
    name = f"{request.solver}-{request.boundary}-{shape}-{widths}{colours}-{request.simulator}"
    return repository.ROOT / "build" / "sim" / name


def describe(request: Request, config: Configuration, calibration: Sensor, frames: Frames) -> dict:
    """Fields of the report that are known before the simulation."""
    pixel_pitch_mm = calibration.pixel_pitch_mm
    assert config.depth_range_px is not None
    return {
        "grid": [config.rows, config.columns],
        "solver": request.solver,
        "boundary": request.boundary,
        "simulator": request.simulator,
        "data_width": config.data_width,
        "coeff_width": config.coefficient_width,
        "frames": len(frames.pixels) * request.repeat,
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
    }


def take_dumps(request: Request, config: Configuration, work: Path, result: Path) -> list[str]:
    """Move the waveforms that a simulation left to `result`; returns their names."""
    if not request.waves:
        return []
    built = bench.build(request.simulator, config, True)  # Icarus writes there, Verilator into `work`
    return [Path(shutil.move(dump, result / dump.name)).name for dump in (*work.glob("*.vcd"), *built.glob("*.fst"))]


def earlier_dumps(out: Path) -> list[str]:
    """Names of the waveforms that the report in `out` lists: this command wrote them, and new results replace them."""
    try:
        names = json.loads((out / "report.json").read_text())["waves"]
        return [name for name in names if name == Path(name).name and name.endswith(DUMPS)]
    except (OSError, ValueError, LookupError, TypeError, AttributeError):  # no report, or one of something else
        return []


def main() -> None:
    with variables.reported("sim"):
        sys.exit(run(parse(sys.argv[1:])))


if __name__ == "__main__":
    main()
