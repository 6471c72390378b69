# SPDX-License-Identifier: Apache-2.0
"""Seams between the units of tactile_depth: registers and records while a sink stalls, tables that change inside a
frame."""

from itertools import repeat
from typing import Any

import cocotb
import numpy as np
from cocotb.triggers import ClockCycles

from tactile_depth.chip.registers.axil_port import Response
from tactile_depth.chip.registers.register_map import REGISTERS
from tb.selection import Level, case, named, up_to
from tb.stream import parametrize
from tb.tactile_depth.bench import COMMIT, started
from tb.tactile_depth.contact_watch import RECORD
from tb.tactile_depth.scoreboard import STATUS
from tb.tactile_depth.tb_tables import BUILT, SHORT, random_entries

LATE = 4  # clocks from an event at the pins until a register has it
INTERRUPT = REGISTERS["INTERRUPT_STATUS"]


@case(Level.FORMATS, whole_rows=True)
@parametrize(accepts=up_to({Level.FORMATS: ["random"], Level.WHOLE: ["one_in_4"]}))
async def registers_follow_the_pins(dut: Any, accepts: str) -> None:
    """Read what the device counts while a sink stalls: each register has what has happened at the pins by then."""
    pipeline = await started(dut, accepts=accepts)
    into, out, pixels = pipeline.into, pipeline.out, pipeline.pixels
    reads: list[tuple[str, int, int, int]] = []  # register, clock before the read, clock after it, word

    async def poll() -> None:
        while True:
            for name in ("STATUS", "FRAMES_OUT", "FIRST_DEPTH_LATENCY"):
                before, word = into.clock_count, await pipeline.read(name)
                reads.append((name, before, into.clock_count, word))

    polling = cocotb.start_soon(poll())
    for pause in (0, 0, 7, 3 * pixels):
        await pipeline.send(pipeline.frame(), [None] * pause)
    await pipeline.until(lambda: len(out.words) == 4 * pixels)
    polling.cancel()
    await ClockCycles(dut.clk, 20)  # until the read that it had begun has ended
    starts, offered = into.taken[::pixels], out.offered[::pixels]
    ends = out.taken[pixels - 1 :: pixels]
    latencies = [0, *(depth - start for depth, start in zip(offered, starts, strict=True))]
    for name, before, after, word in reads:
        events = ends if name == "FRAMES_OUT" else offered
        least, most = (sum(event <= clock for event in events) for clock in (before - LATE, after))
        what = f"{name} is {word:#x} in clocks {before} to {after}"
        if name == "FRAMES_OUT":
            assert least <= word <= most, what
        elif name == "FIRST_DEPTH_LATENCY":
            assert word in latencies[least : most + 1], what
        elif any(start < before and after <= end for start, end in zip(starts, ends, strict=True)):
            assert STATUS.unpack(word)["busy"], what
    await pipeline.check()


@case(Level.FORMATS, whole_rows=True)
async def records_while_their_sink_stalls(dut: Any) -> None:
    """Stall the sink of records: registers and interrupt tell of each frame, the packets of the first and of the last
    one wait, and those between are counted as lost. A reset withdraws those that wait."""
    pipeline = await started(dut)
    watch, frames, records = pipeline.contact, 4, []
    watch.takes = repeat(False)
    for _ in range(frames):
        await pipeline.write("INTERRUPT_STATUS", INTERRUPT.pack(record=1))
        await pipeline.send(pipeline.frame())
        await pipeline.drain()
        records.append([await pipeline.read(name) for name in RECORD])
        assert await pipeline.read("INTERRUPT_STATUS") == INTERRUPT.pack(record=1)
    pipeline.scoreboard.counters["RECORDS_LOST"] += frames - 2
    watch.takes = repeat(True)
    await pipeline.until(lambda: len(watch.packets) == 2)
    assert watch.packets == [records[0], records[-1]]
    watch.packets = records
    await pipeline.check()
    watch.takes = repeat(False)
    for _ in range(2):
        await pipeline.send(pipeline.frame())
        await pipeline.drain()
    await pipeline.reset(1)
    watch.takes = repeat(True)
    await pipeline.play(pipeline.frame())


@case(Level.FORMATS)
@parametrize(
    name=up_to({Level.FORMATS: named(SHORT), Level.WHOLE: named([name for name in BUILT if name not in SHORT])}),
    accepts=["none", "random"],
)
async def committed_inside_a_frame(dut: Any, name: str, accepts: str) -> None:
    """Commit a table anywhere in a frame: the frame keeps the old one, those behind it have the new one, and nothing is
    written between. A reset forgets a commit that no frame has taken."""
    pipeline = await started(dut, accepts=accepts)
    tables, old, start = pipeline.tables, pipeline.tables.content, pipeline.columns
    entries = random_entries(pipeline, name, np.random.default_rng(cocotb.RANDOM_SEED))
    new = old.with_table(name, entries)
    await tables.write(name, entries)
    place = pipeline.random.randrange(start, pipeline.pixels - 4 * start)  # the write is answered within this frame
    sending = cocotb.start_soon(pipeline.send(*(pipeline.frame() for _ in range(3))))
    await pipeline.until(lambda: len(pipeline.into.words) >= place)
    await tables.commit(name, entries)
    assert len(pipeline.into.words) < pipeline.pixels, "the test is void: the frame had ended"
    assert await pipeline.write("TABLE_LOW", 0) == Response.SLVERR, "the table that waits was written"
    await sending
    await pipeline.check(contents=[old, new, new])
    assert await pipeline.write("TABLE_COMMIT", COMMIT.pack(**{name: 1})) == Response.OKAY
    await pipeline.reset(1)
    await pipeline.play(pipeline.frame())
