# SPDX-License-Identifier: Apache-2.0
"""Registers of tactile_depth while frames stream: no access disturbs a code or a latency."""

from itertools import repeat
from typing import Any

import cocotb
from cocotb.triggers import ClockCycles, RisingEdge

from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.gradient.frame_marks import NO_LIMIT
from tactile_depth.chip.registers.axil_port import Response
from tactile_depth.chip.registers.register_map import MAP, REGISTERS, TABLES
from tb import structs
from tb.axil import OFFSET, check_waits, present, take
from tb.axis import broken, video
from tb.pixels import pack
from tb.selection import Level, case, up_to
from tb.stream import REGRESS, parametrize
from tb.tactile_depth.bench import COMMIT, CONTROL, Pipeline, started
from tb.tactile_depth.scoreboard import STATUS

REFERENCE_CAPTURE, ZERO_CAPTURE, INTERRUPT = (
    REGISTERS[name] for name in ("REFERENCE_CAPTURE", "ZERO_CAPTURE", "INTERRUPT_STATUS")
)
FULL = (1 << 32) - 1
WRITABLE = [register.name for register in MAP if register.writable]
TABLE_REGISTERS = ("TABLE_SELECT", "TABLE_INDEX", "TABLE_HIGH", "TABLE_LOW")


def as_sent(config: Configuration) -> bool:
    """Return True if the build has the gradient table only, without a reference and without a zero offset."""
    return not config.flat_field and not config.zero_offset


async def busy(pipeline: Pipeline) -> bool:
    """Read STATUS.busy."""
    return bool(STATUS.unpack(await pipeline.read("STATUS"))["busy"])


@case()
async def busy_while_a_frame_is_in_flight(dut: Any) -> None:
    """Read busy while a frame with pauses streams: it is set from the first pixel to the last depth, and not before or
    after."""
    pipeline = await started(dut)
    source, out = pipeline.into, pipeline.out
    polls: list[tuple[int, int, bool]] = []  # cycle before the read, cycle after it, busy

    async def poll() -> None:
        while True:
            before, value = source.clock_count, await busy(pipeline)
            polls.append((before, source.clock_count, value))
            await ClockCycles(dut.clk, pipeline.random.randrange(3))

    for pause in (0, 1, 4, 30):
        polling = cocotb.start_soon(poll())
        await ClockCycles(dut.clk, 20)
        frame = pipeline.frame()
        await pipeline.send(frame[:1], [None] * pause, frame[1:-1], [None] * pause, frame[-1:])
        await pipeline.until(lambda: len(out.words) == pipeline.pixels)
        await ClockCycles(dut.clk, 20)
        polling.cancel()
        await ClockCycles(dut.clk, 20)  # until the read that it had begun has ended
        first, last = source.taken[0], out.taken[-1]
        inside = [value for before, after, value in polls if before >= first and after <= last]
        outside = [value for before, after, value in polls if after <= first or before > last + 1]
        assert len(inside) > 20, len(inside)
        assert all(inside), (
            f"busy is low in {len(inside) - sum(inside)} of {len(inside)} reads while a frame is in flight"
        )
        assert outside
        assert not any(outside), "busy without a frame"
        polls.clear()
        await pipeline.check()


@case(Level.FORMATS, whole_rows=True)
async def busy_until_the_last_depth_is_taken(dut: Any) -> None:
    """Stall the sink at the last depths of a frame: busy stays set until they are taken."""
    pipeline = await started(dut)
    out, before_them = pipeline.out, pipeline.pixels - pipeline.held
    pipeline.sink.stall(len(out.words) < before_them for _ in repeat(None))
    await pipeline.send(pipeline.frame())
    await pipeline.until(lambda: len(out.words) >= before_them)
    await ClockCycles(dut.clk, 4 * pipeline.columns)
    assert len(out.words) < pipeline.pixels
    assert await busy(pipeline), "busy is low while the last depths wait"
    pipeline.sink.stall(repeat(True))
    await pipeline.check()


