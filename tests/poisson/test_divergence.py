# SPDX-License-Identifier: Apache-2.0
"""divergence: RTL against the model, the model against the formula."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from tactile_depth.chip.poisson.divergence import divergence


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(1, 6), st.integers(1, 6))
def test_every_pixel_is_the_formula(seed: int, rows: int, columns: int) -> None:
    gradient = np.random.default_rng(seed).integers(-100, 100, (rows, columns, 2))
    out = divergence(gradient)
    for i, j in np.ndindex(rows, columns):
        left = gradient[i, j - 1, 0] if j else 0
        above = gradient[i - 1, j, 1] if i else 0
        assert out[i, j] == gradient[i, j, 0] - left + gradient[i, j, 1] - above


def test_two_bits_more_hold_every_result() -> None:
    checks = np.where(np.indices((4, 4)).sum(axis=0) % 2, -128, 127)
    out = divergence(np.stack((checks, checks), axis=-1))
    assert out.max() == 2 * (127 + 128)
    assert out.min() == -2 * (127 + 128)


def test_neumann_gives_a_divergence_without_sum() -> None:
    gradient = np.random.default_rng(1).integers(-100, 100, (3, 5, 7, 2))
    assert not np.any(divergence(gradient, neumann=True).sum(axis=(1, 2)))
