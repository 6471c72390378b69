# SPDX-License-Identifier: Apache-2.0
"""Calibrations: from colour to slope, by a table or by quadratics."""

from __future__ import annotations

import io
import math
import zipfile
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from models.configuration import GRADIENT_LIMITS, GRADIENT_MODELS
from models.errors import InputError
from models.npy import is_file, read_header
from models.scenes import GAIN, LIGHTS, REST, scene_pixel_pitch_mm

FOLDER = Path(__file__).resolve().parent.parent / "calibrations"
BUILT_IN = ("synthetic", "gelsight-mini")
MODELS = GRADIENT_MODELS
BITS_PER_CHANNEL = (1, 6)
COEFFICIENTS = (2, 3, 6)  # slope, colour, term
LARGEST_COEFFICIENT = 1e6
SYNTHETIC_PIXEL_PITCH_MM = scene_pixel_pitch_mm(128)  # of a synthetic camera of 128 columns
LARGEST_MEMBER = 2 * (1 << BITS_PER_CHANNEL[1]) ** 3 * np.dtype(np.longdouble).itemsize + 1024  # bytes, with a header
KEYS = ("gradient", "pixel_pitch_mm", "coefficients", "largest_slope", "model")
PIXEL_PITCHES_MM = (1e-6, 1e3)
ROUNDING = 2.0**-8  # share by which rounding to a table's format may enlarge the largest slope
LARGEST_SLOPE = 0.99  # in the synthetic table, so that its gradient limit is 1


@dataclass(frozen=True)
class Calibration:
    """From colour to slope, in one or both of two models.

    Attributes
    ----------
    name : str
    gradient : float64 array (2**b, 2**b, 2**b, 2), or None
        Model `lut`: slope dz/dx (along the columns) and dz/dy (down the rows) by the top b bits of red, green and
        blue, in pixels per pixel; depth z is positive pressed in. Real sensors are flat-fielded first: 128 I / ref.
    pixel_pitch_mm : float
        Of the camera; that of the grid is larger where frames are averaged.
    coefficients : float64 array (2, 3, 6), or None
        Model `quadratic`: slope = sum over red, green, blue of C (I / ref - 1), C = a quadratic in the position:
        terms 1, x, y, x^2, x y, y^2, in mm from the picture's centre, x along the columns, y down the rows.
    largest_slope : float
        That the quadratics were fitted to: their formats hold it.
    model : str
        The better of the two.
    reference : uint8 array (rows, cols, 3), or None
        The sensor without contact, on the grid in use: `on_grid`.
    """

    name: str
    gradient: np.ndarray | None
    pixel_pitch_mm: float
    coefficients: np.ndarray | None = None
    largest_slope: float = 0.0
    model: str = "lut"
    reference: np.ndarray | None = None

    def on_grid(self, pixel_scale: float, reference: np.ndarray | None = None) -> Calibration:
        """For a grid whose pixels are so many of the camera's wide, and the sensor's frame without contact on it."""
        return replace(self, pixel_pitch_mm=self.pixel_pitch_mm * pixel_scale, reference=reference)

    @property
    def models(self) -> tuple[str, ...]:
        """Those that it holds."""
        held = (self.gradient is not None, self.coefficients is not None)
        return tuple(model for model, is_held in zip(MODELS, held, strict=True) if is_held)

    @property
    def table(self) -> np.ndarray:
        """`gradient`.

        Raises
        ------
        InputError
            There is none.
        """
        if self.gradient is None:
            raise InputError(f"{self.name}: no `gradient` in it: the table is needed here")
        return self.gradient

    @property
    def bits_per_channel(self) -> int:
        """Of the table; 4, which is as good as any, where there is none."""
        return 4 if self.gradient is None else self.gradient.shape[0].bit_length() - 1

    @property
    def gradient_limit(self) -> float:
        """A power of two that no slope of either model reaches, exact or rounded to 1/256 of it or finer."""
        table = 0.0 if self.gradient is None else float(np.abs(self.gradient).max())
        largest = max(table, self.largest_slope) * (1 + ROUNDING)
        return 2.0 ** math.ceil(math.log2(largest)) if largest > 0 else 1.0


def load(name_or_path: str) -> Calibration:
    """A built-in calibration by its name, or one from an `.npz`.

    The file holds `pixel_pitch_mm`, and `gradient`, float (2**b, 2**b, 2**b, 2), b in 1..6, or `coefficients`, float
    (2, 3, 6), with `largest_slope`, or all; then `model` says which is the default. More may be in.

    Raises
    ------
    InputError
    """
    if name_or_path == "synthetic":
        return synthetic()
    if name_or_path in BUILT_IN:
        return _read(name_or_path, FOLDER / f"{name_or_path}.npz")
    return _read(name_or_path, Path(name_or_path))


def synthetic(bits_per_channel: int = 4) -> Calibration:
    """The synthetic sensor: the least-squares inverse of its colour model, at each bin's centre and as quadratics.

    Its light is even and its colours linear in the slopes: of each quadratic only the first term is not 0.
    """
    step = 256 >> bits_per_channel
    centre = np.arange(0, 256, step) + (step - 1) / 2
    colour = np.stack(np.meshgrid(centre, centre, centre, indexing="ij"), axis=-1)
    gradient = (colour - REST) / GAIN @ np.linalg.pinv(LIGHTS).T
    within = np.clip(gradient, -LARGEST_SLOPE, LARGEST_SLOPE)
    coefficients = np.zeros(COEFFICIENTS)
    coefficients[..., 0] = REST / GAIN * np.linalg.pinv(LIGHTS)
    return Calibration("synthetic", within, SYNTHETIC_PIXEL_PITCH_MM, coefficients, LARGEST_SLOPE)


