# SPDX-License-Identifier: Apache-2.0
"""Path from make variables to a Request, its sensor and the configuration of the pipeline."""

import errno
import json
import math
import os
import re
from collections.abc import Mapping
from dataclasses import dataclass, fields
from functools import partial
from pathlib import Path
from typing import Any

from commands.common import variables
from commands.common.variables import Several
from tactile_depth.base.errors import InputError
from tactile_depth.base.npy import is_file
from tactile_depth.chip.camera_configuration import FORMATS, PHASES, CameraChoice, CameraConfiguration
from tactile_depth.chip.configuration import CHOICES, DEFAULTS, NUMBERS, WORDS, Configuration
from tactile_depth.chip.limits import BOUNDARIES, COLUMNS, MODELS, can_check
from tactile_depth.pictures.frames import REST_SCENE
from tactile_depth.sensor.built_in import load, read
from tactile_depth.sensor.calibration_file import BUILT_IN
from tactile_depth.sensor.presets import PRESETS, Preset
from tactile_depth.sensor.scenes import NOISE, SCENES, SENSOR_WIDTH_MM, Press
from tactile_depth.sensor.sensor import Sensor
from tb.structures import BOTH

DEFAULT_SCENE = "ball"
WORST = "worst"  # a depth range that no slopes can exceed
SOLVERS = tuple(COLUMNS)
CONTACT_THRESHOLD = 1 / 128  # of the shorter side: one pixel at 128
*_, DEPTH_RANGE = WORDS.values()
CONFIGURING = (
    *("PRESET", *(choice.variable for choice in CHOICES.values())),
    *("COLS", "REFERENCE", "ZERO", "CALIBRATION", "CAMERA_SIZE", "CROP", "CONFIG"),
)
ACCEPTED = (
    *(*CONFIGURING, "SIM", "FRAMES", "PRESS", "AT", "NOISE", "REPEAT", "SEED", "GAPS", "STALLS", "WAVES", "OUT"),
)
CAMERA = ("CAMERA", "BAYER", "WINDOW")  # variables of commands that convert pictures to the stream of a camera
WITH_CAMERA = (*ACCEPTED, *CAMERA)
# Fields that reports state otherwise, or not at all.
APART = ("columns", "rows", "neumann", "depth_range_px", "gradient_limit", "coefficient_limit", "bits_per_channel")
LARGEST_CONFIG = 65_536  # bytes of a configuration file


@dataclass(frozen=True)
class Request:
    """Values of the variables, checked as far as possible without reading files."""

    preset: str
    rows: int
    columns: int
    solver: str
    boundary: str
    lanes: int
    simulator: str
    numbers: Mapping[str, Any]  # by field of Configuration
    deepest_mm: float | None  # infinite: the largest depth that slopes can cause
    frames: str  # "": none is given, and none is needed
    press: Press
    reference: str | None
    zero: str | None
    light_gains: bool | None  # None: unless the model is lut
    parity: bool
    self_check: bool
    calibration: str
    camera_size: tuple[int, int] | None  # rows, columns
    crop: str | None  # what pictures show; None: what those of the calibration show
    gradient: str  # a model; "": that of the calibration
    repeat: int
    seed: int
    gaps: float
    stalls: float
    waves: bool
    out: Path | None
    camera: CameraChoice | None = None


def parse(
    arguments: list[str],
    accepted: tuple[str, ...] = ACCEPTED,
    preset: str = "published",
    frames: str = DEFAULT_SCENE,
) -> Request:
    """Return the Request of KEY=VALUE arguments, as `of_values` does. Raises InputError."""
    return of_values(variables.given(arguments, accepted), accepted, preset, frames)


def chosen(
    accepted: tuple[str, ...] = ACCEPTED, preset: str = "published", frames: str = DEFAULT_SCENE, **others: str
) -> Several:
    """Return the variables that make a Request, as `of_values` does; `others` are values of those not given."""
    return Several(accepted, lambda values: of_values({**others, **values}, accepted, preset, frames))


