# SPDX-License-Identifier: Apache-2.0
"""row_sums against its model: rows of extremes and of random samples, gaps, pauses, resets."""

from typing import Any

import cocotb
import numpy as np

from formal.entries import Proof
from tactile_depth.chip.camera.row_sums import LATENCY, red_columns, row_sums
from tb.camera.slots import Slot, Slots, Window, packed, unpacked
from tb.stream import drive, extremes, parameters, parametrize, uniform
from tb.structures import BOTH, ICARUS, of_parameters

built = of_parameters("Numerator Denominator Width Bayer")
STRUCTURES = (
    built(15, 4, 12, 1, on=BOTH),
    built(4, 3, 6, 0, on=ICARUS, mutants=ICARUS),
    built(5, 2, 5, 1, on=ICARUS, mutants=ICARUS),
    built(1, 1, 10, 0),
    built(8, 1, 14, 1),
    built(15, 4, 10, 0),
    built(2, 1, 10, 1),
    built(4, 3, 10, 0),
)
PROTOCOL = {
    "begun": {"begins": "en & in_valid"},
    "holds": "rst | ~in_valid | begun | in_row_start",
    "counts": "live & ~reset",
    "out_sums out_red_columns": "counts & out_ends",
}
PROOFS = tuple(
    Proof("sums are exact at any width", {"Numerator": numerator, "Denominator": denominator, "Bayer": bayer})
    for numerator, denominator, bayer in ((1, 1, 0), (4, 3, 0), (2, 1, 1), (5, 2, 1))
)


BLOCKS = 8


@cocotb.test(timeout_time=2, timeout_unit="ms")
@parametrize((("gap", "pause"), [(0.0, 0.0), (0.4, 0.0), (0.3, 0.3)]))
async def rows(dut: Any, gap: float, pause: float) -> None:
    numerator, denominator, width, bayer = parameters(dut, "Numerator", "Denominator", "Width", "Bayer")
    window = Window(1, BLOCKS, numerator, denominator)
    channels, lanes = (1, 2) if bayer else (3, 3)
    sum_width = len(dut.out_sums) // lanes
    slots = Slots({"in_samples": channels * width, "in_blue_column": 1, "in_row_start": 1}, ("in_valid", "rst"))
    samples = np.concatenate(
        (
            extremes(window.width, width, channels),
            np.tile(extremes(1, width)[1:3], (1, window.width, channels)),
            uniform(8 * window.width * channels, width).reshape(8, window.width, channels),
        )
    )
    blue = np.array([slots.random.getrandbits(1) for _ in samples])[:, None] + np.arange(window.width) & 1
    stimuli = [slots.idle(rst=1)] * 2
    for row, columns in zip(samples, blue, strict=True):
        words = [
            {"in_samples": packed(pixel, width), "in_blue_column": int(column), "in_row_start": int(place == 0)}
            for place, (pixel, column) in enumerate(zip(row, columns, strict=True))
        ]
        if slots.random.random() < 0.2:  # a row that is cut short
            stimuli += slots.apart(words[: slots.random.randrange(1, len(words))], gap)
        stimuli += slots.apart(words, gap)
    stimuli += [slots.idle() for _ in range(LATENCY + 1)]
    outputs = ["out_ends", "out_sums", "out_red_columns"]
    pins = await drive(dut, stimuli, outputs, pause)

    taken: list[Any] = []  # pixels of the row, as they came in
    for clock in range(len(stimuli) - LATENCY):
        if pins["rst"][clock]:
            continue
        ends = False
        if pins["in_valid"][clock]:
            if pins["in_row_start"][clock]:
                taken = []
            ends = bool(window.column_ends[len(taken)])
            taken.append((unpacked(pins["in_samples"][clock], width, channels), int(pins["in_blue_column"][clock])))
        after = clock + LATENCY
        assert bool(pins["out_ends"][after]) == ends, f"clock {clock}"
        if ends:
            row, columns = np.array([pixel for pixel, _ in taken]), np.array([blue for _, blue in taken]) == 1
            args = (numerator, denominator)
            want = row_sums(row[None, :, 0], columns, *args) if bayer else row_sums(row[None], None, *args)
            assert unpacked(pins["out_sums"][after], sum_width, lanes) == want[0, -1].tolist(), f"clock {clock}"
            if bayer:
                assert int(pins["out_red_columns"][after]) == red_columns(columns, *args)[-1]


@cocotb.test
async def a_reset_forgets_what_is_inside(dut: Any) -> None:
    """Reset in a row: blocks end in every cycle before the reset, and none after it."""
    slots = Slots({"in_samples": len(dut.in_samples), "in_blue_column": 1}, ("in_valid", "in_row_start", "rst"))
    numerator, denominator = parameters(dut, "Numerator", "Denominator")
    width = Window(1, BLOCKS, numerator, denominator).width
    row = [slots.idle(in_valid=1, in_row_start=int(place == 0)) for place in range(width)]
    stimuli: list[Slot] = []
    for length in range(1, width + 1):
        stimuli += [*row[:length], slots.idle(rst=1), *[slots.idle() for _ in range(LATENCY + 1)]]
    pins = await drive(dut, stimuli, ["out_ends"])
    silent = 0  # clocks since a reset, without a pixel
    for clock in range(len(stimuli)):
        assert not (silent and int(pins["out_ends"][clock])), f"clock {clock}"
        silent = 0 if pins["in_valid"][clock] else silent + int(pins["rst"][clock] or silent > 0)
