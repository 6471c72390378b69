# SPDX-License-Identifier: Apache-2.0
"""butterfly: RTL against the model, the model against sdf_butterfly."""

import numpy as np
import pytest

from tactile_depth.chip.poisson.transform.butterfly import butterfly
from tactile_depth.chip.poisson.transform.commutator import to_beats
from tactile_depth.chip.poisson.transform.sdf_butterfly import Stage, sdf_butterfly


@pytest.mark.parametrize("inverse", [False, True])
def test_the_second_butterfly_of_a_pair_is_that_of_sdf_butterfly(inverse: bool) -> None:
    """Hold the bits of a block of 8 in the path number: the inverse takes bit 2 with bit 1, the other bit 1 with 2."""
    re, im = np.random.default_rng(1).integers(-128, 128, (2, 5, 32))
    stage = Stage(8, delay=4 if inverse else 2, rotate=True, halve=True)
    want = [to_beats(part, 4, 1) for part in sdf_butterfly(re, im, stage, inverse, 8)]
    path_bit, rotate_bit = (1, 0) if inverse else (0, 1)
    got = butterfly(to_beats(re, 4, 1), to_beats(im, 4, 1), path_bit, rotate_bit, inverse, True, 8)
    np.testing.assert_array_equal(got, want)


def test_a_bit_of_the_beat_rotates() -> None:
    re, im = np.ones((4, 2), np.int64), np.zeros((4, 2), np.int64)
    got_re, got_im = butterfly(re, im, 0, 2, True, False, 8)  # bit 1 of the beat
    np.testing.assert_array_equal(got_re + 1j * got_im, [[2, 0], [2, 0], [1 + 1j, 1 - 1j], [1 + 1j, 1 - 1j]])
