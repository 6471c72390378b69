# SPDX-License-Identifier: Apache-2.0
"""Top of the ULX3S at its pins: packets enter bit by bit; records, depth and the light are compared with the models.

`Board.check` feeds the models with the bytes that the test sent, broken ones included. The picture that follows a
broken one must be right.
"""

import random
from typing import Any

import cocotb
import numpy as np
from cocotb.triggers import ClockCycles, FallingEdge, ReadOnly, RisingEdge, Timer, ValueChange

from commands.common.run_request import threshold_code
from tactile_depth.chip.common.td_round_saturate import Monitor
from tactile_depth.chip.contact.contact_events import ContactEvents, Settings
from tactile_depth.chip.link.depth_frames import DepthFrames
from tactile_depth.chip.link.device import Build, LinkDevice
from tactile_depth.chip.link.framing import to_line
from tactile_depth.chip.link.packets import MOST_PIXELS, Packet, PacketReader, Picture, RecordPacket, Status, Write
from tactile_depth.chip.link.uart import BITS, transmit
from tactile_depth.chip.registers.register_map import REGISTERS
from tactile_depth.chip.tactile_depth import depth_and_flags, slope_tables, tactile_depth
from tactile_depth.chip.video.frame_guard import frame_guard
from tactile_depth.sensor.scenes import render
from tactile_depth.sensor.synthetic import synthetic
from tb.pixels import unpack
from tb.selection import Level, case
from tb.stream import CLOCK_NS, configuration, parameters, start_clock

THRESHOLDS = ("THRESHOLD", "OFF_THRESHOLD")
BREAK_BITS = 25
RESET_CLOCKS = 8


