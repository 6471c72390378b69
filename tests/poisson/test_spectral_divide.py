# SPDX-License-Identifier: Apache-2.0
"""spectral_divide: RTL against the model, the model against the eigenvalues of the reference."""

from typing import Any

import numpy as np
import pytest

from tactile_depth.chip.common.td_round_saturate import Monitor
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.poisson.spectral_divide import reciprocals, spectral_divide
from tactile_depth.chip.poisson.transform.orders import bit_reversed
from tactile_depth.depth import reference


def divided(modes: Any, config: Configuration) -> Any:
    """Return the exact result in codes, unrounded."""
    k = config.columns - bit_reversed(config.columns)
    eigenvalue = reference.eigenvalues(config.columns)[k - 1]
    pixels = modes * config.column_forward.lsb / (eigenvalue[:, None] + eigenvalue)
    return pixels / config.depth_limit_px / config.column_inverse.lsb / config.transform_gain


CONFIGURATIONS = [
    Configuration(columns=size, coefficient_width=coeff, depth_range_px=depth_range)
    for size, coeff, depth_range in [
        (16, 10, 0.1),
        (16, 18, None),
        (64, 18, 3),
        (128, 24, None),
        (256, 18, None),
    ]
]


@pytest.mark.parametrize("config", CONFIGURATIONS, ids=lambda c: f"{c.columns}-{c.coefficient_width}")
def test_model_divides_by_the_eigenvalues(config: Configuration) -> None:
    """Bound the error: half a step of the rounding, and half the last bit of a mantissa of w bits, at least 2^(w -
    2)."""
    shape = (config.columns, config.columns)
    limit = 2.0 ** (config.arithmetic_width - 1)
    full = np.abs(divided(np.ones(shape), config))
    modes = np.random.default_rng(config.columns).uniform(-1, 1, shape) * 0.99 * limit / np.maximum(full, 1)
    modes = np.rint(modes).astype(np.int64)
    want, monitor = divided(modes, config), Monitor()
    error = np.abs(spectral_divide(modes, config, monitor) - want)
    assert np.all(error <= 0.5 + np.abs(want) * 2.0 ** (1 - config.coefficient_width) * (1 + 1e-9))
    assert not monitor.saturations


@pytest.mark.parametrize("config", CONFIGURATIONS, ids=lambda c: f"{c.columns}-{c.coefficient_width}")
def test_mantissas_are_normalised_and_at_least_one_bit_is_dropped(config: Configuration) -> None:
    table = reciprocals(config)
    top = 2 ** (config.coefficient_width - 1)
    assert np.all((table.mantissa >= -top) & (table.mantissa <= -top // 2))
    assert table.drop >= 1
    assert table.shift.min() >= 0
    assert table.shift.max() < 2**table.shift_width
