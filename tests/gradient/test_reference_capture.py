# SPDX-License-Identifier: Apache-2.0
"""reference_capture: the largest number of frames."""

import pytest

from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.gradient.reference_capture import largest_log2_frames


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
