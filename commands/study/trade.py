# SPDX-License-Identifier: Apache-2.0
"""`make trade`: the true error on real presses against latency, silicon and power, for hundreds of configurations.

The presses are those of `make calibrate`. They are split into FOLDS; each is measured by a calibration fitted to the
others, through the bit-accurate model of a real sensor behind a camera. RTL=10 plays so many configurations, drawn by
SEED, through the RTL too. An interrupted study continues where it stopped. Exit status: 1 if a code of the RTL differs,
2 on bad input.
"""

from __future__ import annotations

import hashlib
import itertools
import os
import random
import shutil
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from functools import lru_cache, partial
from pathlib import Path
from typing import Annotated, Any

import joblib
import numpy as np
from PIL import Image

import tactile_depth as td
from commands.common import recorded, run_request, variables
from commands.common import simulator as simulation
from commands.common.press_data import data_folder, pixels
from commands.common.progress import progress_bar
from commands.common.repository import ROOT
from commands.common.results import written
from commands.common.variables import Place, Seed, real, whole
from commands.common.zero_offset import untouched
from commands.cost.cost import ECP5, cost
from commands.run import sim
from commands.study.presses import Measured, measured
from commands.study.study import INTERRUPTED as INTERRUPTED
from commands.study.study import VERSION, Study, built
from commands.study.trade_front import DEFAULT, LUT, Point, Row, draw, front_of, summary, write_beaten
from tactile_depth.base import files
from tactile_depth.base.errors import InputError
from tactile_depth.calibrate.fitting import fit_folds
from tactile_depth.calibrate.press_pictures import PressPictures, camera_pitch_mm, gather
from tactile_depth.calibrate.presses import GridPress, to_grid
from tactile_depth.chip.camera_configuration import CameraChoice
from tactile_depth.chip.common.td_round_saturate import Monitor
from tactile_depth.chip.configuration import COEFFICIENT, GAIN, STORED, WIDTHS, Configuration
from tactile_depth.chip.contact import threshold_comparator
from tactile_depth.chip.latency import last_pixel_to_first_depth
from tactile_depth.chip.limits import most_lanes
from tactile_depth.chip.poisson.cores import fastest
from tactile_depth.depth.result import Recorder, settings_of
from tactile_depth.depth.twin import Twin
from tactile_depth.pictures.frames import Frames, load_frames, on_grid
from tactile_depth.sensor.built_in import read
from tactile_depth.sensor.calibration_file import PIXEL_PITCHES_MM
from tactile_depth.sensor.presets import AREA_THRESHOLD_MM, THRESHOLD_MM
from tactile_depth.sensor.sensor import Sensor

DEFAULT_OUT = ROOT / "build" / "trade"
RESULTS = ("beaten.csv", "trade.png")
FOLDS = 5
SECONDS = 1e-6  # of a pixel of a press, with the time to read it
FORMATS = (DEFAULT.pixel_format, "rgb565", "yuyv", "raw8")

GRIDS = ((24, 32), (48, 64), (96, 128), (192, 256))
SQUARES = (32, 64, 128)  # of the spectral solver, the middle of the picture
WIDE = (24, 18, 24)  # bits of a stored word, a coefficient, a gain of the flat field
WORDS = (WIDE, (20, 16, 16), (18, 15, 16), (16, 14, 16), (15, 12, 16), (14, 11, 16), (12, 10, 16))
# Words of 21 to 23 bits and 64 values a clock were never on the front.
STORED_WIDTHS = (*range(12, 21), 24)
MOST_LANES = 32
MODELS: tuple[dict[str, Any], ...] = ({}, {"gradient": "quadratic"}, LUT)
OPTIONS: tuple[dict[str, Any], ...] = ({"boundary": "dirichlet"}, {"light_gains": 0})
ALWAYS = ("pixel_format", "gradient", "rows", "columns", *WIDTHS)
NAMES = variables.variables_of_arguments() | {"columns": "COLS", "gradient": "GRADIENT"}  # of make sim


