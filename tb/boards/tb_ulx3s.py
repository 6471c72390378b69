# SPDX-License-Identifier: Apache-2.0
"""Top of the ULX3S at its pins: packets enter bit by bit; records and the contact light are compared with the models.

`Board.check` feeds the models with the bytes that the test sent, broken ones included. The frame that follows a broken
one must be right.
"""

import os
import random
from typing import Any

import cocotb
import numpy as np
from cocotb.clock import Clock
from cocotb.triggers import ClockCycles, FallingEdge, ReadOnly, RisingEdge, Timer

from tactile_depth.boards.serial_link import (
    END,
    ESCAPE,
    FRAME,
    frame_packet,
    packet,
    packets,
    serial_link,
    words_of,
    write_packet,
)
from tactile_depth.link.uart import BITS, transmit
from tactile_depth.built_in import synthetic
from tactile_depth.contact.contact_events import ContactEvents, Settings
from tactile_depth.registers.register_map import REGISTERS
from tactile_depth.scenes import render
from tactile_depth.tactile_depth import tactile_depth
from tactile_depth.video.frame_guard import frame_guard
from tb.pixels import unpack
from tb.selection import Level, case
from tb.stream import CLOCK_NS, configuration, parameters

THRESHOLDS = ("THRESHOLD", "OFF_THRESHOLD")
BREAK_BITS = 25
RESET_CLOCKS = 8


