# SPDX-License-Identifier: Apache-2.0
"""Loads frames from scenes and files, and resamples them to the grid: crop, area average, one rounding."""

from __future__ import annotations

import math
import os
import re
import struct
from collections.abc import Iterable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import BinaryIO

import numpy as np
from PIL import Image

from tactile_depth.base.by_value import ByValue
from tactile_depth.base.errors import Argument, InputError, InputWarning, counted, warn
from tactile_depth.base.files import RECORD, recorded
from tactile_depth.base.npy import is_file, read_header
from tactile_depth.chip.camera_configuration import CameraChoice, CameraConfiguration
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.resampling import WHOLE, Share
from tactile_depth.pictures.blocks import Rest
from tactile_depth.pictures.doubts import Warned, tell
from tactile_depth.pictures.grid_sampler import grid_sampler, middle
from tactile_depth.pictures.picture_check import check_picture, require_all_colours
from tactile_depth.pictures.reference_check import check_reference
from tactile_depth.sensor.scenes import AS_EVER, SCENES, SYNTHETIC_PIXEL_PITCH_MM, Press, render, scene_pixel_pitch_mm
from tactile_depth.sensor.sensor import Sensor

LARGEST_CAMERA = 4096  # largest rows and columns of a frame, so that a damaged header cannot take all memory
PNG_SIGNATURE, JPEG_SIGNATURE = b"\x89PNG\r\n\x1a\n", b"\xff\xd8\xff"
APPLE_DOUBLE = "._"  # macOS puts such a file beside each on a foreign disk; it holds no picture
PICTURE_SUFFIXES = (".png", ".jpg", ".jpeg")
OTHER_SUFFIXES = (  # of pictures that are not read in a folder
    *(".avif", ".bmp", ".dng", ".gif", ".heic", ".heif", ".j2k", ".jfif", ".jp2", ".jpe", ".jxl", ".npy", ".pgm"),
    *(".pnm", ".ppm", ".raw", ".tga", ".tif", ".tiff", ".webp"),
)
SAVE_RGB = "save it as 8-bit RGB"
EXIF_ORIENTATION, UPRIGHT = 0x0112, 1
PALETTE = 3
PNG_COLOURS = {0: "grey", 2: "RGB", PALETTE: "palette", 4: "grey with transparency", 6: "RGB with transparency"}
REST_SCENE = "flat"  # the scene without contact
GREY = 128  # level of a picture that stands for one without contact
SCENE_PICTURE = (480, 640)  # rows and columns of a scene in front of a camera
PICTURES = "a picture (PNG or JPEG), a folder of pictures, a .npy of uint8 (rows, cols, 3) or (frames, rows, cols, 3)"
ACCEPTED = f"a scene ({', '.join(SCENES)}), {PICTURES}"


@dataclass(frozen=True, eq=False)
class Frames(ByValue):
    """Frames on the grid.

    Attributes
    ----------
    pixels : uint8 array (frames, rows, cols, 3), RGB
    pixel_scale : float
        Pixels of the picture per grid pixel.
    name : str
        Name of the source.
    labels : tuple of str
        One label per frame.
    reference : uint8 array (rows, cols, 3), or None
        The sensor without contact.
    picture_size : (rows, columns), or None
        Size of the pictures before resampling; None for a scene, which is drawn on the grid.
    no_contact : uint8 array (rows, columns, 3), or None
        Full picture that `reference` was made from.
    camera : CameraConfiguration, or None
        The camera that the pictures were converted for; None: they are averaged as they are.
    words : uint32 array (frames, picture rows, picture columns), or None
        What that camera sends (`pixel_format`).
    share : Share
        Part of the pictures that the calibrated camera shows.
    """

    pixels: np.ndarray
    pixel_scale: float
    name: str
    labels: tuple[str, ...]
    reference: np.ndarray | None = None
    picture_size: tuple[int, int] | None = None
    no_contact: np.ndarray | None = None
    camera: CameraConfiguration | None = None
    words: np.ndarray | None = None
    share: Share = WHOLE

    def __repr__(self) -> str:
        frames, rows, columns, _ = self.pixels.shape
        return f"Frames({self.name!r}, {frames} x {columns}x{rows})"