def of_values(
    variables_given: Mapping[str, str],
    accepted: tuple[str, ...] = ACCEPTED,
    preset: str = "published",
    frames: str = DEFAULT_SCENE,
) -> Request:
    """Return the Request of variables; those that are not accepted are the command's own. Raises InputError.

    Parameters
    ----------
    preset : name of the preset without PRESET
    frames : source without FRAMES; "" for a command that needs no frame
    """
    values = {name: value for name, value in variables_given.items() if name in accepted}
    if "CONFIG" in values:
        values = from_file(Path(values.pop("CONFIG")), values, [name for name in accepted if name != "CONFIG"]) | values

    name = variables.choice(values, "PRESET", tuple(sorted(PRESETS, key=lambda name: name != preset)))
    values = {"FRAMES": frames} | values
    values = preset_values(PRESETS[name], values) | values
    number, choice = partial(variables.number, values), partial(variables.choice, values)

    def position(key: str) -> tuple[float, float]:
        try:
            x, y = (variables.plain(part, float) for part in values.get(key, "0,0").split(","))
        except ValueError:
            x = y = math.nan
        if not (abs(x) <= SENSOR_WIDTH_MM and abs(y) <= SENSOR_WIDTH_MM):
            raise InputError(f"{key}={values[key]}: accepted is x,y in mm from the middle of the frame, as 2.5,-1")
        return x, y

    by_preset = None if PRESETS[name].light_gains else False
    columns, lanes = number("COLS", 0), number("LANES", 1)  # the configuration file sets the solver: it bounds them
    checks = PRESETS[name].self_check and can_check(columns, lanes)
    return Request(
        preset=name,
        rows=number("ROWS", 0),
        columns=columns,
        solver=choice("SOLVER", SOLVERS),
        boundary=choice("BOUNDARY", BOUNDARIES[::-1]),
        lanes=lanes,
        simulator=choice("SIM", BOTH),
        numbers={name: number(each.variable, DEFAULTS[name]) for name, each in NUMBERS.items()},
        deepest_mm=math.inf if values.get(DEPTH_RANGE) == WORST else number(DEPTH_RANGE, 0, 1e-6, 1e6, float) or None,
        frames=values["FRAMES"],
        press=Press(
            number("PRESS", 0, 1e-3, SENSOR_WIDTH_MM, float) or None,
            position("AT"),
            number("NOISE", NOISE, 0, 255, float),
        ),
        reference=values.get("REFERENCE"),
        zero=values.get("ZERO"),
        light_gains=bool(number("LIGHT_GAINS", 0, 0, 1)) if "LIGHT_GAINS" in values else by_preset,
        parity=bool(number("PARITY", PRESETS[name].parity, 0, 1)),
        self_check=bool(number("SELF_CHECK", checks, 0, 1)),
        calibration=_calibration(values),
        camera_size=_camera_size(values),
        crop=values.get("CROP"),
        gradient=choice("GRADIENT", ("", *MODELS)),
        repeat=number("REPEAT", 1, 1, 100_000),
        seed=number("SEED", 1, 0, 10**9),
        gaps=number("GAPS", 0, 0, 0.99, float),
        stalls=number("STALLS", 0, 0, 0.99, float),
        waves=bool(number("WAVES", 0, 0, 1)),
        out=Path(values["OUT"]) if "OUT" in values else None,
        camera=camera_choice(values),
    )


def preset_values(preset: Preset, values: Mapping[str, str]) -> dict[str, str]:
    """Return the variables that a preset sets beside `values`, which win and decide what goes with them.

    A drawn scene is a picture of the drawn sensor. The spectral solver gets a square grid. Without a picture the
    reference is flat, and the zero offset is that of the reference.
    """
    chosen: dict[str, str] = {"SOLVER": preset.solver, "BOUNDARY": preset.boundary}
    rows, columns = map(str, preset.grid)
    if "N" in values:
        rows = columns = str(variables.number(values, "N", 0))
    elif rows != columns and values.get("SOLVER") == SOLVERS[0]:
        rows = columns = values.get("COLS") or values.get("ROWS") or columns
    chosen |= {"ROWS": rows, "COLS": columns}
    chosen |= {WORDS[name]: f"{value:g}" for name, value in preset.words.items()}
    if preset.zero_offset:
        drawn = values["FRAMES"] in SCENES
        chosen["CALIBRATION"] = BUILT_IN[0] if drawn else preset.calibration
        if values.get("CALIBRATION", chosen["CALIBRATION"]) in BUILT_IN:
            chosen["GRADIENT"] = preset.model  # another file may have the other model alone
        if drawn or not values["FRAMES"]:
            chosen["REFERENCE"] = REST_SCENE
        if reference := values.get("REFERENCE", chosen.get("REFERENCE")):
            chosen["ZERO"] = reference
    return chosen


def announce(request: Request, config: Configuration) -> None:
    """Print the preset and what the variables made of it; the first line that a command prints."""
    options = [name.replace("_", " ") for name, value in described(config).items() if value is True]
    words = [config.solver, config.boundary, f"{config.rows} x {config.columns}", config.gradient_model, *options]
    print(f"preset {request.preset}: {', '.join(words)}", flush=True)


def camera_choice(values: Mapping[str, str]) -> CameraChoice | None:
    """Return the camera that CAMERA, BAYER and WINDOW choose; None without CAMERA. Raises InputError."""
    for name in CAMERA[1:]:
        if values.get(name) and not values.get("CAMERA"):
            raise InputError(f"{name}={values[name]} goes with CAMERA, a pixel format: {', '.join(FORMATS)}")
    if not values.get("CAMERA"):
        return None
    window = None
    if values.get("WINDOW"):
        numbers = re.fullmatch(r"([0-9]{1,5}),([0-9]{1,5}),([0-9]{1,5}),([0-9]{1,5})", values["WINDOW"])
        if not numbers:
            raise InputError(f"WINDOW={values['WINDOW']}: accepted is x,y,width,height in pixels, as 80,0,480,480")
        x, y, width, height = map(int, numbers.groups())
        window = (x, y, width, height)
    return CameraChoice(values["CAMERA"], values.get("BAYER") or PHASES[0], window)


