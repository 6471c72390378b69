# SPDX-License-Identifier: Apache-2.0
"""Resets of tactile_depth in every phase of a frame; tests/test_faults.py resets in every clock of these phases."""

from itertools import product, repeat
from typing import Any

import cocotb
from cocotb.triggers import ClockCycles

from tactile_depth.chip.latency import first_depth_latency
from tactile_depth.chip.registers.register_map import MAP, REGISTERS
from tb.axis import broken, profile
from tb.selection import Level, case, up_to
from tb.stream import parametrize
from tb.tactile_depth.bench import CONTROL, Stream, started

CAPTURES = ("REFERENCE_CAPTURE", "ZERO_CAPTURE")
PHASES = ("mid_frame", "filling", "waiting", "output", "stalled", "full", "idle")


@case(Level.STREAM)
@parametrize(
    (
        ("clocks", "phase"),
        up_to(
            {
                Level.STREAM: [(2, "full")],
                Level.WHOLE: [(2, phase) for phase in PHASES if phase != "full"],
                Level.LONG: list(product((1, 16), PHASES)),
            }
        ),
    )
)
async def resets(dut: Any, clocks: int, phase: str) -> None:
    """Reset: registers have their values of power-up, tables stay, and the next frame is right."""
    pipeline = await started(dut)
    await pipeline.write("THRESHOLD", -5)
    await pipeline.write("CONTROL", CONTROL.pack(hold_contact=1))
    for name in CAPTURES:
        await pipeline.write(name, REGISTERS[name].pack(start=1, log2_frames=4))  # refused where the build has none
    first = pipeline.pixels + 1 + pipeline.random.randrange(pipeline.pixels // 2)
    streams: list[Stream] = [pipeline.frame() for _ in range(5)]
    wait = {
        "mid_frame": first,
        "filling": first + 50,
        "waiting": pipeline.pixels + 50,
        "output": first_depth_latency(pipeline.config) + 1 + pipeline.random.randrange(3 * pipeline.pixels),
        "stalled": first_depth_latency(pipeline.config) + pipeline.pixels,
        "full": first_depth_latency(pipeline.config) + 3 * pipeline.pixels,
        "idle": first_depth_latency(pipeline.config) + pipeline.pixels + 10,
    }[phase]
    if phase in ("waiting", "idle"):
        del streams[1:]
    if phase == "filling":
        streams[1] = broken(pipeline.frame(), "row_short", pipeline.random.randrange(10), pipeline.columns)
    if phase in ("stalled", "full"):
        pipeline.sink.stall(repeat(False) if phase == "full" else profile("alternate"))
    cocotb.start_soon(pipeline.send(*streams))
    await ClockCycles(dut.clk, wait)
    if phase == "stalled":
        await pipeline.until(lambda: phase in pipeline.phases())
    assert phase in pipeline.phases(), f"the test is void: the phase is {pipeline.phases()}"
    await pipeline.reset(clocks)
    pipeline.sink.stall(repeat(True))
    assert not dut.contact.value
    for register in MAP:
        fields = [field for field in register.fields if field.reset is not None or field.name == "busy"]
        values = register.unpack(await pipeline.read(register.name)) if fields else {}
        for field in fields:
            value = values[field.name]
            assert value == (field.reset or 0), f"{register.name}.{field.name} is {value:#x} after a reset"
    await ClockCycles(dut.clk, pipeline.pixels)
    assert not pipeline.out.words, "a depth left that belongs to a frame from before the reset"
    await pipeline.play(pipeline.frame(), pipeline.frame())
    assert pipeline.scoreboard.latency == first_depth_latency(pipeline.config)


@case(needs=lambda config: config.gradient_model == "lut")
async def a_cold_reset_takes_the_first_bank(dut: Any) -> None:
    """Reset with `cold_rst`: frames use the same bank as after the previous cold reset. `rst` alone keeps the bank."""
    pipeline = await started(dut)
    tables = pipeline.tables

    async def cold_reset() -> None:
        dut.cold_rst.value = 1
        await pipeline.reset(2)
        dut.cold_rst.value = 0

    await cold_reset()
    frame = pipeline.frame()
    built = tables.content.entries["gradient"]
    first, second = (built // divisor for divisor in (2, -3))
    await tables.write("gradient", second)
    await tables.commit("gradient", second)
    await pipeline.play(frame)
    await tables.write("gradient", first)  # in the bank of the cold reset
    await pipeline.reset(2)
    await pipeline.play(frame)
    await cold_reset()
    tables.use("gradient", first)
    await pipeline.play(frame)
