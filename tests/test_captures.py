# SPDX-License-Identifier: Apache-2.0
"""Captures of the reference and of the zero offset in a pipeline."""

import warnings
from typing import Any

import numpy as np
import pytest

import tactile_depth as td


def drifted(picture: np.ndarray, seed: int) -> Any:
    """Return the picture under lights that differ by up to 10 % across the gel, with noise."""
    rng = np.random.default_rng(seed)
    y, x = np.mgrid[-1:1:240j, -1:1:320j]
    light = 1 + 0.05 * np.stack([x, y, x * y], axis=-1)
    return np.clip(np.rint(picture * light + rng.normal(size=picture.shape)), 0, 255).astype(np.uint8)


@pytest.mark.parametrize("arithmetic", ["chip", "float"])
def test_captures_take_drift_away(ball: Any, arithmetic: Any) -> None:
    pipeline = td.Pipeline(ball.sensor, ball.reference, arithmetic=arithmetic)
    fresh = pipeline(ball.image).height_mm
    untouched = np.stack([drifted(ball.reference, seed) for seed in range(4)])
    press = drifted(ball.image, 9)
    assert np.abs(pipeline(untouched[0]).depth_mm).max() > 0.1
    pipeline.capture_reference(untouched)
    pipeline.capture_zero(untouched)
    assert np.abs(pipeline(untouched[0]).depth_mm).max() < 0.01
    assert np.abs(pipeline(press).height_mm - fresh).max() < 0.02 * fresh.max()


def test_a_zero_offset_with_a_contact_is_warned_of(ball: Any) -> None:
    pipeline = td.Pipeline(ball.sensor, ball.reference)
    with pytest.warns(td.InputWarning, match="from the reference, as if something touched the gel: capture the zero"):
        pipeline.capture_zero(ball.image)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", td.InputWarning)
        touched = pipeline(ball.image)
    assert "capture the zero offset with the gel untouched" in touched.warnings[0]
    assert touched.height_error is None
    pipeline.capture_zero(ball.reference)
    assert pipeline(ball.image).warnings == ()


def test_a_capture_takes_a_power_of_two_of_pictures(small: Any, ball: Any) -> None:
    three = np.stack([ball.reference] * 3)
    for capture in (small.capture_reference, small.capture_zero):
        with pytest.raises(td.InputError, match="3 pictures: the hardware averages 1, 2, 4,"):
            capture(three)


def test_a_stream_belongs_to_its_pipeline(small: Any, ball: Any) -> None:
    for other in (small.copy(), td.Pipeline(ball.sensor, ball.reference, grid=(24, 32))):
        with pytest.raises(td.InputError, match=r"stream is of another pipeline: call new_stream\(\)"):
            small(ball.image, other.new_stream())
    small(ball.image, small.new_stream())


def test_a_capture_that_the_pipeline_has_not_is_refused(ball: Any) -> None:
    as_sent = td.Pipeline(td.load("synthetic"), grid=(16, 16), zero_offset=False)
    no_contact = np.full((16, 16, 3), 128, np.uint8)
    with pytest.raises(td.InputError, match="takes colours as sent"):
        as_sent.capture_reference(no_contact)
    with pytest.raises(td.InputError, match="has no zero offset"):
        as_sent.capture_zero(no_contact)