def read_picture(path: Path) -> np.ndarray:
    """Read an 8-bit colour PNG or JPEG; transparency is dropped.

    Returns
    -------
    uint8 array (rows, cols, 3)

    Raises
    ------
    InputError
        The file is missing, truncated, too large, or not an 8-bit colour picture.
    """
    if not is_file(path):
        problem = "a folder" if os.path.isdir(path) else "no such file"
        raise InputError(f"{path}: {problem}: give an 8-bit RGB picture, PNG or JPEG")
    try:
        with path.open("rb") as file:
            head = file.read(26)
            if head.startswith(JPEG_SIGNATURE):
                return _read_jpeg(path, file)
            if head[:8] != PNG_SIGNATURE or head[12:16] != b"IHDR" or len(head) < 26:
                raise ValueError("it does not begin as a PNG or a JPEG does")
            width, height, bits, colour = struct.unpack(">IIBB", head[16:])
            # The header is checked first: the reader converts 16 bits to 8, and allocates memory before it reads.
            if (bits, colour) not in ((8, 2), (8, 6)):
                remedy = "take it again in full colour" if colour == PALETTE else SAVE_RGB
                raise InputError(
                    f"{path}: a PNG of {bits} bits, {PNG_COLOURS.get(colour, f'colour type {colour}')}, {height} x "
                    f"{width}: {remedy}"
                )
            _check_camera(str(path), height, width)
            file.seek(0)
            with Image.open(file, formats=["PNG"]) as picture:
                if getattr(picture, "is_animated", False):
                    raise InputError(f"{path}: an animation: save each of its frames as a PNG, in one folder")
                _require_upright(path, picture)
                return np.array(picture.convert("RGB"))
    except InputError:
        raise
    except Exception as error:  # the reader raises many kinds of errors for a damaged file
        raise InputError(f"{path}: not a readable picture ({_line(error)}): give an intact PNG or JPEG") from error


def _read_jpeg(path: Path, file: BinaryIO) -> np.ndarray:
    file.seek(0)
    with Image.open(file, formats=["JPEG"]) as picture:  # reads the header only
        _check_camera(str(path), picture.height, picture.width)
        if picture.mode != "RGB":
            raise InputError(f"{path}: a JPEG of mode {picture.mode}: {SAVE_RGB}")
        _require_upright(path, picture)
        if getattr(picture, "n_frames", 1) > 1:
            warn(InputWarning(f"{path}: the first of its pictures alone counts", remedy="save each by itself"))
        return np.array(picture)


def _require_upright(path: Path, picture: Image.Image) -> None:
    if picture.getexif().get(EXIF_ORIENTATION, UPRIGHT) != UPRIGHT:
        raise InputError(f"{path}: its header asks viewers to rotate it: save it as the camera sees it")


def _check_camera(name: str, height: int, width: int) -> None:
    if max(height, width) > LARGEST_CAMERA:
        raise InputError(
            f"{name}: frames of {height} x {width}: accepted are up to {LARGEST_CAMERA} x {LARGEST_CAMERA}"
        )


def on_grid(sensor: Sensor, frames: Frames, whole: bool = False) -> Sensor:
    """Return a sensor on the grid of frames, with the frames' reference and the pitch of the grid.

    The pictures of a real sensor show what its camera shows, whatever their size; so do those of the synthetic sensor
    if they are `whole`, otherwise their pixels are as wide as its own.
    """
    if sensor.camera is not None and frames.picture_size is None:
        raise InputError(
            f"{frames.name}: a scene is drawn for the synthetic sensor, not for {sensor.name}",
            remedy=("omit the ", Argument("calibration"), ", or give pictures of that sensor"),
        )
    sensor.require_reference(frames.reference is not None)
    zoom = 1.0 if frames.picture_size is None else sensor.zoom(frames.picture_size, frames.name, frames.share)
    if frames.no_contact is not None:
        check_reference(sensor, middle(frames.no_contact[None], frames.share), share=frames.share)
        assert frames.reference is not None
        check_frames(frames, Rest.of(frames.reference[None]))
    placed = sensor
    scale = frames.pixel_scale / zoom
    if frames.camera is None and (whole or sensor.camera is not None):
        scale = grid_scale(sensor, frames.pixels.shape[1:3])
    if frames.camera is not None:
        _warn_of_window(sensor, frames)
        columns, rows = frames.camera.centre_shift
        pitch_mm = sensor.pixel_pitch_mm / zoom
        placed = sensor.centred_at(columns * pitch_mm, rows * pitch_mm)
    return placed.scaled(scale, frames.reference)


