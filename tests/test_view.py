# SPDX-License-Identifier: Apache-2.0
"""Tests of the view: the share of the sensor's full picture that pictures show."""

from typing import Any

import pytest

from tactile_depth.base.errors import InputError
from tactile_depth.sensor.view import view_of


@pytest.mark.parametrize(
    ("crop", "shares"),
    [
        ("none", (1, 1)),
        ("gs_sdk", (5 / 7, 5 / 7)),
        ("gsrobotics", (0.7, 0.7)),
        (1, (1, 1)),
        (0.8, (0.8, 0.8)),
        ("0.8", (0.8, 0.8)),
        ("0.8,0.75", (0.8, 0.75)),
        ((0.8, 0.75), (0.8, 0.75)),
    ],
)
def test_a_crop_is_a_convention_or_a_share(crop: Any, shares: tuple[float, float]) -> None:
    assert view_of(crop) == shares


@pytest.mark.parametrize("crop", [0, 1.01, "some", "0.8,", "nan", True, (0.8, 0.8, 0.8), (), None, "0.8,True"])
def test_another_crop_is_refused(crop: Any) -> None:
    with pytest.raises(InputError, match="none, gs_sdk, gsrobotics, or the share of the full picture"):
        view_of(crop)