def _read(name: str, path: Path) -> Calibration:
    if not is_file(path):
        problem = f"{path}: no such file" if path.suffix == ".npz" else f"unknown calibration {name}"
        raise InputError(f"{problem}: accepted are {', '.join(BUILT_IN)}, or the path of an .npz file")
    arrays = {}
    try:
        with zipfile.ZipFile(path) as archive:
            for key in KEYS:
                if f"{key}.npy" in archive.namelist():
                    arrays[key] = _member(archive, f"{key}.npy")
    except Exception as error:  # numpy, zipfile and zlib raise a dozen kinds over a damaged file
        reason = " ".join(str(error).split()) or type(error).__name__
        raise InputError(f"{path}: not a readable .npz ({reason}): write it with numpy.savez_compressed") from error
    held = {model: key in arrays for model, key in zip(MODELS, ("gradient", "coefficients"), strict=True)}
    if not any(held.values()):
        raise InputError(f"{path}: no `gradient` and no `coefficients` in it: a calibration holds one of them or both")
    needed = ["pixel_pitch_mm", *(["largest_slope"] if held["quadratic"] else [])]
    for key in needed:
        if key not in arrays:
            raise InputError(f"{path}: no `{key}` in it: a calibration holds {' and '.join(f'`{k}`' for k in needed)}")
    return Calibration(
        name,
        _gradient(path, arrays["gradient"]) if held["lut"] else None,
        _pitch(path, arrays["pixel_pitch_mm"]),
        _coefficients(path, arrays["coefficients"]) if held["quadratic"] else None,
        _largest_slope(path, arrays["largest_slope"]) if held["quadratic"] else 0.0,
        _model(path, arrays.get("model"), [model for model in MODELS if held[model]]),
    )


def _member(archive: zipfile.ZipFile, name: str) -> np.ndarray:
    """An array of an archive, of which no more is unpacked than the largest table takes."""
    member = archive.getinfo(name)
    if member.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
        raise ValueError(f"{name} is packed in a way that numpy does not write")
    if member.file_size > LARGEST_MEMBER:
        raise ValueError(f"{name} has {member.file_size:,} bytes, and the largest table {LARGEST_MEMBER:,}")
    content = io.BytesIO(archive.read(member))  # never longer than file_size
    shape, _, dtype = read_header(content)
    if any(length < 0 for length in shape) or math.prod(shape) * dtype.itemsize > LARGEST_MEMBER:
        raise ValueError(f"{name} is {dtype} {shape}")
    content.seek(0)
    return np.lib.format.read_array(content, allow_pickle=False)


def _gradient(path: Path, gradient: np.ndarray) -> np.ndarray:
    low, high = BITS_PER_CHANNEL
    shapes = [(1 << b, 1 << b, 1 << b, 2) for b in range(low, high + 1)]
    if gradient.shape not in shapes or gradient.dtype.kind != "f":
        raise InputError(
            f"{path}: `gradient` is {gradient.dtype} {gradient.shape}: accepted is float "
            f"(2^b, 2^b, 2^b, 2), b from {low} to {high}"
        )
    if bad := np.count_nonzero(~np.isfinite(gradient)):
        raise InputError(f"{path}: `gradient` holds {bad} values that are NaN or infinite: fill empty bins")
    largest = float(np.abs(gradient).max())
    if largest:
        _within_limits(path, "the largest slope in `gradient`", largest)
    return gradient.astype(np.float64)


def _coefficients(path: Path, coefficients: np.ndarray) -> np.ndarray:
    if coefficients.shape != COEFFICIENTS or coefficients.dtype.kind != "f":
        raise InputError(
            f"{path}: `coefficients` is {coefficients.dtype} {coefficients.shape}: accepted is float {COEFFICIENTS}"
        )
    if not (np.abs(coefficients) <= LARGEST_COEFFICIENT).all():  # NaN is not
        raise InputError(
            f"{path}: `coefficients` holds NaN, or values over {LARGEST_COEFFICIENT:g}: is x in mm from the centre?"
        )
    return coefficients.astype(np.float64)


def _largest_slope(path: Path, slope: np.ndarray) -> float:
    if slope.shape != () or slope.dtype.kind not in "iuf":
        raise InputError(f"{path}: `largest_slope` is {slope.dtype} {slope.shape}: accepted is one number")
    _within_limits(path, "`largest_slope`", float(slope))
    return float(slope)


def _within_limits(path: Path, what: str, slope: float) -> None:
    low, high = GRADIENT_LIMITS
    if not low <= slope <= high * (1 - ROUNDING):
        raise InputError(f"{path}: {what} is {slope:.3g}: accepted are {low:g} to {high:g}, in pixels per pixel")


def _model(path: Path, model: np.ndarray | None, held: list[str]) -> str:
    if model is None:
        return held[0]
    name = str(model) if model.shape == () and model.dtype.kind == "U" else f"{model.dtype} {model.shape}"
    if name not in held:
        raise InputError(f"{path}: `model` is {name}: accepted is a model that the file holds: {', '.join(held)}")
    return name


def _pitch(path: Path, pitch: np.ndarray) -> float:
    if pitch.shape != () or pitch.dtype.kind not in "iuf":
        raise InputError(f"{path}: `pixel_pitch_mm` is {pitch.dtype} {pitch.shape}: accepted is one number, in mm")
    low, high = PIXEL_PITCHES_MM
    if not low <= float(pitch) <= high:
        raise InputError(f"{path}: `pixel_pitch_mm` is {float(pitch):g}: accepted are {low:g} to {high:g}, in mm")
    return float(pitch)
