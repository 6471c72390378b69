# SPDX-License-Identifier: Apache-2.0
"""wide_dst_inverse: RTL against the model, the model against dst_inverse."""

from typing import Any

import numpy as np
import pytest

from formal.entries import Proof
from formal.tables import wide_roms
from tactile_depth.chip.poisson.transform.dst_inverse import dst_inverse
from tactile_depth.chip.poisson.transform.transform import Transform
from tactile_depth.chip.poisson.transform.wide_dst_inverse import latency as wide_dst_inverse_latency
from tactile_depth.chip.poisson.transform.wide_dst_inverse import wide_dst_inverse
from tactile_depth.chip.rom_files import write_direction
from tb.structures import ICARUS, VERILATOR, Mutants, Structure
from tests.rtl import test_rtl as test_rtl

PARAMETERS = ("Size", "Words", "InWidth", "InputDrop", "Width", "CoeffWidth", "OutputDrop", "OutWidth", "Sine")


def built(*values: int, **runs: Any) -> Structure:
    parameters = dict(zip(PARAMETERS, values, strict=True))
    size, words, coeff = (parameters[name] for name in ("Size", "Words", "CoeffWidth"))
    return Structure(parameters, roms=lambda folder: write_direction(folder, size, words // 2, True, coeff), **runs)


STRUCTURES = (
    built(16, 4, 27, 0, 27, 18, 3, 24, 1, on=VERILATOR),
    built(16, 8, 27, 0, 27, 18, 3, 24, 1, on=ICARUS),
    built(16, 2, 15, 0, 15, 10, 3, 12, 1, on=ICARUS),
    built(32, 8, 9, 1, 9, 7, 1, 6, 0, on=ICARUS),
    built(8, 4, 9, -1, 9, 7, 3, 5, 1, on=ICARUS),
    built(32, 4, 9, -1, 9, 7, 2, 5, 1, mutants=True),  # of fewer points none clips beside a row alone
    built(64, 32, 27, 0, 27, 18, 3, 24, 1),
    built(128, 8, 27, 0, 27, 18, 3, 24, 1),
)
MUTANTS = Mutants(flat=False)
REFUSED = {
    "Words=3": "Words_must_be_a_power_of_two_2_to_Size_2",
    "Words=128": "Words_must_be_a_power_of_two_2_to_Size_2",
}
PROOFS = (
    Proof(
        "rows leave behind their burst, at the latency of its model; frame_start with the first; a row alone",
        "the smallest transform, every core of a longer one is in it",
        {"Size": 8, "Words": 4, "Latency": wide_dst_inverse_latency(8, 4)},
        depth=80,
        roms=wide_roms(2, 4),
    ),
)


# In steps of a word, coefficients being all but exact. Measured on 100 pairs of rows: 3, 4, 5.
@pytest.mark.parametrize(("size", "largest"), [(16, 4), (64, 5), (128, 6)])
def test_rows_of_a_pair_are_those_alone_within_steps(size: int, largest: int) -> None:
    modes = np.random.default_rng(size).integers(-(2**12), 2**12, (100, 2, size))
    pairs = wide_dst_inverse(modes, Transform(0, 30, 30, 0, 30))
    assert np.abs(pairs - dst_inverse(modes, Transform(0, 30, 30, 0, 30))).max() <= largest


def test_an_odd_row_is_one_beside_zeros() -> None:
    modes = np.random.default_rng(1).integers(-1000, 1000, (3, 16))
    rows = wide_dst_inverse(modes, Transform(0, 27, 18, 0, 27))
    beside = np.stack((modes[2], np.zeros(16, np.int64)))
    np.testing.assert_array_equal(rows[2], wide_dst_inverse(beside, Transform(0, 27, 18, 0, 27))[0])
