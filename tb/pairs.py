# SPDX-License-Identifier: Apache-2.0
"""Monitors of pairs of rows, whose last one in a frame may be a row alone."""

from collections.abc import Iterator, Sequence
from typing import Any

from tb.pins import Read
from tb.stream import at_every_edge
from tb.wide import WideMonitor


class PairMonitor(WideMonitor):
    """WideMonitor of pairs of rows of `beats` beats; what lies behind a row alone counts as 0."""

    def __init__(self, dut: Any, name: str, beats: int, words: int, rows: int, lead: int) -> None:
        super().__init__(dut, name, ["data"], 2 * beats, words, lead)
        self.alone = (rows - 1) // 2 if rows % 2 else None  # the pair of a frame that is a row alone
        self.pair = 0

    def word(self, reads: Sequence[Read]) -> Any:
        index = len(self.words) % self.length
        if index == 0:
            self.pair = 0 if self.frame_starts[-1] else self.pair + 1
        behind = self.pair == self.alone and index >= self.length // 2
        return (0,) * self.paths if behind else super().word(reads)


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
