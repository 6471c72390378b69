# SPDX-License-Identifier: Apache-2.0
"""area_average: RTL against the model, the model against the average of the Python package and against fractions."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tactile_depth.chip.camera.area_average import area_average
from tactile_depth.chip.resampling import resampling
from tb.camera.tb_area_average import PATTERN_RATIOS


@given(st.integers(1, 24), st.integers(1, 24), st.integers(0, 40), st.integers(0, 40), st.integers(0, 2**32 - 1))
def test_rgb_is_the_average_of_the_package(rows: int, columns: int, below: int, beside: int, seed: int) -> None:
    camera = (rows + below, columns + beside)
    picture = np.random.default_rng(seed).integers(0, 256, (*camera, 3))
    plan = resampling(camera, (rows, columns))
    top, left = plan.origin
    means = area_average(picture[top:, left:], 8, plan.numerator, plan.denominator)[:rows, :columns]
    np.testing.assert_array_equal(means, np.rint(plan.average(picture)))


def overlap(pixel: int, block: int, numerator: int, denominator: int) -> int:
    ends = min((pixel + 1) * denominator, (block + 1) * numerator)
    return max(0, ends - max(pixel * denominator, block * numerator))


@pytest.mark.parametrize("colour", [(0, 0), (0, 1), (1, 0), (1, 1)])
@pytest.mark.parametrize(("numerator", "denominator"), PATTERN_RATIOS)
def test_a_pattern_is_averaged_colour_by_colour(numerator: int, denominator: int, colour: tuple[int, int]) -> None:
    """Compare with the mean of each colour over its pixels, by their area in the block and rounded as in Python."""
    length = -(-2 * numerator // denominator)
    samples = np.random.default_rng(numerator).integers(0, 1024, (length, length))
    means = area_average(samples, 10, numerator, denominator, colour)
    for i, j, of in np.ndindex(2, 2, 3):
        total = area = 0
        for row, column in np.ndindex(samples.shape):
            site = (row + colour[0]) % 2 + (column + colour[1]) % 2
            height, width = (overlap(*pair, numerator, denominator) for pair in ((row, i), (column, j)))
            if site == of:
                total += height * width * int(samples[row, column])
                area += height * width
        assert means[i, j, of] == min(round(Fraction(total, 4 * area)), 255)


@given(st.integers(8, 12), st.integers(0, 2**16 - 1), st.integers(0, 2**32 - 1))
def test_a_gain_is_that_of_fractions_rounded_once(bits: int, gain: int, seed: int) -> None:
    samples = np.random.default_rng(seed).integers(-(1 << bits), 1 << bits, (2, 2, 3))
    mean = area_average(samples, bits, 2, 1, gains=(gain,) * 3)[0, 0]
    for of in range(3):
        colour = round(Fraction(int(samples[..., of].sum()) * gain, 4 << bits - 8 + 12))
        assert mean[of] == np.clip(colour, 0, 255)
