# SPDX-License-Identifier: Apache-2.0
"""reference_capture: RTL against the model; the largest number of frames."""

import numpy as np
import pytest

from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.gradient.reference_capture import (
    largest_log2_frames,
    reference_capture,
)


@pytest.mark.parametrize(
    ("columns", "gain_width", "largest"),
    [(16, 24, 8), (128, 24, 8), (256, 24, 8), (512, 24, 6), (1024, 24, 4), (128, 17, 3), (256, 17, 1), (256, 16, 0)],
)
def test_the_largest_sum_fits_its_word(columns: int, gain_width: int, largest: int) -> None:
    config = Configuration(columns=columns, solver="tridiagonal", flat_field=True, gain_width=gain_width)
    assert largest_log2_frames(config) == largest
    pixels = 1 << 2 * config.reference_block_log2 + largest
    assert 255 * pixels < 1 << gain_width
    assert largest == 8 or 2 * 255 * pixels >= 1 << gain_width


def test_a_broken_frame_starts_afresh() -> None:
    config = Configuration(columns=16, rows=8, solver="tridiagonal")
    frames = [np.full((8, 16, 3), level, np.uint8) for level in (50, 60, 100, 102, 30)]
    captured = reference_capture(frames, [False, True, False, False, False], [1, 1, 1, 2, 2], 8, config)
    assert captured is not None
    index, gains = captured
    assert index == 3
    assert np.all(gains == round(2**27 / 101))
    assert reference_capture(frames[:3], [False, True, False], [1, 1, 1], 8, config) is None
