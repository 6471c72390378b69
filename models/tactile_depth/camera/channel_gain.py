# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/camera/channel_gain.sv."""

from __future__ import annotations

import numpy as np

from tactile_depth.camera_configuration import GAIN_FRACTION
from tactile_depth.common.td_round_saturate import round_saturate


def channel_gain(samples: np.ndarray, black_level: int, gains: np.ndarray, width: int) -> np.ndarray:
    """Return the samples less the black level times the gain of their colour, rounded and saturated.

    Parameters
    ----------
    samples : int64 array
    gains : int array that broadcasts against `samples`, in units of 2**-12
    width : int
        Bits of a sample.
    """
    return round_saturate((samples - black_level) * gains, GAIN_FRACTION, width)