class Board:
    """Device with a driver and a monitor of its serial line."""

    def __init__(self, dut: Any) -> None:
        dut._log.info("SEED=%s", os.environ["COCOTB_RANDOM_SEED"])
        self.dut, self.config = dut, configuration()
        self.rows, self.columns = self.config.rows, self.config.columns
        clock_mhz, baud, self.threshold = parameters(dut, "ClockMhz", "Baud", "Threshold")
        self.bit_clocks = round(clock_mhz * 10**6 / baud)
        self.rng = np.random.default_rng(cocotb.RANDOM_SEED)
        self.line: list[Any] = []
        self.replies: list[Any] = []
        self.starts: list[Any] = []
        self.lights: list[Any] = []
        dut.ftdi_txd.value, dut.btn.value = 1, 0

    def pipeline(self) -> Any:
        """Return tactile_depth inside the board."""
        return self.dut.u_system.g_serial.u_depth.u_pipeline

    async def start(self, button: bool = True) -> None:
        Clock(self.dut.clk_25mhz, CLOCK_NS, unit="ns", impl="gpi").start(start_high=False)
        if button:
            self.dut.btn.value = 1
            await ClockCycles(self.dut.clk_25mhz, RESET_CLOCKS)
            self.dut.btn.value = 0
        await ClockCycles(self.dut.clk_25mhz, 2 * RESET_CLOCKS)
        assert int(self.dut.led.value) == 0x80, "only the light of the PLL is on"
        cocotb.start_soon(self.listen())
        cocotb.start_soon(self.note_starts())

    async def listen(self) -> None:
        """Receive the bytes that the board sends, each with the state of the contact light at that time."""
        while True:
            await FallingEdge(self.dut.ftdi_rxd)
            await self.bits(0.5)
            assert int(self.dut.ftdi_rxd.value) == 0
            byte = 0
            for place in range(BITS - 2):
                await self.bits(1)
                byte |= int(self.dut.ftdi_rxd.value) << place
            await self.bits(1)
            assert int(self.dut.ftdi_rxd.value) == 1, "stop bit"
            self.replies.append(byte)
            self.lights.append(int(self.dut.led.value))

    async def note_starts(self) -> None:
        """Note the pipeline's cycle count at the first pixel of each frame; the record holds it."""
        depth = self.pipeline()
        while True:
            await RisingEdge(depth.s_axis_tvalid)  # tuser may be high from power-up on
            await ReadOnly()
            if not depth.s_axis_tuser.value:
                continue
            while not depth.s_axis_tready.value:
                await RisingEdge(self.dut.clk_25mhz)
                await ReadOnly()
            self.starts.append(int(depth.u_video.now.value))

    async def send(self, data: Any) -> None:
        """Send bytes back to back; None is a break."""
        for byte in data:
            if byte is None:
                self.dut.ftdi_txd.value = 0
                await self.bits(BREAK_BITS)
                self.dut.ftdi_txd.value = 1
                await self.bits(2)
            else:
                for level in transmit([byte]):
                    self.dut.ftdi_txd.value = level
                    await self.bits(1)
            self.line.append(byte)

    async def bits(self, count: Any) -> None:
        """Wait for the duration of a number of bits."""
        await Timer(round(count * self.bit_clocks * CLOCK_NS), unit="ns")

    def flat(self) -> Any:
        return np.full((self.rows, self.columns, 3), 135, np.uint8)

    def touched(self) -> Any:
        """Return a frame of a ball with noise, so that the loss of any pixel changes the result."""
        ball = render("ball", self.rows, self.columns).frames[0]
        return (ball ^ self.rng.integers(0, 8, ball.shape, np.uint8)).astype(np.uint8)

    def records(self) -> Any:
        """Return the records that the models expect on the line so far, and whether the light is on."""
        taken = serial_link(self.line, self.columns)
        guarded = frame_guard(taken.pixels, self.rows, self.columns)
        good = [frame for frame in guarded.frames if not frame.bad]
        if not good:
            return []
        pixels = unpack([frame.pixels for frame in good]).reshape(-1, self.rows, self.columns, 3)
        times = iter(self.starts)
        time_of = {index: next(times) for index, word in enumerate(taken.pixels) if word.user}
        thresholds = [[self.setting(name, taken.writes, frame.last) for name in THRESHOLDS] for frame in good]
        return self.records_of(pixels, thresholds, [time_of[frame.first] for frame in good])

    def records_of(self, pixels: np.ndarray, thresholds: Any, times: Any) -> list[tuple[Any, bool]]:
        """Return the record of each frame, and whether its light is on, from its thresholds and its time."""
        depth = tactile_depth(pixels, synthetic(self.config.bits_per_channel), self.config)
        events = ContactEvents(self.rows, self.columns, self.config.data_width, self.config.solver == "tridiagonal")
        expected_records = []
        for codes, (on, off), time in zip(depth, thresholds, times, strict=True):
            settings = Settings(on, off, 0, 1, 1)
            for place, code in enumerate(codes.flat):
                row_end = place % self.columns == self.columns - 1
                record = events.beat(int(code), place == 0, row_end, place == codes.size - 1, settings, time)
            expected_records.append((record.words, bool((codes > on).any())))  # type: ignore[union-attr]
        return expected_records

    def setting(self, name: str, writes: Any, pixels: int) -> Any:
        """Return the value of a register when the frame with this last pixel leaves; tests write between frames."""
        written = [value for address, value, before in writes if address == REGISTERS[name].offset and before <= pixels]
        value = written[-1] if written else self.threshold
        return value - (value >> 31 << 32)

    async def check(self) -> int:
        """Wait until everything has left; compare every record, and the light at the end of each."""
        depth_clocks = 2 * self.rows * self.columns + 8 * self.columns + 1000
        await ClockCycles(self.dut.clk_25mhz, depth_clocks + 120 * BITS * self.bit_clocks)
        expected = self.records()
        received = [words_of(content) for content in packets(self.replies)]
        assert [words for words, _ in expected] == received
        ends = [place for place, byte in enumerate(self.replies) if byte == END][1::2]
        assert [bool(self.lights[place] & 1) for place in ends] == [light for _, light in expected]
        assert [self.lights[place] >> 1 & 1 for place in ends] == [(number + 1) % 2 for number in range(len(ends))]
        return len(received)


