# SPDX-License-Identifier: Apache-2.0
"""mode_pairs: RTL against the model, the model against the definition."""

import numpy as np
import pytest

from formal.entries import ONE_ORDER, WORD_FREE, Proof
from tactile_depth.chip.poisson.transform.mode_pairs import mode_pairs
from tactile_depth.chip.poisson.transform.orders import bit_reversed, mirror
from tb.structures import ICARUS, VERILATOR, Mutants, of_parameters
from tests.rtl import test_rtl as test_rtl

built = of_parameters("Size Width")
STRUCTURES = (
    built(32, 24, on=VERILATOR),
    built(8, 27, on=ICARUS),
    built(16, 12),
    built(64, 24),
    built(8, 4, mutants=True),
)
MUTANTS = Mutants("bursts", columns_are="Size")
REFUSED = {
    "Size=12": "Size_must_be_a_power_of_two_at_least_4",
    "Size=2": "Size_must_be_a_power_of_two_at_least_4",
}
PROOFS = tuple(
    Proof(
        "an arbitrary mode, and beside it mode N - k; latency N / 2 + 2",
        f"{ONE_ORDER}; at 8 the delay line is in memory; {WORD_FREE}",
        {"Size": size},
        depth=45,
    )
    for size in (4, 8)
)


@pytest.mark.parametrize("size", [8, 16, 128, 512])
def test_mode_k_meets_mode_n_minus_k_and_mode_n_is_zero(size: int) -> None:
    by_mode = np.append(np.arange(1, size + 1), 0)  # mode k holds k + 1, and mode N nothing
    k = bit_reversed(size)
    mode, mirrored = mode_pairs(by_mode[k])
    np.testing.assert_array_equal(mode, by_mode[k])
    np.testing.assert_array_equal(mirrored, by_mode[size - k])


@pytest.mark.parametrize("size", [8, 64, 512])
def test_orders_are_their_own_inverses(size: int) -> None:
    for order in (bit_reversed(size), mirror(size)):
        np.testing.assert_array_equal(order[order], np.arange(size))
