# SPDX-License-Identifier: Apache-2.0
"""Tables of tactile_depth over the registers: written, read back, and changed over between two frames."""

from itertools import cycle, product
from typing import Any

import cocotb
import numpy as np
from cocotb.triggers import ClockCycles

from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.registers.axil_port import Response
from tactile_depth.chip.registers.register_map import REGISTERS
from tactile_depth.chip.table_entries import one_word, reference_entries
from tb.selection import Level, case, named, up_to
from tb.stream import MANY, REGRESS, configuration, parametrize
from tb.tactile_depth.bench import HEAD_CLOCKS, SKID_WORDS, Pipeline, started
from tb.tactile_depth.device_tables import Content

COMMIT = REGISTERS["TABLE_COMMIT"]
BUILT = tuple(Content.built(configuration()).entries)  # names of the tables of this build
SHORT = [name for name in BUILT if name != "gradient"]  # tables of a few hundred words
REWRITES = 5


def looks_up(config: Configuration) -> bool:
    """Return True if slopes come from the gradient table."""
    return config.gradient_model == "lut"


def looks_up_pixels(config: Configuration) -> bool:
    """Return True if the colours of the pixels, without a flat field, select entries of the gradient table."""
    return looks_up(config) and not config.flat_field


def random_slopes(pipeline: Pipeline, rng: np.random.Generator, fraction: int = 4) -> np.ndarray:
    """Return random entries of the gradient table, up to a fraction of the largest slope code."""
    limit = (1 << pipeline.config.gradient.width - 1) // fraction
    return rng.integers(-limit, limit, pipeline.tables.content.entries["gradient"].shape)