@case(Level.FIRST, milliseconds=1)
async def wakes(dut: Any) -> None:
    """Come up from any state of the registers: PLL locked, other lights off, nothing sent."""
    board = Board(dut)
    await board.start(button=False)
    await ClockCycles(dut.clk_25mhz, 1000)
    assert int(dut.led.value) == 0x80
    assert int(dut.ftdi_rxd.value) == 1
    assert not board.replies


@case(Level.FIRST, milliseconds=20)
async def frames(dut: Any) -> None:
    """Send frames with and without contact in turn: each has its record, and the light follows."""
    board = Board(dut)
    await board.start()
    for pixels in (board.touched(), board.flat(), board.touched()):
        await board.send(frame_packet(pixels))
    assert await board.check() == 3
    assert [light for _, light in board.records()] == [True, False, True]


@case(Level.LONG, milliseconds=40)
async def broken_transfers(dut: Any) -> None:
    """Send each kind of broken transfer; the next frame is right."""
    board = Board(dut)
    await board.start()
    rng = random.Random(cocotb.RANDOM_SEED)
    frame_bytes = frame_packet(board.touched())
    middle = len(frame_bytes) // 2
    broken = [
        frame_bytes[:middle],  # without its end: the first End of the next packet closes it
        frame_bytes[:middle] + frame_bytes[middle + 1 :],  # a byte is missing
        frame_bytes[:-1] + frame_bytes[1:4] + frame_bytes[-1:],  # a pixel too many
        (*frame_bytes[:middle], None, *frame_bytes[middle:]),  # a break
        (*frame_bytes[:middle], ESCAPE, 0, *frame_bytes[middle:]),  # a wrong escape
        frame_bytes[:5] + frame_bytes[1:],  # no End before
        packet([3, 1, 2]),  # nothing known
        bytes(rng.randrange(256) for _ in range(40)),  # noise
        (None, None, *frame_bytes[:30], *frame_bytes[:9], END, END, END, *packet([FRAME])),
    ]
    for transfer in broken:
        await board.send(transfer)
        await ClockCycles(dut.clk_25mhz, rng.choice([0, 500]))
        await board.send(frame_packet(board.touched()))
    assert await board.check() >= len(broken)


@case(milliseconds=20)
async def registers(dut: Any) -> None:
    """Write a threshold over the line: it applies from the next frame on. A write of another length has no effect."""
    board = Board(dut)
    await board.start()
    touched = board.touched()
    highest = int(tactile_depth(touched[None], synthetic(board.config.bits_per_channel), board.config).max())
    writes = [write_packet(REGISTERS["THRESHOLD"].offset, highest - 1), b""]
    writes += [
        write_packet(REGISTERS["THRESHOLD"].offset, highest),
        write_packet(REGISTERS["OFF_THRESHOLD"].offset, -5),
    ]
    long = write_packet(REGISTERS["THRESHOLD"].offset, -(1 << 31))
    writes += [(*long[:3], None, *long[3:], *long[:-1], 0, END, *long[:-2], END)]  # type: ignore[list-item]
    for write in writes:
        await board.send(write)
        await board.send(frame_packet(touched))
        await ClockCycles(dut.clk_25mhz, 2 * touched.size + 2000)
    assert await board.check() == len(writes)
    assert [light for _, light in board.records()] == [True, True, False, False, False]


@case(milliseconds=20)
async def button(dut: Any) -> None:
    """Press the button inside a frame: the next frame counts as the first, with the threshold of a reset."""
    board = Board(dut)
    await board.start()
    await board.send(write_packet(REGISTERS["THRESHOLD"].offset, (1 << 31) - 1))
    await board.send(frame_packet(board.touched())[:100])
    dut.btn.value = 1
    await ClockCycles(dut.clk_25mhz, RESET_CLOCKS)
    dut.btn.value = 0
    await ClockCycles(dut.clk_25mhz, RESET_CLOCKS)
    for kept in (board.line, board.starts):
        kept.clear()
    await board.send(frame_packet(board.touched()))
    assert await board.check() == 1
