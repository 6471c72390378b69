# SPDX-License-Identifier: Apache-2.0
"""block_weights: RTL against the model, the model against fractions."""

from fractions import Fraction
from math import ceil

from hypothesis import given
from hypothesis import strategies as st

from formal.entries import Proof
from tactile_depth.chip.camera.block_weights import block_weights, pixels_of
from tb.structures import ICARUS, VERILATOR, of_parameters
from tests.rtl import test_rtl as test_rtl

built = of_parameters("Numerator Denominator")
STRUCTURES = (
    built(15, 4, on=VERILATOR),
    built(1, 1, on=ICARUS, late=VERILATOR),
    built(7, 5, on=ICARUS, mutants=True),
    built(8, 1, on=ICARUS, mutants=True),
    built(2, 1),
    built(3, 2),
    built(127, 16),
    built(4, 3),
)
REFUSED = {
    "Denominator=0": "Numerator_must_be_at_least_Denominator_and_Denominator_at_least_1",
    "Numerator=3": "Numerator_must_be_at_least_Denominator_and_Denominator_at_least_1",
}
PROOFS = tuple(
    Proof(
        "the weight of a pixel is its overlap with the block it is in or begins in; the block's last pixel",
        "one counter; ratios of 1, of an integer, below and above 2",
        {"Numerator": numerator, "Denominator": denominator},
    )
    for numerator, denominator in ((1, 1), (3, 1), (4, 3), (15, 4))
)


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
