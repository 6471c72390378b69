# SPDX-License-Identifier: Apache-2.0
"""The top of the ULX3S behind a camera, at its pins: pictures on the parallel port, SCCB, records on the line."""

from typing import Any

import cocotb
import numpy as np
from cocotb.clock import Clock
from cocotb.triggers import ClockCycles, RisingEdge

from tactile_depth.chip.camera.camera_front_end import camera_front_end
from tactile_depth.chip.camera.camera_setup import Entry, Kind
from tactile_depth.chip.camera.dvp_receive import IDLE, Pins, camera_pins
from tactile_depth.chip.camera.pixel_format import photograph
from tactile_depth.chip.camera.register_lists import Camera
from tactile_depth.chip.camera_configuration import CameraConfiguration
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.registers.register_map import REGISTERS
from tactile_depth.sensor.scenes import render
from tb.boards.tb_ulx3s import Board
from tb.camera.sccb_camera import SccbCamera
from tb.selection import case
from tb.stream import CLOCK_NS

RATIO = 2  # camera pixels for each of the grid
PCLK_NS = 18  # of the camera's clock, which no edge of the board's clock follows
ROW_BLANK, FRAME_BLANK = 7, 40
DONE, FAILED, LOST, IRQ, LOCKED = 1 << 2, 1 << 3, 1 << 4, 1 << 5, 1 << 7  # lights
PRODUCT = (0x0A, 0x76)
ENTRIES = (
    Entry(Kind.PINS, 2, 1),
    Entry(Kind.PINS, 1, 1),
    Entry(Kind.CHECK, *PRODUCT),
    Entry(Kind.WRITE, 0x12, 0x01),
    Entry(Kind.WRITE, 0x3B, 0xA5),
)


def sensor(config: Configuration) -> Camera:
    """Return a camera whose pictures have RATIO pixels for each of the grid, along rows and columns."""
    picture = (RATIO * config.rows, RATIO * config.columns)
    return Camera("short", 1, 0x42, picture=picture, bayer="bggr", frames_per_s=1, entries=ENTRIES)


def camera_of(config: Configuration) -> CameraConfiguration:
    """Return the front end for the sensor."""
    device = sensor(config)
    return CameraConfiguration(device.picture, (config.rows, config.columns), "raw8", device.bayer)


class CameraBoard(Board):
    """The board, its serial line, and a camera at its header."""

    def __init__(self, dut: Any) -> None:
        super().__init__(dut)
        self.camera = camera_of(self.config)
        self.sccb = SccbCamera(0x42, 1, dict([PRODUCT]))
        self.pictures: list[np.ndarray] = []  # of the grid, of good pictures
        self.thresholds: list[tuple[int, int]] = []
        self.now = self.threshold, self.threshold
        dut.camera_pulls.value = dut.camera_vsync.value = dut.camera_href.value = dut.camera_data.value = 0

    def pipeline(self) -> Any:
        return self.dut.u_board.u_system.g_camera.u_sensor.u_sensor.u_pipeline

    async def start(self, button: bool = True) -> None:
        Clock(self.dut.camera_pclk, PCLK_NS, unit="ns", impl="gpi").start(start_high=False)
        cocotb.start_soon(self.answer())
        await super().start(button)

    async def answer(self) -> None:
        """Be the camera on the two lines of SCCB."""
        while True:
            await RisingEdge(self.dut.clk_25mhz)
            levels = self.dut.camera_sio_c.value, self.dut.camera_sio_d.value
            if all(level.is_resolvable for level in levels):
                self.dut.camera_pulls.value = int(not self.sccb.follow(*map(int, levels)))

    async def set_up(self) -> None:
        """Start, and wait until the list has ended."""
        await self.start()
        for _ in range(100):
            await ClockCycles(self.dut.clk_25mhz, 200)
            if int(self.dut.led.value) & (DONE | FAILED):
                break
        else:
            raise AssertionError("the list does not end")
        await self.set(THRESHOLD=self.threshold, OFF_THRESHOLD=self.threshold)

    async def play(self, pins: Any) -> None:
        """Drive the pins of the parallel port, an entry in each clock of the camera."""
        for vsync, href, data in pins:
            self.dut.camera_vsync.value, self.dut.camera_href.value = int(vsync), int(href)
            self.dut.camera_data.value = data
            await RisingEdge(self.dut.camera_pclk)

    async def show(self, press: bool) -> None:
        """Send a whole picture, and note what the models say of it; then wait until its depth has left."""
        words = self.picture(press)
        self.pictures.append(camera_front_end(words, self.camera))
        self.thresholds.append(self.now)
        await self.play(camera_pins(words.astype(np.uint8), ROW_BLANK, FRAME_BLANK))
        await self.play([IDLE] * FRAME_BLANK)
        await ClockCycles(self.dut.clk_25mhz, 2 * self.rows * self.columns + 8 * self.columns + 1000)

    def picture(self, press: bool) -> np.ndarray:
        """Return the words of a picture: a ball with noise, so that the loss of any byte shows, or nothing."""
        rows, columns = self.camera.picture
        seen = render("ball", rows, columns).frames[0] if press else np.full((rows, columns, 3), 135, np.uint8)
        noise = self.rng.integers(0, 8 if press else 1, seen.shape, np.uint8)
        return photograph((seen ^ noise).astype(np.uint8), self.camera)

    def frames(self) -> Any:
        """Return what the models expect of each good picture so far."""
        whole = [index for index in range(len(self.starts)) if index not in self.dropped]
        times = [self.starts[index] for index in whole]
        resumed = [index - 1 in self.dropped for index in whole]
        return self.frames_of(np.stack(self.pictures), self.thresholds, times, resumed)

    dropped: tuple[int, ...] = ()  # frames that begin and are not whole, by their number


