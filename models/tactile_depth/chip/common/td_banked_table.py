# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/common/td_banked_table.sv, frame by frame."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass
class BankedTable:
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
    def of(cls, words: np.ndarray) -> BankedTable:
        """Return two banks with the same contents, as at power-up."""
        return cls(np.stack((words, words)))

    @property
    def free(self) -> np.ndarray:
        """Bank that software writes and reads."""
        return self.words[1 - self.in_use]

    def write(self, index: int, word: np.ndarray | tuple[int, ...] | int) -> None:
        if self.wanted != self.in_use:
            raise ValueError(f"entry {index} is written while a change-over is due")
        self.free[index] = word

    def begin_frame(self) -> np.ndarray:
        """Change over if requested, at the start of a frame or at a reset; return the bank in use."""
        self.in_use = self.wanted
        return self.words[self.in_use]
