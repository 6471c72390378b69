# SPDX-License-Identifier: Apache-2.0
"""uart_receive in every clock: bytes at several rates, breaks, noise."""

from typing import Any

import cocotb

from formal.entries import Proof
from tactile_depth.chip.link.uart import BITS, transmit
from tb.lockstep import Pins, play
from tb.stream import parameters
from tb.structures import BOTH, ICARUS, Structure

STRUCTURES = (Structure({"Divider": 4}, on=BOTH, mutants=ICARUS), Structure({"Divider": 33}))
REFUSED = {"Divider_must_be_at_least_4": "Divider=3"}
PROTOCOL = {"counts": "live & ~reset", "out_data": "counts & out_valid"}
PROOFS = tuple(
    Proof("8 bits of a counter; those in use; a byte in a trace", {"Divider": divider}, steps=4)
    for divider in (256, 33, 4)
)


class Receive:
    """The levels that cross into this clock, and the bits of the byte that comes."""

    def __init__(self, divider: int) -> None:
        self.divider, self.crossing = divider, [0, 0, 0]
        self.reset()

    def reset(self) -> None:
        self.wait = 0  # clocks to the middle of the next bit, 0 outside a byte
        self.silent = True  # until the line is high
        self.bits: list[int] = []
        self.out = {"out_valid": 0, "broken": 0}

    def clock(self, *, rst: int, line: int) -> dict[str, int]:
        """Advance by one clock edge; return the outputs before it, but those that do not count."""
        out, self.out = self.out, {"out_valid": 0, "broken": 0}
        level, *self.crossing = *self.crossing, line
        if self.wait > 1:
            self.wait -= 1
        elif self.wait:
            self.bits.append(level)
            self.wait = self.divider if self.bits[0] == 0 and len(self.bits) < BITS else 0
            if len(self.bits) == BITS:
                self.silent = not level
                self.out = {"out_valid": level, "broken": not level}
                self.out |= (
                    {"out_data": sum(bit << place for place, bit in enumerate(self.bits[1:-1]))} if level else {}
                )
        elif level:
            self.silent = False
        elif not self.silent:
            self.wait, self.bits = self.divider // 2, []
        if rst:
            self.reset()
        return out


class Line:
    """A line with bytes at about the right rate, and noise between them."""

    def __init__(self) -> None:
        self.levels: list[int] = []

    def __call__(self, _: Receive, pins: Pins) -> None:
        byte, clocks, sends = (pins.pop(name) for name in ("byte", "clocks", "sends"))
        if sends and not self.levels:
            self.levels = [level for level in transmit([byte]) for _ in range(clocks)]
        if self.levels:
            pins["line"] = self.levels.pop(0)


@cocotb.test()
async def words(dut: Any) -> None:
    (divider,) = parameters(dut, "Divider")
    choices = {"line": 1.0, "sends": 1.0, "byte": range(256), "clocks": [divider, divider - 1, divider + 1]}
    await play(dut, Receive(divider), choices, Line())
