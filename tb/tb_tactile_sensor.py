# SPDX-License-Identifier: Apache-2.0
"""tactile_sensor against the models: pictures under changing settings, broken pictures, the pins beside the stream."""

import random
from collections.abc import Mapping
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import cocotb
import numpy as np
from cocotb.triggers import ClockCycles, RisingEdge

from tactile_depth.chip.camera.camera_front_end import camera_front_end, camera_settings
from tactile_depth.chip.camera.camera_window import FAULTS
from tactile_depth.chip.camera_configuration import CameraConfiguration
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.latency import last_word_to_first_depth
from tactile_depth.chip.registers.axil_port import Response
from tactile_depth.chip.registers.register_map import CAMERA_MAP, CAMERA_REGISTERS, MAP, REGISTERS
from tactile_depth.chip.tactile_depth import hdl_parameters, write_roms
from tactile_depth.sensor.synthetic import synthetic
from tb import axil
from tb.axis import AxisMonitor, AxisSink, AxisSource, profile, video
from tb.camera.slots import camera_words
from tb.cases import on_bench
from tb.pixels import pack
from tb.settings import RUN
from tb.stream import at_every_edge, check_maps, configuration, parametrize, start_clock
from tb.structures import ICARUS, VERILATOR, Mutants, Structure
from tb.tactile_depth.contact_watch import ContactWatch
from tb.tactile_depth.device_tables import Content
from tb.tactile_depth.scoreboard import Scoreboard
from tb.tactile_depth.settings import PROTOCOL as PROTOCOL

PIPELINE: dict[str, Any] = {"columns": 16, "rows": 8, "solver": "tridiagonal", "bits_per_channel": 2}


def built(form: str, picture: tuple[int, int], window: tuple[int, int, int, int], **runs: Any) -> Structure:
    config = Configuration(**PIPELINE)
    camera = {"picture": picture, "grid": (8, 16), "pixel_format": form, "window": window}
    return Structure(
        hdl_parameters(config, camera=CameraConfiguration(**camera)),  # type: ignore[arg-type]
        device={"configuration": PIPELINE, "camera": camera},
        roms=lambda folder: write_roms(folder, synthetic(config.bits_per_channel), config),
        name=form,
        **runs,
    )


STRUCTURES = (
    built("raw10_lsb", (23, 42), (3, 2, 36, 18), on=VERILATOR, mutants=VERILATOR),
    built("yuyv_bytes", (13, 28), (2, 1, 24, 12), on=ICARUS),
)
MUTANTS = Mutants(flat=False)
NO_PROOF = "camera_unit and tactile_depth in a row"


FILLED = 300  # clocks in which the rest of a broken frame is filled
IDLE = {"frames_lost": 0, "setup_done": 0, "setup_failed": 0, "setup_entry": 0, "setup_found": 0}
STATUS, ARRIVED = CAMERA_REGISTERS["CAMERA_STATUS"], CAMERA_REGISTERS["CAMERA_ARRIVED"]