def plan() -> list[Point]:
    """Return every configuration, large grids first.

    All word lengths at the default grid; every grid, number of depth values per clock and gradient model with WORDS;
    the same for the spectral solver; every pixel format; and the options that can be left out.
    """
    points = [point(GRIDS[2], (d, c, 16)) for d in STORED_WIDTHS for c in range(10, 19)]
    for grid, words, model in itertools.product(GRIDS, WORDS, MODELS):
        most = most_lanes(grid[1], zero_offset=True)
        lanes = (lanes for lanes in sorted({1, 4, 16, most}) if lanes <= min(most, MOST_LANES))
        points += [point(grid, words, lanes=each, **model) for each in lanes]
    for size, words, model in itertools.product(SQUARES, WORDS, MODELS):
        points += [point((size, size), words, solver=solver, **model) for solver in ("spectral", DEFAULT.solver)]
    for grid, words, pixel_format in itertools.product(GRIDS[:3], WORDS, FORMATS[1:]):
        points.append(point(grid, words, pixel_format=pixel_format))
    for grid, words, option in itertools.product(GRIDS[1:3], WORDS, OPTIONS):
        points.append(point(grid, words, **option))
    return sorted(dict.fromkeys(points), key=lambda each: (-each.pixels, each.pixel_format))


def point(grid: tuple[int, int], words: tuple[int, int, int], **changes: Any) -> Point:
    """Return the default configuration with a grid, words as WIDE, and changes."""
    sizes = dict(zip(("rows", "columns", STORED, COEFFICIENT, GAIN), (*grid, *words), strict=True))
    return DEFAULT.but(**sizes, **changes)


def of_sim(of: Point) -> dict[str, str]:
    """Return the variables of `make sim` for a configuration, without those that the preset sets."""
    preset = vars(DEFAULT.but(light_gains=int(of.gradient != "lut")))
    names = (*ALWAYS, *(name for name, value in vars(of).items() if name not in ALWAYS and value != preset[name]))
    return {"PRESET": "sensor"} | {NAMES[name]: str(getattr(of, name)) for name in names}


@dataclass(frozen=True)
class Prepared:
    """A folder with the presses of each fold and their calibrations, which `prepare` writes.

    Attributes
    ----------
    folder, source : Path
        Where they are, and the folder of the presses that they were made from.
    pitch_mm : float
        Millimetres per camera pixel.
    middle, sides : frozenset of str
        Names of the presses that lie wholly in the picture's middle square, and of the others in the picture.
    digest : str
        Digest of the models and of the presses.
    """

    folder: Path
    source: Path
    pitch_mm: float
    middle: frozenset[str]
    sides: frozenset[str]
    digest: str

    def sources(self, fold: int, pixel_format: str) -> dict[str, str]:
        """Return the variables of `make sim` that name frames, reference and calibration of a fold."""
        parts = {
            "FRAMES": f"presses-{fold}",
            "REFERENCE": "background.png",
            "CALIBRATION": f"{pixel_format}-{fold}.npz",
        }
        return {name: str(self.folder / part) for name, part in parts.items()}

    def request(self, of: Point, fold: int) -> run_request.Request:
        """Return the request of `make sim` for a fold. Raises InputError."""
        values = of_sim(of) | self.sources(fold, of.pixel_format) | {"CROP": "none"}  # of the presses' own calibration
        return run_request.of_values(values, run_request.WITH_CAMERA, "sensor")

    def command(self, of: Point) -> str:
        """Return the command that plays the first fold through the RTL."""
        sources = {name: os.path.relpath(path, ROOT) for name, path in self.sources(0, of.pixel_format).items()}
        return " ".join(["make sim", *(f"{name}={value}" for name, value in (of_sim(of) | sources).items())])


