# SPDX-License-Identifier: Apache-2.0
"""Frames from scenes and files, brought to the grid: flat-fielded, cropped, area-averaged, rounded once."""

from __future__ import annotations

import math
import re
import struct
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from PIL import Image

from models.calibration import SYNTHETIC_PIXEL_PITCH_MM
from models.errors import InputError
from models.npy import is_file, read_header
from models.scenes import AS_EVER, SCENES, Press, render, scene_pixel_pitch_mm

LARGEST_CAMERA = 4096  # rows, and columns, of a frame: what a file claims must not decide how much memory is taken
PNG_SIGNATURE = b"\x89PNG\r\n\x1a\n"
PNG_COLOURS = {0: "grey", 2: "RGB", 3: "palette", 4: "grey with transparency", 6: "RGB with transparency"}
REST_SCENE = "flat"  # nothing touches
ACCEPTED = f"a scene ({', '.join(SCENES)}), a .npy of uint8 (frames, rows, cols, 3), a PNG, a folder of PNGs"


@dataclass(frozen=True)
class Frames:
    """Frames on the grid.

    Attributes
    ----------
    pixels : uint8 array (frames, rows, cols, 3), RGB
    pixel_scale : float
        Camera pixels per grid pixel: times the calibration's `pixel_pitch_mm` it is the pitch of the grid.
    name : str
        What was loaded.
    labels : tuple of str
        One per frame.
    reference : uint8 array (rows, cols, 3), or None
        The sensor without contact.
    """

    pixels: np.ndarray
    pixel_scale: float
    name: str
    labels: tuple[str, ...]
    reference: np.ndarray | None = None


@dataclass(frozen=True)
class Resampling:
    """Centred crop to the aspect of a grid, and exact area averages over it.

    One grid pixel is `numerator / denominator` camera pixels wide and high. Weights count whole units of 1 /
    `denominator` camera pixels, so averages of integers are exact and the same on every machine.
    """

    rows: np.ndarray  # (grid rows, camera rows), whole numbers as float64
    columns: np.ndarray  # (grid cols, camera cols)
    origin: tuple[int, int]  # first camera row and column of the crop
    numerator: int
    denominator: int

    @property
    def scale(self) -> float:
        """Camera pixels per grid pixel."""
        return self.numerator / self.denominator

    def average(self, image: np.ndarray) -> np.ndarray:
        """Averages of an image (camera rows, camera cols, channels): float64 (rows, cols, channels)."""
        height, width, channels = image.shape
        by_row = self.rows @ image.astype(np.float64).reshape(height, width * channels)
        return self.columns @ by_row.reshape(-1, width, channels) / self.numerator**2


def resampling(camera: tuple[int, int], grid: tuple[int, int]) -> Resampling:
    """The resampling of camera frames (rows, cols) to a grid (rows, cols) that is no larger.

    The crop starts on a whole pixel, so that a frame as wide as the grid passes unblurred.
    """
    (height, width), (rows, cols) = camera, grid
    numerator, denominator = (height, rows) if height * cols <= width * rows else (width, cols)

    def weights(count: int, length: int) -> tuple[np.ndarray, int]:
        origin = (length * denominator - count * numerator) // (2 * denominator)
        start = origin * denominator + np.arange(count)[:, None] * numerator
        pixel = np.arange(length) * denominator
        overlap = np.minimum(start + numerator, pixel + denominator) - np.maximum(start, pixel)
        return np.maximum(overlap, 0).astype(np.float64), origin

    row_weights, top = weights(rows, height)
    column_weights, left = weights(cols, width)
    return Resampling(row_weights, column_weights, (top, left), numerator, denominator)


def read_picture(path: Path) -> np.ndarray:
    """Read an 8-bit colour PNG; transparency is dropped.

    Returns
    -------
    uint8 array (rows, cols, 3)

    Raises
    ------
    InputError
        Missing, truncated, too large, or not an 8-bit colour PNG.
    """
    if not is_file(path):
        raise InputError(f"{path}: no such file: give an 8-bit RGB PNG")
    try:
        with path.open("rb") as file:
            head = file.read(26)
            if head[:8] != PNG_SIGNATURE or head[12:16] != b"IHDR" or len(head) < 26:
                raise ValueError("it does not begin as a PNG does")
            width, height, bits, colour = struct.unpack(">IIBB", head[16:])
            # Asked of the header: the reader takes 16 bits for 8, and memory before it looks at what is there.
            if (bits, colour) not in ((8, 2), (8, 6)) and not (bits <= 8 and colour == 3):
                raise InputError(
                    f"{path}: a PNG of {bits} bits, {PNG_COLOURS.get(colour, f'colour type {colour}')}, {height} x "
                    f"{width}: save it as 8-bit RGB"
                )
            _check_camera(str(path), height, width)
            file.seek(0)
            with Image.open(file, formats=["PNG"]) as picture:
                if getattr(picture, "is_animated", False):
                    raise InputError(f"{path}: an animation: save each of its frames as a PNG, in one folder")
                return np.array(picture.convert("RGB"))
    except InputError:
        raise
    except Exception as error:  # the reader raises a dozen kinds over a damaged file
        raise InputError(f"{path}: not a readable picture ({_line(error)}): give an intact PNG") from error