class Board:
    """Device with a driver and a monitor of its serial line."""

    def __init__(self, dut: Any) -> None:
        self.dut, self.config = dut, configuration()
        self.rows, self.columns = self.config.rows, self.config.columns
        self.threshold = threshold_code(self.config)
        clock_mhz, baud = parameters(dut, "ClockMhz", "Baud")
        self.bit_clocks = round(clock_mhz * 10**6 / baud)
        self.rng = np.random.default_rng(cocotb.RANDOM_SEED)
        self.line: list[Any] = []
        self.replies: list[Any] = []
        self.starts: list[Any] = []
        self.lights: list[bool] = []  # the contact light when the light of a record changes
        self.sent = 0  # packets
        dut.ftdi_txd.value, dut.btn.value = 1, 0

    def pipeline(self) -> Any:
        """Return tactile_depth inside the board."""
        return self.dut.u_system.g_serial.u_depth.u_pipeline

    async def start(self, button: bool = True) -> None:
        start_clock(self.dut.clk_25mhz)
        self.dut.btn.value = int(button)
        await ClockCycles(self.dut.clk_25mhz, RESET_CLOCKS)
        self.dut.btn.value = 0
        cocotb.start_soon(self.listen())  # the first packet leaves soon after the reset
        await ClockCycles(self.dut.clk_25mhz, 2 * RESET_CLOCKS)
        assert int(self.dut.led.value) == 0x80, "only the light of the PLL is on"
        cocotb.start_soon(self.watch())
        cocotb.start_soon(self.note_starts())

    async def listen(self) -> None:
        """Receive the bytes that the board sends."""
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

    async def watch(self) -> None:
        """Note the contact light whenever the light of a record changes."""
        recorded = False
        while True:
            await ValueChange(self.dut.led)
            await ReadOnly()
            lights = int(self.dut.led.value)
            assert not lights & 64, "no frame is in doubt"
            if bool(lights & 2) != recorded:
                recorded = not recorded
                self.lights.append(bool(lights & 1))

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

    def picture_bytes(self, pixels: np.ndarray) -> list[Any]:
        """Return the bytes on the line of a picture, uint8 (rows, columns, 3)."""
        self.sent += 1
        size = 3 * MOST_PIXELS
        data = pixels.tobytes()
        packets = [
            Picture(self.sent, *divmod(first // 3, self.columns), data[first : first + size])
            for first in range(0, len(data), size)
        ]
        return [byte for packet in packets for byte in to_line(packet.pack())]

    def write_bytes(self, **values: int) -> list[Any]:
        """Return the bytes on the line that write registers."""
        self.sent += 1
        pairs = tuple((REGISTERS[name].offset, value % (1 << 32)) for name, value in values.items())
        return list(to_line(Write(self.sent % 256, pairs).pack()))

    async def set(self, **values: int) -> None:
        """Write registers over the line."""
        await self.send(self.write_bytes(**values))

    def flat(self) -> Any:
        return np.full((self.rows, self.columns, 3), 135, np.uint8)

    def touched(self) -> Any:
        """Return a frame of a ball with noise, so that the loss of any pixel changes the result."""
        ball = render("ball", self.rows, self.columns).frames[0]
        return (ball ^ self.rng.integers(0, 8, ball.shape, np.uint8)).astype(np.uint8)

    def taken(self) -> tuple[list[Any], list[tuple[int, int, int]]]:
        """Return the words of pixels that the models take of the line so far, and the writes: address, value, and how
        many words were before it."""
        writes: list[tuple[int, int, int]] = []
        words: list[Any] = []

        def write(address: int, value: int) -> bool:
            writes.append((address, value, len(device.pixels)))
            return True

        build = Build(self.rows, self.columns, self.config.data_width, self.config.solver == "tridiagonal")
        device = LinkDevice(build, lambda _: 0, write)
        device.receive(bytes(0xFF if byte is None else byte for byte in self.line))
        words += device.pixels
        return words, writes

    def frames(self) -> Any:
        """Return what the models expect of each frame on the line so far: codes, record, and whether the light is
        on."""
        words, writes = self.taken()
        good = [frame for frame in frame_guard(words, self.rows, self.columns).frames if not frame.bad]
        if not good:
            return []
        pixels = unpack([frame.pixels for frame in good]).reshape(-1, self.rows, self.columns, 3)
        times = iter(self.starts)
        time_of = {index: next(times) for index, word in enumerate(words) if word.user}
        thresholds = [[self.setting(name, writes, frame.last) for name in THRESHOLDS] for frame in good]
        resumed = [frame.resumed for frame in good]
        return self.frames_of(pixels, thresholds, [time_of[frame.first] for frame in good], resumed)

    def frames_of(
        self, pixels: np.ndarray, thresholds: Any, times: Any, resumed: Any
    ) -> list[tuple[np.ndarray, Any, bool]]:
        """Return codes and record of each frame, and whether its light is on.

        Thresholds, times and `resumed`, that pixels before it were dropped, are those of each frame.
        """
        tables = slope_tables(synthetic(self.config.bits_per_channel), self.config)
        events = ContactEvents(self.rows, self.columns, self.config.data_width, self.config.solver == "tridiagonal")
        expected = []
        for frame, (on, off), time, late in zip(pixels, thresholds, times, resumed, strict=True):
            _, codes, flags = depth_and_flags(frame, self.config, tables, Monitor(), resumed=late)
            record = events.whole_frame(codes, Settings(on, off, 0, 1, 1), time, flags)
            expected.append((codes, record, bool((codes > on).any())))
        return expected

    def setting(self, name: str, writes: Any, pixels: int) -> Any:
        """Return the value of a register when the frame with this last pixel leaves; tests write between frames."""
        register = REGISTERS[name]
        written = [value for address, value, before in writes if address == register.offset and before <= pixels]
        value = written[-1] if written else register.reset or 0
        return value - (value >> 31 << 32)

    async def check(self) -> int:
        """Wait until everything has left; compare every record, every depth frame, and the light of each."""
        quiet, before = 0, -1
        while quiet < 3:
            await ClockCycles(self.dut.clk_25mhz, 2 * self.rows * self.columns + 8 * self.columns + 1000)
            quiet = quiet + 1 if len(self.replies) == before else 0
            before = len(self.replies)
        expected = self.frames()
        packets: list[Packet] = PacketReader().feed(bytes(self.replies))
        records = [packet.record for packet in packets if isinstance(packet, RecordPacket)]
        numbers = [record.frame for record in records]
        assert numbers == sorted(set(numbers))
        for record in records:
            assert record == expected[record.frame - 1][1]
        host = DepthFrames()
        delivered = host.feed(bytes(self.replies))
        assert delivered
        assert delivered[-1].record == records[-1] == expected[-1][1]
        assert (host.lost, host.reader.bad_packets) == (0, 0)
        top_down = slice(None, None, -1 if self.config.solver == "tridiagonal" else 1)
        for frame in delivered:
            codes, record, _ = expected[frame.record.frame - 1]
            assert np.array_equal(frame.codes, codes[top_down])
            assert frame.record == record
        assert self.lights == [light for _, _, light in expected]
        return len(expected)


@case(Level.FIRST, milliseconds=2)
async def wakes(dut: Any) -> None:
    """Come up from any state of the registers: PLL locked, other lights off, a status sent."""
    board = Board(dut)
    await board.start(button=False)
    await ClockCycles(dut.clk_25mhz, 60 * BITS * board.bit_clocks)
    assert int(dut.led.value) == 0x80
    assert int(dut.ftdi_rxd.value) == 1
    (status,) = PacketReader().feed(bytes(board.replies))
    build = Build(board.rows, board.columns, board.config.data_width, board.config.solver == "tridiagonal")
    expected = LinkDevice(build, lambda _: 0, lambda _, __: True).status()
    assert isinstance(status, Status)
    assert status == expected._replace(resets=status.resets)  # the reset's registers begin in any state


@case(Level.FIRST, milliseconds=20)
async def frames(dut: Any) -> None:
    """Send pictures with and without contact in turn: each has its record and depth, and the light follows."""
    board = Board(dut)
    await board.start()
    await board.set(THRESHOLD=board.threshold, OFF_THRESHOLD=board.threshold)
    for pixels in (board.touched(), board.flat(), board.touched()):
        await board.send(board.picture_bytes(pixels))
    assert await board.check() == 3
    assert board.lights == [True, False, True]


@case(Level.LONG, milliseconds=40)
async def broken_transfers(dut: Any) -> None:
    """Send each kind of broken transfer; the next picture is right."""
    board = Board(dut)
    await board.start()
    rng = random.Random(cocotb.RANDOM_SEED)
    whole = board.picture_bytes(board.touched())
    middle = len(whole) // 2
    broken = [
        whole[:middle],  # without its end: the first zero of the next packet closes it
        whole[:middle] + whole[middle + 1 :],  # a byte is missing
        [*whole[:middle], whole[middle - 1], *whole[middle:]],  # a byte too many
        [*whole[:middle], None, *whole[middle:]],  # a break
        [*whole[:middle], whole[middle] ^ 1 or 1, *whole[middle + 1 :]],  # a wrong byte
        [*to_line(bytes((0x23, 1, 2)))],  # nothing known
        [rng.randrange(256) for _ in range(40)],  # noise
        [None, None, *whole[:30], *whole[:9], 0, 0, 0],
    ]
    for transfer in broken:
        await board.send(transfer)
        await ClockCycles(dut.clk_25mhz, rng.choice([0, 500]))
        await board.send(board.picture_bytes(board.touched()))
        await ClockCycles(dut.clk_25mhz, 3 * len(whole))  # packet_store keeps two packets, and gives a byte in 3 cycles
    assert await board.check() >= len(broken)


@case(milliseconds=20)
async def registers(dut: Any) -> None:
    """Write a threshold over the line: it applies from the next frame on. A broken write has no effect."""
    board = Board(dut)
    await board.start()
    touched = board.touched()
    highest = int(tactile_depth(touched[None], synthetic(board.config.bits_per_channel), board.config).max())
    broken = board.write_bytes(THRESHOLD=-(1 << 31))
    for write in (
        board.write_bytes(THRESHOLD=highest - 1, OFF_THRESHOLD=highest - 1),
        [],
        board.write_bytes(THRESHOLD=highest, OFF_THRESHOLD=-5),
        [*broken[:3], None, *broken[3:], *broken[:-2], 0],
    ):
        await board.send(write)
        await board.send(board.picture_bytes(touched))
        await ClockCycles(dut.clk_25mhz, 2 * touched.size + 2000)
    assert await board.check() == 4
    assert board.lights == [True, True, False, False]


@case(milliseconds=20)
async def button(dut: Any) -> None:
    """Press the button inside a picture: the next one counts as the first, with the threshold of a reset."""
    board = Board(dut)
    await board.start()
    await board.set(THRESHOLD=(1 << 31) - 1)
    await board.send(board.picture_bytes(board.touched())[:100])
    dut.btn.value = 1
    await ClockCycles(dut.clk_25mhz, RESET_CLOCKS)
    dut.btn.value = 0
    await ClockCycles(dut.clk_25mhz, RESET_CLOCKS)
    for kept in (board.line, board.starts, board.replies):
        kept.clear()
    await board.send(board.picture_bytes(board.touched()))
    assert await board.check() == 1
