# SPDX-License-Identifier: Apache-2.0
"""divergence against its model: codes, latency; frame on frame with gaps, pauses, extremes, reset."""

from typing import Any

import cocotb
import numpy as np

from formal.entries import Proof
from tactile_depth.chip.poisson.divergence import LATENCY, divergence
from tactile_depth.chip.poisson.raster_check import LAST_COLUMN
from tb.stream import (
    Bench,
    StreamDriver,
    StreamMonitor,
    check_frame_starts,
    check_maps,
    drive,
    extremes,
    parameters,
    parametrize,
    raster,
    send_words,
    uniform,
)
from tb.structures import ICARUS, VERILATOR, of_parameters

built = of_parameters("Columns Width Neumann Parity")
STRUCTURES = (
    built(16, 21, 0, 1, on=VERILATOR),
    built(16, 6, 0, 0, on=ICARUS),
    built(32, 24, 1, 1, on=ICARUS),
    built(128, 35, 0, 0),
    built(16, 21, 1, 0),
    built(4, 3, 1, 0, mutants=ICARUS),
    built(4, 3, 0, 1, mutants=ICARUS),
)
PROOFS = tuple(
    Proof("the subtractions are exact at any width; columns and rows are only counted", {"Neumann": neumann})
    for neumann in (0, 1)
)


FIELDS = ["gx", "gy", "position"]


def pixels(gradient: Any) -> Any:
    """Return gradients (frames, rows, columns, 2) as words of FIELDS."""
    frames, rows, columns, _ = gradient.shape
    positions = np.array(frames * raster(rows, columns)).reshape(frames, rows, columns, 1)
    return np.concatenate((gradient, positions), axis=-1).reshape(-1, len(FIELDS)).tolist()


async def check(dut: Any, gradient: Any, gap: float = 0.0, pause: float = 0.0, interrupts: Any = ()) -> None:
    (neumann,) = parameters(dut, "Neumann")
    bench = Bench(dut, pause)
    driver = StreamDriver(dut, "in", "valid", FIELDS)
    source = StreamMonitor(dut, "in", "valid", FIELDS, unsigned=FIELDS[2:])
    sink = StreamMonitor(dut, "out", "valid", ["data"])
    words = pixels(gradient)
    await send_words(bench, driver, source, sink, words, gap=gap, interrupts=interrupts, quiet=LATENCY + 2)
    check_maps(sink.words, divergence(gradient, bool(neumann)))
    assert sink.starts == [clock + LATENCY for clock in source.starts]
    check_frame_starts([sink], gradient[0, ..., 0].size)


@cocotb.test
@parametrize((("gap", "pause"), [(0.0, 0.0), (0.1, 0.3), (0.7, 0.0)]), ("rows", [1, 4]))
async def frames(dut: Any, gap: float, pause: float, rows: int) -> None:
    width, columns = parameters(dut, "Width", "Columns")
    await check(dut, uniform((3, rows, columns, 2), width), gap, pause)


@cocotb.test
async def limits(dut: Any) -> None:
    """Send rows of each kind of limits, then with their fields exchanged; the last frame is a chequer board.

    On the board all neighbours are at opposite limits, which gives the largest and the smallest results.
    """
    width, columns = parameters(dut, "Width", "Columns")
    rows = extremes(columns, width, 2)
    board = np.where(np.indices((2, columns)).sum(axis=0) % 2, -(1 << (width - 1)), (1 << (width - 1)) - 1)
    frames = [np.stack((rows, rows[:, :, ::-1]), axis=1), np.stack((board, board), axis=-1)[None]]
    await check(dut, np.concatenate(frames))


@cocotb.test
async def reset_in_mid_frame(dut: Any) -> None:
    """Reset at each of the first words, and in the second row."""
    width, columns = parameters(dut, "Width", "Columns")
    await check(dut, uniform((2, 4, columns, 2), width), interrupts=[1, 2, 3, 4, columns, 3 * columns // 2])


@cocotb.test
async def columns_are_counted(dut: Any) -> None:
    """Change the mark of the last column at some pixels: with parity each is told a cycle later, and no other."""
    width, columns, parity = parameters(dut, "Width", "Columns", "Parity")
    words = pixels(uniform((1, 8, columns, 2), width))
    chance = np.random.default_rng(cocotb.RANDOM_SEED)
    wrong = [n > 2 * columns and chance.random() < 0.1 for n in range(len(words))]  # when the line has been written
    mask = (1 << width) - 1
    stimuli = [
        {"rst": 0, "in_valid": 1, "in_gx": gx & mask, "in_gy": gy & mask, "in_position": position ^ LAST_COLUMN * odd}
        for (gx, gy, position), odd in zip(words, wrong, strict=True)
    ]
    pins = await drive(dut, stimuli, ["flipped"])
    told = [bool(int(flag)) for flag in pins["flipped"][columns + 4 :]]
    assert told == [odd and bool(parity) for odd in wrong[columns + 3 : -1]]
