# SPDX-License-Identifier: Apache-2.0
"""Pictures of ball presses, from a folder or from memory, and the picture without contact."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from tactile_depth.base.errors import Argument, InputError, Part
from tactile_depth.calibrate.ball_press import BallPress
from tactile_depth.calibrate.press_folder import background_path, read_presses
from tactile_depth.pictures.frames import read_picture
from tactile_depth.pictures.picture_check import require_all_colours
from tactile_depth.pictures.pictures import ROTATIONS, Picture, array_of, rotated
from tactile_depth.sensor.view import require_field

BACKGROUND = Argument("background")
PITCHES_AGREE = 0.02  # largest relative difference between the given pitch and the pitch from the balls' radii


@dataclass(frozen=True)
class PressPictures:
    """Presses before resampling, and the picture without contact.

    Attributes
    ----------
    name : str
    presses : tuple of BallPress
        Presses with distinct names.
    background : uint8 array (rows, columns, 3)
    notes : tuple of str
        One line for each column or line of presses.csv that was left out.
    rotate : int
        Degrees, counter-clockwise, by which pictures of presses are rotated; the background is rotated already.
    """

    name: str
    presses: tuple[BallPress, ...]
    background: np.ndarray
    notes: tuple[str, ...] = ()
    rotate: int = 0

    def image(self, press: BallPress) -> np.ndarray:
        """Return the picture of a press, rotated; raise InputError if it is none like the background."""
        image = _picture(press.image, press.name, self.rotate)
        if image.shape != self.background.shape:
            raise InputError(
                f"{press.name}: {image.shape[0]} x {image.shape[1]} pixels, but the background has "
                f"{self.background.shape[0]} x {self.background.shape[1]}"
            )
        require_all_colours(image, self.background, press.name)
        return image

    @property
    def pitches(self) -> list[float]:
        """Millimetres per pixel, from each ball whose radius in pixels is known."""
        return [press.diameter_mm / 2 / press.ball_radius_px for press in self.presses if press.ball_radius_px]

    @property
    def ball_pitches(self) -> dict[float, float]:
        """Median of the pitches by the diameter of the ball."""
        given = [press for press in self.presses if press.ball_radius_px]
        balls = {press.diameter_mm for press in given}
        return {
            ball: ball / 2 / float(np.median([press.ball_radius_px for press in given if press.diameter_mm == ball]))
            for ball in sorted(balls)
        }


def gather(
    presses: str | Path | Sequence[BallPress],
    background: Picture | None = None,
    rotate: int = 0,
    table: Path | None = None,
) -> PressPictures:
    """Return presses from a folder or from memory.

    Parameters
    ----------
    presses : path of a folder, or sequence of BallPress
        A folder holds pictures, presses.csv (press_folder.py) and background.png or .jpg.
    background : uint8 array (rows, columns, 3), PIL image or path, optional
        Picture without contact; by default that of the folder.
    rotate : int
        Degrees, counter-clockwise, by which the pictures are rotated: one of `ROTATIONS`. Circles count after that.
    table : path, optional
        Of the presses in the folder; by default its presses.csv.
    """
    if rotate not in ROTATIONS:
        raise InputError(Argument("rotate", rotate), accepted=map(str, ROTATIONS))
    notes: list[str] = []
    if isinstance(presses, (str, Path)):
        folder = Path(presses)
        if background is None:
            background = background_path(folder)
        listed, notes = read_presses(folder, table)
        name = folder.resolve().name
    else:
        is_sequence: bool = isinstance(presses, Sequence)
        if not is_sequence or not all(isinstance(press, BallPress) for press in presses):
            raise InputError(Argument("presses"), accepted=("the path of a folder", "or a sequence of BallPress"))
        if background is None:
            raise InputError(BACKGROUND, " is missing", remedy="give a picture of the sensor without contact")
        name = "fitted"
        numbered = [f"press {n}" if isinstance(p.image, np.ndarray) else str(p.image) for n, p in enumerate(presses, 1)]
        listed = [replace(press, name=press.name or other) for press, other in zip(presses, numbered, strict=True)]
    if not listed:
        raise InputError(
            f"{name}: no presses{''.join(f': {note}' for note in notes[:1])}: give pictures of ball presses"
        )
    names = [press.name for press in listed]
    if repeated := next((one for one in names if names.count(one) > 1), None):
        problem = f": the name {repeated} stands twice"
        raise InputError(Argument("presses"), problem, remedy="give each press a name of its own")
    untouched = _picture(background, BACKGROUND, rotate)
    require_all_colours(untouched, untouched, BACKGROUND)
    return PressPictures(name, tuple(listed), untouched, tuple(notes), rotate)


def camera_pitch_mm(pictures: PressPictures, pitch_mm: float | None) -> float:
    """Return millimetres per camera pixel: `pitch_mm`, or the pitch from the balls' radii in pixels."""
    pitch = _camera_pitch_mm(pictures, pitch_mm)
    rows, columns = pictures.background.shape[:2]
    remedy = ("correct ", Argument("pitch_mm"), ", in mm per camera pixel, or diameter_mm and ball_radius_px")
    require_field((rows, columns), pitch, Argument("pitch_mm", pitch), remedy=remedy)
    return pitch


def _camera_pitch_mm(pictures: PressPictures, pitch_mm: float | None) -> float:
    if not pictures.pitches:
        if pitch_mm is None:
            raise InputError(
                Argument("pitch_mm"),
                " is needed: mm per camera pixel, which presses without ball_radius_px do not give",
            )
        return pitch_mm
    by_balls = float(np.median(pictures.pitches))
    if pitch_mm is None:
        return float(f"{by_balls:.3g}")  # diameters and radii have no more digits
    if abs(by_balls / pitch_mm - 1) > PITCHES_AGREE:
        raise InputError(
            *(Argument("pitch_mm", pitch_mm), f" contradicts {pictures.name}, whose ball radii give {by_balls:.4g} "),
            *("mm/pixel. Omit ", Argument("pitch_mm"), " or correct ball_radius_px."),
        )
    return pitch_mm


def _picture(image: Picture, name: Part, rotate: int) -> np.ndarray:
    """Return the pixels of a picture, from an array, a PIL image or a path, rotated by so many degrees."""
    image = read_picture(Path(image)) if isinstance(image, str | Path) else array_of(image, name)
    if image.dtype != np.uint8 or image.ndim != 3 or image.shape[-1] != 3 or not image.size:
        raise InputError(name, f": {image.dtype} {image.shape}", accepted="uint8 (rows, columns, 3), RGB")
    return rotated(image, rotate)
