# SPDX-License-Identifier: Apache-2.0
"""zero_capture: RTL against the model, and the model against exact fractions."""

from fractions import Fraction
from typing import Any

import numpy as np
import pytest

from formal.entries import ROUNDING, Proof
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.depth.zero_capture import LARGEST_LOG2, captured_zero
from tb.structures import BOTH, ICARUS, VERILATOR, Structure
from tests.rtl import test_rtl as test_rtl


def built(*case: int, **runs: Any) -> Structure:
    names = ("Columns", "Rows", "BlockLog2", "Width", "MaxLog2", "Lanes")
    return Structure(dict(zip(names, case, strict=True)), **runs)


STRUCTURES = (
    built(16, 8, 1, 24, 5, 1, on=VERILATOR, late=()),
    built(32, 13, 2, 20, 3, 4, on=VERILATOR),
    built(4, 5, 1, 4, 2, 1, on=ICARUS, mutants=True),
    built(4, 2, 1, 6, 1, 1, on=ICARUS),
    built(16, 11, 2, 5, 2, 2, on=ICARUS),
    built(16, 5, 1, 4, 1, 4, on=ICARUS, mutants=True),
    built(32, 21, 1, 12, 1, 1),
    built(16, 16, 2, 24, 3, 1),
    built(128, 20, 3, 16, 1, 1),
    built(16, 9, 1, 32, 0, 1),
    built(16, 8, 1, 24, LARGEST_LOG2, 1, late=BOTH),
    built(128, 20, 3, 24, 2, 8),
    built(256, 9, 3, 24, 1, 32),
    built(128, 17, 3, 24, 1, 32),
    built(256, 9, 3, 24, 1, 64),
)
REFUSED = {
    "BlockLog2=0": "BlockLog2_must_be_at_least_1",
    "Columns=96": "Columns_must_be_a_power_of_two",
    "Columns=8": "two_blocks_a_row_and_one_a_column_are_needed",
    "Rows=7": "two_blocks_a_row_and_one_a_column_are_needed",
    "MaxLog2=9": "MaxLog2_must_be_at_most_8",
}
PROOFS = (
    *(
        Proof(
            "2^k frames behind a request, each node written once, 6 clocks behind its block, done after 7; memory as "
            "td_ram.sv asks; of several lanes all a clock later, depths of a block in a beat added up",
            "two rows of blocks and a cut one, and a single whole one; rows, columns and frames are only counted; a "
            "beat of a block, and of two",
            {"Sums": 0, "Rows": rows, "Columns": 4 * lanes, "Lanes": lanes},
            depth=60,
        )
        for rows, lanes in ((5, 1), (2, 1), (3, 2), (3, 4))
    ),
    Proof(
        "an arbitrary depth is added once to its node, and to no other; a zero offset is the mean, ties to even",
        f"a cut row of blocks; sums are exact at any width; {ROUNDING}",
        {"Sums": 1, "Rows": 3},
        depth=60,
    ),
)


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
