# SPDX-License-Identifier: Apache-2.0
"""sdf_butterfly: RTL against the model, the model against complex sums."""

from typing import Any

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from tactile_depth.chip.common.td_round_saturate import Monitor
from tactile_depth.chip.poisson.transform.fft import Stage
from tactile_depth.chip.poisson.transform.sdf_butterfly import sdf_butterfly

WORDS = st.lists(st.integers(-(2**20), 2**20), min_size=32, max_size=32)


@given(WORDS, st.booleans(), st.sampled_from([Stage(16, delay=8, rotate=True), Stage(16, delay=4, rotate=True)]))
def test_model_is_the_complex_sum_and_difference(words: Any, inverse: bool, stage: Any) -> None:
    re, im = np.array(words).reshape(2, 16)
    z = re + 1j * im
    z[12:] *= 1j if inverse else -1j
    want = np.empty(16, complex)
    for block in range(0, 16, 2 * stage.delay):
        for n in range(block, block + stage.delay):
            want[n], want[n + stage.delay] = z[n] + z[n + stage.delay], z[n] - z[n + stage.delay]
    out_re, out_im = sdf_butterfly(re, im, stage, inverse, 40)
    np.testing.assert_array_equal(out_re + 1j * out_im, want)


def test_full_scale_sums_saturate_and_halved_ones_do_not() -> None:
    full = np.full(16, 127)
    for halve, clipped in ((False, 16), (True, 0)):  # the sums of both parts; the differences are 0
        monitor = Monitor()
        sdf_butterfly(full, full, Stage(16, delay=8, halve=halve), False, 8, monitor)
        assert monitor.saturations.total() == clipped
