# SPDX-License-Identifier: Apache-2.0
"""A picture of a ball that is pressed into the gel, and the circle of its contact."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np

from tactile_depth.base.by_value import ByValue
from tactile_depth.base.errors import Argument, InputError, is_number
from tactile_depth.pictures.pictures import array_of, is_array

LARGEST_NUMBER = 1e6  # millimetres or pixels


class Circle(NamedTuple):
    """Edge of a contact in camera pixels, x along the columns, y down the rows."""

    x: float
    y: float
    radius: float


@dataclass(frozen=True, eq=False)
class BallPress(ByValue):
    """Picture of a ball that is pressed into the gel.

    Attributes
    ----------
    image : uint8 array (rows, columns, 3), RGB, or the path of a picture
        A PIL image is kept as an array.
    diameter_mm : float
        Diameter of the ball.
    circle : (x, y, radius) in pixels of the picture, optional
        Edge of the contact, x along the columns, y down the rows. None: the picture is searched for it.
    name : str
        Name in tables and messages; by default the path, or the number of the press.
    ball_radius_px : float, optional
        Radius of the ball in pixels of the picture, from which the pixel pitch follows.

    Raises
    ------
    InputError
        A number is not accepted.
    """

    image: np.ndarray | str | Path
    diameter_mm: float
    circle: tuple[float, float, float] | None = None
    name: str = ""
    ball_radius_px: float | None = None

    def __repr__(self) -> str:
        image = str(self.image)
        if isinstance(self.image, np.ndarray):
            image = f"{self.image.dtype} {self.image.shape}"
        named = f", name={self.name!r}" if self.name else ""
        return f"BallPress({image}, {self.diameter_mm:g} mm, circle={self.circle}{named})"

    def __post_init__(self) -> None:
        if is_array(self.image):
            object.__setattr__(self, "image", array_of(self.image, "image"))
        for length in (Argument("diameter_mm", self.diameter_mm), Argument("ball_radius_px", self.ball_radius_px)):
            if length.value is not None and not (is_number(length.value) and 0 < length.value < LARGEST_NUMBER):
                raise InputError(Argument(length.name), f" is {length.value}", accepted="a number above 0")
        if self.circle is None:
            return
        try:
            x, y, radius = (float(value) for value in self.circle)
        except (TypeError, ValueError) as error:
            raise InputError(Argument("circle", self.circle), accepted=("x", "y and radius in pixels")) from error
        if not (abs(x) < LARGEST_NUMBER and abs(y) < LARGEST_NUMBER and 0 < radius < LARGEST_NUMBER):
            raise InputError(f"the circle has x={x:g}, y={y:g}, radius={radius:g}: accepted are pixels, radius above 0")
        if self.ball_radius_px is not None and radius >= self.ball_radius_px:
            raise InputError(f"a contact of {radius:g} pixels does not lie on a ball of {self.ball_radius_px:g}")
