# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/gradient/gradient_lookup.sv, and the contents of its table."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tactile_depth.configuration import Configuration
from tactile_depth.sensor import Sensor


def gradient_codes(calibration: Sensor, config: Configuration) -> np.ndarray:
    """Return the slope codes gx, gy by bin {red, green, blue}, int64 (bins, 2); slope = code * config.gradient_lsb."""
    slopes = calibration.table.reshape(-1, 2)
    return np.rint(slopes / config.gradient_lsb).astype(np.int64)


def gradient_lookup(frames: np.ndarray, codes: np.ndarray, bits_per_channel: int) -> np.ndarray:
    """Return the slope codes of frames: uint8 (..., rows, cols, 3) RGB to int64 (..., rows, cols, 2)."""
    top = frames.astype(np.int64) >> (8 - bits_per_channel)
    index = (top[..., 0] << bits_per_channel | top[..., 1]) << bits_per_channel | top[..., 2]
    return codes[index]


@dataclass
class Banks:
    """Two banks of a table, (2, entries, ..): frames use one, software accesses the other.

    Raises
    ------
    ValueError
        An entry is written while a change-over is due; the next frame could use a half-written table.
    """

    words: np.ndarray
    in_use: int = 0
    wanted: int = 0

    @classmethod
    def of(cls, words: np.ndarray) -> Banks:
        """Return two banks with the same contents, as at power-up."""
        return cls(np.stack((words, words)))

    @property
    def spare(self) -> np.ndarray:
        """Bank that software writes and reads."""
        return self.words[1 - self.in_use]

    def write(self, index: int, word: np.ndarray | tuple[int, ...]) -> None:
        if self.wanted != self.in_use:
            raise ValueError(f"entry {index} is written while a change-over is due")
        self.spare[index] = word

    def begin_frame(self) -> np.ndarray:
        """Change over if requested, at the start of a frame or at a reset; return the bank in use."""
        self.in_use = self.wanted
        return self.words[self.in_use]