def check_frames(frames: Frames, rest: Rest) -> None:
    """Refuse a frame that gives no right depth with its reference, `rest`; warn of each kind of doubt once.

    Raises
    ------
    UnusablePicture
    """
    warned = Warned()
    for label, frame in zip(frames.labels, frames.pixels, strict=True):
        name = frames.name if len(frames.labels) == 1 else f"{frames.name}: {label}"
        tell(warned.new(check_picture(frame, rest, name).doubts))


def _warn_of_window(sensor: Sensor, frames: Frames) -> None:
    """Warn of a camera's window that shows gel that the calibration's pictures do not show."""
    if sensor.camera is None or frames.camera is None or frames.picture_size is None:
        return
    x, y, width, height = frames.camera.crop
    beyond = 0.0
    for first, length, whole, share in zip((y, x), (height, width), frames.picture_size, frames.share, strict=True):
        margin = float(whole * (1 - share) / 2)
        beyond = max(beyond, margin - first, first + length - (whole - margin))
    if beyond > 1:
        far = counted(round(beyond), "pixel")
        problem = f" shows gel up to {far} beyond the calibration's pictures, which is not calibrated"
        remedy = "omit it for the view of the calibration"
        warn(InputWarning(Argument("window", frames.camera.crop), problem, remedy=remedy))


def load_frames(
    source: str,
    size: tuple[int, int],
    reference: str | None = None,
    seed: int = 1,
    press: Press = AS_EVER,
    camera: CameraChoice | None = None,
    share: Share = WHOLE,
) -> Frames:
    """Load the frames that `FRAMES` and `REFERENCE` of make name.

    Parameters
    ----------
    source : str
        A scene's name, a `.npy` of uint8 (rows, cols, 3) or (frames, rows, cols, 3), a picture, or a folder of them.
    size : (rows, cols) of the grid
    reference : str, optional
        Picture of the sensor without contact, of the same size as the frames; `flat` for a scene.
    seed : int
        Seed of a scene's noise.
    press : Press
        Depth, position and noise of a scene.
    camera : CameraChoice, optional
        Pictures are converted to what this camera sends, and then taken as its hardware takes them. A scene is drawn as
        a picture of `SCENE_PICTURE`.
    share : Share
        Part of the pictures that the grid covers; the default window of `camera` is in it.
    """
    if source in SCENES:
        return _scene(source, size, reference, seed, press, camera)
    if press != AS_EVER:
        raise InputError(f"press, position and noise with {source}: they go with scenes: omit them")
    labels, images = read_pictures(source, accepted=ACCEPTED)
    no_contact = None if reference is None else read_picture(Path(reference))
    return _to_grid(source, labels, images, size, reference or "", no_contact, camera, share)


def flat_frames(
    sensor: Sensor, size: tuple[int, int], camera: CameraChoice | None, share: Share, *, with_reference: bool
) -> Frames:
    """Return a grey picture as a frame and as its reference: for builds without a picture.

    The calibration's camera shows a share of it, in its own pixels; in front of a camera of the same aspect ratio it is
    of `SCENE_PICTURE`.
    """
    assert sensor.camera is not None
    rows, columns = sensor.camera.rows / share[0], sensor.camera.columns / share[1]
    picture = round(rows), round(columns)
    if camera is not None and rows * SCENE_PICTURE[1] == columns * SCENE_PICTURE[0]:
        picture = SCENE_PICTURE
    grey = np.full((*picture, 3), GREY, np.uint8)
    rest = grey if with_reference else None
    frames = _to_grid(REST_SCENE, (REST_SCENE,), [grey], size, REST_SCENE, rest, camera, share)
    return replace(frames, no_contact=None)  # its lighting is that of no sensor


