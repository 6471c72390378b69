# SPDX-License-Identifier: Apache-2.0
"""block_weights: RTL against the model, the model against fractions."""

from fractions import Fraction
from math import ceil

from hypothesis import given
from hypothesis import strategies as st

from tactile_depth.chip.camera.block_weights import block_weights, pixels_of


@given(st.integers(1, 60), st.integers(1, 30), st.integers(1, 40))
def test_weights_are_overlaps_of_pixel_and_block(extra: int, denominator: int, pixels: int) -> None:
    numerator = denominator + extra - 1
    block = Fraction(numerator, denominator)
    weights, ends = block_weights(pixels, numerator, denominator)
    for pixel in range(pixels):
        boundary = (pixel // block + 1) * block
        assert Fraction(int(weights[pixel]), denominator) == min(boundary, Fraction(pixel + 1)) - pixel
        assert ends[pixel] == (boundary <= pixel + 1)


@given(st.integers(1, 40), st.integers(1, 12), st.integers(1, 12))
def test_the_last_pixel_ends_the_last_block(blocks: int, denominator: int, extra: int) -> None:
    numerator = denominator + extra - 1
    pixels = pixels_of(blocks, numerator, denominator)
    assert pixels == ceil(Fraction(numerator, denominator) * blocks)
    ends = block_weights(pixels, numerator, denominator)[1]
    assert ends[-1]
    assert ends.sum() == blocks
