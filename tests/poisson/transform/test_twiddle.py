# SPDX-License-Identifier: Apache-2.0
"""twiddle: RTL against the model, the model against complex products."""

from typing import Any

import numpy as np
import pytest

from tactile_depth.chip.common.td_round_saturate import Monitor
from tactile_depth.chip.poisson.transform.fft import path_factors
from tactile_depth.chip.poisson.transform.orders import bit_reversed
from tactile_depth.chip.poisson.transform.twiddle import (
    coefficient,
    coefficient_gain,
    ones,
    phase_factors,
    twiddle,
    twiddle_factors,
)


@pytest.mark.parametrize("inverse", [False, True])
@pytest.mark.parametrize(("block", "coeff"), [(8, 10), (64, 18), (512, 24)])
def test_factors_are_roots_of_unity_within_half_a_bit(block: Any, coeff: int, inverse: bool) -> None:
    n = np.arange(block // 4)
    exponent = np.concatenate((0 * n, 2 * n, n, 3 * n))  # the butterflies leave the quarters in order 0, 2, 1, 3
    want = np.exp((2j if inverse else -2j) * np.pi * exponent / block) * (2 ** (coeff - 1) - 1)
    error = twiddle_factors(block, inverse, coeff) - np.stack((want.real, want.imag), axis=-1)
    assert np.abs(error).max() <= 0.5 + 1e-6


@pytest.mark.parametrize(("size", "coeff"), [(16, 10), (128, 18), (512, 24)])
def test_phases_are_those_of_makhoul_within_half_a_bit(size: int, coeff: int) -> None:
    forward = np.exp(-0.5j * np.pi * bit_reversed(size) / size)
    for inverse, want in ((False, forward), (True, forward.conj() / 1j)):
        error = phase_factors(size, inverse, coeff) / (2 ** (coeff - 1) - 1)
        error = error - np.stack((want.real, want.imag), axis=-1)
        assert np.abs(error).max() <= (0.5 + 1e-6) / (2 ** (coeff - 1) - 1)


@pytest.mark.parametrize("coeff", [10, 18, 24])
def test_a_factor_of_one_is_the_gain_and_no_factor_is_the_lowest_code(coeff: int) -> None:
    top = 2 ** (coeff - 1) - 1
    assert coefficient(np.array([1.0, -1.0, 0.0]), coeff).tolist() == [top, -top, 0]
    assert top / 2 ** (coeff - 1) == coefficient_gain(coeff)


def test_a_turned_corner_saturates() -> None:
    """Rotate (A, A) by an eighth to (1.41 A, 0), which needs the guard bit of the formats."""
    full = np.full(8, 2**26 - 1)
    monitor = Monitor()
    re, im = twiddle(full, full, twiddle_factors(8, False, 18), 17, 27, monitor)
    assert re[5] == 2**26 - 1  # position 5: exponent 1 of 8
    assert abs(im[5]) <= 1
    assert monitor.saturations["twiddle.re"] > 0


@pytest.mark.parametrize("inverse", [False, True])
@pytest.mark.parametrize("paths", [4, 8, 16])
def test_a_quarter_of_the_paths_needs_no_multiplier(paths: int, inverse: bool) -> None:
    for block in (128, 32):
        factors = path_factors(128, paths, block, inverse, 18)
        assert ones(factors, 18).bit_count() == paths // 4