def read_pictures(
    source: str | Path, name: str = "", accepted: str = PICTURES
) -> tuple[tuple[str, ...], Iterable[np.ndarray]]:
    """Return labels and pictures, uint8 (rows, cols, 3) each, of a picture, a folder of pictures or a `.npy`.

    The pictures of a folder are read one by one when the iterable reaches them. Those of its subfolders are left out,
    with a warning, and so are results that the command wrote there, without one.

    Parameters
    ----------
    name : str
        Names the source in errors; by default its path.
    accepted : str
        Lists in errors what the caller accepts.
    """
    if not str(source):
        raise InputError(f"{name or 'the path of pictures'} is empty: give a file or a folder")
    path = Path(source)
    try:
        folder = path.is_dir()
        listed = list(path.iterdir()) if folder else []
    except OSError as error:
        raise InputError(f"{name or source}: {error.strerror}: give a file or a folder") from error
    if folder:
        results = recorded(path)  # of an earlier run with this folder as --out
        given = (each for each in listed if not each.name.startswith(APPLE_DOUBLE) and each.name not in results)
        pictures = sorted(given, key=_natural)
        files = [each for each in pictures if _is_picture(each.name)]
        inside = [each.name for each in pictures if not _is_picture(each.name) and _holds_pictures(each)]
        if not files:
            beside = f", but with subfolders that hold some ({inside[0]}, {len(inside)} in all)" if inside else ""
            raise InputError(f"{name or source}: a folder without any PNG or JPEG{beside}: accepted is {accepted}")
        if inside:
            problem = f"{name or source}: left out are subfolders that hold pictures: {inside[0]}, {len(inside)} in all"
            warn(InputWarning(problem, remedy="name a subfolder to use it"))
        if others := [each.name for each in pictures if each.suffix.lower() in OTHER_SUFFIXES]:
            problem = f"{name or source}: left out is what is no PNG or JPEG: {others[0]}, {len(others)} in all"
            warn(InputWarning(problem, remedy="save them as PNG"))
        return tuple(p.name for p in files), map(read_picture, files)
    if is_file(path) and path.suffix.lower() == ".npy":
        array = _read_array(path)
        if array.ndim == 3:
            return (path.name,), [array]
        return tuple(str(i) for i in range(len(array))), array
    if is_file(path) and path.suffix.lower() == ".npz":
        raise InputError(
            f"{name or source}: a .npz", accepted=accepted, remedy="save its array with numpy.save, as .npy"
        )
    if is_file(path):
        return (path.name,), [read_picture(path)]
    raise InputError(f"{name or source}: no such file or folder: accepted is {accepted}")


def _is_picture(name: str) -> bool:
    return os.path.splitext(name)[1].lower() in PICTURE_SUFFIXES and not name.startswith(APPLE_DOUBLE)


def _holds_pictures(path: Path) -> bool:
    """Return True for a folder with pictures in it or below, unless it is hidden or they are results of a command."""
    if path.name.startswith(".") or not os.path.isdir(path):
        return False
    return any(RECORD not in names and any(map(_is_picture, names)) for _, _, names in os.walk(path))


def read_stack(source: str | Path, name: str = "") -> np.ndarray:
    """Return the pictures of `read_pictures` in one array, uint8 (pictures, rows, cols, 3)."""
    images = list(read_pictures(source, name)[1])
    if len({image.shape for image in images}) > 1:
        raise InputError(f"{name or source}: pictures of several sizes: give pictures of one camera")
    return np.stack(images)


def camera_scale(sensor: Sensor, config: Configuration) -> float:
    """Return the camera pixels per grid pixel, for full pictures of a sensor's camera."""
    return grid_scale(sensor, (config.rows, config.columns))


def grid_scale(sensor: Sensor, grid: tuple[int, ...]) -> float:
    """Return `camera_scale` for a grid (rows, columns)."""
    rows, columns = grid
    if sensor.camera is None:
        return scene_pixel_pitch_mm(min(rows, columns)) / SYNTHETIC_PIXEL_PITCH_MM
    return grid_sampler(sensor.name, (sensor.camera.rows, sensor.camera.columns), (rows, columns)).scale


