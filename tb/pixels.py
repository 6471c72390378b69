# SPDX-License-Identifier: Apache-2.0
"""Conversion of colours to the words of s_axis and back."""

from typing import Any

import numpy as np

GREEN, BLUE, RED = 0, 8, 16  # lowest bit of each colour in a word


def pack(rgb: Any) -> np.ndarray:
    """Return the words of colours, int64 (...), from integers (..., 3) in the order red, green, blue."""
    colours = np.asarray(rgb, np.int64)
    return colours[..., 0] << RED | colours[..., 1] << GREEN | colours[..., 2] << BLUE


def unpack(words: Any) -> np.ndarray:
    """Return the colours of words, uint8 (..., 3) in the order red, green, blue."""
    data = np.asarray(words)
    return np.stack([data >> low & 255 for low in (RED, GREEN, BLUE)], axis=-1).astype(np.uint8)
