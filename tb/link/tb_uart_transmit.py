# SPDX-License-Identifier: Apache-2.0
"""uart_transmit in every clock."""

from collections.abc import Sequence
from typing import Any

import cocotb

from formal.entries import Proof
from tactile_depth.chip.link.uart import transmit
from tb.lockstep import WORD, play
from tb.stream import parameters
from tb.structures import BOTH, ICARUS, Structure

STRUCTURES = (Structure({"Divider": 4}, on=BOTH, mutants=ICARUS), Structure({"Divider": 33}))
REFUSED = {"Divider_must_be_at_least_2": "Divider=1"}
PROTOCOL = {"stays": "in_", "counts": "live & ~reset"}
PROOFS = tuple(
    Proof("a count of bits and of their clocks, of the size in use and of all of 8 bits", {"Divider": divider}, steps=1)
    for divider in (33, 256)
)


class Transmit:
    """The levels of the byte on the line, one for each clock that is left of it."""

    levels: Sequence[int] = ()

    def __init__(self, divider: int) -> None:
        self.divider = divider

    def clock(self, *, rst: int, in_valid: int, in_data: int) -> dict[str, int]:
        """Advance by one clock edge; return the outputs before it."""
        out = {"in_ready": not self.levels, "line": self.levels[0] if self.levels else 1}
        if in_valid and not self.levels:
            self.levels = [level for level in transmit([in_data]) for _ in range(self.divider)]
        else:
            self.levels = self.levels[1:]
        if rst:
            self.levels = ()
        return out


@cocotb.test()
async def words(dut: Any) -> None:
    await play(dut, Transmit(*parameters(dut, "Divider")), {"in_valid": 1.0, "in_data": WORD}, offers=["in"])
