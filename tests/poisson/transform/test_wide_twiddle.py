# SPDX-License-Identifier: Apache-2.0
"""wide_twiddle: RTL against the model, the model against twiddle_multiply, the paths without a multiplier."""

import numpy as np
import pytest

from tactile_depth.chip.poisson.transform.twiddle_multiply import twiddle_factors, twiddle_multiply
from tactile_depth.chip.poisson.transform.wide_commutator import to_beats
from tactile_depth.chip.poisson.transform.wide_fft import twiddle_window, wide_factors
from tactile_depth.chip.poisson.transform.wide_twiddle import ones, wide_twiddle


@pytest.mark.parametrize("inverse", [False, True])
@pytest.mark.parametrize(("paths", "block"), [(2, 32), (4, 32), (4, 8), (8, 32)])
def test_products_are_those_of_twiddle_multiply(paths: int, block: int, inverse: bool) -> None:
    re, im = np.random.default_rng(paths).integers(-(2**25), 2**25, (2, 3, 32))
    want = twiddle_multiply(re, im, twiddle_factors(block, inverse, 18), 17, 27)
    window = twiddle_window(32, paths, block, inverse)
    factors = wide_factors(32, paths, block, inverse, 18)
    got = wide_twiddle(to_beats(re, paths, window), to_beats(im, paths, window), factors, 17, 27)
    np.testing.assert_array_equal(got, [to_beats(part, paths, window) for part in want])


@pytest.mark.parametrize("inverse", [False, True])
@pytest.mark.parametrize("paths", [4, 8, 16])
def test_a_quarter_of_the_paths_needs_no_multiplier(paths: int, inverse: bool) -> None:
    for block in (128, 32):
        factors = wide_factors(128, paths, block, inverse, 18)
        assert ones(factors, 18).bit_count() == paths // 4