def prepare(folder: Path, source: Path, pitch_mm: float | None) -> Prepared:
    """Write the pictures of each fold and a calibration for each pixel format, unless they are there already."""
    pictures = gather(source)
    pitch = camera_pitch_mm(pictures, pitch_mm)
    on = to_grid(pictures, pitch)
    whole = {view.press.name: view.press.is_central for view in on.views if view.is_whole}
    middle, sides = (frozenset(name for name, central in whole.items() if central == is_in) for is_in in (True, False))
    study = Prepared(folder, source, pitch, middle, sides, _digest(pictures, pitch))
    stamp = folder / "presses.txt"
    if stamp.exists() and stamp.read_text() == study.digest:
        return study
    folds = [folder / f"presses-{fold}" for fold in range(FOLDS)]
    if not stamp.exists() and (others := [path for path in (folder / "background.png", *folds) if path.exists()]):
        raise InputError(f"OUT={folder}: {others[0].name} in it is of no earlier run: move it away or give another")
    files.make(folder, [stamp.name], guarded=False)
    stamp.write_text("")
    Image.fromarray(pictures.background).save(folder / "background.png")
    for fold in folds:
        shutil.rmtree(fold, ignore_errors=True)
        fold.mkdir()
    for index, press in enumerate(pictures.presses):
        Image.fromarray(pixels(press)).save(folds[index % FOLDS] / f"{index:03}.png")
    jobs = [joblib.delayed(_calibrate)(study, pictures, pixel_format) for pixel_format in FORMATS]
    fitted = joblib.Parallel(n_jobs=-1, return_as="generator_unordered")(jobs)
    for _ in progress_bar(fitted, "calibrations", len(jobs), unit=" pixel formats"):
        pass
    stamp.write_text(study.digest)
    return study


def _digest(pictures: PressPictures, pitch_mm: float) -> str:
    digest = hashlib.sha256(f"{VERSION} {FOLDS} {FORMATS} {pitch_mm}".encode() + pictures.background.tobytes())
    for press in pictures.presses:
        digest.update(f"{press.name} {press.diameter_mm} {press.circle}".encode() + pixels(press).tobytes())
    return digest.hexdigest()[:12]


def _calibrate(study: Prepared, pictures: PressPictures, pixel_format: str) -> None:
    """Fit and write the calibration of each fold, from pictures as a camera of this format sends them."""
    presses = to_grid(pictures, study.pitch_mm, choice=CameraChoice(pixel_format))
    folds = [{press.name for press in pictures.presses[fold::FOLDS]} for fold in range(FOLDS)]
    for fold, sensor in enumerate(fit_folds(presses, folds)):
        sensor.save(study.folder / f"{pixel_format}-{fold}.npz")


# A row.


@dataclass(frozen=True)
class Fold:
    """A fold on a grid: pictures, the calibration that was not fitted to them, and the geometry of the presses."""

    frames: Frames
    sensor: Sensor
    presses: dict[int, GridPress]  # by the number of the frame


@lru_cache(maxsize=2)
def _folds(study: Prepared, rows: int, columns: int, pixel_format: str) -> list[Fold]:
    choice, grid = CameraChoice(pixel_format), (rows, columns)
    pictures = gather(study.source)
    on = to_grid(pictures, study.pitch_mm, choice=choice, grid=grid)
    geometry = {view.press.name: view.press for view in on.views}
    seen = study.middle | (study.sides if rows != columns else frozenset())
    folds = []
    for fold in range(FOLDS):
        sources = study.sources(fold, pixel_format)
        frames = load_frames(sources["FRAMES"], grid, sources["REFERENCE"], camera=choice)
        among = [press.name for press in pictures.presses[fold::FOLDS]]
        presses = {number: geometry[name] for number, name in enumerate(among) if name in seen}
        folds.append(Fold(frames, on_grid(read(sources["CALIBRATION"]), frames), presses))
    return folds


def measure(study: Prepared, of: Point) -> dict[str, Any]:
    """Return the measurements of a configuration on all folds. Raises InputError: it cannot be built."""
    values: list[tuple[Measured, bool, float]] = []
    monitor = Monitor()
    for fold, data in enumerate(_folds(study, of.rows, of.columns, of.pixel_format)):
        request = study.request(of, fold)
        config = run_request.configure(request, data.sensor)
        values += _measured(study, request, config, data, monitor)
    middle = [value for value, is_in_the_middle, _ in values if is_in_the_middle]
    sides = [value for value, is_in_the_middle, _ in values if not is_in_the_middle]
    counted = cost(config)
    caps = np.array([value.cap for value in middle])
    return {
        "presses": len(middle),
        "height_um": 1000 * np.mean([value.height_rms for value in middle]),
        "sides_height_um": 1000 * np.mean([value.height_rms for value in sides]) if sides else None,
        "cap_percent": 100 * np.sqrt(((caps - 1) ** 2).mean()),
        "untouched_um": 1000 * np.mean([value.rest_rms for value in middle]),
        "centroid_um": 1000 * np.mean([value.centroid for value in middle]),
        "area_percent": 100 * np.mean([abs(value.area - 1) for value in middle]),
        "saturations": monitor.saturations.total(),
        "first_depth_cycles": counted.last_pixel_cycles,
        "map_cycles": counted.map_cycles,
        "contact_cycles": np.mean([cycles for _, is_in_the_middle, cycles in values if is_in_the_middle]),
        "multipliers": counted.tiles,
        "multipliers_18": counted.multipliers_of(ECP5),
        "luts": counted.luts_of(ECP5),
        "memory_bits": counted.memory_bits,
        "power_mw": counted.power_mw,
    }


