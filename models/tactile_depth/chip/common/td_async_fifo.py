# SPDX-License-Identifier: Apache-2.0
"""Model of hdl/common/td_async_fifo.sv, edge by edge of both clocks; a code that crosses arrives at once and whole."""

from __future__ import annotations

from dataclasses import dataclass, field


@dataclass
class AsyncFifo:
    """State of the queue between two edges; counts never wrap.

    Attributes
    ----------
    depth : int
        Words of the memory; one more waits at the output.
    words : list of int
        Every word that was written.
    fetched : int
        Words that have gone to the output.
    fetched_crossing, written_crossing : list of int
        Counts in the two registers of each crossing, the older second.
    offered : bool
        True while a word waits at the output.
    """

    depth: int
    words: list[int] = field(default_factory=list)
    fetched: int = 0
    fetched_crossing: list[int] = field(default_factory=lambda: [0, 0])
    written_crossing: list[int] = field(default_factory=lambda: [0, 0])
    offered: bool = False

    @property
    def write_ready(self) -> bool:
        return len(self.words) - self.fetched_crossing[1] < self.depth

    @property
    def read_data(self) -> int | None:
        """Return the word at the output, None if there is none."""
        return self.words[self.fetched - 1] if self.offered else None

    def edges(self, word: int | None, taken: bool, writes: bool, reads: bool) -> None:
        """Advance by an edge of the writer's clock, of the reader's, or of both in the same instant.

        Parameters
        ----------
        word : int or None
            The word that is offered to the queue, None without one.
        taken : bool
            True if the sink is ready.
        writes, reads : bool
            Clocks that rise.
        """
        written, fetched = len(self.words), self.fetched
        if writes:
            if word is not None and self.write_ready:
                self.words.append(word)
            self.fetched_crossing = [fetched, self.fetched_crossing[0]]
        if reads:
            if taken or not self.offered:
                self.offered = fetched < self.written_crossing[1]
                self.fetched += self.offered
            self.written_crossing = [written, self.written_crossing[0]]
