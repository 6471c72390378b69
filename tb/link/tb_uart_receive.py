# SPDX-License-Identifier: Apache-2.0
"""uart_receive against tactile_depth.chip.link.uart: bytes at several rates, gaps, breaks, noise, resets."""

import random
from typing import Any

import cocotb
from cocotb.triggers import ClockCycles, RisingEdge

from formal.entries import Proof
from tactile_depth.chip.link.uart import receive, transmit
from tb.stream import parameters, parametrize, start_clock
from tb.structures import BOTH, ICARUS, Structure

STRUCTURES = (
    Structure({"Divider": 4}, on=BOTH, mutants=ICARUS),
    Structure(
        {"Divider": 33},
    ),
)
REFUSED = {"Divider_must_be_at_least_4": "Divider=3"}
PROTOCOL = {"counts": "live & ~reset", "out_data": "counts & out_valid"}
PROOFS = (
    Proof(
        "clocks of a bit are only counted",
    ),
)


BYTES = 40
LEVELS = 120
TOLERANCE = 0.04  # of the rate


def line_of(data: Any, clocks_a_bit: Any, gaps: Any) -> Any:
    """Return the level of the line in each cycle; `gaps` gives the idle cycles after each byte."""
    levels, time = [1] * 8, 0.0
    for byte in data:
        start = len(levels)
        time = 0.0
        for level in transmit([byte]):
            time += clocks_a_bit
            levels += [level] * (start + round(time) - len(levels))
        levels += [1] * next(gaps)
    return levels


async def play(dut: Any, levels: Any, resets: Any = ()) -> Any:
    """Drive the pin with levels, the first of them in a reset, and those of `resets`; return the bytes received."""
    edge = RisingEdge(dut.clk)
    received: list[Any] = []
    (divider,) = parameters(dut, "Divider")
    dut.rst.value, dut.line.value = 1, levels[0]
    start_clock(dut.clk)
    await ClockCycles(dut.clk, 8)
    dut.rst.value = 0
    for clock, level in enumerate([*levels, *[levels[-1]] * 12 * divider]):
        dut.line.value, dut.rst.value = level, int(clock in resets)
        await edge
        assert not (dut.out_valid.value and dut.broken.value)
        if dut.broken.value:
            received.append(None)
        elif dut.out_valid.value:
            received.append(int(dut.out_data.value))
    return received


@cocotb.test(timeout_time=0.5, timeout_unit="ms")
@parametrize((("off", "gap"), [(0, 0), (0, 40), (-TOLERANCE, 0), (TOLERANCE, 0)]))
async def words(dut: Any, off: Any, gap: Any) -> None:
    """Receive every byte, also back to back, from a sender that is slower or faster."""
    (divider,) = parameters(dut, "Divider")
    rng = random.Random(cocotb.RANDOM_SEED)
    sent = [0, 255, *rng.sample(range(256), BYTES)]
    if off and divider < 1 / TOLERANCE:
        return  # a bit of so few cycles cannot represent so small a deviation
    levels = line_of(sent, divider * (1 + off), iter(lambda: rng.randint(0, gap), None))
    assert receive(levels + [1] * divider, divider) == sent
    assert await play(dut, levels) == sent


@cocotb.test(timeout_time=0.5, timeout_unit="ms")
@parametrize(longest=[1, 3, 12])
async def noise(dut: Any, longest: Any) -> None:
    """Receive levels of random length: glitches, breaks, bytes that begin at any time."""
    (divider,) = parameters(dut, "Divider")
    rng = random.Random(cocotb.RANDOM_SEED)
    levels = [1] * 8
    for level in range(LEVELS * 12 // longest):
        levels += [level % 2] * rng.randint(1, longest * divider)
    levels += [1] * 12 * divider
    expected = receive(levels, divider)
    assert longest == 1 or None in expected
    assert await play(dut, levels) == expected


@cocotb.test(timeout_time=0.5, timeout_unit="ms")
@parametrize(rate=[0.1, 0.01])
async def resets(dut: Any, rate: float) -> None:
    """Reset in any clock of bytes and breaks: nothing of them is left, and bytes come once the line is high."""
    (divider,) = parameters(dut, "Divider")
    rng = random.Random(cocotb.RANDOM_SEED)
    levels = line_of(rng.sample(range(256), BYTES), divider, iter(lambda: rng.randint(0, 2 * divider), None))
    for _ in range(BYTES // 2):  # breaks
        first = rng.randrange(len(levels))
        levels[first : first + 12 * divider] = [0] * 12 * divider
    levels += [1] * 12 * divider
    clocks = [clock for clock in range(3, len(levels)) if rng.random() < rate * 4 / divider]
    starts, ends = [0, *(clock - 2 for clock in clocks)], [*(clock - 3 for clock in clocks), len(levels)]
    expected = [byte for start, end in zip(starts, ends, strict=True) for byte in receive(levels[start:end], divider)]
    assert await play(dut, levels, set(clocks)) == expected


@cocotb.test(timeout_time=0.5, timeout_unit="ms")
async def a_reset_in_each_part_of_a_byte(dut: Any) -> None:
    """Reset in each clock of a byte, or in some where a bit has many: it does not come, the next one does."""
    (divider,) = parameters(dut, "Divider")
    levels, clocks, expected = [1] * 8, [], []
    for offset in range(4, 9 * divider + divider // 2 + 4, max(1, divider // 6)):
        clocks.append(len(levels) + offset)
        levels += [level for level in transmit([0xFF]) for _ in range(divider)] + [1] * 4
        levels += [level for level in transmit([offset % 256]) for _ in range(divider)] + [1] * divider
        expected.append(offset % 256)
    assert await play(dut, levels, set(clocks)) == expected
