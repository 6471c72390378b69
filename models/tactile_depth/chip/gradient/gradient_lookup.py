# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/gradient/gradient_lookup.sv, and the contents of its table."""

from __future__ import annotations

import numpy as np

from tactile_depth.chip.calibration import Calibration
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.limits import CORRECTION_BITS, CORRECTION_WIDTH
from tactile_depth.chip.resources import Parts, Words, banks

LATENCY = 4


def gradient_codes(calibration: Calibration, config: Configuration) -> np.ndarray:
    """Return the slope codes gx, gy by bin {red, green, blue}, int64 (bins, 2); slope = code * config.gradient_lsb."""
    slopes = calibration.table.reshape(-1, 2)
    return np.rint(slopes / config.gradient_lsb).astype(np.int64)


def gradient_lookup(frames: np.ndarray, codes: np.ndarray, bits: int) -> np.ndarray:
    """Return the slope codes of frames: uint8 (..., rows, cols, 3) RGB to int64 (..., rows, cols, 2)."""
    top = frames.astype(np.int64) >> (8 - bits)
    index = (top[..., 0] << bits | top[..., 1]) << bits | top[..., 2]
    return codes[index]


def parts(config: Configuration) -> Parts:
    """Return the tables of slopes or, with polynomials, of corrections."""
    bits, width = config.bits_per_channel, config.gradient.width
    if config.polynomials:
        bits, width = CORRECTION_BITS, CORRECTION_WIDTH
    return [Words(width), *banks(2 * width, 1 << 3 * bits)]
