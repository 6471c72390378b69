# SPDX-License-Identifier: Apache-2.0
"""uart_receive against tactile_depth.boards.uart: bytes at rates that differ, gaps, breaks, noise, resets."""

import os
import random
from typing import Any

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import ClockCycles, RisingEdge

from tactile_depth.boards.uart import receive, transmit
from tb.stream import CLOCK_NS, parameters

BYTES = 40
LEVELS = 120
TOLERANCE = 0.04  # of the rate


def line_of(data: Any, clocks_a_bit: Any, gaps: Any) -> Any:
    """Levels in each clock; `gaps` gives the clocks of silence after a byte."""
    levels, time = [1] * 8, 0.0
    for byte in data:
        start = len(levels)
        time = 0.0
        for level in transmit([byte]):
            time += clocks_a_bit
            levels += [level] * (start + round(time) - len(levels))
        levels += [1] * next(gaps)
    return levels


async def play(dut: Any, levels: Any) -> Any:
    """Play levels on the pin, the first of them in a reset; return the bytes received."""
    dut._log.info("SEED=%s", os.environ["COCOTB_RANDOM_SEED"])
    edge = RisingEdge(dut.clk)
    found: list[Any] = []
    (divider,) = parameters(dut, "Divider")
    dut.rst.value, dut.line.value = 1, levels[0]
    Clock(dut.clk, CLOCK_NS, unit="ns", impl="gpi").start(start_high=False)
    await ClockCycles(dut.clk, 8)
    dut.rst.value = 0
    for level in [*levels, *[levels[-1]] * 12 * divider]:
        dut.line.value = level
        await edge
        assert not (dut.out_valid.value and dut.broken.value)
        if dut.broken.value:
            found.append(None)
        elif dut.out_valid.value:
            found.append(int(dut.out_data.value))
    return found


@cocotb.test(timeout_time=2, timeout_unit="ms")
@cocotb.parametrize((("off", "gap"), [(0, 0), (0, 40), (-TOLERANCE, 0), (TOLERANCE, 0)]))
async def words(dut: Any, off: Any, gap: Any) -> None:
    """Every byte, back to back too, from a sender that is slower or faster."""
    (divider,) = parameters(dut, "Divider")
    rng = random.Random(cocotb.RANDOM_SEED)
    sent = [0, 255, *rng.sample(range(256), BYTES)]
    if off and divider < 1 / TOLERANCE:
        return  # a bit of so few clocks cannot be off by that little
    levels = line_of(sent, divider * (1 + off), iter(lambda: rng.randint(0, gap), None))
    assert receive(levels + [1] * divider, divider) == sent
    assert await play(dut, levels) == sent


@cocotb.test(timeout_time=2, timeout_unit="ms")
@cocotb.parametrize(longest=[1, 3, 12])
async def noise(dut: Any, longest: Any) -> None:
    """Levels of any length, in bits: glitches, breaks, bytes that begin anywhere."""
    (divider,) = parameters(dut, "Divider")
    rng = random.Random(cocotb.RANDOM_SEED)
    levels = [1] * 8
    for level in range(LEVELS):
        levels += [level % 2] * rng.randint(1, longest * divider)
    levels += [1] * 12 * divider
    expected = receive(levels, divider)
    assert longest == 1 or None in expected
    assert await play(dut, levels) == expected
