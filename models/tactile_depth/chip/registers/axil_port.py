# SPDX-License-Identifier: Apache-2.0
"""Cycle-accurate model of hdl/registers/axil_port.sv: an AXI4-Lite port with one write and one read in flight."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum

from tactile_depth.chip.registers.register_map import WORD_BITS

BYTES = WORD_BITS // 8
LATE_CLOCKS = 4
"""Clocks from the address of a read to its late answer."""


class Response(IntEnum):
    """AXI responses (IHI 0022, table A3-4) that the registers use."""

    OKAY = 0
    SLVERR = 2


def strobed_bits(strobe: int) -> int:
    """Return a mask of the bits of a word whose bytes are strobed."""
    return sum(0xFF << 8 * byte for byte in range(BYTES) if strobe >> byte & 1)


def response(refused: bool) -> Response:
    """Return the response of an access."""
    return Response.SLVERR if refused else Response.OKAY


@dataclass(frozen=True)
class Write:
    """A write in the cycle in which it takes effect: byte offset of the register, data, mask of its strobed bits."""

    offset: int
    ones: int
    mask: int


@dataclass(frozen=True)
class Pins:
    """Words that the master offers in one cycle; None: not valid."""

    write_address: int | None = None
    write_data: tuple[int, int] | None = None  # word, strobe
    write_response_ready: bool = False
    read_address: int | None = None
    read_response_ready: bool = False


def offset_of(address: int) -> int:
    """Return the offset of the register with this byte address."""
    return address & ~(BYTES - 1)


@dataclass
class AxilPort:
    """Transactions in flight.

    Attributes
    ----------
    address, data : int, (int, int), or None
        Address, and word with strobe, of the write that was taken.
    written : Response or None
        Response of the write, while it waits for its ready.
    answer : (int, Response) or None
        Data and response of the read, while they wait for their ready.
    asked : int or None
        Offset of the read that was taken in the cycle before, and is looked up in this one.
    late : int
        Cycles until the late answer of a read; 0: none is under way.
    """

    address: int | None = None
    data: tuple[int, int] | None = None
    written: Response | None = None
    answer: tuple[int, Response] | None = None
    asked: int | None = None
    late: int = 0

    def reset(self) -> None:
        """Forget the transactions in flight; while a reset lasts, none is taken."""
        self.address = self.data = self.written = self.answer = self.asked = None
        self.late = 0

    @property
    def read_ready(self) -> bool:
        """Return `arready` out of reset; the ready of address and data of a write is that none is held."""
        return self.answer is None and self.asked is None and not self.late

    def write(self) -> Write | None:
        """Return the write that takes effect in this cycle, which may be the first one of a reset."""
        if self.address is None or self.data is None or self.written is not None or self.late:
            return None
        word, strobe = self.data
        mask = strobed_bits(strobe)
        return Write(offset_of(self.address), word & mask, mask)

    def clock(
        self, pins: Pins, refused: bool, answer: tuple[int, Response], is_late: bool, late_answer: tuple[int, Response]
    ) -> None:
        """Take one clock edge out of reset.

        Parameters
        ----------
        pins : Pins
        refused : bool
            The write of this cycle is refused.
        answer, is_late : (int, Response), bool
            Answer of the read that is looked up in this cycle, or whether it comes late.
        late_answer : (int, Response)
            Late answer as it stands in this cycle.
        """
        writes, reads = self.write() is not None, self.asked is not None
        taken = pins.read_address if self.read_ready else None
        held = self.address is not None, self.data is not None
        if self.written is not None and pins.write_response_ready:
            self.address = self.data = self.written = None
        elif writes:
            self.written = response(refused)
        if pins.write_address is not None and not held[0]:
            self.address = pins.write_address
        if pins.write_data is not None and not held[1]:
            self.data = pins.write_data
        if pins.read_response_ready:
            self.answer = None
        if reads and not is_late:
            self.answer = answer
        if self.late == 1:
            self.answer = late_answer
        self.asked = None if taken is None else offset_of(taken)
        self.late = LATE_CLOCKS if reads and is_late else max(0, self.late - 1)
