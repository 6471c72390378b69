# SPDX-License-Identifier: Apache-2.0
"""Packets of bytes on streams of valid, ready, data and last: a bench with drivers, monitors and resets."""

import random
from collections.abc import Iterable, Sequence
from typing import Any

import cocotb
from cocotb.triggers import ClockCycles, RisingEdge

from tb.axis import AxisMonitor, AxisSink, AxisSource, profile
from tb.stream import start_clock

BYTE = ("data",)
FIELDS = ("data", "last")
# Profiles of the source and of the sink.
STREAMS = (
    ("none", "none"),
    ("random", "random"),
    ("one_in_4", "long"),
    ("long", "alternate"),
    ("none", "random"),
)
STALLED = 2000  # cycles without a byte after which a test fails; the slowest streams stall for less


def words(packet: bytes) -> list[tuple[int, int]]:
    """Return the words of a packet, last with the last of them."""
    return [(byte, int(place == len(packet) - 1)) for place, byte in enumerate(packet)]


def packets(taken: Iterable[tuple[int, int]]) -> list[bytes]:
    """Return the packets of which the words are; a packet that has not ended is left out."""
    whole, packet = [], bytearray()
    for byte, last in taken:
        packet.append(byte)
        if last:
            whole.append(bytes(packet))
            packet.clear()
    return whole


def random_packet(rng: random.Random, most: int) -> bytes:
    """Return 1 to `most` bytes; zeros are rare, frequent, or all."""
    zeros = rng.choice([0.0, 0.01, 0.3, 1.0])
    return bytes(0 if rng.random() < zeros else rng.randint(1, 255) for _ in range(rng.randint(1, most)))


class Bench:
    """Clock and reset, a source with a monitor for each stream in, a sink with a monitor for the stream out.

    Parameters
    ----------
    offers, accepts : str
        Profiles of the sources and of the sink.
    inputs : sequence of str
        Names of the streams in.
    out_fields : sequence of str
        Fields of the stream out.
    """

    def __init__(
        self,
        dut: Any,
        offers: str = "none",
        accepts: str = "none",
        inputs: Sequence[str] = ("in",),
        out_fields: Sequence[str] = FIELDS,
    ) -> None:
        self.dut, self.random = dut, random.Random(cocotb.RANDOM_SEED)
        dut.rst.value = 1
        self.sources = {
            name: AxisSource(dut, name, FIELDS, offers=profile(offers, seed)) for seed, name in enumerate(inputs)
        }
        for name in inputs:
            getattr(dut, f"{name}_data").value = 0
            getattr(dut, f"{name}_last").value = 0
        AxisSink(dut, "out", accepts=profile(accepts, len(inputs)))
        self.taken = {name: AxisMonitor(dut, name, FIELDS) for name in inputs}
        self.left = AxisMonitor(dut, "out", out_fields)

    async def start(self) -> None:
        start_clock(self.dut.clk)
        await self.reset()

    async def clocks(self, count: int) -> None:
        await ClockCycles(self.dut.clk, count)

    async def reset(self, clocks: int = 2) -> None:
        """Reset; what was offered is withdrawn, and what the monitors saw is forgotten."""
        for source in self.sources.values():
            source.abort()
        self.dut.rst.value = 1
        await self.clocks(clocks)
        self.dut.rst.value = 0
        await RisingEdge(self.dut.clk)
        for monitor in (*self.taken.values(), self.left):
            monitor.forget()

    async def until_left(self, count: int, quiet: int = 8) -> None:
        """Wait until so many words have left; after that none may come for some cycles."""
        left, idle, edge = 0, 0, RisingEdge(self.dut.clk)
        while len(self.left.words) < count:
            await edge
            idle = 0 if len(self.left.words) > left else idle + 1
            left = len(self.left.words)
            assert idle < STALLED, f"no byte has left for {idle} cycles: {left} bytes left, {count} expected"
        await self.clocks(quiet)
        assert len(self.left.words) == count, f"{len(self.left.words)} bytes left, {count} expected"