class Bench:
    """Driver of the pins, and the models."""

    def __init__(self, dut: Any, stalls: str = "none") -> None:
        self.dut, self.config, self.random = dut, configuration(), random.Random(cocotb.RANDOM_SEED)
        self.camera = CameraConfiguration(**RUN.device["camera"])
        self.rng = np.random.default_rng(cocotb.RANDOM_SEED)
        dut.rst.value, dut.cold_rst.value = 1, 0
        dut.m_event_tready.value = 1
        for pin, value in IDLE.items():
            getattr(dut, pin).value = value
        self.source = AxisSource(dut, "s_axis", prefix="t")
        self.came, self.left = (AxisMonitor(dut, side, prefix="t") for side in ("s_axis", "m_axis"))
        self.sink = AxisSink(dut, "m_axis", prefix="t", accepts=profile(stalls, 1))
        self.master = axil.Master(dut)
        self.watch = ContactWatch(dut, self.config, profile(stalls, 2))
        self.scoreboard = Scoreboard(self.config, self.watch)

    async def start(self) -> None:
        start_clock(self.dut.clk)
        at_every_edge(self.dut.clk, self.watch.watch_contact())
        cocotb.start_soon(self.watch.watch_events())
        await ClockCycles(self.dut.clk, 3)
        self.dut.rst.value = 0
        await RisingEdge(self.dut.clk)

    async def use(self, camera: CameraConfiguration) -> None:
        """Write the settings of a camera into the registers."""
        s = camera_settings(camera)
        await self.write("CAMERA_PICTURE", columns=s["columns"], rows=s["rows"])
        await self.write("CAMERA_WINDOW", x=s["window_x"], y=s["window_y"])
        for name in ("black_level", "red_gain", "green_gain", "blue_gain"):
            await self.write(f"CAMERA_{name.upper()}", value=s[name])
        self.camera = camera

    async def write(self, name: str, **fields: int) -> None:
        """Write a register of the camera, and read it back."""
        word = CAMERA_REGISTERS[name].pack(**fields)
        assert await self.master.write(CAMERA_REGISTERS[name].offset, word) == Response.OKAY
        assert await self.camera_word(name) == word

    async def camera_word(self, name: str) -> int:
        return await self.master.read(CAMERA_REGISTERS[name].offset)

    async def faults(self) -> list[str]:
        """Return the faults in CAMERA_STATUS, and clear them."""
        word = await self.camera_word("CAMERA_STATUS")
        await self.master.write(STATUS.offset, word)
        return [name for name, bit in STATUS.unpack(word).items() if bit and name in FAULTS]

    def picture(self) -> np.ndarray:
        """Return the words of a picture: a random colour with noise, so that slopes stay in their range."""
        words = self.rng.integers(0, 1 << 24, self.camera.picture)
        if self.camera.format.bayer:
            top = self.camera.bits
            words = self.rng.integers(0, 1 << top, self.camera.picture) << (16 - top if top > 8 else 0)
        return words

    async def show(self, words: np.ndarray) -> int:
        """Send a picture; return the number of depths that leave until the pipeline is empty."""
        for monitor in (self.came, self.left, self.watch):
            monitor.forget()
        await self.source.send(camera_words(words, self.camera))
        await ClockCycles(self.dut.clk, 100)
        while await self.master.read(REGISTERS["STATUS"].offset) & REGISTERS["STATUS"].field("busy").mask:
            pass
        await ClockCycles(self.dut.clk, 100)
        return len(self.left.words)

    async def check(self, words: np.ndarray, events: bool = True) -> None:
        """Send a picture, and compare depth and its marks with the models; the record too, where all before were."""
        await self.show(words)
        pixels, content = pack(camera_front_end(words, self.camera)).ravel(), Content.built(self.config)
        if events:
            into: Any = SimpleNamespace(words=video(pixels.tolist(), self.config.columns), taken=range(pixels.size))
            self.scoreboard.compare(into, self.left, 0, content, drained=False)
        else:
            check_maps(self.scoreboard.depth(self.left, 1), self.scoreboard.model([pixels], content))


@on_bench(Bench, milliseconds=5)
@parametrize(stalls=["none", "random"])
async def settings_change_between_pictures(bench: Bench, stalls: str) -> None:
    """Write window, black level, gains and threshold between pictures: depth is that of the models, at its cycle."""
    built = bench.camera
    rows, columns = built.picture
    _, _, width, height = built.crop
    chance = bench.rng

    choices = [built] + [
        replace(
            built,
            window=(
                int(chance.integers(0, columns - width + 1)),
                int(chance.integers(0, rows - height + 1)),
                width,
                height,
            ),
            black_level=int(chance.integers(0, 1 << built.bits - 2)),
            gains=tuple(chance.integers(0, 1 << 16, 3) / 4096),
        )
        for _ in range(6)
    ]
    for place, camera in enumerate(choices):
        if place:
            await bench.use(camera)
        await bench.master.write(REGISTERS["THRESHOLD"].offset, bench.random.randrange(1 << 18))
        await bench.check(bench.picture())
        if stalls != "none":
            continue
        taken, first = bench.came.taken[camera.last_word], bench.left.offered[0]
        assert first - taken == last_word_to_first_depth(camera, bench.config)
    assert await bench.camera_word("CAMERA_STATUS") == 0
    assert ARRIVED.unpack(await bench.camera_word("CAMERA_ARRIVED")) == {"columns": columns, "rows": rows}


@on_bench(Bench, milliseconds=5)
async def broken_pictures_are_counted(bench: Bench) -> None:
    """A window outside the picture, a row too short: the fault has its bit and counts; the next picture is right."""
    offset = CAMERA_REGISTERS["CAMERA_WINDOW"].offset
    built = await bench.camera_word("CAMERA_WINDOW")
    await bench.master.write(offset, bench.camera.picture[1])
    assert not await bench.show(bench.picture())
    assert await bench.faults() == ["window_outside"]
    await bench.master.write(offset, built)
    words = bench.picture()
    assert not await bench.show(words[:, :-1])
    arrived = ARRIVED.unpack(await bench.camera_word("CAMERA_ARRIVED"))
    assert arrived["columns"] == words.shape[1] - 1
    await bench.check(words, events=False)
    assert await bench.faults() == ["row_short"]
    assert await bench.camera_word("CAMERA_DROPPED") == 2


