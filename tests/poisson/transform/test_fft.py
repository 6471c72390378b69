# SPDX-License-Identifier: Apache-2.0
"""fft: RTL against the model, the model against numpy."""

from typing import Any

import numpy as np
import pytest

from tactile_depth.chip.poisson.transform.fft import fft, halvings, twiddle_stages
from tactile_depth.chip.poisson.transform.orders import bit_reversed
from tactile_depth.chip.poisson.transform.twiddle import coefficient_gain
from tests.poisson.transform.transforms import coefficient_noise


def transform(z: np.ndarray, inverse: bool, coeff: int, width: int = 40) -> Any:
    """Transform complex integers (..., N), both sides in natural order."""
    order = bit_reversed(z.shape[-1])
    z_in = z[..., order] if inverse else z
    re, im = fft(z_in.real.astype(np.int64), z_in.imag.astype(np.int64), inverse, width, coeff)
    out = re + 1j * im
    return out if inverse else out[..., order]


def ideal(z: Any, inverse: bool) -> Any:
    size = z.shape[-1]
    return (size * np.fft.ifft(z) if inverse else np.fft.fft(z)) * 2.0 ** -halvings(size, inverse)


def random_words(seed: int, shape: Any, bits: int) -> Any:
    re, im = np.random.default_rng(seed).integers(-(2**bits), 2**bits, (2, *shape))
    return re + 1j * im


@pytest.mark.parametrize("coeff", [18, 24])
@pytest.mark.parametrize("inverse", [False, True])
@pytest.mark.parametrize("size", [8, 16, 32, 64, 128, 256, 512, 1024])
def test_model_is_an_fft_but_for_rounded_coefficients(size: int, inverse: bool, coeff: int) -> None:
    z = random_words(size, (5, size), 30)
    want = ideal(z, inverse) * coefficient_gain(coeff) ** twiddle_stages(size)
    error = np.std(transform(z, inverse, coeff) - want) / np.std(want)
    assert error < coefficient_noise(twiddle_stages(size), coeff)


# In steps of a word, coefficients being all but exact; on 200 bursts: 1.8, 2.1, 3.1, 3.0, 4.8, 3.8, 5.5.
@pytest.mark.parametrize(("size", "largest"), [(8, 2.5), (16, 2.5), (32, 4), (64, 4), (128, 6), (256, 5), (512, 7)])
def test_rounding_stays_within_steps(size: int, largest: int) -> None:
    z = random_words(size, (200, size), 12)
    assert np.abs(transform(z, False, 30, 30) - ideal(z, False)).max() < largest


# Measured on 200 bursts: 2, 3, 3, 3, 4, 5, 5.
@pytest.mark.parametrize(("size", "largest"), [(8, 3), (16, 4), (32, 4), (64, 4), (128, 5), (256, 6), (512, 6)])
def test_inverse_of_forward_is_the_identity_within_steps(size: int, largest: int) -> None:
    z = random_words(size, (200, size), 12)
    error = transform(transform(z, False, 30, 30), True, 30, 30) - z
    assert max(np.abs(error.real).max(), np.abs(error.imag).max()) <= largest
