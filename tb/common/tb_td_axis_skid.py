# SPDX-License-Identifier: Apache-2.0
"""td_axis_skid against tactile_depth.chip.common.td_axis_skid, every output in every cycle; gaps, stalls, resets."""

import random
from typing import Any

import cocotb
from cocotb.triggers import ClockCycles, RisingEdge

from formal.entries import WORD_FREE, Proof
from tactile_depth.chip.common.td_axis_skid import AxisSkid
from tb.axis import PROFILES, AxisMonitor, AxisSink, AxisSource, profile
from tb.pins import by_name
from tb.stream import REGRESS, parameters, parametrize, sample, start_clock
from tb.structures import BOTH, ICARUS, Structure

STRUCTURES = (Structure({"Width": 26}, on=BOTH, mutants=ICARUS),)
PROTOCOL = {"counts": "live", "m_data": "live & m_valid"}
PROOFS = (Proof(WORD_FREE),)


WORDS = 600 if REGRESS else 200
FIELDS = ("data",)


async def follow(dut: Any) -> None:
    """Compare ready, valid and data with the model, which is fed from the pins."""
    model, read, edge = AxisSkid(), by_name(dut), RisingEdge(dut.clk)
    await edge  # of the first reset: before it everything is unknown
    while True:
        await edge
        assert read("s_ready") == model.ready, "s_ready"
        assert read("m_valid") == model.valid, "m_valid"
        if model.valid:
            assert read("m_data") == model.words[0], "m_data"
        if read("rst"):
            model.reset()
        else:
            model.clock(read("s_data") if read("s_valid") else None, bool(read("m_ready")))


async def reset(dut: Any, clocks: int = 3) -> None:
    dut.rst.value = 1
    await ClockCycles(dut.clk, clocks)
    dut.rst.value = 0
    await RisingEdge(dut.clk)  # AXI: the first edge out of reset comes before the first word


async def start(dut: Any, offers: str, accepts: str) -> Any:
    """Start clock, drivers, monitors and model, and reset."""
    dut.rst.value, dut.s_data.value = 1, 0
    source = AxisSource(dut, "s", FIELDS, offers=profile(offers, 1))
    AxisSink(dut, "m", accepts=profile(accepts, 2))
    taken, left = (AxisMonitor(dut, side, FIELDS) for side in "sm")
    start_clock(dut.clk)
    cocotb.start_soon(follow(dut))
    await reset(dut)
    return source, taken, left


def random_words(dut: Any, count: int) -> list[Any]:
    (width,) = parameters(dut, "Width")
    rng = random.Random(cocotb.RANDOM_SEED)
    return [(rng.getrandbits(width),) for _ in range(count)]


@cocotb.test(timeout_time=1, timeout_unit="ms")
@parametrize(offers=list(PROFILES), accepts=list(PROFILES))
async def words(dut: Any, offers: str, accepts: str) -> None:
    """Send words: all leave in order, at full rate each one cycle after it entered."""
    source, taken, left = await start(dut, offers, accepts)
    sent = random_words(dut, WORDS)
    await source.send(sent)
    while len(left.words) < len(taken.words):
        await RisingEdge(dut.clk)
    await ClockCycles(dut.clk, 4)
    assert taken.words == sent
    assert left.words == sent
    if accepts == "none":
        assert {after - before for before, after in zip(taken.taken, left.taken, strict=True)} == {1}


@cocotb.test(timeout_time=1, timeout_unit="ms")
@parametrize(accepts=["none", "alternate", "long"], clocks=sample([1, 2, 5]))
async def resets(dut: Any, accepts: Any, clocks: int) -> None:
    """Reset in every phase: no word from before the reset leaves, and none from after it is lost."""
    source, taken, left = await start(dut, "none", accepts)
    sent = random_words(dut, 200)
    for phase in (1, 2, 3, 4, 151, 153):
        cocotb.start_soon(source.send(sent))
        await ClockCycles(dut.clk, phase)
        source.abort()
        await reset(dut, clocks)
        taken.forget()
        left.forget()
        await source.send(sent)
        while len(left.words) < len(sent):
            await RisingEdge(dut.clk)
        assert taken.words == sent
        assert left.words == sent, f"reset after {phase} clocks"
