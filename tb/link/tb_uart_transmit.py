# SPDX-License-Identifier: Apache-2.0
"""uart_transmit against tactile_depth.chip.link.uart: every level of every bit; gaps, a reset."""

import random
from itertools import groupby
from typing import Any

import cocotb
from cocotb.triggers import ClockCycles, RisingEdge

from formal.entries import Proof
from tactile_depth.chip.link.uart import BITS, receive, transmit
from tb.axis import AxisSource, profile
from tb.stream import parameters, parametrize, start_clock
from tb.structures import BOTH, ICARUS, Structure

STRUCTURES = (
    Structure({"Divider": 4}, on=BOTH, mutants=ICARUS),
    Structure(
        {"Divider": 33},
    ),
)
REFUSED = {"Divider_must_be_at_least_2": "Divider=1"}
PROTOCOL = {"stays": "in_", "counts": "live & ~reset"}
PROOFS = tuple(
    Proof("a count of bits and of their clocks, of the size in use and of all of 8 bits", {"Divider": divider}, steps=1)
    for divider in (33, 256)
)


BYTES = 40


async def start(dut: Any, offers: str) -> Any:
    """Start clock and driver, reset, and record the level of the line from then on."""
    dut.rst.value = 1
    source = AxisSource(dut, "in", ("data",), offers=profile(offers))
    start_clock(dut.clk)
    await ClockCycles(dut.clk, 3)
    dut.rst.value = 0
    await RisingEdge(dut.clk)
    levels = []

    async def watch() -> None:
        while True:
            await RisingEdge(dut.clk)
            levels.append(int(dut.line.value))

    cocotb.start_soon(watch())
    return source, levels


@cocotb.test(timeout_time=0.5, timeout_unit="ms")
@parametrize(offers=["none", "long", "random"])
async def words(dut: Any, offers: str) -> None:
    """Send every byte in order; each bit has its length, and no stop bit is shorter."""
    (divider,) = parameters(dut, "Divider")
    source, levels = await start(dut, offers)
    sent = [0, 255, *random.Random(cocotb.RANDOM_SEED).sample(range(256), BYTES)]
    await source.send([(byte,) for byte in sent])
    await ClockCycles(dut.clk, (BITS + 1) * divider)
    assert receive(levels, divider) == sent
    runs = [(level, len(list(group))) for level, group in groupby(levels)]
    for (level, clocks), (wanted, bits) in zip(
        runs[1:-1], [(level, len(list(group))) for level, group in groupby(transmit(sent))][:-1], strict=True
    ):
        assert level == wanted
        late = clocks - bits * divider  # only where a stop bit ends a run
        assert late == 0 or (level and late > 0)
        assert late <= 1 or offers != "none", "the next byte waits although the line is free"
    assert runs[-1][0] == 1


@cocotb.test(timeout_time=0.5, timeout_unit="ms")
async def reset(dut: Any) -> None:
    """Reset inside a byte: the line is high at once, and the next byte is complete."""
    (divider,) = parameters(dut, "Divider")
    source, levels = await start(dut, "none")
    cocotb.start_soon(source.send([(0,)] * 3))
    await ClockCycles(dut.clk, 5 * divider)
    source.abort()
    dut.rst.value = 1
    await ClockCycles(dut.clk, 2)
    dut.rst.value = 0
    await RisingEdge(dut.clk)
    levels.clear()
    await source.send([(0x5A,)])
    await ClockCycles(dut.clk, (BITS + 1) * divider)
    assert receive(levels, divider) == [0x5A]