def _check_camera(name: str, height: int, width: int) -> None:
    if max(height, width) > LARGEST_CAMERA:
        raise InputError(
            f"{name}: frames of {height} x {width}: accepted are up to {LARGEST_CAMERA} x {LARGEST_CAMERA}"
        )


def load_frames(
    source: str, size: tuple[int, int], reference: str | None = None, seed: int = 1, press: Press = AS_EVER
) -> Frames:
    """Load what `FRAMES` and `REFERENCE` name.

    Parameters
    ----------
    source : str
        A scene's name, a `.npy` of uint8 (frames, rows, cols, 3), a PNG, or a folder of PNGs.
    size : (rows, cols) of the grid
    reference : str, optional
        Picture of the sensor without contact, as large as the frames; with a scene `flat`.
    seed : int
        Seed of a scene's noise.
    press : Press
        Of a scene.

    Raises
    ------
    InputError
    """
    if source in SCENES:
        return _scene(source, size, reference, seed, press)
    if press != AS_EVER:
        raise InputError(f"PRESS, AT and NOISE with FRAMES={source}: they go with scenes, leave them out")
    path = Path(source)
    try:
        folder = path.is_dir()
        listed = list(path.iterdir()) if folder else []
    except OSError as error:
        raise InputError(f"{source}: {error.strerror}: give a scene, a file or a folder") from error
    if folder:
        files = sorted((p for p in listed if p.suffix.lower() == ".png"), key=_natural)
        if not files:
            raise InputError(f"{source}: a folder without any PNG: accepted is {ACCEPTED}")
        labels = tuple(p.name for p in files)
        images: Iterable[np.ndarray] = map(read_picture, files)
    elif is_file(path) and path.suffix.lower() == ".npy":
        array = _read_array(path)
        labels = tuple(str(i) for i in range(len(array)))
        images = array
    elif is_file(path):
        labels, images = (path.name,), [read_picture(path)]
    else:
        raise InputError(f"{source}: neither a scene nor a file or folder: accepted is {ACCEPTED}")
    return _to_grid(source, labels, images, size, reference)


def _scene(name: str, size: tuple[int, int], reference: str | None, seed: int, press: Press) -> Frames:
    if reference not in (None, REST_SCENE):
        raise InputError(f"REFERENCE={reference} with the scene {name}: accepted is REFERENCE={REST_SCENE}, or none")
    scene = render(name, *size, seed, press)
    rest = render(REST_SCENE, *size, seed, Press(noise=0)).frames[0] if reference else None
    scale = scene_pixel_pitch_mm(min(size)) / SYNTHETIC_PIXEL_PITCH_MM
    return Frames(scene.frames, scale, name, scene.labels, rest)


def _to_grid(
    name: str,
    labels: tuple[str, ...],
    images: Iterable[np.ndarray],
    size: tuple[int, int],
    reference: str | None,
) -> Frames:
    no_contact = None if reference is None else read_picture(Path(reference))
    pixels = np.empty((len(labels), *size, 3), np.uint8)
    plan, camera = None, (0, 0)
    for index, (label, image) in enumerate(zip(labels, images, strict=True)):
        height, width = image.shape[:2]
        if plan is None:
            camera = (height, width)
            if height < size[0] or width < size[1]:
                raise InputError(
                    f"{name}: frames of {height} x {width} are smaller than the grid of "
                    f"{size[0]} x {size[1]}: give larger frames or a smaller N"
                )
            if no_contact is not None and no_contact.shape[:2] != camera:
                raise InputError(
                    f"{reference}: {no_contact.shape[0]} x {no_contact.shape[1]}, but the frames are "
                    f"{height} x {width}: give the no-contact frame of the same camera"
                )
            plan = resampling(camera, size)
        if (height, width) != camera:
            raise InputError(
                f"{name}: {label} is {height} x {width}, {labels[0]} is {camera[0]} x {camera[1]}: "
                "all frames must be of one size"
            )
        pixels[index] = np.rint(plan.average(image))
    assert plan is not None
    on_grid = None if no_contact is None else np.rint(plan.average(no_contact)).astype(np.uint8)
    return Frames(pixels, plan.scale, name, labels, on_grid)


def _read_array(path: Path) -> np.ndarray:
    try:
        with path.open("rb") as file:
            shape, _, dtype = read_header(file)
            if dtype != np.uint8 or len(shape) != 4 or shape[3] != 3 or min(shape) < 1:
                raise InputError(f"{path}: {dtype} {shape}: accepted is uint8 (frames, rows, cols, 3)")
            _check_camera(str(path), shape[1], shape[2])
            present = path.stat().st_size - file.tell()
            if math.prod(shape) > present:  # before memory is taken for it
                raise ValueError(f"{present:,} bytes of data for {shape}")
            file.seek(0)
            return np.lib.format.read_array(file, allow_pickle=False)
    except InputError:
        raise
    except Exception as error:  # a damaged header can make numpy raise anything
        raise InputError(f"{path}: not a readable .npy ({_line(error)}): write it with numpy.save") from error


def _natural(path: Path) -> list[tuple[int, str]]:
    """Sorting key in which numbers count as numbers: 2.png before 12.png."""
    parts = re.split(r"(\d+)", path.name)
    return [(int(part), "") if part.isdecimal() else (-1, part) for part in parts]


def _line(error: BaseException) -> str:
    return " ".join(str(error).split()) or type(error).__name__
