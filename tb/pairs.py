# SPDX-License-Identifier: Apache-2.0
"""Monitors of pairs of rows side by side, of which the last one in a frame may be a row alone."""

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from tb.beats import BeatsMonitor
from tb.pins import Read
from tb.stream import at_every_edge


class PairMonitor(BeatsMonitor):
    """BeatsMonitor of pairs of rows, `paths` words of each in a beat; what lies beside a row alone counts as 0."""

    def __init__(self, dut: Any, name: str, beats: int, paths: int, rows: int, lead: int) -> None:
        super().__init__(dut, name, ["data"], beats, 2 * paths, lead)
        self.alone = (rows - 1) // 2 if rows % 2 else None  # the pair of a frame that is a row alone
        self.pair = 0

    def word(self, reads: Sequence[Read]) -> Any:
        if len(self.words) % self.length == 0:
            self.pair = 0 if self.frame_starts[-1] else self.pair + 1
        lower = len(reads) // 2
        return super().word(reads[:lower]) + (0,) * lower if self.pair == self.alone else super().word(reads)


class AloneMonitor:
    """Monitor that keeps the pin `alone` of each start."""

    def __init__(self, dut: Any, name: str) -> None:
        self.dut, self.name = dut, name
        self.marks: list[bool] = []
        at_every_edge(dut.clk, self._watch())

    def _watch(self) -> Iterator[None]:
        start, alone = getattr(self.dut, f"{self.name}_start"), getattr(self.dut, f"{self.name}_alone")
        while True:
            yield
            if not self.dut.rst.value and self.dut.en.value and int(start.value):
                self.marks.append(bool(int(alone.value)))


def side_by_side(rows: Any, paths: int) -> Any:
    """Return rows (frames, rows, columns), last row first, as beats (frames * pairs, beats, 2 paths).

    Beside a row alone are zeros.
    """
    count, columns = rows.shape[1:]
    if count % 2:
        rows = np.concatenate((rows, np.zeros_like(rows[:, :1])), axis=1)
    pairs = rows.reshape(-1, 2, columns // paths, paths)
    return np.moveaxis(pairs, 1, 2).reshape(-1, columns // paths, 2 * paths)