@case()
async def busy_from_the_clock_after_the_first_pixel(dut: Any) -> None:
    """Look up STATUS before, with and after the first pixel."""
    pipeline = await started(dut)
    after_pixel = {}
    for lead in range(-2, 5):
        dut.s_axil_rready.value = 0
        sending = cocotb.start_soon(pipeline.send([None] * (20 - lead), pipeline.frame()))
        await ClockCycles(dut.clk, 20)
        await present(dut, "ar", araddr=OFFSET["STATUS"])
        await RisingEdge(dut.clk)
        asked = pipeline.into.clock_count
        await RisingEdge(dut.clk)
        value = STATUS.unpack(int(dut.s_axil_rdata.value))["busy"]
        assert await take(dut, "r") == Response.OKAY
        dut.s_axil_rready.value = 1
        await sending
        after_pixel[asked - pipeline.into.taken[0]] = value
        await pipeline.check()
    assert after_pixel.keys() >= {0, 1}, f"the test is void: clocks after the first pixel are {list(after_pixel)}"
    assert all(value == (clocks > 0) for clocks, value in after_pixel.items()), after_pixel


@case(Level.FORMATS, whole_rows=True)
async def interrupts(dut: Any) -> None:
    """Raise the interrupts of a record and of a dropped frame: `irq` is high while a set bit is unmasked."""
    pipeline = await started(dut)
    good, malformed = pipeline.frame(), broken(pipeline.frame(), "row_long", pipeline.columns - 1, pipeline.columns)

    async def status(cleared: int = 0) -> tuple[int, bool]:
        await pipeline.write("INTERRUPT_STATUS", cleared)
        await ClockCycles(dut.clk, 2)
        return await pipeline.read("INTERRUPT_STATUS"), bool(dut.irq.value)

    for mask in (0, *(INTERRUPT.pack(**{name: 1}) for name in ("record", "frame_dropped"))):
        await pipeline.write("INTERRUPT_MASK", mask)
        assert await status() == (0, False)
        for stream, bits in (
            ((good,), INTERRUPT.pack(record=1)),
            ((malformed, good), INTERRUPT.pack(record=1, frame_dropped=1)),
        ):
            await pipeline.play(*stream)
            assert await status() == (bits, bool(bits & mask)), f"INTERRUPT_MASK {mask:#x}"
            assert await status(cleared=bits & ~mask) == (bits & mask, bool(bits & mask))
            assert await status(cleared=bits) == (0, False)


@case()
async def the_register_port_waits(dut: Any) -> None:
    """Write with address and word in either order: each is taken once, responses stay until they are taken, and bytes
    without a strobe keep their value."""
    pipeline = await started(dut)
    await check_waits(dut, pipeline.random)
    dut.s_axil_bready.value = dut.s_axil_rready.value = 1
    for word in (0, FULL):
        writing = cocotb.start_soon(pipeline.write("TIMEOUT", word))
        await pipeline.until(lambda: structs.of(dut.register_command, "register_command_t")["write"])
        command = {"write": 1, "write_offset": OFFSET["TIMEOUT"], "write_ones": word, "write_mask": FULL}
        assert structs.of(dut.register_command, "register_command_t").items() >= command.items()
        await writing
    await pipeline.play(pipeline.frame())


@case(whole_rows=True)
@parametrize(accepts=["none", "random"])
async def written_all_the_time(dut: Any, accepts: str) -> None:
    """Write registers all the time: no code and no latency changes."""
    pipeline = await started(dut, offers="random", accepts=accepts)
    running, refused = True, 0

    async def writes() -> None:
        nonlocal refused
        rng = pipeline.random
        while running:
            word = rng.getrandbits(32)
            name = rng.choice(("THRESHOLD", "TIMEOUT", "CONTROL", *TABLE_REGISTERS, "GRID"))
            if name in ("TIMEOUT", "CONTROL"):
                word = word | 1 << 20 if name == "TIMEOUT" else word & ~CONTROL.pack(clear_counters=1, drop_frames=1)
            refused += await pipeline.write(name, word) == Response.SLVERR
            await pipeline.read(
                rng.choice(("STATUS", "FRAMES_IN", "FIRST_DEPTH_LATENCY", "TABLE_INDEX", "TABLE_COMMIT"))
            )

    sending = cocotb.start_soon(pipeline.send(*(pipeline.frame() for _ in range(4))))
    await ClockCycles(dut.clk, 12)
    writing = cocotb.start_soon(writes())
    await sending
    await pipeline.until(lambda: len(pipeline.out.words) >= 4 * pipeline.pixels - 40)
    running = False
    await writing
    assert refused > 5
    await pipeline.write("CONTROL", 0)
    await pipeline.check()


