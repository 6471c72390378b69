# SPDX-License-Identifier: Apache-2.0
"""A sensor and its calibration: a table or polynomials from colour to slope, and the camera that they are valid for."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from tactile_depth.base.by_value import ByValue
from tactile_depth.base.errors import Argument, InputError, Part, is_number
from tactile_depth.base.npy import DIGEST, Bytes, Floats, digest_of
from tactile_depth.chip.camera_configuration import FORMATS
from tactile_depth.chip.limits import (
    COEFFICIENT_LIMITS,
    CORRECTION_BITS,
    CUBIC,
    MODELS,
    SHALLOWEST_PX,
)
from tactile_depth.chip.resampling import WHOLE, Share
from tactile_depth.sensor.verdict import Verdict

if TYPE_CHECKING:
    from tactile_depth.chip.configuration import Configuration

FORMAT_VERSION = 4
PIXEL_FORMATS = tuple(FORMATS)
TABLE_BITS = (1, 6)
CORRECTIONS = (*(1 << CORRECTION_BITS,) * 3, 2)  # red, green, blue; slope
ROUNDING = 2.0**-8  # largest relative increase of a slope by rounding to a table's format
ASPECTS_AGREE = 0.005  # largest relative difference between the aspect ratios of a picture and of the calibrated camera
LIGHTING_BLOCKS = (4, 4)  # rows and columns of `Sensor.lighting`
UNTOUCHED_AREAS = (24, 32)  # rows and columns of `Sensor.untouched`
# Largest RMS difference between two lightings of one sensor. On the presses of gelslam a contact changes it by 0.06
# at most; exchanged colours change it by 0.14 to 0.31, an upside-down picture by 0.18, a uniform grey picture by 0.25.
LIGHTING_AGREES = 0.12
TOO_DARK = 16  # grey levels: where a colour of the reference is below, a pixel is dark


@dataclass(frozen=True)
class Camera:
    """Camera of a calibration, with the settings that the calibration is valid for.

    Attributes
    ----------
    rows, columns : int
        Size of the pictures.
    pixel_format : str
        One of `PIXEL_FORMATS`.
    black_level : float
        Grey levels, of 255, that the camera adds to every pixel. It is 0, because it is subtracted from the pictures
        first.
    exposure_us : float or None
        Exposure time in microseconds; None: unknown.
    """

    rows: int
    columns: int
    pixel_format: str = PIXEL_FORMATS[0]
    black_level: float = 0.0
    exposure_us: float | None = None


@dataclass(frozen=True)
class HeightError:
    """Error of a calibration, measured on ball presses that were not fitted.

    The presses lay wholly in the picture's middle square.

    Attributes
    ----------
    mean : float
        Recovered over true height of the cap, mean over the presses.
    spread : float
        Standard deviation of that ratio over the presses.
    presses : int
    """

    mean: float
    spread: float
    presses: int

    @property
    def relative(self) -> float:
        """Relative RMS error of a height, from bias and spread together."""
        return math.hypot(self.mean - 1, self.spread)


@dataclass(frozen=True, eq=False)
class Sensor(ByValue):
    """A calibrated sensor, with one or more models from colour to slope.

    Its arrays are read-only. Two sensors are equal if all their values are.

    Attributes
    ----------
    name : str
    gradient : float64 array (2**b, 2**b, 2**b, 2), or None
        Model `lut`: slope dz/dx (along the columns) and dz/dy (down the rows) by the top b bits of red, green and
        blue, in pixels per pixel; depth z is positive pressed in. Real sensors are flat-fielded first: 128 I / ref.
    pixel_pitch_mm : float
        Height of the camera's pixels; that of the grid's is larger if pixels are averaged.
    coefficients : float64 array (2, 3, 6), or None
        Model `quadratic`: slope = sum over red, green, blue of C (I / ref - 1), C = a quadratic in the position:
        terms 1, x, y, x^2, x y, y^2, in mm from the picture's centre, x along the columns, y down the rows.
    cubic : float64 array (2, 3, 10), or None
        Model `cubic`: the same, with cubics: `position_terms`.
    corrections : float64 array (16, 16, 16, 2), or None
        Model `cubic`: added to the slopes, by red, green, blue; entry e is of deviations within 1/16 of e / 8 - 1.
    largest_slope : float
        Largest slope that the formats of the polynomials hold.
    model : str
        The best of the models.
    reference : uint8 array (rows, columns, 3) or (2**k, rows, columns, 3), or None
        The sensor without contact, on the grid in use (see `frames.on_grid`).
    camera : Camera or None
        Camera of the pictures; None for the synthetic sensor, which takes pictures of any size.
    flat_field : bool or None
        True if colours are relative to a reference; None if both are accepted, as with the synthetic sensor.
    fitted_slope : mapping of str to float
        Largest slope in the fitted presses, by model. Steeper slopes are extrapolated. A model without an entry is
        valid for all slopes.
    height_errors : mapping of str to HeightError, by model
    lighting : float64 array (`LIGHTING_BLOCKS`, 3), or None
        Block means of the picture without contact over their mean, which distinguish types of sensors.
    pixel_aspect : float
        Width of a pixel over its height. The models give the change of depth from pixel to pixel, in heights of a
        pixel: dz/dx times this, and dz/dy.
    view : (float, float), or None
        Shares of the width and of the height of the sensor's full picture that the camera's pictures show, around its
        middle; None: unknown.
    untouched : float64 array (`UNTOUCHED_AREAS`, 3), or None
        Grey levels of the calibration's own picture without contact, as means of equal areas.
    verdict : Verdict or None
        Verdict of the fit; None: unknown.
    """

    name: str
    gradient: Floats | None
    pixel_pitch_mm: float
    coefficients: Floats | None = None
    largest_slope: float = 0.0
    model: str = "lut"
    reference: Bytes | None = None
    camera: Camera | None = None
    flat_field: bool | None = None
    fitted_slope: Mapping[str, float] = field(default_factory=dict)
    height_errors: Mapping[str, HeightError] = field(default_factory=dict)
    lighting: Floats | None = None
    cubic: Floats | None = None
    corrections: Floats | None = None
    pixel_aspect: float = 1.0
    view: tuple[float, float] | None = None
    untouched: Floats | None = None
    verdict: Verdict | None = None

    def __post_init__(self) -> None:
        for name in ("gradient", "coefficients", "reference", "lighting", "cubic", "corrections", "untouched"):
            if (array := getattr(self, name)) is not None:
                view = np.asarray(array).view()
                view.flags.writeable = False
                object.__setattr__(self, name, view)

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        self.__post_init__()  # a copy's arrays could be written

    def __repr__(self) -> str:
        camera = "" if self.camera is None else f"{self.camera.columns}x{self.camera.rows}, "
        return f"Sensor({self.name!r}, {camera}{self.model})"

    def scaled(self, pixel_scale: float, reference: np.ndarray | None = None) -> Sensor:
        """Return the sensor on a grid with pixels `pixel_scale` camera pixels wide, with the reference on that grid."""
        return replace(self, pixel_pitch_mm=self.pixel_pitch_mm * pixel_scale, reference=reference)

    def centred_at(self, x_mm: float, y_mm: float) -> Sensor:
        """Return the sensor for the part of its pictures around a position, in mm from the middle of a picture."""
        if not (x_mm or y_mm):
            return self
        quadratic, cubic = (
            None if held is None else _centred_at(held, x_mm, y_mm) for held in (self.coefficients, self.cubic)
        )
        return replace(self, coefficients=quadratic, cubic=cubic)

    def polynomials(self, model: str) -> np.ndarray:
        """Return the coefficients of `quadratic` or `cubic`, float64 (2, 3, 10) by `position_terms`.

        Raises
        ------
        InputError
            The sensor does not have the model.
        """
        self.require_model(model)
        held = self.cubic if model == "cubic" else self.coefficients
        assert held is not None
        return np.pad(held, ((0, 0), (0, 0), (0, CUBIC[-1] - held.shape[-1])))

    def zoom(self, picture_size: tuple[int, int], name: Part = "picture", share: Share = WHOLE) -> float:
        """Return pixels of a picture (rows, columns) per pixel of the calibrated camera; 1 for the synthetic sensor.

        Parameters
        ----------
        share : of the rows and of the columns of the picture, which the calibrated camera shows

        Raises
        ------
        InputError
            That share and the camera's pictures have different aspect ratios.
        """
        if self.camera is None:
            return 1.0
        rows, columns = (float(length * part) for length, part in zip(picture_size, share, strict=True))
        if abs(columns * self.camera.rows / (rows * self.camera.columns) - 1) > ASPECTS_AGREE:
            is_turned = abs(rows * self.camera.rows / (columns * self.camera.columns) - 1) <= ASPECTS_AGREE
            kept = "" if share == WHOLE else f", of which {columns:.0f} x {rows:.0f} are used"
            raise InputError(
                name,
                f": {picture_size[1]} x {picture_size[0]} pixels (columns x rows){kept}, but {self.name} is calibrated "
                f"for pictures of {self.camera.columns} x {self.camera.rows}",
                remedy="rotate them by 90 or 270 degrees (--rotate, or numpy.rot90), or, if the calibration was made "
                "from pictures as these, correct its `camera_size`, whose rows come first"
                if is_turned
                else (
                    *("give pictures of that camera, of the same aspect ratio, say with ", Argument("crop")),
                    " what part of the sensor's full picture they show, or calibrate for this one",
                ),
            )
        return math.sqrt(rows * columns / (self.camera.rows * self.camera.columns))

    def require_reference(self, is_given: bool) -> None:
        """Raise InputError if a reference is needed and not given, or given and not accepted."""
        if self.flat_field and not is_given:
            raise InputError(
                f"{self.name} needs a reference: its colours are relative to a picture without contact. Give ",
                *(Argument("reference", "<picture of the sensor without contact>"), ", taken with the frames"),
            )
        if self.flat_field is False and is_given:
            remedy = ("omit the ", Argument("reference"), ", or calibrate again with one")
            raise InputError(f"{self.name} was fitted to colours as sent", remedy=remedy)

    def require_no_grid(self) -> None:
        """Raise InputError if the pitch is that of a grid, with the reference on it."""
        if self.reference is not None:
            problem = f"{self.name}: it has the pitch of a grid and a reference, as Pipeline.sensor"
            raise InputError(problem, remedy="give the sensor that the pipeline was made from")

    def lighting_difference(self, reference: np.ndarray) -> float:
        """Return the RMS difference of lighting to a picture without contact; infinite if it is unknown."""
        if self.lighting is None:
            return math.inf
        return float(np.sqrt(((lighting(reference) - self.lighting) ** 2).mean()))

    def configuration(
        self,
        model: str = "",
        light_gains: bool | None = None,
        kind: type[Configuration] | None = None,
        **choices: Any,
    ) -> Configuration:
        """Return the configuration that fits this sensor on its grid.

        Parameters
        ----------
        model : str
            A gradient model of the sensor; "": its best model if it has a reference, else `lut`.
        light_gains : bool or None
            A gain for each colour follows the light; None: unless the model is `lut`.
        kind : class
            `Configuration`, the default, or `ExactConfiguration` for double precision alone.
        choices
            Arguments of `Configuration` that do not follow from the sensor.

        Raises
        ------
        InputError
            The sensor does not have the model, or the configuration cannot be built.
        """
        from tactile_depth.chip.configuration import Configuration, ExactConfiguration  # not for who only reads a file

        kind = kind or Configuration
        flat_field = self.reference is not None
        model = model or (self.model if flat_field else MODELS[0])
        self.require_model(model)
        self.require_reference(flat_field)
        config = kind(
            gradient_limit=self.gradient_limit,
            bits_per_channel=self.bits_per_channel,
            flat_field=flat_field,
            gradient_model=model,
            light_gains=model != "lut" if light_gains is None else light_gains,
            **choices,
        )
        if not config.polynomials or isinstance(config, ExactConfiguration):
            return config
        largest = np.abs(self.grid_coefficients(config)).max() / config.coefficient_unit
        above = 2.0 ** (math.floor(math.log2(largest)) + 1) if largest else 0
        return replace(config, coefficient_limit=max(COEFFICIENT_LIMITS[0], above))

    def grid_coefficients(self, config: Configuration) -> np.ndarray:
        """Return the coefficients at `Configuration.samples`, float64 (2, 3, `SAMPLES`, `SAMPLES`)."""
        terms = grid_terms(*config.samples, (config.rows, config.columns), self.pixel_pitch_mm)
        return np.tensordot(self.polynomials(config.gradient_model), terms, (-1, -1))

    def depth_range_px(self, depth_range_mm: float) -> float:
        """Return a depth range in pixels of this sensor's grid; raise InputError if the formats cannot be that fine."""
        smallest = SHALLOWEST_PX * self.pixel_pitch_mm
        if not (is_number(depth_range_mm) and smallest <= depth_range_mm < math.inf):
            accepted = f"{smallest:.2g} mm, {SHALLOWEST_PX:g} of a grid pixel, and more"
            raise InputError(Argument("depth_range_mm", depth_range_mm), accepted=accepted)
        return depth_range_mm / self.pixel_pitch_mm

    def steepest(self, config: Configuration) -> float:
        """Return the largest slope that the model of a configuration was fitted to; infinite if it is unknown."""
        return self.fitted_slope.get(config.gradient_model, math.inf)

    def check(self, config: Configuration, gains_given: bool = False) -> None:
        """Raise InputError unless a configuration agrees with this sensor, because depth would be wrong.

        Parameters
        ----------
        gains_given : bool
            True if the gains of the flat field do not come from `reference`.
        """
        self.require_model(config.gradient_model)
        if config.gradient_limit < self.gradient_limit:
            problem = f" is below the slopes of {self.name}, which reach {self.gradient_limit:g}"
            _refuse(Argument("gradient_limit", config.gradient_limit), problem)
        if config.gradient_model == "lut" and config.bits_per_channel != self.bits_per_channel:
            problem = f", but the table of {self.name} has {self.bits_per_channel}"
            _refuse(Argument("bits_per_channel", config.bits_per_channel), problem)
        grid = (config.rows, config.columns)
        if self.reference is not None and self.reference.shape[-3:-1] != grid:
            raise InputError(
                f"the reference of {self.name} has {self.reference.shape[-3]} rows and {self.reference.shape[-2]} "
                "columns, the grid of the configuration has ",
                *(Argument("rows", grid[0]), ", ", Argument("columns", grid[1])),
                remedy="use frames.on_grid",
            )
        if self.reference is not None and not config.flat_field:
            _refuse(Argument("flat_field", False), f", but {self.name} has a reference")
        if self.flat_field is False and config.flat_field:
            _refuse(Argument("flat_field", True), f", but {self.name} was fitted to colours as sent")
        if self.flat_field and not (config.flat_field and (gains_given or self.reference is not None)):
            self.require_reference(False)

    def require_model(self, model: str) -> None:
        """Raise InputError unless the sensor has the gradient model."""
        if model not in self.models:
            raise InputError(Argument("gradient_model", model), f": {self.name} holds only {', '.join(self.models)}")

    @property
    def models(self) -> tuple[str, ...]:
        """Gradient models that the sensor has."""
        held = (array is not None for array in (self.gradient, self.coefficients, self.cubic))
        return tuple(model for model, is_held in zip(MODELS, held, strict=True) if is_held)

    @property
    def table(self) -> np.ndarray:
        """Table of the model `lut`, `gradient`.

        Raises
        ------
        InputError
            The sensor has no table.
        """
        if self.gradient is None:
            raise InputError(f"{self.name}: no `gradient` in it: the table is needed here")
        return self.gradient

    @property
    def bits_per_channel(self) -> int:
        """Bits of each colour that index the table; 4 without a table, where the value has no effect."""
        return 4 if self.gradient is None else self.gradient.shape[0].bit_length() - 1

    @property
    def gradient_limit(self) -> float:
        """Power of two above all slopes of all models, exact or rounded to 1/256 of the slope or finer."""
        table = 0.0 if self.gradient is None else float(np.abs(self.gradient).max())
        largest = max(table, self.largest_slope) * (1 + ROUNDING)
        return 2.0 ** math.ceil(math.log2(largest)) if largest > 0 else 1.0

    def save(self, path: str | Path) -> None:
        """Write the calibration to an `.npz` of format version 4, without the reference; `load` reads it.

        Raises
        ------
        InputError
            The sensor has no camera or is that of a pipeline, or the path cannot be written.
        OSError
            The machine failed, with a full disk for example.
        """
        from tactile_depth.base import files  # not for who only reads a file

        if not isinstance(path, str | Path):
            raise InputError(Argument("path"), f" is a {type(path).__name__}", accepted="the path of an .npz file")
        path = Path(path)
        self.require_no_grid()
        if self.camera is None:
            raise InputError(f"{self.name}: no camera in it: a calibration file names the camera that it holds for")
        if path.suffix != ".npz":
            raise InputError(f"{path}: give the name of an .npz file")
        camera = self.camera
        arrays: dict[str, Any] = {
            "format_version": FORMAT_VERSION,
            "camera_size": np.array((camera.rows, camera.columns)),
            "pixel_format": camera.pixel_format,
            "black_level": camera.black_level,
            "exposure_us": math.nan if camera.exposure_us is None else camera.exposure_us,
            "pixel_pitch_mm": self.pixel_pitch_mm,
            "flat_field": bool(self.flat_field),
            "model": self.model,
            "gradient": self.gradient,
            "coefficients": self.coefficients,
            "cubic": self.cubic,
            "corrections": None if self.corrections is None else self.corrections.astype(np.float32),
            "largest_slope": self.largest_slope if self.models != ("lut",) else None,
            "lighting": self.lighting,
            "untouched": None if self.untouched is None else self.untouched.astype(np.float32),
            "view": None if self.view is None else np.array(self.view),
            "verdict": None if self.verdict is None else np.array((self.verdict.grade, *self.verdict.reasons)),
            "pixel_aspect": self.pixel_aspect if self.pixel_aspect != 1 else None,
        }
        for model, slope in self.fitted_slope.items():
            arrays[f"fitted_slope_{model}"] = slope
        for model, error in self.height_errors.items():
            arrays[f"cap_height_{model}"] = np.array((error.mean, error.spread, error.presses))
        with files.workspace(path.parent, (path.name,), str(path), guarded=False) as work:
            held = {key: value for key, value in arrays.items() if value is not None}
            np.savez_compressed(work / path.name, **held | {DIGEST: digest_of(held)})
            files.replace(work, (path.name,), path.parent, guarded=False)