def random_entries(pipeline: Pipeline, name: str, rng: np.random.Generator) -> np.ndarray:
    """Return random entries of a table that keep depth within its range."""
    config, entries = pipeline.config, pipeline.tables.content.entries[name]
    if name == "gradient":
        return random_slopes(pipeline, rng)
    if name == "coefficients":
        return one_word(np.rint(entries[:, 0] * rng.uniform(0.5, 1, len(entries))).astype(np.int64))
    if name == "reference":
        return reference_entries((1 << config.gain.fraction) // rng.integers(90, 160, (*config.reference_nodes, 3)))
    limit = 1 << config.data_width - 1
    return one_word(rng.integers(-limit // 8, limit // 8, len(entries)))


@case(Level.FORMATS)
@parametrize(
    name=up_to({Level.FORMATS: named(SHORT), Level.WHOLE: named([name for name in BUILT if name not in SHORT])})
)
async def written(dut: Any, name: str) -> None:
    """Write and read a table between frames: after its commit the next frame has the codes of the new table."""
    pipeline = await started(dut)
    tables = pipeline.tables
    built = tables.content.entries[name]
    frame = pipeline.frame()
    await pipeline.send(frame)
    before = (await pipeline.check()).codes
    new = random_entries(pipeline, name, np.random.default_rng(cocotb.RANDOM_SEED))
    for old, entries in ((built, new), (new, built)):
        await tables.write(name, entries)
        np.testing.assert_array_equal(await tables.read(name), entries)
        await pipeline.send(frame)
        await pipeline.check()  # with the old table
        await tables.commit(name, entries)
        assert await pipeline.read("TABLE_COMMIT") == COMMIT.pack(**{name: 1})
        await pipeline.send(frame)
        after = (await pipeline.check()).codes
        assert await pipeline.read("TABLE_COMMIT") == 0
        assert (after != before).any() == (entries is new)
        np.testing.assert_array_equal(await tables.read(name), old)  # the bank that was in use until then


@case(Level.FORMATS, needs=lambda config: config.zero_offset)
async def a_zero_at_full_scale(dut: Any) -> None:
    """Write a zero offset at full scale: depth beyond its range is clipped, and the zero offset survives a reset."""
    pipeline = await started(dut)
    limit = 1 << pipeline.config.data_width - 1
    count = len(pipeline.tables.content.entries["zero"])
    zero = one_word(np.random.default_rng(cocotb.RANDOM_SEED).choice([-limit, limit - 1], count))
    await pipeline.tables.write("zero", zero)
    await pipeline.tables.commit("zero", zero)
    await pipeline.play(pipeline.pressed(), pipeline.frame())
    assert "saturation" in pipeline.scoreboard.sticky
    await pipeline.reset(1)
    await pipeline.play(pipeline.pressed(0.25))


@case(needs=looks_up_pixels)
async def committed_at_the_first_pixel(dut: Any) -> None:
    """Commit around the first pixel of a frame: the frame has the codes of one table, which the cycle decides."""
    pipeline = await started(dut)
    tables, bits, rng = pipeline.tables, pipeline.config.bits_per_channel, pipeline.random
    colour = (200, 40, 90)
    frame = pipeline.plain(colour)
    index = int(sum(channel >> 8 - bits << shift * bits for shift, channel in enumerate(reversed(colour))))
    taken = []
    # Cycles from the commit to the first pixel, and from the first pixel to the second.
    cases = product(range(-6, 5), (0, 4)) if REGRESS else zip(range(-6, 5), cycle((0, 4)))
    for lead, gap in cases:
        entries = np.array(tables.content.entries["gradient"])
        entries[index] = rng.randrange(1 << 8), -rng.randrange(1 << 8)
        old, new = tables.content, tables.content.with_table("gradient", entries)
        assert await tables.write_entry("gradient", index, *entries[index].tolist()) == Response.OKAY
        stream = [None] * (8 + lead), frame[:1], [None] * gap, frame[1:]
        sending = cocotb.start_soon(pipeline.send(*stream))
        await ClockCycles(dut.clk, 8)
        answer = cocotb.start_soon(tables.commit("gradient"))
        await pipeline.until(lambda: dut.s_axil_bvalid.value)
        decided = pipeline.into.clock_count - 1
        await answer
        await sending
        taken.append(decided < pipeline.into.taken[0] + HEAD_CLOCKS)
        pending = await pipeline.read("TABLE_COMMIT")
        assert pending == COMMIT.pack(gradient=not taken[-1])
        assert await pipeline.write("TABLE_LOW", 123) == (Response.OKAY if taken[-1] else Response.SLVERR)
        await pipeline.send(frame)
        await pipeline.check(contents=[new if taken[-1] else old, new])
        tables.use("gradient", entries)
    assert set(taken) == {False, True}, "the test is void: every commit came on the same side of the first pixel"


@case(needs=looks_up)
@parametrize(offers=["none", "random"], accepts=up_to({Level.WHOLE: ["random"], Level.LONG: ["none"]}))
async def rewritten_while_frames_stream(dut: Any, offers: str, accepts: str) -> None:
    """Rewrite the whole table repeatedly while frames stream back to back.

    Each frame has the codes of one table, the last one committed before its first pixel.
    """
    pipeline = await started(dut, offers=offers, accepts=accepts)
    tables, rng = pipeline.tables, np.random.default_rng(cocotb.RANDOM_SEED)
    contents, decided = [tables.content], []  # the tables in their order; cycles of the commits
    running = True

    async def feed() -> None:
        while running:
            await pipeline.send(pipeline.frame(), pipeline.frame())

    feeding = cocotb.start_soon(feed())
    for _ in range(REWRITES):
        entries = random_slopes(pipeline, rng)
        await tables.write("gradient", entries)
        await ClockCycles(dut.clk, int(rng.integers(pipeline.pixels)))
        commit = cocotb.start_soon(tables.commit("gradient", entries))
        await pipeline.until(lambda: dut.s_axil_bvalid.value)
        decided.append(pipeline.into.clock_count - 1)
        await commit
        contents.append(tables.content)
    while await pipeline.read("TABLE_COMMIT"):
        pass
    running = False
    await feeding
    await pipeline.drain()

    # A frame takes its tables when its first pixel is at the head of the pipeline: without stalls a fixed number of
    # cycles after it was taken, and at the latest when later words have no more room before the head.
    behind = 0 if accepts == "none" else SKID_WORDS + 1
    candidates = []
    for first in range(0, len(pipeline.into.words), pipeline.pixels):
        earliest, latest = (pipeline.into.taken[first + more] + HEAD_CLOCKS for more in (0, behind))
        certain, possible = (sum(clock < bound for clock in decided) for bound in (earliest, latest))
        candidates.append(contents[certain : possible + 1])
    used = pipeline.scoreboard.used(pipeline.into, pipeline.out, candidates)
    order = [contents.index(content) for content in used]
    assert order == sorted(order), f"a frame used an older table than the frame before it: {order}"
    assert set(order) == set(range(len(contents))), f"the test is void: no frame used one of the tables: {order}"
    await pipeline.check(contents=used)


@case(needs=looks_up)
@parametrize(fraction=[1, 8, 128])
async def many_frames_of_any_slopes(dut: Any, fraction: int) -> None:
    """Reach ties of every rounding, and clip every value that can clip, with steep and small slopes."""
    pipeline = await started(dut)
    entries = random_slopes(pipeline, np.random.default_rng(cocotb.RANDOM_SEED), fraction)
    await pipeline.tables.write("gradient", entries)
    await pipeline.tables.commit("gradient", entries)
    await pipeline.play(*(pipeline.frame() for _ in range(MANY)))
