# SPDX-License-Identifier: Apache-2.0
"""Model of a camera on SCCB: it follows the two lines, keeps registers, answers reads, and fails on request."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

RELEASED = 1


@dataclass
class SccbCamera:
    """Registers of a camera, and the state of its transmission.

    Attributes
    ----------
    device_id, address_bytes : int
    registers : dict of int to int
    acknowledges : bool
        True to pull the ninth bit of what it takes low.
    faults : callable
        (what, address, value) to the value that is stored (what: write) or sent (read); None: not stored, not answered.
    transmissions : list of list of int
        Bytes of every whole transmission.
    """

    device_id: int
    address_bytes: int
    registers: dict[int, int] = field(default_factory=dict)
    acknowledges: bool = True
    faults: Callable[[str, int, int], int | None] = lambda what, address, value: value
    transmissions: list[list[int]] = field(default_factory=list)
    address: int = 0
    bits: list[int] | None = None  # bits of the current byte; None between transmissions
    bytes: list[int] = field(default_factory=list)
    answer: list[int] = field(default_factory=list)  # bits still to send
    line: int = RELEASED
    before: tuple[int, int] = (1, 1)

    def follow(self, sio_c: int, sio_d: int) -> int:
        """Take the levels of both lines; return 0 if this camera pulls SIO_D low, else 1."""
        was_c, was_d = self.before
        self.before = sio_c, sio_d
        if was_c and sio_c and was_d != sio_d:
            self._stop() if sio_d else self._start()
        elif sio_c and not was_c and self.bits is not None:
            self.bits.append(sio_d)
        elif was_c and not sio_c and self.bits is not None:
            self._next_bit()
        return self.line

    def _start(self) -> None:
        self.bits, self.bytes, self.answer, self.line = [], [], [], RELEASED

    def _stop(self) -> None:
        """End a transmission: store the byte of a write, or the address of a read."""
        data, self.bits, self.line = self.bytes, None, RELEASED
        self.transmissions.append(data)
        if not data or data[0] != self.device_id or len(data) <= self.address_bytes:
            return
        self.address = int.from_bytes(bytes(data[1 : 1 + self.address_bytes]), "big")
        for value in data[1 + self.address_bytes :]:
            stored = self.faults("write", self.address, value)
            if stored is not None:
                self.registers[self.address] = stored

    def _next_bit(self) -> None:
        """Set the line for the bit that begins as SIO_C falls."""
        assert self.bits is not None
        if len(self.bits) == 9:
            self.bytes.append(int("".join(map(str, self.bits[:8])), 2))
            self.bits = []
            if self.bytes == [self.device_id | 1]:
                sent = self.faults("read", self.address, self.registers.get(self.address, 0))
                self.answer = [] if sent is None else [sent >> place & 1 for place in range(7, -1, -1)]
        own = self.bits is not None and len(self.bits) == 8 and not self.reading
        self.line = RELEASED
        if self.answer:
            self.line = self.answer.pop(0)
        elif own and self.acknowledges:
            self.line = 0

    @property
    def reading(self) -> bool:
        """Return True in the bytes that this camera sends."""
        return self.bytes[:1] == [self.device_id | 1]