def grid_terms(row: np.ndarray, column: np.ndarray, grid: tuple[int, int], pixel_pitch_mm: float) -> np.ndarray:
    """Return `position_terms` of pixels (..), from the centre of a grid (rows, columns): float64 (.., 10)."""
    rows, columns = grid
    return position_terms((column - (columns - 1) / 2) * pixel_pitch_mm, (row - (rows - 1) / 2) * pixel_pitch_mm)


def position_terms(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Return 1, x, y, x^2, x y, y^2, x^3, x^2 y, x y^2, y^3: float64 (.., 10), of positions in mm (..)."""
    return np.stack((np.ones_like(x), x, y, x * x, x * y, y * y, x**3, x * x * y, x * y * y, y**3), axis=-1)


def _centred_at(coefficients: np.ndarray, x_mm: float, y_mm: float) -> np.ndarray:
    """Return the coefficients of the same polynomials of the distance from a position."""
    count = coefficients.shape[-1]
    x, y = (places.ravel() for places in np.meshgrid(*(np.linspace(-1, 1, 4),) * 2))
    values = coefficients @ position_terms(x + x_mm, y + y_mm)[:, :count].T
    found = np.linalg.lstsq(position_terms(x, y)[:, :count], values.reshape(-1, x.size).T, rcond=None)[0]
    return found.T.reshape(coefficients.shape)


def lighting(picture: np.ndarray) -> np.ndarray:
    """Return block means of a picture without contact over their mean, which do not depend on exposure.

    Parameters
    ----------
    picture : uint8 array (rows, columns, 3), RGB

    Returns
    -------
    float64 array (`LIGHTING_BLOCKS`, 3)
    """
    rows, columns = LIGHTING_BLOCKS
    height, width = (length // blocks for length, blocks in zip(picture.shape[:2], LIGHTING_BLOCKS, strict=True))
    whole = picture[: rows * height, : columns * width].astype(np.float64)
    blocks = whole.reshape(rows, height, columns, width, 3).mean(axis=(1, 3))
    return blocks / max(float(blocks.mean()), 1.0)


def equal_areas(picture: np.ndarray, areas: tuple[int, int] = UNTOUCHED_AREAS) -> np.ndarray:
    """Return means of a picture (rows, columns, 3) over equal areas, float64 (area rows, area columns, 3)."""
    down, across = (
        overlaps(length, np.linspace(0, length, count + 1))
        for length, count in zip(picture.shape[:2], areas, strict=True)
    )
    means: np.ndarray = np.einsum("ir,rcn,jc->ijn", down, picture.astype(np.float64), across, optimize=True)
    return means


def overlaps(length: int, edges: np.ndarray) -> np.ndarray:
    """Return the share of each of `length` pixels in the mean over each part between two edges: (parts, length)."""
    pixels = np.arange(length)
    shared = np.minimum(edges[1:, None], pixels + 1) - np.maximum(edges[:-1, None], pixels)
    return np.clip(shared, 0, None) / np.diff(edges)[:, None]


def _refuse(argument: Argument, problem: str) -> None:
    raise InputError(argument, f" of the configuration{problem}", remedy="make it with Sensor.configuration")
