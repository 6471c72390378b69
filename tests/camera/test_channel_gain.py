# SPDX-License-Identifier: Apache-2.0
"""channel_gain: RTL against the model, the model against fractions."""

from collections.abc import Callable
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tactile_depth.camera.channel_gain import channel_gain


@pytest.mark.structures(
    "bits bayer",
    verilator=[(10, 1)],
    icarus=[(10, 1), (8, 0)],
    regress=[(12, 1), (10, 0), (8, 1)],
    regress_verilator=[(8, 0)],
)
def test_rtl(run_tb: Callable[..., None], bits: int, bayer: int) -> None:
    run_tb("channel_gain", {"Bits": bits, "Bayer": bayer})


@given(st.integers(-(2**13), 2**13 - 1), st.integers(0, 2**12 - 1), st.integers(0, 2**16 - 1))
def test_rounding_is_that_of_fractions(sample: int, black: int, gain: int) -> None:
    rounded = round(Fraction((sample - black) * gain, 1 << 12))
    assert channel_gain(np.array([sample]), black, np.array([gain]), 14) == [min(max(rounded, -(2**13)), 2**13 - 1)]


def test_one_changes_nothing() -> None:
    samples = np.arange(-(2**11), 2**11)
    np.testing.assert_array_equal(channel_gain(samples, 0, np.array([1 << 12]), 12), samples)
