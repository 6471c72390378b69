# SPDX-License-Identifier: Apache-2.0
"""tactile_depth against its models, at its pins.

Whatever a test sends, `Pipeline.check` then feeds the models with what the monitor saw on s_axis and compares
every code, side-band, latency, counter and status bit; `contact` is compared in every clock.
"""

import math
import os
import random
from itertools import pairwise, product, repeat
from typing import Any

import cocotb
import numpy as np
from cocotb.clock import Clock
from cocotb.triggers import ClockCycles, RisingEdge

from tactile_depth.calibration.flat_field import captured_gains
from tactile_depth.calibration.floor_capture import captured_floor
from tactile_depth.common.round_saturate import Monitor
from tactile_depth.contact.contact_events import ContactEvents, Settings
from tactile_depth.contact.contact_events import record as record_of
from tactile_depth.contact.threshold_comparator import ThresholdComparator
from tactile_depth.frame.frame_guard import FAULTS, frame_guard
from tactile_depth.gradient.divergence import divergence
from tactile_depth.gradient.gradient_lookup import gradient_codes, gradient_lookup
from tactile_depth.latency import first_depth_latency, last_pixel_to_first_depth
from tactile_depth.registers.axil_registers import WORD, Response, strobed_bits
from tactile_depth.registers.register_map import MAP, REGISTERS, TABLES
from tactile_depth.sensor import synthetic
from tactile_depth.tactile_depth import slope_codes, solve, top_parameters, zeroed
from tb import functional_coverage
from tb.axis import PROFILES, AxisMonitor, AxisSink, AxisSource, broken, positions, profile, video
from tb.registers.tb_axil_registers import master_of, present, read, response_of, take, write
from tb.second_client import SecondMaster, SecondSink, SecondSource
from tb.stream import CLOCK_NS, MANY, REGRESS, configuration

OFFSET = {register.name: register.offset for register in MAP}
STATUS, CONTROL, COMMIT, CAPTURE = (REGISTERS[name] for name in ("STATUS", "CONTROL", "TABLE_COMMIT", "CAPTURE"))
FLOOR_CAPTURE = REGISTERS["FLOOR_CAPTURE"]
SETTINGS = ("THRESHOLD", "OFF_THRESHOLD", "MINIMUM_AREA", "DEBOUNCE")  # and signals of the device
RECORD = [register.name for register in MAP if register.name.startswith("RECORD_")]
STICKY = {"timed_out": "timeout"}  # names of faults and of status bits, where they differ
GREEN, BLUE, RED = 0, 8, 16  # lowest bits of the colours in a word
TABLE_REGISTERS = ("TABLE_SELECT", "TABLE_INDEX", "TABLE_HIGH", "TABLE_LOW")
HEAD_CLOCKS = 2  # from a pixel's clock on the pins to that in which it is the first at the head of the pipeline
SKID_WORDS = 2  # that a stalled output holds
SECOND_CLIENT = os.environ.get("CLIENT") == "second"  # cocotbext-axi drives the ports


def pixel(red: int, green: int, blue: int) -> Any:
    return int(red) << RED | int(green) << GREEN | int(blue) << BLUE


def colours(pixels: Any) -> Any:
    """Words of pixels to uint8 (..., 3), RGB."""
    words = np.asarray(pixels)
    return np.stack([words >> low & 255 for low in (RED, GREEN, BLUE)], axis=-1).astype(np.uint8)


