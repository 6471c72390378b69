# SPDX-License-Identifier: Apache-2.0
"""Calibrations: tables from colour to slope."""

from __future__ import annotations

import io
import math
import zipfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from models.configuration import GRADIENT_LIMITS
from models.errors import InputError
from models.npy import is_file, read_header
from models.scenes import GAIN, LIGHTS, REST, scene_pixel_pitch_mm

FOLDER = Path(__file__).resolve().parent.parent / "calibrations"
BUILT_IN = ("synthetic", "gelsight-mini")
BITS_PER_CHANNEL = (1, 6)
SYNTHETIC_PIXEL_PITCH_MM = scene_pixel_pitch_mm(128)  # of a synthetic camera of 128 columns
LARGEST_MEMBER = 2 * (1 << BITS_PER_CHANNEL[1]) ** 3 * np.dtype(np.longdouble).itemsize + 1024  # bytes, with a header
PIXEL_PITCHES_MM = (1e-6, 1e3)
ROUNDING = 2.0**-8  # share by which rounding to a table's format may enlarge the largest slope
LARGEST_SLOPE = 0.99  # in the synthetic table, so that its gradient limit is 1


@dataclass(frozen=True)
class Calibration:
    """A table from colour to slope.

    Attributes
    ----------
    name : str
    gradient : float64 array (2**b, 2**b, 2**b, 2)
        Slope dz/dx (along the columns) and dz/dy (down the rows) by the top b bits of red, green and blue, in
        pixels per pixel; depth z is positive pressed in.
    pixel_pitch_mm : float
        Of the camera; that of the grid is larger where frames are averaged.
    """

    name: str
    gradient: np.ndarray
    pixel_pitch_mm: float

    @property
    def bits_per_channel(self) -> int:
        return self.gradient.shape[0].bit_length() - 1

    @property
    def gradient_limit(self) -> float:
        """A power of two that no slope of the table reaches, exact or rounded to 1/256 of it or finer."""
        largest = float(np.abs(self.gradient).max()) * (1 + ROUNDING)
        return 2.0 ** math.ceil(math.log2(largest)) if largest > 0 else 1.0


def load(name_or_path: str) -> Calibration:
    """A built-in calibration by its name, or one from an `.npz`.

    The file holds `gradient`, float (2**b, 2**b, 2**b, 2), b in 1..6, and `pixel_pitch_mm`; more may be in.

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
    """The synthetic sensor's table: the least-squares inverse of its colour model at each bin's centre."""
    step = 256 >> bits_per_channel
    centre = np.arange(0, 256, step) + (step - 1) / 2
    colour = np.stack(np.meshgrid(centre, centre, centre, indexing="ij"), axis=-1)
    gradient = (colour - REST) / GAIN @ np.linalg.pinv(LIGHTS).T
    within = np.clip(gradient, -LARGEST_SLOPE, LARGEST_SLOPE)
    return Calibration("synthetic", within, SYNTHETIC_PIXEL_PITCH_MM)


def _read(name: str, path: Path) -> Calibration:
    if not is_file(path):
        problem = f"{path}: no such file" if path.suffix == ".npz" else f"unknown calibration {name}"
        raise InputError(f"{problem}: accepted are {', '.join(BUILT_IN)}, or the path of an .npz file")
    arrays = {}
    try:
        with zipfile.ZipFile(path) as archive:
            for key in ("gradient", "pixel_pitch_mm"):
                if f"{key}.npy" in archive.namelist():
                    arrays[key] = _member(archive, f"{key}.npy")
    except Exception as error:  # numpy, zipfile and zlib raise a dozen kinds over a damaged file
        reason = " ".join(str(error).split()) or type(error).__name__
        raise InputError(f"{path}: not a readable .npz ({reason}): write it with numpy.savez_compressed") from error
    for key in ("gradient", "pixel_pitch_mm"):
        if key not in arrays:
            raise InputError(f"{path}: no `{key}` in it: a calibration holds `gradient` and `pixel_pitch_mm`")
    return Calibration(name, _gradient(path, arrays["gradient"]), _pitch(path, arrays["pixel_pitch_mm"]))


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
    if largest and not GRADIENT_LIMITS[0] <= largest <= GRADIENT_LIMITS[1] * (1 - ROUNDING):
        raise InputError(
            f"{path}: the largest slope in `gradient` is {largest:.3g}: accepted are {GRADIENT_LIMITS[0]:g} to "
            f"{GRADIENT_LIMITS[1]:g}, in pixels per pixel"
        )
    return gradient.astype(np.float64)


def _pitch(path: Path, pitch: np.ndarray) -> float:
    if pitch.shape != () or pitch.dtype.kind not in "iuf":
        raise InputError(f"{path}: `pixel_pitch_mm` is {pitch.dtype} {pitch.shape}: accepted is one number, in mm")
    low, high = PIXEL_PITCHES_MM
    if not low <= float(pitch) <= high:
        raise InputError(f"{path}: `pixel_pitch_mm` is {float(pitch):g}: accepted are {low:g} to {high:g}, in mm")
    return float(pitch)
