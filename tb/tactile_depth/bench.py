# SPDX-License-Identifier: Apache-2.0
"""Bench of tactile_depth: drivers and monitors at its pins.

`Pipeline.check` feeds the models with the words that the monitor saw on s_axis and compares every code, side-band,
latency, counter and status bit; `contact` is compared in every cycle. Each test begins with a device after a reset,
with the tables of its build.
"""

import random
from collections.abc import Callable, Sequence
from typing import Any

import cocotb
import numpy as np
from cocotb.triggers import ClockCycles, RisingEdge

from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.registers.register_map import REGISTERS
from tactile_depth.chip.video.frame_guard import Word, frame_guard
from tactile_depth.sensor.synthetic import synthetic
from tb.axil import Master, RegisterClient
from tb.axis import AxisMonitor, AxisSink, AxisSource, BeatMonitor, positions, profile, video
from tb.pixels import pack
from tb.second_client import SecondMaster, SecondSink, SecondSource
from tb.settings import RUN
from tb.stream import at_every_edge, configuration, start_clock
from tb.tactile_depth import device_tables
from tb.tactile_depth.contact_watch import RECORD, ContactWatch
from tb.tactile_depth.device_tables import Content, DeviceTables
from tb.tactile_depth.scoreboard import STATUS, Checked, Scoreboard

CONTROL, COMMIT, LIGHT = REGISTERS["CONTROL"], REGISTERS["TABLE_COMMIT"], REGISTERS["LIGHT"]
HEAD_CLOCKS = 2  # cycles from a pixel at the pins to the same pixel at the head of the pipeline
SKID_WORDS = 2  # beats that a stalled output holds
FLAT = (135, 135, 135)  # a colour without contact
RESET_CLOCKS = 3
RECORD_PROFILES = ("none", "one_in_4", "alternate", "random")  # profiles of a sink that loses no record
Stream = Sequence[Word | None]


