# SPDX-License-Identifier: Apache-2.0
"""wide_fft: RTL against the model of sdf_fft, the order of its words, its ROMs."""

import numpy as np
import pytest

from tactile_depth.chip.poisson.transform.sdf_fft import sdf_fft
from tactile_depth.chip.poisson.transform.wide_fft import wide_fft


@pytest.mark.parametrize("inverse", [False, True])
@pytest.mark.parametrize("paths", [1, 2, 8])
def test_words_enter_and_leave_at_the_positions_of_the_header(paths: int, inverse: bool) -> None:
    re, im = np.random.default_rng(paths).integers(-(2**20), 2**20, (2, 32))
    want = sdf_fft(re, im, inverse, 27, 18)
    sent = [in_beats(part, paths, by_path=not inverse) for part in (re, im)]
    got = wide_fft(sent[0], sent[1], inverse, 27, 18)
    np.testing.assert_array_equal(got, [in_beats(part, paths, by_path=inverse) for part in want])


def in_beats(words: np.ndarray, paths: int, by_path: bool) -> np.ndarray:
    """Return words as beats: neighbours lie in one path, or in one beat."""
    return words.reshape(paths, -1).T if by_path else words.reshape(-1, paths)
