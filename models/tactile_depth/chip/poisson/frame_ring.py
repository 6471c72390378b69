# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/poisson/frame_ring.sv: keeps words of frames, one behind the other, until they are read."""

from __future__ import annotations

from tactile_depth.chip.common.td_parity_ram import ParityRam


class FrameRing:
    """State between two clocks; None: not known yet.

    Attributes
    ----------
    word : int or None
        Number in its frame of the word that comes next, if it does not begin one.
    write, read : int, int or None
        Addresses of the next word that comes, and of the next one that is read.
    """

    def __init__(self, width: int, words: int, held: int, *, last_first: bool, late: int, parity: bool) -> None:
        self.words, self.last_first, self.parity = words, last_first, parity
        self.size = 1 << (held - 1).bit_length()
        self.half = 1 << (late - 1).bit_length() - 1 if late else 0
        self._ram = ParityRam([None] * self.size, width, latency=2, parity=parity)
        self.word: int | None = None
        self.write = 0
        self.read: int | None = None
        self._first: int | None = None
        self._latest: int | None = None
        self._earlier: int | None = None
        self._since: int | None = None

    @property
    def chosen(self) -> int | None:
        """Address of the first word of the frame that is read if reading begins now."""
        return self._latest if not self.half or self._since == self.half else self._earlier

    def clock(self, **pins: int) -> dict[str, int | None]:
        """Advance by one clock edge; return the outputs before it, None where one is not known."""
        takes, asks = pins["en"] and pins["in_valid"], pins["out_en"] and pins["out_next"]
        written, read, word = self.write, self.read, 0 if pins["in_frame_start"] else self.word
        chosen = self.chosen
        read_out = self._ram.clock(
            en=pins["out_en"],
            write_en=takes,
            write_address=written,
            write_data=pins["in_data"],
            read_en=asks,
            read_address=read,
        )
        if pins["en"]:
            self._since = None if self._since is None else min(self._since + 1, self.half)
        if takes:
            self.write = (written + 1) % self.size
            self._first = written if pins["in_frame_start"] else self._first
            if word == self.words - 1:
                self._earlier, self._latest = self._latest, written if self.last_first else self._first
                self._since = 0
            self.word = None if word is None else (word + 1) % (1 << (self.words - 1).bit_length())
        if pins["out_en"] and pins["out_frame_start"]:
            self.read = chosen
        elif asks:
            assert read is not None, "no frame was chosen"
            self.read = (read + (-1 if self.last_first else 1)) % self.size
        if pins["rst"]:
            self.write = 0
        return {"out_data": read_out["read_data"], "flipped": read_out["flipped"]}
