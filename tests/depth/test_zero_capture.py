# SPDX-License-Identifier: Apache-2.0
"""zero_capture: RTL against the model, and the model against exact fractions."""

from collections.abc import Callable
from fractions import Fraction

import numpy as np
import pytest

from tactile_depth.configuration import Configuration
from tactile_depth.depth.zero_capture import LARGEST_LOG2, captured_zero
from tb.stream import REGRESS


@pytest.mark.structures(
    "case",  # columns, rows, block_log2, width, largest, lanes
    verilator=[((16, 8, 1, 24, LARGEST_LOG2 if REGRESS else 5, 1),), ((32, 13, 2, 20, 3, 4),)],
    icarus=[((4, 5, 1, 4, 2, 1),), ((4, 2, 1, 6, 1, 1),), ((16, 11, 2, 5, 2, 2),), ((16, 5, 1, 4, 1, 4),)],
    regress=[
        ((32, 21, 1, 12, 1, 1),),
        ((16, 16, 2, 24, 3, 1),),
        ((128, 20, 3, 16, 1, 1),),
        ((16, 9, 1, 32, 0, 1),),
        ((16, 8, 1, 24, LARGEST_LOG2, 1),),
        ((128, 20, 3, 24, 2, 8),),
        ((256, 9, 3, 24, 1, 32),),
        ((128, 17, 3, 24, 1, 32),),
    ],
)
def test_rtl(run_tb: Callable[..., None], case: tuple[int, ...]) -> None:
    names = ("Columns", "Rows", "BlockLog2", "Width", "MaxLog2", "Lanes")
    run_tb("zero_capture", dict(zip(names, case, strict=True)))


@pytest.mark.parametrize("count", [1, 2, 8])
@pytest.mark.parametrize("limit", [2, 1 << 23])
def test_a_zero_is_the_mean_to_the_nearest_with_ties_to_even(count: int, limit: int) -> None:
    config = Configuration(columns=32, rows=21, solver="tridiagonal")
    frames = np.random.default_rng(count).integers(-limit, limit, (count, 21, 32))
    zero = captured_zero(frames, config)
    block = 1 << config.reference_block_log2
    for row, column in np.ndindex(*config.reference_nodes):
        words = frames[:, row * block : (row + 1) * block, column * block : (column + 1) * block]
        assert zero[row, column] == round(Fraction(int(words.sum()), words.size))
