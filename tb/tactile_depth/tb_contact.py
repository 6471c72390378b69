# SPDX-License-Identifier: Apache-2.0
"""`contact` and the records of contact events of tactile_depth, with thresholds and areas at their limits."""

from typing import Any

import numpy as np
from cocotb.triggers import ClockCycles

from tb.selection import Level, case, up_to
from tb.stream import parametrize, sample
from tb.tactile_depth.bench import CONTROL, started


@case(Level.FORMATS, whole_rows=True)
@parametrize(accepts=up_to({Level.FORMATS: ["none"], Level.WHOLE: ["random"]}))
async def contact(dut: Any, accepts: str) -> None:
    """Check `contact`: set by the deciding beat, cleared by the first beat of the next frame, held by its register
    bit."""
    pipeline = await started(dut, accepts=accepts)
    pressed, flat = pipeline.pressed(), pipeline.plain()
    codes = pipeline.depth_of(pressed, flat)
    flat_peak, peak = int(codes[1].max()), int(codes[0].max())
    assert flat_peak < peak, "the test is void: the press is not deeper than the frame without contact"

    for level in ("its value after reset", "the peak"):
        await pipeline.play(pressed)
        assert not pipeline.contact.comparator.contact, f"contact was set with the threshold at {level}"
        await pipeline.write("THRESHOLD", peak)

    await pipeline.write("THRESHOLD", peak - 1)
    await pipeline.send(pressed)
    await pipeline.idle()
    await pipeline.until(lambda: len(pipeline.out.words) == pipeline.pixels)
    await ClockCycles(dut.clk, 2)
    deciding = int(np.argmax(codes[0]))
    assert pipeline.contact.raised == [pipeline.out.taken[deciding] + 1]
    await pipeline.check()
    assert dut.contact.value

    await pipeline.play(flat)
    assert not dut.contact.value

    await pipeline.write("CONTROL", CONTROL.pack(hold_contact=1))
    await pipeline.play(pressed, flat, flat)
    assert dut.contact.value, "not held"
    await pipeline.write("CONTROL", 0)
    await ClockCycles(dut.clk, 2)
    assert not dut.contact.value, "contact is still held after hold_contact was cleared"
    await pipeline.play(flat)
    assert not dut.contact.value

    await pipeline.play(pressed, flat, pressed)
    assert dut.contact.value


@case()
async def records_at_the_limits(dut: Any) -> None:
    """Set both thresholds to a depth of the frame and one below it, and the least area to that of the frame and one
    above."""
    pipeline = await started(dut)
    pressed = pipeline.pressed()
    codes = pipeline.depth_of(pressed)
    depths = np.unique(codes)
    chosen = sample([int(depth) for depth in depths[:: max(1, len(depths) // 4)]])
    # One threshold always decides at once, against the decision of the other one on the previous frame.
    for name, other, always in (
        ("THRESHOLD", "OFF_THRESHOLD", int(depths[-1])),
        ("OFF_THRESHOLD", "THRESHOLD", int(depths[0])),
    ):
        await pipeline.write(other, always)
        for depth in chosen:
            for code in (depth, depth - 1):
                await pipeline.write(name, code)
                await pipeline.send(pressed, pressed)
                await pipeline.check(counters=False)
    # Most depths are below 0, then all: first the sum is negative, at last the peak and the thresholds too.
    sunk = pipeline.frame_of(np.full((pipeline.rows, pipeline.columns, 2), 0.5))
    peak = int(pipeline.depth_of(sunk).max())
    assert peak < 0
    lowest = -(1 << pipeline.config.data_width - 1)
    for frame, threshold, of_area in (
        (pipeline.pressed(-0.5), lowest, lowest),
        (sunk, peak, lowest),
        (sunk, peak - 1, lowest),
        (sunk, lowest, peak - 1),
    ):
        await pipeline.write("THRESHOLD", threshold)
        await pipeline.write("OFF_THRESHOLD", threshold)
        await pipeline.write("AREA_THRESHOLD", of_area)
        await pipeline.send(frame)
        await pipeline.check(counters=False)
        assert pipeline.contact.events.touching == (threshold != peak)
    await pipeline.write("AREA_THRESHOLD", lowest)
    area = int((codes > chosen[0]).sum())
    for least, debounce in ((area, 1), (area + 1, 1), (area, 3), (area + 1, 2), (area, 2), (0, 0)):
        await pipeline.write("OFF_THRESHOLD", chosen[0])
        await pipeline.write("MINIMUM_AREA", least)
        await pipeline.write("DEBOUNCE", debounce)
        for _ in range(debounce + 1):
            await pipeline.send(pressed)
            await pipeline.check(counters=False)
    beyond = [1 << bit for bit in range(pipeline.config.data_width - 1, 31)]
    for level in (*chosen, int(depths[-1]) // 2 - 1, *sample([*beyond, (1 << 31) - 1])):
        for code in (level, ~level):
            await pipeline.write("AREA_THRESHOLD", code)
            await pipeline.send(pressed, pressed)
            await pipeline.check(counters=False)
