# SPDX-License-Identifier: Apache-2.0
"""tactile_sensor against the models: pictures under changing settings, broken pictures, the pins beside the stream."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import cocotb
import numpy as np
from cocotb.triggers import ClockCycles, RisingEdge

from tactile_depth.chip.camera.camera_front_end import camera_front_end, camera_settings
from tactile_depth.chip.camera_configuration import CameraConfiguration
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.latency import last_word_to_first_depth
from tactile_depth.chip.registers.axil_port import Response
from tactile_depth.chip.registers.register_map import CAMERA_MAP, CAMERA_REGISTERS, MAP, REGISTERS
from tactile_depth.chip.tactile_depth import hdl_parameters, tactile_depth, write_roms
from tactile_depth.sensor.synthetic import synthetic
from tb import axil
from tb.axis import AxisMonitor, AxisSource
from tb.camera.slots import camera_words
from tb.cases import on_bench
from tb.settings import RUN
from tb.stream import MANY, configuration, start_clock
from tb.structures import ICARUS, VERILATOR, Mutants, Structure
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


IDLE = {"frames_lost": 0, "setup_done": 0, "setup_failed": 0, "setup_entry": 0, "setup_found": 0}
STATUS, ARRIVED = CAMERA_REGISTERS["CAMERA_STATUS"], CAMERA_REGISTERS["CAMERA_ARRIVED"]


class Bench:
    """Driver of the pins, and the models."""

    def __init__(self, dut: Any) -> None:
        self.dut, self.config = dut, configuration()
        self.camera = CameraConfiguration(**RUN.device["camera"])
        self.rng = np.random.default_rng(cocotb.RANDOM_SEED)
        dut.rst.value, dut.cold_rst.value = 1, 0
        dut.m_axis_tready.value = dut.m_event_tready.value = 1
        for pin, value in IDLE.items():
            getattr(dut, pin).value = value
        self.source = AxisSource(dut, "s_axis", prefix="t")
        self.came, self.left = (AxisMonitor(dut, side, prefix="t") for side in ("s_axis", "m_axis"))
        self.master = axil.Master(dut)

    async def start(self) -> None:
        start_clock(self.dut.clk)
        await ClockCycles(self.dut.clk, 3)
        self.dut.rst.value = 0
        await RisingEdge(self.dut.clk)

    async def use(self, camera: CameraConfiguration) -> None:
        """Write the settings of a camera into the registers."""
        s = camera_settings(camera)
        words = {
            "CAMERA_PICTURE": CAMERA_REGISTERS["CAMERA_PICTURE"].pack(columns=s["columns"], rows=s["rows"]),
            "CAMERA_WINDOW": CAMERA_REGISTERS["CAMERA_WINDOW"].pack(x=s["window_x"], y=s["window_y"]),
            **{f"CAMERA_{name.upper()}": s[name] for name in ("black_level", "red_gain", "green_gain", "blue_gain")},
        }
        for name, word in words.items():
            assert await self.master.write(CAMERA_REGISTERS[name].offset, word) == Response.OKAY
            assert await self.camera_word(name) == word
        self.camera = camera

    async def camera_word(self, name: str) -> int:
        return await self.master.read(CAMERA_REGISTERS[name].offset)

    def picture(self) -> np.ndarray:
        """Return the words of a picture: a random colour with noise, so that slopes stay in their range."""
        words = self.rng.integers(0, 1 << 24, self.camera.picture)
        if self.camera.format.bayer:
            top = self.camera.bits
            words = self.rng.integers(0, 1 << top, self.camera.picture) << (16 - top if top > 8 else 0)
        return words

    async def show(self, words: np.ndarray) -> list[int]:
        """Send a picture; return the codes that leave until the pipeline is empty."""
        self.came.forget()
        self.left.forget()
        await self.source.send(camera_words(words, self.camera))
        await ClockCycles(self.dut.clk, 100)
        while await self.master.read(REGISTERS["STATUS"].offset) & REGISTERS["STATUS"].field("busy").mask:
            pass
        width = len(self.dut.m_axis_tdata)
        return [word.data - (word.data >> width - 1 << width) for word in self.left.words]

    def depth(self, words: np.ndarray) -> list[int]:
        """Return the codes of the models."""
        frame = camera_front_end(words, self.camera)
        codes: list[int] = tactile_depth(frame[None], synthetic(self.config.bits_per_channel), self.config)[0].reshape(
            -1
        )
        return [int(code) for code in codes]


@on_bench(Bench, milliseconds=5)
async def settings_change_between_pictures(bench: Bench) -> None:
    """Write window, black level and gains between pictures: depth is that of the models, at its cycle."""
    built = bench.camera
    rows, columns = built.picture
    _, _, width, height = built.crop
    chance = bench.rng

    def gain() -> float:
        return int(chance.integers(0, 4 << 12)) / 4096

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
            gains=(gain(), gain(), gain()),
        )
        for _ in range(3 * MANY)
    ]
    for place, camera in enumerate(choices):
        if place:
            await bench.use(camera)
        words = bench.picture()
        assert await bench.show(words) == bench.depth(words), camera
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
    assert await bench.show(bench.picture()) == []
    await bench.master.write(offset, built)
    words = bench.picture()
    assert await bench.show(words[:, :-1]) == []
    arrived = ARRIVED.unpack(await bench.camera_word("CAMERA_ARRIVED"))
    assert arrived["columns"] == words.shape[1] - 1
    assert await bench.show(words) == bench.depth(words)
    status = STATUS.unpack(await bench.camera_word("CAMERA_STATUS"))
    assert [name for name, bit in status.items() if bit] == ["row_short", "window_outside"]
    assert await bench.camera_word("CAMERA_DROPPED") == 2


@on_bench(Bench)
async def pins_beside_the_stream(bench: Bench) -> None:
    """Frames that dvp_receive lost count; the state of camera_setup is read; a written bit restarts it."""
    bench.dut.frames_lost.value = 3
    await RisingEdge(bench.dut.clk)
    bench.dut.frames_lost.value = 0
    bench.dut.setup_failed.value, bench.dut.setup_entry.value, bench.dut.setup_found.value = 1, 0x12, 0x34
    assert await bench.camera_word("CAMERA_LOST") == 3
    assert await bench.camera_word("CAMERA_SETUP") == 0x3412
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
