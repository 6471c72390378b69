# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/gradient_lookup.sv, and the contents of its table."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from models.calibration import Calibration
from models.configuration import Configuration


def gradient_codes(calibration: Calibration, config: Configuration) -> np.ndarray:
    """Slope codes, slope = code * config.gradient_lsb, by bin {red, green, blue}, int64 (bins, 2): gx, gy."""
    slopes = calibration.table.reshape(-1, 2)
    return np.rint(slopes / config.gradient_lsb).astype(np.int64)


def gradient_lookup(frames: np.ndarray, codes: np.ndarray, bits_per_channel: int) -> np.ndarray:
    """Slope codes of frames: uint8 (..., rows, cols, 3) RGB to int64 (..., rows, cols, 2)."""
    top = frames.astype(np.int64) >> (8 - bits_per_channel)
    index = (top[..., 0] << bits_per_channel | top[..., 1]) << bits_per_channel | top[..., 2]
    return codes[index]


@dataclass
class Banks:
    """The two banks of a table, (2, entries, ..): frames use one, software reaches the other.

    Raises
    ------
    ValueError
        An entry is written while a change-over is due: the frame to come could see half a table.
    """

    words: np.ndarray
    in_use: int = 0
    wanted: int = 0

    @classmethod
    def of(cls, words: np.ndarray) -> Banks:
        """Both hold the same, as at power-up."""
        return cls(np.stack((words, words)))

    @property
    def spare(self) -> np.ndarray:
        """What software writes and reads."""
        return self.words[1 - self.in_use]

    def write(self, index: int, word: np.ndarray | tuple[int, ...]) -> None:
        if self.wanted != self.in_use:
            raise ValueError(f"entry {index} is written while a change-over is due")
        self.spare[index] = word

    def begin_frame(self) -> np.ndarray:
        """The table of the frame that begins, or that a reset leaves in use."""
        self.in_use = self.wanted
        return self.words[self.in_use]