@on_bench(Bench)
async def a_window_at_the_edge(bench: Bench) -> None:
    """Set pictures of any size: a window in their last rows and columns is inside, one pixel more is a fault."""
    _, _, width, height = bench.camera.crop
    for _ in range(20):
        columns, rows = (bench.random.randrange(width, 1 << 13, 2) for _ in range(2))  # pairs of YUYV are whole
        beyond = bench.random.choice(((0, 0), (0, 1), (1, 0)))
        await bench.write("CAMERA_PICTURE", columns=columns, rows=rows)
        await bench.write("CAMERA_WINDOW", x=columns - width + beyond[0], y=rows - height + beyond[1])
        await bench.source.send(camera_words(bench.picture(), bench.camera)[:1])
        await ClockCycles(bench.dut.clk, FILLED)
        assert ("window_outside" in await bench.faults()) == any(beyond), f"{columns} x {rows}, {beyond}"


@on_bench(Bench, milliseconds=20)
@parametrize(size=[0x1555, 0xAAA] if RUN.mutants else [0x15, 0x2A])
async def sizes_that_arrive(bench: Bench, size: int) -> None:
    """Send as many rows of two pixels, then two rows of as many pixels."""
    pixels = bench.camera.words_per_pixel
    narrow, wide = (video([0] * 2 * size * pixels, columns * pixels) for columns in (2, size))
    await bench.source.send([*narrow, *wide])
    await ClockCycles(bench.dut.clk, 10)
    assert ARRIVED.unpack(await bench.camera_word("CAMERA_ARRIVED")) == {"columns": size, "rows": size}


@on_bench(Bench)
async def pins_beside_the_stream(bench: Bench) -> None:
    """Frames that dvp_receive lost count; the state of camera_setup is read; a written bit restarts it."""
    dut, lost = bench.dut, 0
    for some in (0x0F, 0x33, 0x55, 0xAA):
        dut.frames_lost.value = some
        await RisingEdge(dut.clk)
        dut.frames_lost.value = 0
        dut.setup_failed.value, dut.setup_entry.value, dut.setup_found.value = 1, some, ~some & 0xFF
        lost += some
        assert await bench.camera_word("CAMERA_LOST") == lost
        assert await bench.camera_word("CAMERA_SETUP") == (~some & 0xFF) << 8 | some
    assert await bench.camera_word("CAMERA_STATUS") == STATUS.pack(lost=1, setup_failed=1, waiting=1)
    restarts: list[int] = []
    control = CAMERA_REGISTERS["CAMERA_CONTROL"]

    async def watch() -> None:
        while True:
            await RisingEdge(bench.dut.clk)
            restarts.append(int(bench.dut.setup_restart.value))

    cocotb.start_soon(watch())
    await bench.master.write(control.offset, control.pack(restart_setup=1))
    assert sum(restarts) == 1


@on_bench(Bench)
async def pins_of_the_pipeline(bench: Bench) -> None:
    """The port waits for its client, and a record raises the interrupt that is asked for."""
    await axil.check_waits(bench.dut, bench.random)
    bench.dut.s_axil_bready.value = bench.dut.s_axil_rready.value = 1
    status, mask = REGISTERS["INTERRUPT_STATUS"], REGISTERS["INTERRUPT_MASK"]
    await bench.master.write(mask.offset, status.pack(record=1))
    for _ in range(2):
        assert not bench.dut.irq.value
        await bench.check(bench.picture())
        assert bench.dut.irq.value
        await bench.master.write(status.offset, status.pack(record=1))
        await ClockCycles(bench.dut.clk, 2)


@on_bench(Bench)
async def one_port(bench: Bench) -> None:
    """Registers of pipeline and camera are on one port; every other offset is refused, as a write to what is read
    only."""
    registers: Mapping[int, Any] = {register.offset: register for register in (*MAP, *CAMERA_MAP)}
    for offset in range(0, 0x200, 4):
        register = registers.get(offset)
        if register is None:
            assert await axil.response_of(bench.master.master.read(offset)) == Response.SLVERR
        elif "TABLE" not in register.name:
            assert await axil.response_of(bench.master.master.read(offset)) == Response.OKAY
        if register is None or not register.writable:
            assert await bench.master.write(offset, 0) == Response.SLVERR
    assert await bench.camera_word("CAMERA_FORMAT") == CAMERA_REGISTERS["CAMERA_FORMAT"].pack(
        pixel_format=bench.camera.format.code, phase=bench.camera.phase_code, bits=bench.camera.bits
    )