class Pipeline:
    """Drivers, monitors, scoreboard and registers of one test."""

    def __init__(self, dut: Any, offers: str = "none", accepts: str = "none", timeout: int = 0) -> None:
        self.dut, self.random = dut, random.Random(cocotb.RANDOM_SEED)
        self.config: Configuration = configuration()
        self.rows, self.columns = self.config.rows, self.config.columns
        self.pixels = self.rows * self.columns
        self.held = SKID_WORDS * self.config.lanes  # depths that a stalled output holds
        self.timeout, self.stalled = timeout, accepts != "none"
        self.profiles = offers, accepts
        dut.rst.value, dut.cold_rst.value, dut.m_event_tready.value = 1, 0, 1
        master: Any
        self.source: Any
        self.sink: Any
        if RUN.second_client:
            self.source = SecondSource(dut, profile(offers, 1))
            self.sink = SecondSink(dut, profile(accepts, 2))
            master = SecondMaster(dut)
        else:
            self.source = AxisSource(dut, "s_axis", prefix="t", offers=profile(offers, 1))
            self.sink = AxisSink(dut, "m_axis", prefix="t", accepts=profile(accepts, 2))
            master = Master(dut)
        self.into = AxisMonitor(dut, "s_axis", prefix="t", silence=bool(timeout))
        self.out = BeatMonitor(dut, "m_axis", self.config.lanes, prefix="t")
        self.registers = RegisterClient(master)
        self.read, self.write = self.registers.read, self.registers.write
        self.tables = DeviceTables(self.config, self.registers)
        self.contact = ContactWatch(dut, self.config, profile(accepts if accepts in RECORD_PROFILES else "none", 3))
        self.scoreboard = Scoreboard(self.config, self.contact)

    async def start(self) -> None:
        """Start clock and monitors, reset, and restore the tables that earlier tests have changed."""
        start_clock(self.dut.clk)
        at_every_edge(self.dut.clk, self.contact.watch_contact())
        cocotb.start_soon(self.contact.watch_events())
        await self.reset(RESET_CLOCKS)
        if device_tables.changed:
            await self.tables.restore()
            await self.send(self.plain())  # its first pixel takes the tables into use
            await self.idle()
            device_tables.changed.clear()
            self.disturb(*self.profiles)
            await self.reset(RESET_CLOCKS)
        if self.timeout:
            await self.write("TIMEOUT", self.timeout)

    def disturb(self, offers: str, accepts: str) -> None:
        """Restart the profiles of source and sink."""
        self.source.offers = profile(offers, 1)
        self.sink.stall(profile(accepts, 2))

    async def reset(self, clocks: int) -> None:
        """Reset for a number of cycles; frames sent before are no longer expected."""
        self.source.abort()
        self.dut.rst.value = 1
        await ClockCycles(self.dut.clk, clocks)
        self.dut.rst.value = 0
        await RisingEdge(self.dut.clk)  # AXI: the first edge out of reset comes before the first word
        self.forget()
        self.contact.events.reset()
        self.scoreboard.reset()

    def forget(self) -> None:
        """Clear the records of the monitors."""
        if RUN.second_client:
            self.sink.words()
        self.into.forget()
        self.out.forget()
        self.contact.forget()

    # What a test has reached.

    def phases(self) -> set[str]:
        """Return the phases of this cycle: a frame may enter while another one leaves."""
        dut, guarded = self.dut, frame_guard(self.into.words, self.rows, self.columns)
        broken = [frame.first for frame in guarded.frames if frame.bad]
        whole = len(guarded.frames) - len(broken)
        inside, offered = bool(guarded.open), bool(dut.m_axis_tvalid.value)
        filling = bool(broken) and self.into.clock_count < self.into.taken[broken[-1]] + self.pixels
        stalled = offered and not dut.m_axis_tready.value
        left = len(self.out.words) == whole * self.pixels
        phases = {
            "mid_frame": inside,
            "filling": filling,
            "waiting": not inside and not offered and not left,
            "output": offered and not stalled,
            "stalled": stalled,
            "full": stalled and dut.s_axis_tvalid.value and not dut.s_axis_tready.value,
            "idle": not inside and not filling and not offered and left,
        }
        return {phase for phase, reached in phases.items() if reached}

    def handshakes(self) -> set[tuple[str, str]]:
        """Return what input and output did in the same cycle since the last check: "idle", "held" or "taken".

        At the input a start of frame, held or taken, is "start".
        """
        into, out = (
            {
                clock: "held" if clock < taken else "taken"
                for since, taken in zip(monitor.offered, monitor.taken, strict=True)
                for clock in range(since, taken + 1)
            }
            for monitor in (self.into, self.out)
        )
        for word, since, taken in zip(self.into.words, self.into.offered, self.into.taken, strict=True):
            into |= dict.fromkeys(range(since, taken + 1), "start") if word.user else {}
        return {(into.get(clock, "idle"), out.get(clock, "idle")) for clock in range(min(into), max(out) + 1)}

    # Frames.

    def frame(self) -> list[Word]:
        """Return the words of a frame of random colours."""
        return video((self.random.getrandbits(24) for _ in range(self.pixels)), self.columns)

    def plain(self, colour: Sequence[int] = FLAT) -> list[Word]:
        """Return the words of a frame of one colour."""
        return video([int(pack(colour))] * self.pixels, self.columns)

    def frame_of(self, slopes: np.ndarray) -> list[Word]:
        """Return the words of a frame whose slopes are those of the gradient table nearest to `slopes`, (rows, columns,
        2).

        With flat-fielding the reference is 128.
        """
        bits = self.config.bits_per_channel
        if self.config.flat_field:
            coefficients: Any = synthetic(bits).coefficients
            deviation = slopes @ np.linalg.pinv(coefficients[..., 0]).T
            rgb = np.clip(np.rint(128 * (1 + deviation)), 0, 255).astype(int)
            return video(pack(rgb).ravel(), self.columns)
        entries = self.tables.content.entries["gradient"] * self.config.gradient_lsb
        bins = ((slopes.reshape(-1, 1, 2) - entries) ** 2).sum(axis=-1).argmin(axis=1)
        rgb = np.stack([(bins >> shift & (1 << bits) - 1) << 8 - bits for shift in (2 * bits, bits, 0)], axis=-1)
        return video(pack(rgb), self.columns)

    def pressed(self, slope: float = 0.5) -> list[Word]:
        """Return the words of a frame with a pyramid, whose slopes change their sign in the middle of both axes."""
        along, down = (np.where(np.arange(n) < n // 2, slope, -slope) for n in (self.columns, self.rows))
        return self.frame_of(np.stack(np.meshgrid(along, down), axis=-1))

    def places(self, fault: str) -> list[int]:
        """Return positions for a fault: first, last and inner pixels of first, last and inner rows."""
        size, pixels = self.columns, self.pixels
        inner = self.rows // 2 * size
        chosen = (0, 1, size - 2, size - 1, size, inner + 3, inner + size - 1, pixels - size, pixels - 2, pixels - 1)
        return [position for position in chosen if position in positions(fault, self.rows, size)]

    def depth_of(self, *frames: Stream) -> np.ndarray:
        """Return the expected depth codes (frames, rows, columns) of whole frames."""
        words = [[word.data for word in frame if word is not None] for frame in frames]
        return self.scoreboard.model(words, self.tables.content)

    async def hold_light(self) -> None:
        """Hold the light gains as they are, in a build with light gains."""
        if self.scoreboard.light is not None:
            await self.write("LIGHT", LIGHT.pack(follow=0))
            self.scoreboard.light.follow = False

    # Traffic.

    async def send(self, *streams: Stream) -> None:
        """Send words, one stream after another; None is a cycle of pause."""
        await self.source.send([word for stream in streams for word in stream])

    async def idle(self) -> None:
        """Wait until no frame is in flight."""
        for _ in range(400 * self.pixels // 64):
            if not STATUS.unpack(await self.read("STATUS"))["busy"]:
                return
        raise AssertionError("STATUS.busy does not fall")

    async def until(self, reached: Callable[[], object]) -> None:
        """Wait until a condition holds, cycle by cycle."""
        while not reached():
            await RisingEdge(self.dut.clk)

    async def drain(self) -> None:
        """Wait until every frame has left. The source must be idle."""
        await RisingEdge(self.dut.clk)  # the monitor may see the last word later than the test
        frames, _ = self.scoreboard.frames(self.into, self.timeout)
        words = sum(not frame.bad for frame in frames) * self.pixels
        await self.idle()
        for _ in range(100 * SKID_WORDS * self.columns):
            if len(self.out.words) >= words:
                break
            await RisingEdge(self.dut.clk)
        await ClockCycles(self.dut.clk, 4 * self.columns)

    async def check(self, counters: bool = True, contents: Sequence[Content] | None = None) -> Checked:
        """Wait until every frame has left, then compare with the models.

        `contents` holds the content of the tables for each frame, if it changes.
        """
        await self.drain()
        if RUN.second_client:
            assert self.sink.words() == self.out.words, "the second client's sink saw other words than the monitor"
        checked = self.scoreboard.compare(
            self.into, self.out, self.timeout, contents or self.tables.content, not self.stalled
        )
        if self.contact.packets:
            have = [await self.read(name) for name in RECORD]
            assert have == self.contact.packets[-1], "the registers of the last record"
        await self.scoreboard.check_registers(self.registers, counters)
        self.forget()
        return checked

    async def play(self, *streams: Stream) -> None:
        """Send streams and compare what leaves with the models."""
        await self.send(*streams)
        await self.check()

    async def clear_status(self, **bits: int) -> None:
        """Clear bits of STATUS by writing ones to them."""
        await self.write("STATUS", STATUS.pack(**bits))
        self.scoreboard.sticky -= bits.keys()


async def started(dut: Any, **arguments: Any) -> Pipeline:
    """Return the device after a reset, with the tables of its build."""
    pipeline = Pipeline(dut, **arguments)
    await pipeline.start()
    return pipeline
