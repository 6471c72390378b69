# SPDX-License-Identifier: Apache-2.0
"""Views: the share of a sensor's full picture that pictures show."""

from __future__ import annotations

from typing import Any

from tactile_depth.base.errors import Argument, InputError, is_number

# What software for a GelSight Mini cuts off before anything else: gs_sdk's `resize_crop` 1/7 at each border, gsrobotics
# 0.15. A plain camera cuts nothing.
CONVENTIONS = {"none": 1.0, "gs_sdk": 5 / 7, "gsrobotics": 0.70}
SMALLEST_VIEW = 0.05
ACCEPTED = (
    f"{', '.join(CONVENTIONS)}, or the share of the full picture's width and height that pictures show, "
    f"{SMALLEST_VIEW:g} to 1"
)

Crop = str | float | tuple[float, float]


def view_of(crop: Crop, name: str = "crop") -> tuple[float, float]:
    """Return the shares of width and height that `crop` names: a convention, a share, or a share of each.

    Raises
    ------
    InputError
    """
    shares: Any = CONVENTIONS.get(crop, crop) if isinstance(crop, str) else crop
    if isinstance(shares, str):
        shares = tuple(map(_number, shares.split(",")))
    pair = tuple(shares) if isinstance(shares, tuple | list) else (shares,)
    pair = pair * 2 if len(pair) == 1 else pair
    if len(pair) != 2 or not all(map(is_share, pair)):
        raise InputError(Argument(name, crop), accepted=ACCEPTED)
    return float(pair[0]), float(pair[1])


def _number(text: str) -> float | None:
    try:
        return float(text)
    except ValueError:
        return None


def is_share(share: object) -> bool:
    """Return True for a share of a picture's width or height that a view can have."""
    return is_number(share) and SMALLEST_VIEW <= float(share) <= 1  # type: ignore[arg-type]