def _measured(
    study: Prepared, request: run_request.Request, config: Configuration, data: Fold, monitor: Monitor
) -> list[tuple[Measured, bool, float]]:
    """Return what was measured of each press, if it is in the middle, and the cycles from last pixel to contact."""
    sensor = data.sensor
    twin = Twin(sensor, config, untouched(request, data.frames), fastest())
    every = twin.codes(data.frames.pixels, monitor)
    pitch = sensor.pixel_pitch_mm
    lsb = config.depth_lsb_px * pitch
    empty = np.zeros((0, 0, 2))
    settings = settings_of(THRESHOLD_MM, THRESHOLD_MM, AREA_THRESHOLD_MM, lsb, pitch**2, empty)
    recorder = Recorder.of(config, settings)
    values: list[tuple[Measured, bool, float]] = []
    for number, press in data.presses.items():
        codes = every[number]
        result = td.Result(
            codes.astype(np.int32), codes * lsb, empty, empty[..., 0] > 0, None, {}, recorder, lsb, pitch, np.inf, None
        )
        touching = twin.upright(codes).reshape(-1) > settings.on_threshold
        first = int(touching.argmax()) if touching.any() else touching.size
        cycles = last_pixel_to_first_depth(config) + first // config.lanes + threshold_comparator.LATENCY
        values.append((measured(result, press), press.name in study.middle, cycles))
    return values


def study_of(prepared: Prepared) -> Study[Point, Row]:
    def noted(of: Point) -> dict[str, Any]:
        return {"command": prepared.command(of)}

    seconds = SECONDS * len(prepared.middle | prepared.sides)
    return Study("trade", Point, Row, partial(measure, prepared), seconds, noted, prepared.digest)


def in_rtl(study: Prepared, rows: Sequence[Row], count: int, seed: int, simulator: str) -> int:
    """Play so many rows, drawn by chance, through the RTL; return how many differ from the model."""
    drawn = random.Random(seed).sample(built(rows), count)
    differing = 0
    for number, row in enumerate(drawn):
        print(f"\n{number + 1} of {count}: {row.command}")
        words = [word for word in row.command.split() if "=" in word]
        request = run_request.parse([*words, f"SIM={simulator}"], run_request.WITH_CAMERA, "sensor")
        differing += sim.run(replace(request, out=study.folder / "rtl" / str(number))) != variables.EQUAL
    return differing


def sources(arguments: Sequence[str]) -> str:
    """Return the digest of models and command, for docs/figures.json."""
    variables.read(Variables, arguments)
    return recorded.digest(sorted(Path(__file__).parent.glob("trade*.py")), VERSION)


@dataclass(frozen=True)
class Variables:
    presses: Place | None = None
    pitch: Annotated[float | None, real(*PIXEL_PITCHES_MM)] = None
    out: Place = DEFAULT_OUT
    rtl: Annotated[int, whole(0, 1000)] = 0
    seed: Seed = 1
    simulator: simulation.Simulator = simulation.SIMULATORS[0]


def main(chosen: Variables) -> int:
    if chosen.rtl:
        simulation.check(chosen.simulator)
    files.check(chosen.out, RESULTS)  # refuse bad input before minutes of work
    source = chosen.presses or data_folder()
    study = prepare(chosen.out.resolve(), source.resolve(), chosen.pitch)
    rows = study_of(study).complete(plan(), study.folder)
    front = front_of(rows)
    print(summary(front))
    recorded.record(asdict(front))
    with written(study.folder, RESULTS) as work:
        write_beaten(rows, work / "beaten.csv")
        draw(rows, work / "trade.png")
    differing = in_rtl(study, rows, chosen.rtl, chosen.seed, chosen.simulator) if chosen.rtl else 0
    return variables.MISMATCH if differing else variables.EQUAL
