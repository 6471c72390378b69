# SPDX-License-Identifier: Apache-2.0
"""divergence_sums against its model: the sums of every row and their cycles; gaps, pauses, extremes, a new start."""

from typing import Any

import cocotb
import numpy as np
from cocotb.triggers import RisingEdge

from formal.entries import Proof
from tactile_depth.chip.poisson.divergence_sums import LATENCY_BEHIND_STEPS, SUMS, divergence_sums
from tactile_depth.chip.poisson.self_check import wrapped
from tb.pins import Driver, by_name
from tb.stream import drive, parameters, parametrize, start_clock, uniform
from tb.structures import ICARUS, VERILATOR, of_parameters

NAMES = "Columns Width Dropped Scale ScaleFraction SumWidth LastFirst"
built = of_parameters(NAMES)
STRUCTURES = (
    built(128, 15, 5, 32255, 15, 11, 1, on=VERILATOR),
    built(32, 9, 0, 101, 7, 10, 0, on=ICARUS, mutants=ICARUS),
    built(32, 8, 2, 90, 7, 18, 1, on=ICARUS, mutants=ICARUS),
    built(64, 24, 3, 14564, 14, 23, 0),
)
PROTOCOL = {"counts": "live", "out_data out_frame_start": "live & out_valid"}
PROOFS = (
    Proof("the longest and the shortest time of a row", {"LastFirst": 1}),
    Proof("the sums in order", {"LastFirst": 0}),
)
FRAMES = 3


async def check(dut: Any, f: Any, gap: float = 0.0, pause: float = 0.0, strays: int = 0) -> None:
    """Send frames f (frames, rows, columns); `strays` words of an incomplete frame come before the last frame."""
    columns, _, dropped, scale, fraction, width, last_first = parameters(dut, *NAMES.split())
    chance = np.random.default_rng(cocotb.RANDOM_SEED)
    stimuli: list[dict[str, int]] = []
    ends, wanted, begins, incomplete = [], [], [], range(0)
    idle = {"in_valid": 0, "in_frame_start": 0, "in_data": 0, "rst": 0}
    want = wrapped(divergence_sums(f, dropped, scale, fraction), width)
    for frame, rows in enumerate(f):
        words = rows.ravel().tolist()
        if frame == len(f) - 1 and strays:
            begun = len(stimuli)
            stimuli += [
                idle | {"in_valid": 1, "in_frame_start": int(n == 0), "in_data": words[n]} for n in range(strays)
            ]
            stimuli += [idle | {"rst": 1}]
            incomplete = range(begun, len(stimuli))
        for n, word in enumerate(words):
            while chance.random() < gap:
                stimuli.append(idle | {"in_frame_start": int(n == 0), "in_data": int(chance.integers(-4, 4))})
            stimuli.append(idle | {"in_valid": 1, "in_frame_start": int(n == 0), "in_data": word})
            if n % columns == columns - 1:
                ends.append(len(stimuli) - 1)
                begins += [n < columns and not k for k in range(SUMS)]
                wanted.append(want[frame, n // columns][:: -1 if last_first else 1])
        if strays:  # the sums of the last row leave before the reset
            stimuli += [idle] * (SUMS * (fraction + 1) + LATENCY_BEHIND_STEPS)
    stimuli += [idle] * (SUMS * (fraction + 1) + LATENCY_BEHIND_STEPS + 8)
    pins = await drive(dut, stimuli, ["out_valid", "out_frame_start", "out_data"], pause)
    due = [end + LATENCY_BEHIND_STEPS + fraction + n * (fraction + 1) for end in ends for n in range(SUMS)]
    valid = np.array([int(value) for value in pins["out_valid"]])
    np.testing.assert_array_equal([clock for clock in np.flatnonzero(valid) if clock not in incomplete], due)
    np.testing.assert_array_equal([pins["out_data"][clock].to_signed() for clock in due], np.concatenate(wanted))
    assert [bool(pins["out_frame_start"][clock]) for clock in due] == begins


@cocotb.test
@parametrize((("gap", "pause"), [(0.0, 0.0), (0.3, 0.3)]), ("amplitude", [1.0, None]))
async def frames(dut: Any, gap: float, pause: float, amplitude: float | None) -> None:
    columns, width = parameters(dut, "Columns", "Width")
    await check(dut, uniform((FRAMES, 3, columns), width, amplitude), gap, pause)


@cocotb.test
async def limits(dut: Any) -> None:
    """Send rows of the highest word, of the lowest, and of zeros."""
    columns, width = parameters(dut, "Columns", "Width")
    high = (1 << (width - 1)) - 1
    rows = np.array([high, ~high, 0, 1, -1])[None, :, None] * np.ones((1, 1, columns), np.int64)
    await check(dut, rows)


@cocotb.test
@parametrize(strays=[1, 5, 31, 43, 63])
async def a_reset_in_mid_row(dut: Any, strays: int) -> None:
    columns, width = parameters(dut, "Columns", "Width")
    await check(dut, uniform((2, 3, columns), width), strays=strays)


@cocotb.test
async def a_reset_in_which_en_is_low(dut: Any) -> None:
    """Reset in each clock in which the first sum of a row of the lowest words is made, with `en` low as in the whole.

    What it leaves would make the next sum 1 too small, mostly one of 0.
    """
    columns, width, dropped, scale, fraction, sum_width, last_first = parameters(dut, *NAMES.split())
    edge, write, valid = RisingEdge(dut.clk), Driver(dut), by_name(dut)
    start_clock(dut.clk)
    zeros = np.zeros((1, 1, columns), np.int64)
    want = wrapped(divergence_sums(zeros, dropped, scale, fraction), sum_width)[0, 0, :: -1 if last_first else 1]
    got: list[int] = []
    for clocks in range(LATENCY_BEHIND_STEPS + fraction):
        for word, idle in ((-1 << (width - 1), clocks), (0, SUMS * (fraction + 1) + LATENCY_BEHIND_STEPS)):
            write(rst=1, en=0)
            await edge
            write(rst=0, en=1)
            got.clear()
            for n in range(columns + idle):
                write(in_valid=n < columns, in_frame_start=not n, in_data=word)
                await edge
                if valid("out_valid"):
                    got.append(dut.out_data.value.to_signed())
        np.testing.assert_array_equal(got, want)
