# SPDX-License-Identifier: Apache-2.0
"""Objects of the package that hold arrays: equality, hash, representation, arrays that cannot be written."""

import copy
import pickle
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import tactile_depth as td
from tactile_depth.base.by_value import ByValue
from tactile_depth.pictures.frames import Frames


def press() -> td.BallPress:
    return td.BallPress(np.zeros((24, 32, 3), np.uint8), 4, name="one")


def result() -> td.Result:
    drawn = td.sample("ball")
    return td.Pipeline(drawn.sensor, drawn.reference, grid=(24, 32))(drawn.image)


MAKERS: dict[str, Callable[[], Any]] = {
    "Sensor('gelsight-mini', 320x240, cubic)": lambda: td.load("gelsight-mini"),
    "Sensor('synthetic', lut)": lambda: td.load("synthetic"),
    "Sample(320x240, height up to 1.37 mm)": lambda: td.sample("ball"),
    "Result(32x24, depth up to 1.28 mm)": result,
    "Contact(peak 1.28 mm at (11, 17), area 20.9 mm^2)": lambda: result().contact,
    "BallPress(uint8 (24, 32, 3), 4 mm, circle=None, name='one')": press,
    "BallPress(a.png, 4 mm, circle=(1, 2, 3))": lambda: td.BallPress("a.png", 4, (1, 2, 3)),
    "Evaluation(2 presses, 1 left out: lut)": lambda: td.Evaluation(
        ("a", "b"), (4.0, 4.0), (True, True), {"lut": ()}, ("c: cut",)
    ),
    "Frames('scene', 2 x 32x24)": lambda: Frames(np.zeros((2, 24, 32, 3), np.uint8), 1.0, "scene", ("1", "2")),
}


@pytest.mark.parametrize("shown", MAKERS)
def test_an_object_equals_another_of_the_same_values(shown: str) -> None:
    one, other = MAKERS[shown](), MAKERS[shown]()
    assert one is not other
    assert one == other == copy.deepcopy(one) == pickle.loads(pickle.dumps(one))
    assert len({one, other}) == 1
    assert one != shown
    assert repr(one) == shown


def test_other_values_are_not_equal() -> None:
    sensor = td.load("gelsight-mini")
    assert sensor.coefficients is not None
    changes: tuple[dict[str, Any], ...] = (
        {"name": "other"},
        {"pixel_pitch_mm": 0.1},
        {"coefficients": sensor.coefficients * 1.001},
        {"coefficients": None},
        {"fitted_slope": {}},
    )
    assert [change for change in changes if replace(sensor, **change) == sensor] == []


def test_nan_equals_nan_and_shapes_count() -> None:
    contact = replace(result().contact, untouched_mm=float("nan"))
    assert contact == replace(contact, untouched_mm=np.nan)
    assert contact != replace(contact, mask=contact.mask[:1])


def test_every_public_class_with_arrays_is_compared_by_value() -> None:
    kinds = [getattr(td, name) for name in td.__all__ if isinstance(getattr(td, name), type)]
    with_arrays = {kind for kind in kinds if "ndarray" in str(getattr(kind, "__annotations__", {})).lower()}
    assert with_arrays
    assert [kind for kind in with_arrays if not issubclass(kind, ByValue)] == []


def test_the_arrays_of_a_copied_sensor_cannot_be_written() -> None:
    for copied in (pickle.loads(pickle.dumps(td.load("gelsight-mini"))), copy.deepcopy(td.load("gelsight-mini"))):
        assert copied.cubic is not None
        assert not copied.cubic.flags.writeable


def test_the_arrays_of_a_sensor_cannot_be_written() -> None:
    mine = np.zeros((2, 3, 6))
    sensor = replace(td.load("gelsight-mini"), coefficients=mine, reference=np.zeros((24, 32, 3), np.uint8))
    for name in ("gradient", "coefficients", "cubic", "corrections", "reference", "lighting", "untouched"):
        with pytest.raises(ValueError, match="read-only"):
            getattr(sensor, name)[0] = 1
    mine[:] = 1  # the array of the caller stays as it was
