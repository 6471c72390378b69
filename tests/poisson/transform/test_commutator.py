# SPDX-License-Identifier: Apache-2.0
"""commutator: RTL against the model, the model against the orders of its words."""

import numpy as np
import pytest

from tactile_depth.chip.poisson.transform.commutator import commutator, from_beats, positions, to_beats


def test_positions_have_three_fields() -> None:
    assert positions(16, 4, 0).tolist() == [[0, 1, 2, 3], [4, 5, 6, 7], [8, 9, 10, 11], [12, 13, 14, 15]]
    assert positions(16, 4, 1).tolist() == [[0, 2, 4, 6], [1, 3, 5, 7], [8, 10, 12, 14], [9, 11, 13, 15]]
    assert positions(16, 4, 2).tolist() == [[0, 4, 8, 12], [1, 5, 9, 13], [2, 6, 10, 14], [3, 7, 11, 15]]


@pytest.mark.parametrize("lowest", [0, 1, 2])
def test_beats_become_the_burst_again(lowest: int) -> None:
    words = np.random.default_rng(1).integers(0, 99, (3, 16))
    np.testing.assert_array_equal(from_beats(to_beats(words, 4, lowest), lowest), words)


@pytest.mark.parametrize("delay", [1, 2])
def test_up_and_down_are_inverse(delay: int) -> None:
    beats = np.arange(16).reshape(4, 4)
    np.testing.assert_array_equal(commutator(commutator(beats, delay, True), delay, False), beats)