def _calibration(values: dict[str, str]) -> str:
    """Return the chosen calibration: scenes use the synthetic sensor, pictures need the calibration of their sensor."""
    if "CALIBRATION" in values:
        return values["CALIBRATION"]
    for key in ("FRAMES", "REFERENCE", "ZERO"):
        if key in values and values[key] not in SCENES and os.path.exists(values[key]):
            raise InputError(
                f"{key}={values[key]} needs CALIBRATION, that of the sensor that took it: {', '.join(BUILT_IN)}, or "
                "the .npz of `make calibrate`"
            )
    return BUILT_IN[0]


def _camera_size(values: dict[str, str]) -> tuple[int, int] | None:
    """Return rows and columns of CAMERA_SIZE=320x240, which states columns first, as cameras do."""
    if "CAMERA_SIZE" not in values:
        return None
    size = re.fullmatch(r"([0-9]{1,5})x([0-9]{1,5})", values["CAMERA_SIZE"])
    if not size:
        raise InputError(f"CAMERA_SIZE={values['CAMERA_SIZE']}: accepted is columns x rows in pixels, as 320x240")
    return int(size[2]), int(size[1])


def load_sensor(request: Request) -> Sensor:
    """Return the calibration of a request. Raises InputError."""
    return (load if request.crop is None else read)(request.calibration, request.camera_size)


def from_file(path: Path, explicit: dict[str, str], accepted: list[str]) -> dict[str, str]:
    """Return the variables of a configuration file, a JSON object; N in `explicit` replaces rows and columns of the
    file.

    Raises InputError.
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
    values = {variables.RENAMED.get(key, key): value for key, value in values.items()}  # of an earlier version
    for key, value in values.items():
        if key not in accepted:
            raise InputError(f"CONFIG={path}: unknown variable {key}: accepted are {', '.join(accepted)}")
        if isinstance(value, bool) or not isinstance(value, str | int | float):
            raise InputError(f"CONFIG={path}: {key} is {json.dumps(value)}: accepted is a number or a string")
        if isinstance(value, str) and not variables.usable(value):
            raise InputError(f"CONFIG={path}: {key} is {json.dumps(value)}: it holds a character that no path can hold")
    replaced = ("ROWS", "COLS") if "N" in explicit else ()
    return {key: str(value) for key, value in values.items() if key not in replaced}


def described(config: Configuration) -> dict[str, Any]:
    """Return a configuration as the reports of commands state it."""
    stated = [field.name for field in fields(config) if field.name not in APART]
    values = {NUMBERS[name].variable.lower() if name in NUMBERS else name: getattr(config, name) for name in stated}
    return {"grid": [config.rows, config.columns], "solver": config.solver, "boundary": config.boundary, **values}


def described_camera(camera: CameraConfiguration | None) -> dict[str, Any]:
    """Return a camera as the reports of commands state it; nothing without one."""
    if camera is None:
        return {}
    described = {
        "pixel_format": camera.pixel_format,
        "bayer": camera.phase if camera.format.bayer else None,
        "picture": list(camera.picture),
        "window": list(camera.crop),
        "pixels_per_grid_pixel": float(camera.ratio),
    }
    return {"camera": described}


def words_of(config: Configuration, colours: bool = False) -> str:
    """Return the numbers as names of folders state them; those of colours only if asked for."""
    stated = {name: getattr(config, name) for name, number in NUMBERS.items() if colours or not number.colours}
    return "-".join(
        f"{NUMBERS[name].letter or name}{value}"
        for name, value in stated.items()
        if NUMBERS[name].letter or value != DEFAULTS[name]
    )


def model_of(config: Configuration) -> str:
    """Return the gradient model as names of folders state it."""
    return f"-{config.gradient_model}" if config.flat_field else ""


def threshold_code(config: Configuration) -> int:
    """Return the code above which a depth is a contact."""
    return round(CONTACT_THRESHOLD * min(config.rows, config.columns) / config.depth_lsb_px)


def check_grid(request: Request) -> None:
    """Refuse a grid, a solver or lanes before frames are read. Raises InputError."""
    Configuration(columns=request.columns, rows=request.rows, solver=request.solver, lanes=request.lanes)


def configure(request: Request, calibration: Sensor) -> Configuration:
    """Return the configuration for a request and a calibration on its grid; the depth range becomes grid pixels."""
    neumann = request.boundary == "neumann"
    depth_range = request.deepest_mm
    depth_range_px: float | None
    if depth_range == math.inf:
        from commands.common.slopes import deepest  # scipy's transforms, which few requests need

        check_grid(request)
        depth_range_px = deepest(request.rows, request.columns, neumann) * calibration.gradient_limit
    else:
        depth_range_px = None if depth_range is None else calibration.depth_range_px(depth_range)
    return calibration.configuration(
        request.gradient,
        request.light_gains,
        columns=request.columns,
        rows=request.rows,
        solver=request.solver,
        lanes=request.lanes,
        neumann=neumann,
        **request.numbers,
        depth_range_px=depth_range_px,
        zero_offset=request.zero is not None,
        parity=request.parity,
        self_check=request.self_check,
    )