class Pipeline:
    """The device, driven and watched at its pins."""

    gains: Any = None  # of the reference in use, if it was captured: they survive as the table does
    floor: Any = None  # of depth, in the same way
    table: Any = None  # slope codes that frames to come use: the table survives resets, so it survives a test

    def __init__(self, dut: Any, offers: str = "none", accepts: str = "none", timeout: int = 0) -> None:
        dut._log.info("SEED=%s", os.environ["COCOTB_RANDOM_SEED"])
        self.dut, self.random = dut, random.Random(cocotb.RANDOM_SEED)
        self.config = configuration()
        bits = self.config.bits_per_channel
        self.rows, self.columns = self.config.rows, self.config.columns
        self.pixels = self.rows * self.columns
        if Pipeline.table is None:
            Pipeline.table = gradient_codes(synthetic(bits), self.config)
        self.timeout, self.stalled = timeout, accepts != "none"
        self.profiles = offers, accepts
        dut.rst.value, dut.m_event_tready.value = 1, 1
        if SECOND_CLIENT:
            self.source = SecondSource(dut, profile(offers, 1))
            self.sink = SecondSink(dut, profile(accepts, 2))
            self.master = SecondMaster(dut)
        else:
            self.source = AxisSource(dut, "s_axis", prefix="t", offers=profile(offers, 1))
            self.sink = AxisSink(dut, "m_axis", prefix="t", accepts=profile(accepts, 2))
            self.master = master_of(dut)
        self.into = AxisMonitor(dut, "s_axis", prefix="t", silence=bool(timeout))
        self.out = AxisMonitor(dut, "m_axis", prefix="t")
        self.comparator = ThresholdComparator()
        self.contacts: list[Any] = []  # clocks in which contact rose
        self.dark_level = 0
        self.drops = False  # CONTROL.drop_frames
        self.packets: list[Any] = []  # of contact events, in words
        self.events = ContactEvents(self.rows, self.columns, self.config.solver == "tridiagonal")
        # A sink of records, never so slow that one is lost.
        self.takes = profile(accepts if accepts in ("one_in_4", "alternate", "random") else "none", 3)
        self.settings: list[Any] = []  # of contact events, as they stood with the first depth of each frame
        self.tables: Any = None  # of each frame that comes, if they differ
        self.floors: Any = None  # the same
        self.expect_reset_values()

    async def start(self) -> None:
        Clock(self.dut.clk, CLOCK_NS, unit="ns", impl="gpi").start(start_high=False)
        cocotb.start_soon(self.watch_contact())
        cocotb.start_soon(self.watch_events())
        functional_coverage.start(self.dut, self.config, *self.profiles)
        await self.reset(3)
        if self.timeout:
            await self.write("TIMEOUT", self.timeout)

    def expect_reset_values(self) -> None:
        self.counters = dict.fromkeys(("FRAMES_IN", "FRAMES_OUT", "FRAMES_DROPPED", "SATURATIONS", "DARK_PIXELS"), 0)
        self.counters |= dict.fromkeys(("DEPTH_DROPPED", "RECORDS_LOST"), 0)
        self.dark_level = 0
        self.sticky: set[Any] = set()
        self.latency = 0

    async def reset(self, clocks: int) -> None:
        """Reset; what was sent before no longer counts."""
        self.source.abort()
        self.dut.rst.value = 1
        await ClockCycles(self.dut.clk, clocks)
        self.dut.rst.value = 0
        await RisingEdge(self.dut.clk)  # AXI: the first edge out of reset comes before the first word
        self.forget()
        self.events.reset()
        self.expect_reset_values()

    def forget(self) -> None:
        if SECOND_CLIENT:
            self.sink.words()
        self.into.forget()
        self.out.forget()
        self.contacts.clear()
        self.packets.clear()
        self.settings.clear()

    async def watch_contact(self) -> None:
        """contact is what the beats up to the clock before make of it; thresholds as the registers say."""
        dut, model, edge = self.dut, self.comparator, RisingEdge(self.dut.clk)
        await edge
        clock, was = 1, False
        while True:
            await edge
            clock += 1
            contact = bool(dut.contact.value)
            if dut.rst.value:
                model.reset()
                was = False
                continue
            assert contact == model.contact, f"contact is {contact} in clock {clock}"
            if contact and not was:
                self.contacts.append(clock)
            was = contact
            if self.drops:  # then depth counts when it would leave
                counts, user, depth = dut.look_valid.value, dut.look_user.value, dut.look_data.value
                depth = depth.to_signed() if counts else 0
            else:
                counts, user = dut.m_axis_tvalid.value and dut.m_axis_tready.value, dut.m_axis_tuser.value
                depth = self.signed(dut.m_axis_tdata.value) if counts else 0
            if counts and user:
                self.settings.append(Settings(*map(self.setting, SETTINGS)))
            if counts:
                model.beat(depth, bool(user), dut.threshold.value.to_signed(), bool(dut.hold_contact.value))

    async def watch_events(self) -> None:
        """Packets that leave, each word the same until it is taken; a reset ends one."""
        dut, edge = self.dut, RisingEdge(self.dut.clk)
        while True:
            await RisingEdge(dut.m_event_tvalid)
            words, held = [], None
            await edge
            while dut.m_event_tvalid.value and not dut.rst.value:
                word = int(dut.m_event_tdata.value), bool(dut.m_event_tlast.value)
                assert held in (None, word), "a word of a record changed before it was taken"
                held = word
                if dut.m_event_tready.value:
                    held = None
                    words.append(word[0])
                    if word[1]:
                        self.packets.append(words)
                        words = []
                dut.m_event_tready.value = int(next(self.takes))
                await edge
            assert dut.rst.value or (held is None and not words), "a record broke off"

    def setting(self, register: str) -> Any:
        """A register as the cores have it."""
        value = getattr(self.dut, register.lower()).value
        return value.to_signed() if "THRESHOLD" in register else value.to_unsigned()

    def signed(self, data: Any) -> Any:
        width = 8 * ((self.config.data_width + 7) // 8)
        return (int(data) ^ 1 << width - 1) - (1 << width - 1)

    # Registers.

    async def write(self, name: Any, value: Any) -> Any:
        answer = self.master.write(OFFSET[name], value & WORD)
        return await (answer if SECOND_CLIENT else response_of(answer))

    async def read(self, name: str) -> Any:
        return int(await self.master.read(OFFSET[name]))

    async def write_bin(self, index: int, slopes: np.ndarray) -> Any:
        """Write one bin of the gradient table that is not in use; how its last write is answered."""
        for name, value in (
            ("TABLE_SELECT", TABLES["gradient"]),
            ("TABLE_INDEX", index),
            ("TABLE_HIGH", slopes[1]),
        ):
            assert await self.write(name, int(value)) == Response.OKAY
        return await self.write("TABLE_LOW", int(slopes[0]))

    async def write_table(self, table: Any) -> None:
        """Write all bins of the table that is not in use, one after another as they come."""
        while await self.read("TABLE_COMMIT"):
            pass
        await self.write("TABLE_SELECT", TABLES["gradient"])
        assert await self.read("TABLE_SIZE") == len(table)
        await self.write("TABLE_INDEX", 0)
        for index, (gx, gy) in enumerate(table.tolist()):
            await self.write("TABLE_HIGH", gy)
            assert await self.write("TABLE_LOW", gx) == Response.OKAY, f"refused at bin {index}"
        assert await self.read("TABLE_INDEX") == 0, "it does not wrap at the end of the table"

    async def read_table(self) -> Any:
        """All bins of the table that is not in use."""
        await self.write("TABLE_SELECT", TABLES["gradient"])
        await self.write("TABLE_INDEX", 0)
        words = [[await self.read(name) for name in ("TABLE_HIGH", "TABLE_LOW")] for _ in self.table]
        return np.array(words, np.uint32).astype(np.int32).astype(np.int64)[:, ::-1]

    async def commit(self, table: Any = None) -> None:
        """Have the frames that begin from now on use what was written."""
        assert await self.write("TABLE_COMMIT", COMMIT.pack(gradient=1)) == Response.OKAY
        if table is not None:
            Pipeline.table = table.copy()

    # Frames.

    def frame(self) -> Any:
        """Words of a frame of random colours."""
        return video((self.random.getrandbits(24) for _ in range(self.pixels)), self.columns)

    def frame_of(self, wanted: Any) -> Any:
        """Words of a frame whose slopes are those of the table nearest to wanted, (rows, columns, 2).

        With flat-fielding, by a reference of 128: of its colours.
        """
        if self.config.flat_field:
            coefficients: Any = synthetic(self.config.bits_per_channel).coefficients
            deviation = wanted @ np.linalg.pinv(coefficients[..., 0]).T
            rgb = np.clip(np.rint(128 * (1 + deviation)), 0, 255).astype(int)
            return video([pixel(*colour) for colour in rgb.reshape(-1, 3)], self.columns)
        slopes = self.table * self.config.gradient_lsb
        bins = ((wanted.reshape(-1, 1, 2) - slopes) ** 2).sum(axis=-1).argmin(axis=1)
        bits = self.config.bits_per_channel
        parts = [(bins >> shift & (1 << bits) - 1) << 8 - bits for shift in (2 * bits, bits, 0)]
        return video((pixel(*rgb) for rgb in zip(*parts, strict=True)), self.columns)

    def pressed(self, slope: float = 0.5) -> Any:
        """Words of a frame with a pyramid in it: up one side and down the other along both axes."""
        along, down = (np.where(np.arange(n) < n // 2, slope, -slope) for n in (self.columns, self.rows))
        return self.frame_of(np.stack(np.meshgrid(along, down), axis=-1))

    def model(self, frames: Any) -> Any:
        """Depth codes (frames, rows, columns) and the number of values clipped, of frames in the order they came."""
        if not frames:
            return np.zeros((0, self.rows, self.columns), np.int64), 0
        monitor = Monitor()
        solved = self.solved(frames, monitor)
        floors = [Pipeline.floor] * len(solved) if self.floors is None else self.floors
        pairs = zip(solved, floors, strict=True)
        codes = np.stack([zeroed(codes, self.config, monitor, floor) for codes, floor in pairs])
        return codes, monitor.saturations.total()

    def solved(self, frames: int, monitor: Monitor | None = None) -> Any:
        """The codes before a floor is taken off."""
        rgb = colours(frames).reshape(-1, self.rows, self.columns, 3)
        if self.config.flat_field:
            sensor = synthetic(self.config.bits_per_channel)
            slopes = slope_codes(rgb, sensor, self.config, monitor, Pipeline.gains, self.dark_level)
        else:
            tables = [self.table] * len(rgb) if self.tables is None else self.tables
            pairs = zip(rgb, tables, strict=True)
            slopes = np.stack([gradient_lookup(frame, table, self.config.bits_per_channel) for frame, table in pairs])
        return solve(divergence(slopes, self.config.neumann), self.config, monitor)

    async def send(self, *streams: Any) -> None:
        await self.source.send([word for stream in streams for word in stream])

    async def idle(self) -> None:
        """Wait until no frame is in flight."""
        for _ in range(400 * self.pixels // 64):
            if not STATUS.unpack(await self.read("STATUS"))["busy"]:
                return
        raise AssertionError("busy does not end")

    async def check(self, counters: bool = True) -> Any:
        """Let everything drain, then compare it with the models. The source must be idle.

        Returns
        -------
        Codes of the frames that left, int64 (frames, rows, columns).
        """
        await RisingEdge(self.dut.clk)  # the monitor may see the last word after the test does
        guarded = frame_guard(self.into.words, self.rows, self.columns, self.timeout)
        assert not guarded.open, "not the stream it was meant to be: its last frame is not complete"
        codes, clipped = self.model([frame.pixels for frame in guarded.frames])
        good = [index for index, frame in enumerate(guarded.frames) if not frame.bad]
        await self.idle()
        waited = 0
        while len(self.out.words) < len(good) * self.pixels and waited < 100 * SKID_WORDS * self.columns:
            await RisingEdge(self.dut.clk)
            waited += 1
        await ClockCycles(self.dut.clk, 4 * self.columns)

        beats = self.out.words
        if SECOND_CLIENT:
            assert self.sink.words() == beats, "the second client's sink saw other words than the monitor"
        assert len(beats) == len(good) * self.pixels, f"{len(beats)} beats left, of {len(good)} good frames"
        got = np.array([self.signed(beat.data) for beat in beats], np.int64).reshape(-1, self.rows, self.columns)
        for index, (have, want) in enumerate(zip(got, codes[good], strict=True)):
            np.testing.assert_array_equal(have, want, f"codes of frame {index} to leave")
        for place, beat in enumerate(beats):
            assert beat.user == (place % self.pixels == 0), f"tuser of beat {place}"
            assert beat.last == (place % self.columns == self.columns - 1), f"tlast of beat {place}"

        first_depths = self.out.offered[:: self.pixels]
        for index, depth in zip(good, first_depths, strict=True):
            frame = guarded.frames[index]
            self.latency = depth - self.into.taken[frame.first]
            if not self.stalled:
                drained = depth - self.into.taken[frame.last]
                assert drained == last_pixel_to_first_depth(self.config), f"last pixel to first depth: {drained}"
        self.check_events(got, [guarded.frames[index].first for index in good])
        if self.packets:
            assert [await self.read(name) for name in RECORD] == self.packets[-1], "the registers of the last record"
        self.counters["FRAMES_IN"] += len(good)
        self.counters["FRAMES_OUT"] += len(good)
        self.counters["FRAMES_DROPPED"] += len(guarded.faults)
        self.counters["SATURATIONS"] += clipped
        self.sticky |= {STICKY.get(fault, fault) for fault in guarded.faults}
        self.sticky |= {"saturation"} if clipped else set()
        await self.check_registers(counters)
        self.faults, self.first_depths = guarded.faults, first_depths
        self.sent = [(self.into.taken[f.first], self.into.taken[f.last]) for f in guarded.frames]
        self.forget()
        return got

    def check_events(self, depth: np.ndarray, first: Any) -> None:
        """A packet a frame, each as the model has it; `first`: the place of each frame's first pixel in the input."""
        wanted = []
        for codes, settings in zip(depth, self.settings, strict=True):
            beats = zip(codes.flat, range(self.pixels), strict=True)
            for code, place in beats:
                row_ends = place % self.columns == self.columns - 1
                record = self.events.beat(int(code), not place, row_ends, place == self.pixels - 1, settings, 0)
            wanted.append(record)
        seen = [record_of(words) for words in self.packets]
        assert [record._replace(time=0) for record in seen] == wanted, "records of contact events"
        times = [record.time for record in seen]
        taken = [self.into.taken[place] for place in first]
        assert [time - times[0] for time in times] == [clock - taken[0] for clock in taken], "time stamps"

    async def check_registers(self, counters: bool = True) -> None:
        """Counters, sticky bits, busy, contact and the latency that the hardware counted."""
        if counters:
            have = {name: await self.read(name) for name in self.counters}
            assert have == self.counters, f"counters are {have}, should be {self.counters}"
        status = STATUS.unpack(await self.read("STATUS"))
        status = STATUS.unpack(await self.read("STATUS"))
        assert not status.pop("busy"), "busy after everything left"
        assert status.pop("contact") == self.comparator.contact
        assert status.pop("touching") == self.events.touching
        bits = {name for name, value in status.items() if value}
        assert bits == self.sticky, f"sticky bits {bits}, should be {self.sticky}"
        for name in SETTINGS:
            assert await self.read(name) == self.setting(name) % 2**32, f"{name} is not what the cores have"
        latency = await self.read("FIRST_DEPTH_LATENCY")
        assert latency == self.latency, f"FIRST_DEPTH_LATENCY is {latency}, on the pins it was {self.latency}"


async def started(dut: Any, **arguments: Any) -> Any:
    pipeline = Pipeline(dut, **arguments)
    await pipeline.start()
    return pipeline


TEST = cocotb.test(timeout_time=3, timeout_unit="ms")


@TEST
async def the_configuration_is_that_of_the_models(dut: Any) -> None:
    """Every parameter that the models derive is the device's."""
    pipeline = await started(dut)
    derived = top_parameters(pipeline.config)
    device = {name: getattr(dut, name).value.to_signed() for name in derived}
    assert device == derived
    assert await pipeline.read("GRID") == REGISTERS["GRID"].pack(rows=pipeline.rows, columns=pipeline.columns)


@TEST
async def one_frame(dut: Any) -> None:
    """It drains by itself, nothing follows; latencies are those of tactile_depth.latency."""
    pipeline = await started(dut)
    await pipeline.send(pipeline.frame())
    await pipeline.check()
    assert pipeline.latency == first_depth_latency(pipeline.config)
    await pipeline.idle()


@TEST
async def nothing_unknown(dut: Any) -> None:
    """Handshakes, side-bands and contact are 0 or 1 from the second clock after reset on, valid or not."""
    pipeline = await started(dut, accepts="random")
    await RisingEdge(dut.clk)
    sending = cocotb.start_soon(pipeline.send(pipeline.frame()))
    names = "s_axis_tready m_axis_tvalid m_axis_tlast m_axis_tuser contact s_axil_awready s_axil_wready"
    pins = [getattr(dut, pin) for pin in f"{names} s_axil_bvalid s_axil_arready s_axil_rvalid".split()]
    for _ in range(first_depth_latency(pipeline.config) + pipeline.pixels):
        await RisingEdge(dut.clk)
        for pin in pins:
            assert pin.value.is_resolvable, f"{pin._name} is {pin.value}"
    await sending
    await pipeline.check()


@TEST
async def back_to_back(dut: Any) -> None:
    """One frame every N^2 clocks exactly, and every latency the same."""
    pipeline = await started(dut)
    frames = 6
    sending = cocotb.start_soon(pipeline.send(*(pipeline.frame() for _ in range(frames))))
    counted = set()
    while len(pipeline.out.words) < (frames - 1) * pipeline.pixels:
        counted.add(await pipeline.read("FIRST_DEPTH_LATENCY"))
    assert counted == {0, first_depth_latency(pipeline.config)}, "counted by the hardware, over all frames"
    await sending
    await pipeline.check()
    (first, _), *_, (_, last) = pipeline.sent
    assert last - first == frames * pipeline.pixels - 1, "the input was not taken at one pixel a clock"
    latencies = {d - first for d, (first, _) in zip(pipeline.first_depths, pipeline.sent, strict=True)}
    assert latencies == {first_depth_latency(pipeline.config)}
    intervals = {after - before for before, after in pairwise(pipeline.first_depths)}
    assert intervals == {pipeline.pixels}


@TEST
async def the_clock_comes_round(dut: Any) -> None:
    """Wherever the count of clocks returns to 0 while a frame is in flight, its latency is that of any other."""
    pipeline = await started(dut)
    for ahead in (5, pipeline.pixels // 2, pipeline.pixels + 5, first_depth_latency(pipeline.config)):
        dut.now.value = (1 << 32) - ahead
        await pipeline.send(pipeline.frame())
        await pipeline.check()
        assert pipeline.latency == first_depth_latency(pipeline.config)
    await pipeline.send(pipeline.frame())
    await pipeline.check()


@TEST
@cocotb.parametrize(offers=list(PROFILES), accepts=list(PROFILES))
async def gaps_and_stalls(dut: Any, offers: str, accepts: str) -> None:
    """The same codes, nothing lost. Under stalls enough frames that their ends meet a stalled output too."""
    pipeline = await started(dut, offers=offers, accepts=accepts)
    await pipeline.send(*(pipeline.frame() for _ in range(2 if accepts == "none" else 5)))
    await pipeline.check()


@TEST
async def a_sink_that_waits_for_long(dut: Any) -> None:
    """The input stops; then everything comes, and a frame sent after it is timed as ever."""
    pipeline = await started(dut)
    pipeline.stalled = True
    pipeline.sink.stall(repeat(False))
    frames = cocotb.start_soon(pipeline.send(*(pipeline.frame() for _ in range(6))))
    await ClockCycles(dut.clk, 5 * pipeline.pixels)
    taken = len(pipeline.into.words)
    await ClockCycles(dut.clk, 2 * pipeline.pixels)
    assert len(pipeline.into.words) == taken < 6 * pipeline.pixels, "the input did not stop"
    pipeline.sink.stall(repeat(True))
    await frames
    await pipeline.check()
    pipeline.stalled = False
    await pipeline.send(pipeline.frame())
    await pipeline.check()
    assert pipeline.latency == first_depth_latency(pipeline.config)


@TEST
async def capture(dut: Any) -> None:
    """Capture two frames after a broken one: the colours of later frames are relative to their mean."""
    pipeline = await started(dut)
    start = CAPTURE.pack(start=1, log2_frames=1)
    if not pipeline.config.flat_field:
        assert await pipeline.write("CAPTURE", start) == Response.SLVERR
        return
    shades = [
        [pixel(*(pipeline.random.randint(90, 160) for _ in range(3))) for _ in range(pipeline.pixels)] for _ in "ab"
    ]
    rest = [video(shade, pipeline.columns) for shade in shades]
    assert await pipeline.write("CAPTURE", start) == Response.OKAY
    await pipeline.send(broken(pipeline.frame(), "row_short", 1, pipeline.columns), *rest, pipeline.pressed())
    while CAPTURE.unpack(await pipeline.read("CAPTURE"))["busy"]:
        await RisingEdge(dut.clk)
    await pipeline.check()
    shape = (2, pipeline.rows, pipeline.columns, 3)
    Pipeline.gains = captured_gains(colours(shades).reshape(shape), pipeline.config)
    await pipeline.send(pipeline.pressed(), rest[0])
    await pipeline.check()
    await pipeline.reset(2)
    await pipeline.send(pipeline.pressed())
    await pipeline.check()


@TEST
async def floor_captured(dut: Any) -> None:
    """Capture the floor from two frames with a broken one between them, while more frames stream.

    Frames that begin before the capture ends keep the old floor from first depth to last. Later frames use the new
    one. Both kinds are in the pipeline at once.
    """
    pipeline = await started(dut, offers="random")
    start = FLOOR_CAPTURE.pack(start=1, log2_frames=1)
    if not pipeline.config.auto_zero:
        assert await pipeline.write("FLOOR_CAPTURE", start) == Response.SLVERR
        return
    new: list[Any] = []  # of each frame, whether it has the new floor

    async def follow() -> None:
        pending = False
        while True:
            await RisingEdge(dut.clk)
            if dut.u_registers.frame_start.value:
                new.append(pending or any(new))
                pending = False
            pending |= bool(dut.floor_done.value)

    following = cocotb.start_soon(follow())
    assert await pipeline.write("FLOOR_CAPTURE", start) == Response.OKAY
    frames = [pipeline.pressed(slope) for slope in (0.25, 0.125, -0.25)]
    late = 3 + first_depth_latency(pipeline.config) // pipeline.pixels
    await pipeline.send(frames[0], broken(pipeline.frame(), "row_short", 1, pipeline.columns), *frames[1:])
    await pipeline.send(*(pipeline.pressed(pipeline.random.uniform(-0.3, 0.3)) for _ in range(late)))
    await pipeline.idle()
    following.cancel()
    assert not FLOOR_CAPTURE.unpack(await pipeline.read("FLOOR_CAPTURE"))["busy"]
    assert not await pipeline.read("TABLE_COMMIT")
    words = [[word.data for word in frame] for frame in frames[:2]]
    floor = captured_floor(pipeline.solved(words), pipeline.config)
    pipeline.floors = [floor if later else Pipeline.floor for later in new]
    await pipeline.check()
    assert 3 < sum(not later for later in new) < len(new), "a poor test: no frame has one of the floors"
    pipeline.floors, Pipeline.floor = None, floor
    await pipeline.send(frames[0], frames[1])
    await pipeline.check()
    # One capture after another, the second as soon as it is let in.
    for frame in frames[1:]:
        while await pipeline.write("FLOOR_CAPTURE", FLOOR_CAPTURE.pack(start=1)) != Response.OKAY:
            pass
        await pipeline.send(frame)
        while FLOOR_CAPTURE.unpack(await pipeline.read("FLOOR_CAPTURE"))["busy"]:
            pass
        assert await pipeline.write("FLOOR_CAPTURE", start) == Response.SLVERR, "before the change-over"
        await pipeline.check()
        await pipeline.send(frame)
        Pipeline.floor = captured_floor(pipeline.solved([[word.data for word in frame]]), pipeline.config)
        await pipeline.check()
    await pipeline.reset(2)
    await pipeline.send(frames[2])
    await pipeline.check()


@TEST
async def floor_written(dut: Any) -> None:
    """Over the bus, read back; used from the next frame on; depth that leaves its range is clipped. In the end none."""
    pipeline = await started(dut)
    if not pipeline.config.auto_zero:
        return
    limit = 1 << pipeline.config.data_width - 1
    rng = np.random.default_rng(cocotb.RANDOM_SEED)
    await pipeline.write("TABLE_SELECT", TABLES["floor"])
    nodes = math.prod(pipeline.config.reference_nodes)
    assert await pipeline.read("TABLE_SIZE") == nodes
    some, most = rng.integers(-limit // 8, limit // 8, nodes), rng.choice([-limit, limit - 1], nodes)
    for floor in (most, some, 0 * some):
        for index, code in enumerate(floor.tolist()):
            await pipeline.write("TABLE_INDEX", index)
            assert await pipeline.write("TABLE_LOW", code) == Response.OKAY
        await pipeline.write("TABLE_INDEX", 0)
        read = [(await pipeline.read("TABLE_LOW") ^ 1 << 31) - (1 << 31) for _ in range(nodes)]
        assert read == floor.tolist()
        assert await pipeline.read("TABLE_HIGH") == 0
        assert await pipeline.write("TABLE_COMMIT", COMMIT.pack(floor=1)) == Response.OKAY
        Pipeline.floor = floor.reshape(pipeline.config.reference_nodes)
        await pipeline.send(pipeline.pressed(), pipeline.frame())
        await pipeline.check()
        assert "saturation" in pipeline.sticky
    await pipeline.reset(1)
    await pipeline.send(pipeline.pressed(0.25))
    await pipeline.check()


@TEST
async def dark_pixels_are_held(dut: Any) -> None:
    """Anywhere in a row, and the whole of one; each is counted."""
    pipeline = await started(dut)
    if not pipeline.config.flat_field:
        return
    level = 50
    words = [word.data for word in pipeline.pressed()]
    for row in range(pipeline.rows):
        for column in range(pipeline.columns):
            if row == 2 or pipeline.random.random() < 0.3:
                words[row * pipeline.columns + column] = pixel(*(pipeline.random.randrange(level) for _ in range(3)))
    await pipeline.write("DARK_LEVEL", level)
    pipeline.dark_level = level
    await pipeline.send(video(words, pipeline.columns), pipeline.frame())
    await RisingEdge(dut.clk)
    dark = (colours([word.data for word in pipeline.into.words]) < level).all(axis=-1).sum()
    pipeline.counters["DARK_PIXELS"] += int(dark)
    pipeline.sticky.add("dark")
    await pipeline.check()


@TEST
async def depth_frames_are_dropped(dut: Any) -> None:
    """With drop_frames a sink that stands still costs frames and no time; the next one after it is whole."""
    pipeline = await started(dut)
    flat = video([pixel(135, 135, 135)] * pipeline.pixels, pipeline.columns)
    frames = [flat, flat, pipeline.pressed(), flat]
    codes, _ = pipeline.model([[word.data for word in words] for words in frames])
    await pipeline.write("THRESHOLD", int(codes[2].max()) - 1)
    await pipeline.write("CONTROL", CONTROL.pack(drop_frames=1))
    pipeline.drops = True
    pipeline.sink.stall(repeat(False))
    began = pipeline.into.clock_count
    await pipeline.send(*frames[:3])
    assert pipeline.into.clock_count - began < 3 * pipeline.pixels + 8, "the input waited"
    await pipeline.idle()
    assert dut.contact.value, "late for a sink that stands still"
    assert await pipeline.read("DEPTH_DROPPED") == 3
    assert STATUS.unpack(await pipeline.read("STATUS"))["depth_dropped"]
    pipeline.sink.stall(repeat(True))
    await ClockCycles(dut.clk, 8)
    await pipeline.send(frames[3])
    await pipeline.idle()
    await ClockCycles(dut.clk, 4 * pipeline.columns)
    left = [pipeline.signed(beat.data) for beat in pipeline.out.words]
    assert left == [*codes[0].flat[:SKID_WORDS].tolist(), *codes[3].flat], "the words that had left, then a whole frame"
    assert await pipeline.read("FRAMES_OUT") == 1
    assert len(pipeline.packets) == len(frames), "each frame leaves its record"
    await pipeline.reset(2)


@TEST
@cocotb.parametrize(accepts=["none", "random"])
async def contact(dut: Any, accepts: str) -> None:
    """Raised by the deciding beat, cleared by the next frame's first, held by its bit."""
    pipeline = await started(dut, accepts=accepts)
    pressed, flat = pipeline.pressed(), video([pixel(135, 135, 135)] * pipeline.pixels, pipeline.columns)
    codes, _ = pipeline.model([[word.data for word in words] for words in (pressed, flat)])
    flat_peak, peak = int(codes[1].max()), int(codes[0].max())
    assert flat_peak < peak, "a poor test: pressing is no deeper than not pressing"

    await pipeline.send(pressed)
    await pipeline.check()
    assert not pipeline.comparator.contact, "raised by the threshold after reset"

    await pipeline.write("THRESHOLD", peak)
    await pipeline.send(pressed)
    await pipeline.check()
    assert not pipeline.comparator.contact, "raised by a depth equal to the threshold"

    await pipeline.write("THRESHOLD", peak - 1)
    await pipeline.send(pressed)
    await pipeline.idle()
    while len(pipeline.out.words) < pipeline.pixels:
        await RisingEdge(dut.clk)
    await ClockCycles(dut.clk, 2)
    deciding = int(np.argmax(codes[0]))
    assert pipeline.contacts == [pipeline.out.taken[deciding] + 1]
    await pipeline.check()
    assert dut.contact.value

    await pipeline.send(flat)
    await pipeline.check()
    assert not dut.contact.value

    await pipeline.write("CONTROL", CONTROL.pack(hold_contact=1))
    await pipeline.send(pressed, flat, flat)
    await pipeline.check()
    assert dut.contact.value, "not held"
    await pipeline.write("CONTROL", 0)
    await pipeline.send(flat)
    await pipeline.check()
    assert not dut.contact.value

    await pipeline.send(pressed, flat, pressed)
    await pipeline.check()
    assert dut.contact.value


@TEST
async def records_at_the_limits(dut: Any) -> None:
    """Both thresholds at a depth of the frame and one below it, the least area at that of the frame and one above."""
    pipeline = await started(dut)
    pressed = pipeline.pressed()
    codes, _ = pipeline.model([[word.data for word in pressed]])
    depths = np.unique(codes)
    chosen = [int(depth) for depth in depths[:: max(1, len(depths) // 4)]]
    # One of them stands where it always decides, at once, against what the other says of the frame before.
    for name, other, always in (
        ("THRESHOLD", "OFF_THRESHOLD", int(depths[-1])),
        ("OFF_THRESHOLD", "THRESHOLD", int(depths[0])),
    ):
        await pipeline.write(other, always)
        for depth in chosen:
            for code in (depth, depth - 1):
                await pipeline.write(name, code)
                await pipeline.send(pressed, pressed)
                await pipeline.check(counters=False)
    # Most depths below 0, then all: their sum is, and at last the peak.
    for name in ("THRESHOLD", "OFF_THRESHOLD"):
        await pipeline.write(name, -(1 << pipeline.config.data_width - 1))
    await pipeline.send(pipeline.pressed(-0.5))
    await pipeline.check(counters=False)
    assert pipeline.events.touching
    await pipeline.send(pipeline.frame_of(np.full((pipeline.rows, pipeline.columns, 2), 0.5)))
    below = await pipeline.check(counters=False)
    assert below.max() < 0
    await pipeline.write("THRESHOLD", chosen[0])
    area = int((codes > chosen[0]).sum())
    for least, debounce in ((area, 1), (area + 1, 1), (area, 3), (area + 1, 2), (area, 2), (0, 0)):
        await pipeline.write("OFF_THRESHOLD", chosen[0])
        await pipeline.write("MINIMUM_AREA", least)
        await pipeline.write("DEBOUNCE", debounce)
        for _ in range(debounce + 1):
            await pipeline.send(pressed)
            await pipeline.check(counters=False)


@TEST
async def busy_while_a_frame_is_in_flight(dut: Any) -> None:
    """From its first pixel to its last depth, whatever the source pauses; and not before or after."""
    pipeline = await started(dut)
    source, out = pipeline.into, pipeline.out
    polls = []  # clock before, clock after, busy

    async def poll() -> None:
        while True:
            before = source.clock_count
            busy = STATUS.unpack(await pipeline.read("STATUS"))["busy"]
            polls.append((before, source.clock_count, busy))
            await ClockCycles(dut.clk, pipeline.random.randrange(3))

    for pause in (0, 1, 4, 30):
        polling = cocotb.start_soon(poll())
        await ClockCycles(dut.clk, 20)
        frame = pipeline.frame()
        await pipeline.send(frame[:1], [None] * pause, frame[1:-1], [None] * pause, frame[-1:])
        while len(out.words) < pipeline.pixels:
            await RisingEdge(dut.clk)
        await ClockCycles(dut.clk, 20)
        polling.cancel()
        await ClockCycles(dut.clk, 20)  # for the read that it had begun
        first, last = source.taken[0], out.taken[-1]
        inside = [busy for before, after, busy in polls if before >= first and after <= last]
        outside = [busy for before, after, busy in polls if after <= first or before > last + 1]
        assert len(inside) > 20, len(inside)
        assert all(inside), f"{len(inside) - sum(inside)} of {len(inside)} reads say that nothing is in flight"
        assert outside
        assert not any(outside), "busy without a frame"
        polls.clear()
        await pipeline.check()

    # To the clock: the address is taken before, with and after the first pixel.
    seen = {}
    for lead in range(5):
        dut.s_axil_rready.value = 0
        sending = cocotb.start_soon(pipeline.send([None] * (20 - lead), pipeline.frame()))
        await ClockCycles(dut.clk, 20)
        await present(dut, "ar", araddr=OFFSET["STATUS"])
        asked = source.clock_count
        await RisingEdge(dut.clk)
        busy = STATUS.unpack(int(dut.s_axil_rdata.value))["busy"]
        assert await take(dut, "r") == Response.OKAY
        dut.s_axil_rready.value = 1
        await sending
        seen[asked - source.taken[0]] = busy
        await pipeline.check()
    assert seen.keys() >= {0, 1}, f"a poor test: clocks after the first pixel are {list(seen)}"
    assert all(busy == (after > 0) for after, busy in seen.items()), seen


@TEST
async def the_register_port_waits(dut: Any) -> None:
    """Address and word of a write in either order, each taken once; answers stay until they are taken; bytes without a
    strobe keep what they hold."""
    pipeline = await started(dut)
    pins = {name: getattr(dut, f"s_axil_{name}") for name in ("awready", "wready", "arready", "bvalid", "rvalid")}
    dut.s_axil_bready.value = dut.s_axil_rready.value = 0

    async def stays(clocks: int = 3, **wanted: Any) -> None:
        for _ in range(clocks):
            await RisingEdge(dut.clk)
            got = {name: int(pin.value) for name, pin in pins.items()}
            assert got == {"awready": 1, "wready": 1, "arready": 1, "bvalid": 0, "rvalid": 0} | wanted

    held = 0
    for strobe in (15, *range(16), 15):
        data = pipeline.random.getrandbits(32)
        beats = {"aw": {"awaddr": OFFSET["TIMEOUT"]}, "w": {"wdata": data, "wstrb": strobe}}
        first, second = beats if strobe & 1 else reversed(beats)
        await stays()
        await present(dut, first, **beats[first])
        await RisingEdge(dut.clk)
        await stays(**{f"{first}ready": 0})
        await present(dut, second, **beats[second])
        while not dut.s_axil_bvalid.value:
            await RisingEdge(dut.clk)
        await stays(awready=0, wready=0, bvalid=1)
        assert await take(dut, "b", 2) == Response.OKAY
        mask = strobed_bits(strobe)
        held = data & mask | held & ~mask
        await present(dut, "ar", araddr=OFFSET["TIMEOUT"])
        await RisingEdge(dut.clk)
        for _ in range(4):
            await stays(1, arready=0, rvalid=1)
            assert int(dut.s_axil_rdata.value) == held
        assert await take(dut, "r", 2) == Response.OKAY
    assert await write(dut, OFFSET["GRID"], 0) == Response.SLVERR
    assert await write(dut, OFFSET["TIMEOUT"], 0) == Response.OKAY
    assert await read(dut, OFFSET["TIMEOUT"]) == (0, Response.OKAY)
    dut.s_axil_bready.value = dut.s_axil_rready.value = 1
    await pipeline.send(pipeline.frame())
    await pipeline.check()


def places(pipeline: Any, fault: str) -> list[Any]:
    """Positions for a fault: first, last and inner pixels of first, last and inner rows."""
    size, pixels = pipeline.columns, pipeline.pixels
    inner = pipeline.rows // 2 * size
    chosen = (0, 1, size - 2, size - 1, size, inner + 3, inner + size - 1, pixels - size, pixels - 2, pixels - 1)
    return [position for position in chosen if position in positions(fault, pipeline.rows, size)]


@TEST
@cocotb.parametrize(fault=FAULTS, accepts=["none", "random"])
async def malformed(dut: Any, fault: str, accepts: str) -> None:
    """A, B, A back to back, B broken: B never leaves nor raises contact, both A come out the same."""
    timeout = 60 if fault == "timed_out" else 0
    pipeline = await started(dut, accepts=accepts, timeout=timeout)
    flat = video([pixel(135, 135, 135)] * pipeline.pixels, pipeline.columns)
    pressed = pipeline.pressed()
    codes, _ = pipeline.model([[word.data for word in words] for words in (pressed, flat)])
    await pipeline.write("THRESHOLD", (int(codes[0].max()) + int(codes[1].max())) // 2)
    a = video((word.data ^ pipeline.random.getrandbits(3) for word in flat), pipeline.columns)
    for position in places(pipeline, fault)[: 2 if pipeline.stalled else None]:
        b = broken(pressed, fault, position, pipeline.columns, timeout + 1)
        await pipeline.send(a, b, a)
        left = await pipeline.check()
        assert pipeline.faults == [fault], f"{fault} at {position}: {pipeline.faults}"
        assert len(left) == 2
        np.testing.assert_array_equal(left[0], left[1])
        assert not pipeline.comparator.contact, f"{fault} at {position} raised contact"

    bit = STATUS.pack(**{STICKY.get(fault, fault): 1})
    await pipeline.write("STATUS", WORD ^ bit)
    assert await pipeline.read("STATUS") == bit
    await pipeline.write("STATUS", bit)
    assert await pipeline.read("STATUS") == 0
    pipeline.sticky.clear()
    await pipeline.write("CONTROL", CONTROL.pack(clear_counters=1))
    pipeline.counters = dict.fromkeys(pipeline.counters, 0)
    await pipeline.send(a)
    await pipeline.check()


@TEST
@cocotb.parametrize(fault=FAULTS)
async def faults_side_by_side(dut: Any, fault: str) -> None:
    """A broken frame between whole and broken ones: each is counted by itself, and the whole ones are right."""
    timeout = 60 if fault == "timed_out" else 0
    pipeline = await started(dut, timeout=timeout)
    silent = timeout + pipeline.pixels  # the guard may be filling up the frame before
    for before, after in product(("good", "bad"), repeat=2):
        sides = {"good": pipeline.frame(), "bad": broken(pipeline.frame(), "row_short", 3, pipeline.columns)}
        middle = broken(pipeline.frame(), fault, places(pipeline, fault)[0], pipeline.columns, silent)
        await pipeline.send(pipeline.frame(), sides[before], middle, sides[after], pipeline.frame())
        left = await pipeline.check()
        assert len(left) == 2 + (before == "good") + (after == "good")
        own = [] if fault == "start_missing" and before == "bad" else [fault]  # rest of the one before
        assert pipeline.faults == [*["row_short"] * (before == "bad"), *own, *["row_short"] * (after == "bad")]


@TEST
@cocotb.parametrize(accepts=["none", "random"])
async def every_fault_in_a_row(dut: Any, accepts: str) -> None:
    """Broken frames between good ones and right after one another, all in flight together."""
    pipeline = await started(dut, accepts=accepts)
    faults = [fault for fault in FAULTS if fault != "timed_out"]
    streams = []
    for fault in (*faults, *reversed(faults)):
        for position in places(pipeline, fault)[:2]:
            streams.append(broken(pipeline.frame(), fault, position, pipeline.columns))
        streams.append(pipeline.frame())
    await pipeline.send(*streams)
    await pipeline.check()
    assert set(pipeline.faults) == set(faults)


@TEST
async def starts_one_after_another(dut: Any) -> None:
    """Each start of frame breaks the frame before it; the last of them is kept, its latency its own."""
    pipeline = await started(dut)
    for count in (1, 2, 3, 5):
        starts = [word for _ in range(count) for word in pipeline.frame()[:1]]
        await pipeline.send(pipeline.frame(), starts, pipeline.frame())
        await pipeline.check()
        assert pipeline.faults == ["start_early"] * count


@TEST
async def words_before_the_first_frame(dut: Any) -> None:
    """Dropped and counted as one; the frame after them is right."""
    pipeline = await started(dut)
    await pipeline.send([word._replace(user=0) for word in pipeline.frame()[:37]], pipeline.frame())
    await pipeline.check()
    assert pipeline.faults == ["start_missing"]


@TEST
async def silence(dut: Any) -> None:
    """Without the time-out register a frame is waited for; with it, for as many clocks as it says."""
    pipeline = await started(dut)
    frame = pipeline.frame()
    await pipeline.send(frame[:100], [None] * 10 * pipeline.pixels, frame[100:])
    assert len(await pipeline.check()) == 1
    timeout = 50
    pipeline.timeout = timeout
    pipeline.into.silence = True
    await pipeline.write("TIMEOUT", timeout)
    for clocks, waited in ((timeout, True), (timeout + 1, False), (10 * timeout, False)):
        await pipeline.send(frame[:100], [None] * clocks, frame[100:], [None] * 3 * timeout, frame)
        assert len(await pipeline.check()) == 1 + waited, f"{clocks} silent clocks, TIMEOUT {timeout}"


@TEST
@cocotb.parametrize(offers=["none", "random"], accepts=["none", "alternate", "random"])
async def random_streams(dut: Any, offers: str, accepts: str) -> None:
    """Good and broken frames, stray words and pauses at random."""
    pipeline = await started(dut, offers=offers, accepts=accepts)
    rng = pipeline.random
    for _ in range(12):
        words = pipeline.frame()
        for _ in range(rng.choice((0, 0, 0, 1, 2))):
            place = rng.randrange(len(words))
            flip = rng.choice(("last", "user"))
            match rng.randrange(4):
                case 0:
                    words[place] = words[place]._replace(**{flip: 1 - getattr(words[place], flip)})
                case 1:
                    del words[place : place + rng.randint(1, 40)]
                case 2:
                    words[place:place] = words[place : place + rng.randint(1, 40)]
                case 3:
                    words = words[: place + 1]
        await pipeline.send(words, [None] * rng.choice((0, 0, 1, 30)))
    await pipeline.send(pipeline.frame()[:1], pipeline.frame())  # ends what is still open
    await pipeline.check()


@TEST
async def gradient_table(dut: Any) -> None:
    """Written and read between frames; with its commit the next frame has the codes of the new table."""
    pipeline = await started(dut)
    power_up = Pipeline.table
    rng = np.random.default_rng(cocotb.RANDOM_SEED)
    frame = pipeline.frame()
    await pipeline.send(frame)
    before = await pipeline.check()
    limit = 1 << pipeline.config.gradient.width - 1
    new = rng.integers(-limit // 4, limit // 4, power_up.shape)
    for old, table in ((power_up, new), (new, power_up)):
        await pipeline.write_table(table)
        np.testing.assert_array_equal(await pipeline.read_table(), table)
        await pipeline.send(frame)
        await pipeline.check()  # of the old table
        await pipeline.commit(table)
        assert await pipeline.read("TABLE_COMMIT") == COMMIT.pack(gradient=1)
        await pipeline.send(frame)
        after = await pipeline.check()
        assert await pipeline.read("TABLE_COMMIT") == 0
        assert (after != before).any() == (table is new)
        np.testing.assert_array_equal(await pipeline.read_table(), old)  # what was in use before


@TEST
async def gradient_table_committed_at_the_first_pixel(dut: Any) -> None:
    """The frame whose first pixel is taken around the commit has the codes of one table; the clock says of which."""
    pipeline = await started(dut)
    colour = pixel(200, 40, 90)
    frame = video([colour] * pipeline.pixels, pipeline.columns)
    bits = pipeline.config.bits_per_channel
    index = int(sum(int(c) >> 8 - bits << shift * bits for shift, c in enumerate(colours([colour])[0][::-1])))
    taken = []
    # Of the commit over the first pixel, in clocks; and clocks between that and the second.
    for lead, gap in product(range(-6, 5), (0, 4)):
        old, new = np.array(Pipeline.table), np.array(Pipeline.table)
        new[index] = pipeline.random.randrange(1 << 8), -pipeline.random.randrange(1 << 8)
        assert await pipeline.write_bin(index, new[index]) == Response.OKAY
        stream = [None] * (8 + lead), frame[:1], [None] * gap, frame[1:]
        sending = cocotb.start_soon(pipeline.send(*stream))
        await ClockCycles(dut.clk, 8)
        answer = cocotb.start_soon(pipeline.commit())
        while not dut.s_axil_bvalid.value:
            await RisingEdge(dut.clk)
        decided = pipeline.into.clock_count - 1
        await answer
        await sending
        taken.append(decided < pipeline.into.taken[0] + HEAD_CLOCKS)
        pending = await pipeline.read("TABLE_COMMIT")
        assert pending == COMMIT.pack(gradient=not taken[-1])
        assert await pipeline.write("TABLE_LOW", 123) == (Response.OKAY if taken[-1] else Response.SLVERR)
        await pipeline.send(frame)
        pipeline.tables = [new if taken[-1] else old, new]
        await pipeline.check()
        pipeline.tables, Pipeline.table = None, new
    assert set(taken) == {False, True}, "a poor test: every commit came on the same side of the first pixel"
    power_up = gradient_codes(synthetic(bits), pipeline.config)
    await pipeline.write_table(power_up)
    await pipeline.commit(power_up)
    await pipeline.send(frame)
    await pipeline.check()


@TEST
@cocotb.parametrize(offers=["none", "random"], accepts=["none", "random"])
async def gradient_table_rewritten_while_frames_stream(dut: Any, offers: str, accepts: str) -> None:
    """Frames without a pause, the whole table written again and again: each frame has the codes of one table, the one
    whose commit was the last to take effect before its first pixel."""
    pipeline = await started(dut, offers=offers, accepts=accepts)
    power_up = Pipeline.table
    limit = 1 << pipeline.config.gradient.width - 1
    rng = np.random.default_rng(cocotb.RANDOM_SEED)
    tables, of_frames = [power_up], []  # the tables in their order; of each frame, the number of its table
    committing, running = None, True

    async def follow() -> None:
        nonlocal committing
        while True:
            await RisingEdge(dut.clk)
            if committing is not None and dut.s_axil_bvalid.value:  # it took effect in the clock before
                tables.append(committing)
                committing = None
            if dut.u_registers.frame_start.value:
                of_frames.append(len(tables) - 1)

    async def feed() -> None:
        while running:
            await pipeline.send(pipeline.frame(), pipeline.frame())

    following, feeding = cocotb.start_soon(follow()), cocotb.start_soon(feed())
    for _ in range(5):
        table = rng.integers(-limit // 4, limit // 4, power_up.shape)
        await pipeline.write_table(table)
        await ClockCycles(dut.clk, int(rng.integers(pipeline.pixels)))
        committing = table
        await pipeline.commit()
    await pipeline.write_table(power_up)  # waits until the last has been taken
    running = False
    await feeding
    await pipeline.idle()
    following.cancel()
    pipeline.tables = [tables[number] for number in of_frames]
    await pipeline.check()
    assert set(of_frames) == set(range(len(tables))), "a poor test: no frame used one of the tables"
    pipeline.tables = None
    await pipeline.commit(power_up)
    await pipeline.send(pipeline.frame())
    await pipeline.check()


@TEST
async def many_frames(dut: Any) -> None:
    """Ties of every rounding and clips of all that can: any slopes, small ones and steep ones."""
    pipeline = await started(dut)
    power_up = Pipeline.table
    rng = np.random.default_rng(cocotb.RANDOM_SEED)
    limit = 1 << pipeline.config.gradient.width - 1
    tables = [rng.integers(-most, most, power_up.shape) for most in (limit >> 7, limit >> 3, limit)] + [power_up]
    for table in [None] if pipeline.config.flat_field else tables:
        if table is not None:
            await pipeline.write_table(table)
            await pipeline.commit(table)
        await pipeline.send(*(pipeline.frame() for _ in range(1 if table is power_up else MANY)))
        await pipeline.check()


@TEST
@cocotb.parametrize(accepts=["none", "random"])
async def saturation(dut: Any, accepts: str) -> None:
    """A pyramid deeper than full scale: clipped where the model clips, counted, flagged; never wrapped."""
    pipeline = await started(dut, accepts=accepts)
    steep = pipeline.pressed(slope=1.0)
    _, clipped = pipeline.model([[word.data for word in steep]])
    assert clipped > 0, "a poor test: nothing clips"
    await pipeline.send(steep, pipeline.frame(), steep)
    codes = await pipeline.check()
    limit = 1 << pipeline.config.data_width - 1
    assert codes.max() == limit - 1 or codes.min() == -limit, "no depth at full scale"
    await pipeline.write("STATUS", STATUS.pack(saturation=1))
    pipeline.sticky.clear()
    await pipeline.send(video([pixel(135, 135, 135)] * pipeline.pixels, pipeline.columns))
    await pipeline.check()
    assert not pipeline.sticky


@TEST
@cocotb.parametrize(
    clocks=[1, 2, 16] if REGRESS else [2],
    phase=["mid_frame", "filling", "waiting", "output", "stalled", "full", "idle"],
)
async def resets(dut: Any, clocks: Any, phase: str) -> None:
    """Registers are as after power-up, but for tables; the next frame is right.

    tests/test_faults.py resets in every clock of these phases.
    """
    pipeline = await started(dut)
    await pipeline.write("THRESHOLD", -5)
    await pipeline.write("CONTROL", CONTROL.pack(hold_contact=1))
    first = pipeline.pixels + pipeline.random.randrange(pipeline.pixels // 2)
    streams = [pipeline.frame() for _ in range(5)]
    wait = {
        "mid_frame": first,
        "filling": first + 50,
        "waiting": pipeline.pixels + 50,
        "output": first_depth_latency(pipeline.config) + pipeline.random.randrange(3 * pipeline.pixels),
        "stalled": first_depth_latency(pipeline.config) + pipeline.pixels,
        "full": first_depth_latency(pipeline.config) + 3 * pipeline.pixels,
        "idle": first_depth_latency(pipeline.config) + pipeline.pixels + 10,
    }[phase]
    if phase in ("waiting", "idle"):
        del streams[1:]
    if phase == "filling":
        streams[1] = broken(streams[1], "row_short", pipeline.random.randrange(10), pipeline.columns)
    if phase in ("stalled", "full"):
        pipeline.sink.stall(repeat(False) if phase == "full" else profile("alternate"))
    cocotb.start_soon(pipeline.send(*streams))
    await ClockCycles(dut.clk, wait)
    await pipeline.reset(clocks)
    pipeline.sink.stall(repeat(True))
    assert not dut.contact.value
    for register in MAP:
        fields = [field for field in register.fields if field.reset is not None]
        values = register.unpack(await pipeline.read(register.name)) if fields else {}
        for field in fields:
            value = values[field.name]
            assert value == field.reset, f"{register.name}.{field.name} is {value:#x} after a reset"
    await ClockCycles(dut.clk, pipeline.pixels)
    assert not pipeline.out.words, "something left that was sent before the reset"
    await pipeline.send(pipeline.frame(), pipeline.frame())
    await pipeline.check()
    assert pipeline.latency == first_depth_latency(pipeline.config)


@TEST
@cocotb.parametrize(accepts=["none", "random"])
async def registers_written_all_the_time(dut: Any, accepts: str) -> None:
    """They disturb no code and no latency."""
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
    while len(pipeline.out.words) < 4 * pipeline.pixels - 40:
        await RisingEdge(dut.clk)
    running = False
    await writing
    assert refused > 5
    await pipeline.write("CONTROL", 0)
    await pipeline.check()


@TEST
async def registers_written_phase_by_phase(dut: Any) -> None:
    """Each of them while nothing moves, while a frame comes, fills up, is waited for, leaves and is stalled."""
    pipeline = await started(dut)
    columns, first = pipeline.columns, Pipeline.table[0]

    async def write_all() -> None:
        names = ["STATUS", "CONTROL", "THRESHOLD", "TIMEOUT", "TABLE_COMMIT", "OFF_THRESHOLD", "MINIMUM_AREA"]
        names += ["DEBOUNCE", "DARK_LEVEL", "CAPTURE", "FLOOR_CAPTURE"]
        answers = [await pipeline.write(name, 0) for name in names]
        assert answers == [Response.OKAY] * len(answers)
        assert await pipeline.write_bin(0, first) == Response.OKAY

    await write_all()
    frame, silence = pipeline.frame(), [None] * 100
    sending = cocotb.start_soon(pipeline.send(frame[:columns], silence, frame[columns:]))
    await ClockCycles(dut.clk, columns + 10)
    await write_all()  # inside the frame
    await sending
    await write_all()  # before its first depth
    while not pipeline.out.words:
        await RisingEdge(dut.clk)
    await write_all()  # while it leaves
    pipeline.sink.stall(repeat(False))
    await ClockCycles(dut.clk, 4)
    await write_all()
    pipeline.sink.stall(repeat(True))
    await pipeline.idle()
    await pipeline.send(broken(pipeline.frame(), "row_short", 0, columns)[:1])
    await write_all()  # while it fills up
    await pipeline.check()


@TEST
@cocotb.parametrize(accepts=["none", "random"])
async def registers_written_in_every_phase(dut: Any, accepts: str) -> None:
    """Each register at each pixel of a frame, while frames come without a gap: no code and no latency changes."""
    pipeline = await started(dut, accepts=accepts)
    rng, running = pipeline.random, True
    words = (pixel(*(135 + rng.randint(-3, 3) for _ in range(3))) for _ in range(pipeline.pixels))
    frame = video(words, pipeline.columns)
    values = {
        "THRESHOLD": lambda: rng.getrandbits(32),
        # As they are: the records of the frames in flight are compared too.
        "OFF_THRESHOLD": lambda: REGISTERS["OFF_THRESHOLD"].reset,
        "MINIMUM_AREA": lambda: REGISTERS["MINIMUM_AREA"].reset,
        "DEBOUNCE": lambda: REGISTERS["DEBOUNCE"].reset,
        "TIMEOUT": lambda: rng.randint(2, 300),  # no frame is silent
        "CONTROL": lambda: CONTROL.pack(hold_contact=rng.getrandbits(1)),
        "STATUS": lambda: rng.getrandbits(32),
        "TABLE_SELECT": lambda: TABLES["gradient"],
        "TABLE_INDEX": lambda: rng.getrandbits(32),
        "TABLE_HIGH": lambda: rng.getrandbits(32),
        "TABLE_LOW": lambda: rng.getrandbits(32),  # of the table that no frame uses
        "TABLE_COMMIT": lambda: COMMIT.pack(coefficients=1, reference=1, floor=1),  # the build has none of these
        "DARK_LEVEL": lambda: rng.getrandbits(8),  # the build has no flat-fielding
        "CAPTURE": lambda: CAPTURE.pack(start=1),  # nor a reference to capture
        "FLOOR_CAPTURE": lambda: FLOOR_CAPTURE.pack(start=1),  # nor a floor
        "GRID": lambda: rng.getrandbits(32),
    }
    refused = {"GRID", "CAPTURE", "FLOOR_CAPTURE"}
    missing = {name: set(range(pipeline.pixels)) for name in values}

    async def feed() -> None:
        while running:
            await pipeline.send(frame, frame)

    feeding = cocotb.start_soon(feed())
    while not pipeline.into.words:
        await RisingEdge(dut.clk)
    await ClockCycles(dut.clk, 4)
    while any(missing.values()):
        phase = len(pipeline.into.words) % pipeline.pixels
        name = max(missing, key=lambda name: (phase in missing[name], len(missing[name])))
        if phase not in missing[name]:
            await RisingEdge(dut.clk)
            continue
        missing[name].discard(phase)
        answer = await pipeline.write(name, values[name]())  # type: ignore[no-untyped-call]
        assert answer == (Response.SLVERR if name in refused else Response.OKAY), f"{name} at pixel {phase}: {answer}"
    running = False
    await feeding
    await pipeline.write("CONTROL", 0)
    await pipeline.check()
