# SPDX-License-Identifier: Apache-2.0
"""dst_inverse: RTL against the model, the model against dst_forward and scipy."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.fft import idst

from tactile_depth.chip.poisson.transform.dst_forward import dst_forward
from tactile_depth.chip.poisson.transform.dst_inverse import dst_inverse, dst_inverse_pairs
from tactile_depth.chip.poisson.transform.fft import halvings, twiddle_stages
from tactile_depth.chip.poisson.transform.orders import bit_reversed, makhoul
from tactile_depth.chip.poisson.transform.transform import Transform
from tactile_depth.chip.poisson.transform.twiddle import coefficient_gain
from tests.poisson.transform.transforms import coefficient_noise


def inverse(modes: Any, coeff: int, width: int = 40) -> Any:
    return dst_inverse(modes, Transform(0, width, coeff, 0, width))


@pytest.mark.parametrize("coeff", [18, 24])
@pytest.mark.parametrize("size", [8, 16, 32, 64, 128, 256, 512, 1024])
def test_model_is_the_inverse_dst_but_for_rounded_coefficients(size: int, coeff: int) -> None:
    modes = np.random.default_rng(size).integers(-(2**30), 2**30, (20, size))
    natural = np.empty_like(modes)
    natural[:, size - 1 - bit_reversed(size)] = modes  # scipy's order, from mode 1
    gain = 2.0 ** (1 + halvings(size, inverse=False)) * coefficient_gain(coeff) ** (twiddle_stages(size) + 1)
    want = gain * idst(natural, type=2)[:, makhoul(size)]
    error = np.std(inverse(modes, coeff) - want) / np.std(want)
    assert error < coefficient_noise(twiddle_stages(size) + 1, coeff)


# In steps of a word, coefficients being all but exact; measured on 200 bursts:
# RMS 0.63, 0.92, 1.00, 1.23, 1.28, 1.47, 1.51; largest 2, 3, 3, 5, 5, 6, 7.
@pytest.mark.parametrize(
    ("size", "rms", "largest"),
    [(8, 0.7, 3), (16, 1.0, 4), (32, 1.1, 5), (64, 1.35, 6), (128, 1.4, 7), (256, 1.6, 7), (512, 1.65, 8)],
)
def test_there_and_back_stays_within_steps(size: int, rms: Any, largest: int) -> None:
    x = np.random.default_rng(size).integers(-(2**12), 2**12, (200, size))
    error = inverse(dst_forward(x, Transform(0, 30, 30, 0, 30)), 30, 30) - x
    assert np.std(error) < rms
    assert np.abs(error).max() <= largest


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 2**32 - 1), st.sampled_from([8, 16, 32, 64]))
def test_negation_goes_through(seed: int, size: int) -> None:
    modes = np.random.default_rng(seed).integers(-(2**20), 2**20, size)
    np.testing.assert_array_equal(inverse(-modes, 18, 30), -inverse(modes, 18, 30))


# In steps of a word, coefficients being all but exact. Measured on 100 pairs of rows: 3, 4, 5.
@pytest.mark.parametrize(("size", "largest"), [(16, 4), (64, 5), (128, 6)])
def test_rows_of_a_pair_are_those_alone_within_steps(size: int, largest: int) -> None:
    modes = np.random.default_rng(size).integers(-(2**12), 2**12, (100, 2, size))
    pairs = dst_inverse_pairs(modes, Transform(0, 30, 30, 0, 30))
    assert np.abs(pairs - dst_inverse(modes, Transform(0, 30, 30, 0, 30))).max() <= largest
