# SPDX-License-Identifier: Apache-2.0
"""reference_capture: RTL against the model; the largest number of frames."""

from typing import Any

import numpy as np
import pytest

from formal.entries import Proof
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.gradient.reference_capture import (
    largest_log2_frames,
    reference_capture,
    reference_capture_parameters,
)
from tb.structures import BOTH, ICARUS, VERILATOR, Structure
from tests.rtl import test_rtl as test_rtl


def built(columns: int, rows: int, largest: int, gain_width: int, **runs: Any) -> Structure:
    """Return a structure; `largest` is the binary logarithm of the largest number of frames."""
    choices: dict[str, Any] = {"columns": columns, "rows": rows, "solver": "tridiagonal", "gain_width": gain_width}
    return Structure(
        reference_capture_parameters(Configuration(**choices)) | {"MaxLog2": largest},
        device={"configuration": choices},
        **runs,
    )


STRUCTURES = (
    built(16, 8, 5, 24, on=VERILATOR),
    built(16, 8, 2, 17, on=ICARUS, mutants=True),
    built(16, 16, 3, 24),
    built(32, 21, 3, 24),
    built(128, 8, 4, 24),
    built(128, 8, 3, 17),
    built(16, 8, 8, 24, late=BOTH),
)
REFUSED = {
    "BlockLog2=0": "BlockLog2_must_be_at_least_1",
    "Columns=96": "Columns_must_be_a_power_of_two",
    "Columns=8": "two_blocks_a_row_and_one_a_column_are_needed",
    "Rows=7": "two_blocks_a_row_and_one_a_column_are_needed",
    "MaxLog2=11": "a_sum_over_2_to_the_MaxLog2_frames_must_fit_Width_bits",
    "GainFraction=10": "GainFraction_plus_2_BlockLog2_must_be_at_least_Width",
}
PROOFS = tuple(
    Proof(
        claim,
        "a cut row of blocks; rows, columns and frames are only counted; sums are exact at any width"
        + (", whatever the divider writes behind them" if sums else ""),
        {"Sums": sums},
        depth=60,
        free=("word",) if sums else (),
    )
    for sums, claim in (
        (
            0,
            "2^k good frames in a row behind a request, done a fixed number of clocks later; memory as td_ram asks",
        ),
        (1, "an arbitrary pixel is added once to its node, and to no other"),
    )
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
