# SPDX-License-Identifier: Apache-2.0
"""Cycle-accurate model of hdl/camera/camera_setup.sv: a list of registers goes to a camera over SCCB.

SCCB: OmniVision Serial Camera Control Bus Functional Specification, version 2.2, 2007. Every byte has a ninth bit that
is don't-care, and cameras do not agree on it. So a write is known to have arrived only when the register has been read
back. A read is two transmissions: one puts the address, the other reads.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from enum import IntEnum
from typing import NamedTuple

READ = 1  # lowest bit of the first byte of a transmission
START, STOP = "start", "stop"


class Kind(IntEnum):
    """Kinds of entries of a list."""

    WRITE = 0  # and read back
    PLAIN_WRITE = 1
    CHECK = 2
    PINS = 3


class Entry(NamedTuple):
    """An entry: `address` and `data` of a register, or pins {power_down, reset_n} and milliseconds."""

    kind: Kind
    address: int
    data: int

    @property
    def word(self) -> int:
        """Return the word of the table."""
        return self.kind << 24 | self.address << 8 | self.data


def bits_of(data: Sequence[int]) -> list[int]:
    """Return the bits of a transmission's bytes, highest first, each byte with its released ninth bit."""
    return [bit for byte in data for bit in [*(byte >> place & 1 for place in range(7, -1, -1)), 1]]


def levels_of(symbol: str | int, quarter: int) -> tuple[bool, bool]:
    """Return (sio_c, sio_d_low) in a quarter of a start, a stop or a bit."""
    if symbol == START:
        return quarter < 2, quarter > 0
    if symbol == STOP:
        return quarter > 0, quarter < 2
    return quarter in (1, 2), not symbol


@dataclass
class CameraSetup:
    """State of the core.

    Attributes
    ----------
    entries : sequence of Entry
    address_bytes, device_id, quarter_clocks, millisecond_clocks, attempts, xclk_half_clocks : int
        Parameters of the core.
    state : str
        fetch, decode, wait, send, done or failed.
    step : int
        Transmission of an entry: 0 write, 1 put the address, 2 read back.
    symbols : list
        What is left of a transmission; empty between two of them.
    left, quarter : int
        Clocks left of a quarter; quarter of a symbol.
    line : list of int
        SIO_D in its two registers, the older second.
    caught : list of int
        Bits caught.
    """

    entries: Sequence[Entry]
    address_bytes: int = 1
    device_id: int = 0x42
    quarter_clocks: int = 250
    millisecond_clocks: int = 100_000
    attempts: int = 4
    xclk_half_clocks: int = 2
    state: str = "fetch"
    entry: int = 0
    attempt: int = 0
    step: int = 0
    symbols: list[str | int] = field(default_factory=list)
    left: int = 0
    quarter: int = 0
    line: list[int] = field(default_factory=lambda: [1, 1])
    caught: list[int] = field(default_factory=list)
    waiting: int = 0
    power_down: bool = True
    reset_n: bool = False
    levels: tuple[bool, bool] = (True, False)
    found: int | None = None
    xclk: int = 0
    xclk_left: int = 0

    def clock(self, *, sio_d: int, rst: int = 0, restart: int = 0) -> dict[str, int | None]:
        """Advance by one clock edge; return the outputs before it, None where one does not count."""
        out: dict[str, int | None] = {
            "xclk": self.xclk,
            "power_down": self.power_down,
            "reset_n": self.reset_n,
            **dict(zip(("sio_c", "sio_d_low"), self.levels, strict=True)),
            "done": self.state == "done",
            "failed": self.state == "failed",
            "entry": self.entry,
            "found": self.found,
        }
        self.xclk_left -= 1
        if self.xclk_left < 0:
            self.xclk, self.xclk_left = 1 - self.xclk, self.xclk_half_clocks - 1
        if rst:
            self.xclk, self.xclk_left = 0, 0
        sent = self._bus_edge(sio_d)
        match self.state:
            case "fetch":
                self.state = "decode"
            case "decode":
                self._decode()
            case "wait" if self.waiting == 0:
                self._advance()
            case "wait":
                self.waiting -= 1
            case "send" if sent:
                self._follow()
        if rst or restart:
            self.state, self.entry, self.attempt, self.symbols = "fetch", 0, 0, []
            self.power_down, self.reset_n = True, False
        return out

    def _bus_edge(self, sio_d: int) -> bool:
        """Advance the transmission; return True as its last clock passes."""
        seen = self.line[1]
        self.line = [sio_d, self.line[0]]
        self.levels = levels_of(self.symbols[0], self.quarter) if self.symbols else (True, False)
        if not self.symbols:
            return False
        if self.left:
            self.left -= 1
            return False
        self.left = self.quarter_clocks - 1
        if self.quarter == 2 and self.symbols != [STOP]:
            self.caught = [*self.caught[-8:], seen]
        self.quarter = (self.quarter + 1) % 4
        if self.quarter == 0:
            self.symbols.pop(0)
        return not self.symbols

    def _decode(self) -> None:
        entry = self.entries[self.entry]
        if entry.kind == Kind.PINS:
            self.power_down, self.reset_n = bool(entry.address & 2), bool(entry.address & 1)
            self.state, self.waiting = "wait", entry.data * self.millisecond_clocks
        else:
            self.state = "send"
            self._send(1 if entry.kind == Kind.CHECK else 0)

    def _send(self, step: int) -> None:
        """Begin a transmission of the entry."""
        entry = self.entries[self.entry]
        address = list(entry.address.to_bytes(2, "big"))[-self.address_bytes :]
        data = [[self.device_id, *address, entry.data], [self.device_id, *address], [self.device_id | READ, 0xFF]][step]
        self.step, self.symbols = step, [START, *bits_of(data), STOP]
        self.left, self.quarter = self.quarter_clocks - 1, 0

    def _follow(self) -> None:
        """Go on after a transmission."""
        entry = self.entries[self.entry]
        if self.step == 0 and entry.kind == Kind.PLAIN_WRITE:
            self._advance()
        elif self.step < 2:
            self._send(self.step + 1)
        else:
            self.found = int("".join(map(str, self.caught[:8])), 2)
            if self.found == entry.data:
                self._advance()
            else:
                self.attempt += 1
                self.state = "failed" if self.attempt == self.attempts else "decode"

    def _advance(self) -> None:
        self.attempt = 0
        if self.entry == len(self.entries) - 1:
            self.state = "done"
        else:
            self.entry += 1
            self.state = "fetch"