@case(milliseconds=20)
async def brings_the_camera_up(dut: Any) -> None:
    """The list arrives, the pins follow it, the light says so, and XCLK runs at a quarter of the clock."""
    board = CameraBoard(dut)
    await board.set_up()
    assert int(dut.led.value) == LOCKED | DONE
    assert board.sccb.registers == dict([PRODUCT]) | {entry.address: entry.data for entry in ENTRIES[3:]}
    assert (int(dut.camera_power_down.value), int(dut.camera_reset_n.value)) == (0, 1)
    for _ in range(3):
        await RisingEdge(dut.camera_xclk)
        begun = cocotb.utils.get_sim_time("ns")
        await RisingEdge(dut.camera_xclk)
        assert cocotb.utils.get_sim_time("ns") - begun == 4 * CLOCK_NS


@case(milliseconds=20)
async def a_camera_that_does_not_answer(dut: Any) -> None:
    """Another product: the light says that the list has failed; pictures are taken all the same."""
    board = CameraBoard(dut)
    board.sccb.registers[PRODUCT[0]] = PRODUCT[1] ^ 1
    await board.set_up()
    assert int(dut.led.value) == LOCKED | FAILED
    await board.show(True)
    assert await board.check() == 1


@case(milliseconds=40)
async def pictures(dut: Any) -> None:
    """Contact and none in turn: a record of each, the light on and off, and a threshold written between them."""
    board = CameraBoard(dut)
    await board.set_up()
    for press in (True, False, True):
        await board.show(press)
    highest = max(record.peak for _, record, _ in board.frames())
    await board.set(THRESHOLD=highest, OFF_THRESHOLD=highest)
    board.now = highest, highest
    await board.show(False)
    assert await board.check() == 4
    assert board.lights == [True, False, True, False]


@case(milliseconds=40)
async def malformed_pictures(dut: Any) -> None:
    """A row too short, and a picture that ends early: each is dropped, irq says so, and the next picture is right."""
    board = CameraBoard(dut)
    await board.set_up()
    await board.set(INTERRUPT_MASK=REGISTERS["INTERRUPT_MASK"].pack(frame_dropped=1))
    await board.show(True)
    assert not int(dut.led.value) & IRQ
    whole = list(camera_pins(board.picture(True).astype(np.uint8), ROW_BLANK, FRAME_BLANK))
    columns = board.camera.picture[1]
    short = [*whole[: len(whole) // 2], *whole[len(whole) // 2 + columns // 2 :]]
    for broken in (short, whole[: len(whole) // 2]):
        board.dropped = (*board.dropped, len(board.starts))
        await board.play([*broken, *[Pins(False, False, 0)] * FRAME_BLANK])
        await board.show(True)
        assert int(dut.led.value) & IRQ
    assert await board.check() == 3