def _scene(
    name: str, size: tuple[int, int], reference: str | None, seed: int, press: Press, camera: CameraChoice | None
) -> Frames:
    if reference not in (None, REST_SCENE):
        raise InputError(Argument("reference", reference), f" with the scene {name}", accepted=f"{REST_SCENE}, or none")
    drawn = size if camera is None else SCENE_PICTURE
    scene = render(name, *drawn, seed, press)
    rest = render(REST_SCENE, *drawn, seed, Press(noise=0)).frames[0] if reference else None
    scale = scene_pixel_pitch_mm(min(drawn)) / SYNTHETIC_PIXEL_PITCH_MM
    if camera is None:
        return Frames(scene.frames, scale, name, scene.labels, rest)
    frames = _to_grid(name, scene.labels, scene.frames, size, REST_SCENE, rest, camera)
    return replace(frames, pixel_scale=frames.pixel_scale * scale, picture_size=None, no_contact=None)


def _to_grid(
    name: str,
    labels: tuple[str, ...],
    images: Iterable[np.ndarray],
    size: tuple[int, int],
    reference: str,
    no_contact: np.ndarray | None,
    choice: CameraChoice | None,
    share: Share = WHOLE,
) -> Frames:
    pixels = np.empty((len(labels), *size, 3), np.uint8)
    words: np.ndarray | None = None
    sampler, picture = None, (0, 0)
    if no_contact is not None:
        require_all_colours(no_contact, no_contact, reference)
    for index, (label, image) in enumerate(zip(labels, images, strict=True)):
        if no_contact is not None:
            require_all_colours(image, no_contact, f"{name}: {label}")
        height, width = image.shape[:2]
        if sampler is None:
            picture = (height, width)
            if no_contact is not None and no_contact.shape[:2] != picture:
                raise InputError(
                    f"{reference}: {no_contact.shape[0]} x {no_contact.shape[1]}, but the frames are "
                    f"{height} x {width}: give the no-contact frame of the same camera"
                )
            sampler = grid_sampler(name, picture, size, choice, share)
            if sampler.camera is not None:
                words = np.empty((len(labels), *picture), np.uint32)
        if (height, width) != picture:
            raise InputError(
                f"{name}: {label} is {height} x {width}, {labels[0]} is {picture[0]} x {picture[1]}: "
                "all frames must be of one size"
            )
        pixels[index] = sampler.frame(image)
        if words is not None:
            words[index] = sampler.words(image)
    assert sampler is not None
    on_grid = None if no_contact is None else sampler.frame(no_contact)
    return Frames(pixels, sampler.scale, name, labels, on_grid, picture, no_contact, sampler.camera, words, share)


def _read_array(path: Path) -> np.ndarray:
    try:
        with path.open("rb") as file:
            shape, _, dtype = read_header(file)
            if dtype != np.uint8 or len(shape) not in (3, 4) or shape[-1] != 3 or min(shape) < 1:
                raise InputError(
                    f"{path}: {dtype} {shape}: accepted is uint8 (rows, cols, 3) or (frames, rows, cols, 3)"
                )
            _check_camera(str(path), shape[-3], shape[-2])
            present = path.stat().st_size - file.tell()
            if math.prod(shape) > present:  # checked before memory is allocated
                raise ValueError(f"{counted(present, 'byte')} of data for {shape}")
            if math.prod(shape) < present:
                raise InputError(f"{path}: more follows the first array: save one (frames, rows, cols, 3)")
            file.seek(0)
            return np.lib.format.read_array(file, allow_pickle=False)
    except InputError:
        raise
    except Exception as error:  # numpy raises many kinds of errors for a damaged header
        raise InputError(f"{path}: not a readable .npy ({_line(error)}): write it with numpy.save") from error


def _natural(path: Path) -> list[tuple[int, str]]:
    """Return a sorting key that compares digits as numbers: 2.png comes before 12.png."""
    parts = re.split(r"(\d+)", path.name)
    return [(int(part), "") if part.isdecimal() else (-1, part) for part in parts]


def _line(error: BaseException) -> str:
    return " ".join(str(error).split()) or type(error).__name__