@case(needs=as_sent, whole_rows=True)
async def written_phase_by_phase(dut: Any) -> None:
    """Write each register while the pipeline is idle, and while a frame enters, is filled up, pauses, leaves and is
    stalled."""
    pipeline = await started(dut)
    columns, first = pipeline.columns, pipeline.tables.content.entries["gradient"][0].tolist()

    async def write_all(phase: str) -> None:
        await RisingEdge(dut.clk)
        for name in WRITABLE:
            reached = pipeline.phases()
            assert phase in reached, f"the test is void: {name} is written in {reached}, not {phase}"
            word = NO_LIMIT if name == "SLOPE_LIMIT" else 0
            assert await pipeline.write(name, word) == Response.OKAY, name
        assert await pipeline.tables.write_entry("gradient", 0, *first) == Response.OKAY

    await write_all("idle")
    frame, silence = pipeline.frame(), [None] * 100
    sending = cocotb.start_soon(pipeline.send(frame[:columns], silence, frame[columns:]))
    await ClockCycles(dut.clk, columns + 10)
    await write_all("mid_frame")
    await sending
    await write_all("waiting")
    await pipeline.until(lambda: pipeline.out.words)
    await write_all("output")
    pipeline.sink.stall(repeat(False))
    await ClockCycles(dut.clk, 4)
    await write_all("stalled")
    pipeline.sink.stall(repeat(True))
    await pipeline.idle()
    await pipeline.send(broken(pipeline.frame(), "row_short", 0, columns)[:1])
    await write_all("filling")
    await pipeline.check()


@case(needs=as_sent, whole_rows=True)
@parametrize(accepts=up_to({Level.WHOLE: ["random"], Level.LONG: ["none"]}))
async def written_in_every_phase(dut: Any, accepts: str) -> None:
    """Write each register at each pixel of a frame, while frames come without a gap: no code and no latency changes.

    `make test` writes each register at each fourth pixel, and some register at each.
    """
    pipeline = await started(dut, accepts=accepts)
    rng, running = pipeline.random, True
    colours = [[135 + rng.randint(-3, 3) for _ in range(3)] for _ in range(pipeline.pixels)]
    frame = video(pack(colours), pipeline.columns)
    values: dict[str, Any] = dict.fromkeys((*WRITABLE, "GRID"), lambda: rng.getrandbits(32)) | {
        # Write the current values, because the records of the frames in flight are compared too.
        "OFF_THRESHOLD": lambda: REGISTERS["OFF_THRESHOLD"].reset,
        "MINIMUM_AREA": lambda: REGISTERS["MINIMUM_AREA"].reset,
        "DEBOUNCE": lambda: REGISTERS["DEBOUNCE"].reset,
        "SLOPE_LIMIT": lambda: NO_LIMIT,
        "TIMEOUT": lambda: rng.randint(2, 300),  # no frame pauses
        "CONTROL": lambda: CONTROL.pack(hold_contact=rng.getrandbits(1)),
        "TABLE_SELECT": lambda: TABLES["gradient"],  # TABLE_LOW then writes an entry of the free bank
        "TABLE_COMMIT": lambda: COMMIT.pack(coefficients=1, reference=1, zero=1),  # the build has none of these
        "REFERENCE_CAPTURE": lambda: REFERENCE_CAPTURE.pack(start=1),  # nor a reference to capture
        "ZERO_CAPTURE": lambda: ZERO_CAPTURE.pack(start=1),  # nor a zero offset
    }
    refused = {"GRID", "REFERENCE_CAPTURE", "ZERO_CAPTURE"}
    step = 1 if REGRESS else 4
    missing = {name: set(range(index % step, pipeline.pixels, step)) for index, name in enumerate(values)}

    async def feed() -> None:
        while running:
            await pipeline.send(frame, frame)

    feeding = cocotb.start_soon(feed())
    await pipeline.until(lambda: pipeline.into.words)
    await ClockCycles(dut.clk, 4)
    while any(missing.values()):
        phase = len(pipeline.into.words) % pipeline.pixels
        name = max(missing, key=lambda name: (phase in missing[name], len(missing[name])))
        if phase not in missing[name]:
            await RisingEdge(dut.clk)
            continue
        missing[name].discard(phase)
        answer = await pipeline.write(name, values[name]())
        assert answer == (Response.SLVERR if name in refused else Response.OKAY), f"{name} at pixel {phase}: {answer}"
    running = False
    await feeding
    await pipeline.write("CONTROL", 0)
    await pipeline.check()
