# SPDX-License-Identifier: Apache-2.0
"""commutator: RTL against the model, the model against the orders of its words."""

import numpy as np
import pytest

from tactile_depth.chip.poisson.transform.commutator import commutator, from_beats, to_beats


@pytest.mark.parametrize("lowest", [0, 1, 2])
def test_beats_become_the_burst_again(lowest: int) -> None:
    words = np.random.default_rng(1).integers(0, 99, (3, 16))
    np.testing.assert_array_equal(from_beats(to_beats(words, 4, lowest), lowest), words)


@pytest.mark.parametrize("delay", [1, 2])
def test_up_and_down_are_inverse(delay: int) -> None:
    beats = np.arange(16).reshape(4, 4)
    np.testing.assert_array_equal(commutator(commutator(beats, delay, True), delay, False), beats)
