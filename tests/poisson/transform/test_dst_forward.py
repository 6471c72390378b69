# SPDX-License-Identifier: Apache-2.0
"""dst_forward: RTL against the model, the model against scipy."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.fft import dst

from tactile_depth.chip.poisson.transform.dst_forward import dst_forward
from tactile_depth.chip.poisson.transform.fft import halvings, twiddle_stages
from tactile_depth.chip.poisson.transform.orders import bit_reversed, makhoul
from tactile_depth.chip.poisson.transform.transform import Transform
from tactile_depth.chip.poisson.transform.twiddle import coefficient_gain
from tests.poisson.transform.transforms import coefficient_noise


def transform(x: np.ndarray, coeff: int, width: int = 40) -> Any:
    """Transform rows in natural order, at full precision except for the coefficients."""
    return dst_forward(x[..., makhoul(x.shape[-1])], Transform(0, width, coeff, 0, width))


def ideal(x: Any) -> Any:
    """Return the DST-II of scipy (twice the sum, modes from 1) in the order and with the halvings of the hardware."""
    size = x.shape[-1]
    return dst(x, type=2)[..., size - 1 - bit_reversed(size)] / 2 * 2.0 ** -halvings(size, inverse=False)


@pytest.mark.parametrize("coeff", [18, 24])
@pytest.mark.parametrize("size", [8, 16, 32, 64, 128, 256, 512, 1024])
def test_model_is_the_dst_but_for_rounded_coefficients(size: int, coeff: int) -> None:
    x = np.random.default_rng(size).integers(-(2**30), 2**30, (20, size))
    want = ideal(x) * coefficient_gain(coeff) ** (twiddle_stages(size) + 1)
    error = np.std(transform(x, coeff) - want) / np.std(want)
    assert error < coefficient_noise(twiddle_stages(size) + 1, coeff)


# In steps of a word, coefficients being all but exact; measured on 200 bursts:
# RMS 0.55, 0.58, 0.81, 0.72, 1.01, 0.83, 1.17; largest 1.7, 2.0, 3.1, 3.0, 4.0, 3.9, 5.0. Odd powers
# of two halve once less, so they carry more noise.
@pytest.mark.parametrize(
    ("size", "rms", "largest"),
    [(8, 0.6, 2), (16, 0.65, 2.5), (32, 0.9, 4), (64, 0.8, 4), (128, 1.1, 5), (256, 0.95, 5), (512, 1.3, 6)],
)
def test_rounding_stays_within_steps(size: int, rms: Any, largest: int) -> None:
    x = np.random.default_rng(size).integers(-(2**12), 2**12, (200, size))
    error = transform(x, 30, 30) - ideal(x)
    assert np.std(error) < rms
    assert np.abs(error).max() < largest


SEED = st.integers(0, 2**32 - 1)
SIZE = st.sampled_from([8, 16, 32, 64])


@settings(max_examples=40, deadline=None)
@given(SEED, SIZE)
def test_negation_goes_through(seed: int, size: int) -> None:
    x = np.random.default_rng(seed).integers(-(2**20), 2**20, size)
    np.testing.assert_array_equal(transform(-x, 18, 30), -transform(x, 18, 30))
