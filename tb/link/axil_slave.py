# SPDX-License-Identifier: Apache-2.0
"""AXI4-Lite slave behind `m_axil_*`: it answers when it likes, checks the rules, and reaches registers that log."""

from __future__ import annotations

import random
from collections.abc import Iterator
from typing import Any

from tb.pins import by_name
from tb.stream import at_every_edge

CHANNELS = {"aw": ("awaddr",), "w": ("wdata",), "ar": ("araddr",)}


class Registers:
    """Registers whose values differ from read to read, of which some are refused; every access is logged.

    Parameters
    ----------
    address_width : int
        Accesses of addresses with bits above are refused without an entry of the log.
    """

    def __init__(self, address_width: int) -> None:
        self.address_width = address_width
        self.log: list[tuple[int, int | None]] = []  # address, and the value of a write

    def refuses(self, address: int) -> bool:
        """Return whether the port refuses this address."""
        return address & 3 == 3

    def read(self, address: int) -> int | None:
        """Return the value of a register, None if the access is refused."""
        if address >> self.address_width:
            return None
        self.log.append((address, None))
        value = random.Random(f"{address} {len(self.log)}").getrandbits(32)
        return None if self.refuses(address) else value

    def write(self, address: int, value: int) -> bool:
        """Write a register; return False if the access is refused."""
        if address >> self.address_width:
            return False
        self.log.append((address, value))
        return not self.refuses(address)


class AxilSlave:
    """Slave whose readys and answers come by a profile.

    Attributes
    ----------
    registers : Registers
        Those behind the port. A reset of the bench puts new ones here.
    """

    def __init__(self, dut: Any, registers: Registers, moves: Iterator[bool], seed: int) -> None:
        self.dut, self.registers, self.moves = dut, registers, moves
        self.random = random.Random(seed)
        self.read = by_name(dut)
        self.clear()
        at_every_edge(dut.clk, self._run())

    def pin(self, name: str) -> Any:
        return getattr(self.dut, f"m_axil_{name}")

    def clear(self) -> None:
        """Forget what is on its way."""
        self.taken: dict[str, int] = {}  # channel to the word that was taken, and is not answered
        self.held: dict[str, int] = {}  # channel to the word that was offered, and is not taken
        self.answer: str | None = None  # channel of the answer that is offered
        for name in ("awready", "wready", "bvalid", "arready", "rvalid"):
            self.pin(name).value = 0
        self.ready = dict.fromkeys(CHANNELS, 0)  # at the pins

    def _run(self) -> Iterator[None]:
        while True:
            yield
            if self.read("rst"):
                self.clear()
                continue
            self._take()
            self._answer()

    def _take(self) -> None:
        for channel, (word,) in CHANNELS.items():
            if not self.read(f"m_axil_{channel}valid"):
                assert channel not in self.held, f"{channel}valid fell before {channel}ready came"
            else:
                value = self.read(f"m_axil_{word}")
                assert self.held.get(channel, value) == value, f"{word} changed before {channel}ready came"
                assert channel not in self.taken, f"{channel}: two accesses at a time"
                assert self.answer is None, f"{channel}: an access before the answer to the last"
                self.held[channel] = value
                if self.ready[channel]:
                    self.taken[channel] = self.held.pop(channel)
            ready = int(next(self.moves))
            if self.ready[channel] != ready:  # a write costs more than a read
                self.pin(f"{channel}ready").value = self.ready[channel] = ready

    def _answer(self) -> None:
        if self.answer is not None:
            if not self.read(f"m_axil_{self.answer}ready"):
                return
            self.pin(f"{self.answer}valid").value = 0
            self.answer = None
            self.taken.clear()
        whole = "ar" in self.taken or len(self.taken) > 1
        if not whole or not next(self.moves):
            return
        if "ar" in self.taken:
            assert len(self.taken) == 1, "a read and a write at a time"
            value = self.registers.read(self.taken["ar"])
            refused = value is None
            self.pin("rdata").value = self.random.getrandbits(32) if value is None else value
            self.answer = "r"
        else:
            refused = not self.registers.write(self.taken["aw"], self.taken["w"])
            self.answer = "b"
        self.pin(f"{self.answer}resp").value = self.random.randint(1, 3) if refused else 0
        self.pin(f"{self.answer}valid").value = 1
