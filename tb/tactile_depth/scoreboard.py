# SPDX-License-Identifier: Apache-2.0
"""Scoreboard of tactile_depth: frames, counters and status bits expected from the words seen on s_axis."""

from __future__ import annotations

import math
from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass
from typing import Any

import numpy as np

from tactile_depth.chip.common.td_frame_size import FrameSize
from tactile_depth.chip.common.td_round_saturate import Monitor
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.contact.frame_flags import FrameFlags
from tactile_depth.chip.gradient.frame_marks import NO_LIMIT
from tactile_depth.chip.gradient.light_gains import Light, LightFilter
from tactile_depth.chip.latency import last_pixel_to_first_depth, last_pixel_to_last_depth
from tactile_depth.chip.poisson.divergence import divergence
from tactile_depth.chip.registers.register_map import REGISTERS
from tactile_depth.chip.tactile_depth import depth_and_flags, residuals, slopes_and_light, solve
from tactile_depth.chip.video.frame_guard import Frame, Guarded, frame_guard
from tb.axil import RegisterClient
from tb.axis import AxisMonitor
from tb.pixels import unpack
from tb.stream import check_maps
from tb.tactile_depth.contact_watch import SETTINGS, ContactWatch
from tb.tactile_depth.device_tables import Content

STATUS, ARRIVED = REGISTERS["STATUS"], REGISTERS["ARRIVED"]
STICKY = {"timed_out": "timeout"}  # names of faults and of status bits, where they differ
Lit = tuple[np.ndarray | None, bool]
"""Light gains of a frame, int64 (3,), None without, and whether the light moves."""
COUNTERS = (
    *("FRAMES_IN", "FRAMES_OUT", "FRAMES_DROPPED", "SATURATIONS", "DARK_PIXELS", "DEPTH_DROPPED", "RECORDS_LOST"),
    *("FLIPS", "RESIDUALS"),
)


@dataclass(frozen=True)
class Checked:
    """Frames that were compared.

    Attributes
    ----------
    codes : int64 array (frames, rows, columns)
        Depth of the frames that left.
    flags : list of FrameFlags
        Their flags, as if each was alone.
    faults : list of str
        Faults in their order.
    taken : list of (int, int)
        Cycles of the first and of the last pixel of each frame, the broken ones included.
    first_depths : list of int
        Cycles in which the first depth of each frame was first at the pins.
    """

    codes: np.ndarray
    flags: list[FrameFlags]
    faults: list[str]
    taken: list[tuple[int, int]]
    first_depths: list[int]


class Scoreboard:
    """Expected values, and the comparison of all codes, side-bands and latencies of every frame.

    Attributes
    ----------
    counters : dict
        Expected values of the counters, by register.
    sticky : set of str
        Bits of STATUS that are expected to be set.
    latency : int
        Expected value of FIRST_DEPTH_LATENCY, as measured at the pins.
    largest : int
        Expected value of LARGEST_RESIDUAL.
    dark_level, slope_limit : int
        Values of the registers that the next frames use.
    hunting, size : bool, FrameSize
        State of the guard, and what ARRIVED shows.
    beside : bool
        The solver clipped in a self-test, whose flag frames beside it may have.
    light : LightFilter or None
        Light gains of the next frame, and how they follow; None in a build without.
    """

    def __init__(self, config: Configuration, watch: ContactWatch) -> None:
        self.config, self.watch = config, watch
        self.rows, self.columns = config.rows, config.columns
        self.pixels = self.rows * self.columns
        self.reset()

    def reset(self) -> None:
        """Expect the state after a reset."""
        self.counters = dict.fromkeys(COUNTERS, 0)
        self.sticky: set[str] = set()
        self.latency, self.dark_level, self.slope_limit, self.largest = 0, 0, NO_LIMIT, 0
        self.hunting, self.size, self.beside = False, FrameSize(), False
        self.light = LightFilter(Light.of(self.config)) if self.config.light_gains else None

    def light_of(self, words: Any, content: Content, light: LightFilter | None, bad: bool = False) -> Lit:
        """Return the light of a frame of pixel words, whose gains move in `light`."""
        if light is None:
            return None, False
        assert content.slopes.gains is not None
        rgb = unpack(words).reshape(self.rows, self.columns, 3)
        return light.take(content.slopes.gains.ratios(rgb, self.dark_level), bad), light.moves

    def before_the_zero(self, words: Any, content: Content, light: LightFilter | None) -> np.ndarray:
        """Return the depth codes (frames, rows, columns) of pixel words before the zero offset is subtracted."""
        frames = [self.frame(each, content, self.light_of(each, content, light), Monitor()) for each in words]
        return np.stack([depth for depth, _, _ in frames])

    def frame(
        self, words: Any, content: Content, light: Lit, monitor: Monitor, resumed: bool = False
    ) -> tuple[np.ndarray, np.ndarray, FrameFlags]:
        """Return the depth codes of a frame before and after the zero offset, and its flags as if it were alone."""
        marks: dict[str, Any] = {"light": light[0], "light_moves": light[1], "resumed": resumed}
        marks |= {"dark_level": self.dark_level, "limit": self.slope_limit, "zero": content.zero}
        rgb = unpack(words).reshape(self.rows, self.columns, 3)
        return depth_and_flags(rgb, self.config, content.slopes, monitor, **marks)

    def residual(self, words: Any, content: Content, light: Lit) -> int:
        """Return the residual of a frame."""
        rgb, gains = unpack(words).reshape(1, self.rows, self.columns, 3), None if light[0] is None else light[0][None]
        slopes, _ = slopes_and_light(rgb, self.config, content.slopes, None, self.dark_level, gains)
        divergences = divergence(slopes, self.config.neumann)
        return int(residuals(divergences, solve(divergences, self.config), self.config)[0])

    def model(self, words: Any, content: Content) -> np.ndarray:
        """Return the depth codes (frames, rows, columns) of pixel words behind a reset."""
        light = None if self.light is None else LightFilter(self.light.light)
        each = [(frame, content, self.light_of(frame, content, light)) for frame in words]
        return np.stack([self.frame(*frame, Monitor())[1] for frame in each])

    def frames(self, into: AxisMonitor, timeout: int) -> tuple[list[Frame], list[str]]:
        """Return the frames that the device has taken, and the faults."""
        guarded = self.guarded(into, timeout)
        return guarded.frames, guarded.faults

    def guarded(self, into: AxisMonitor, timeout: int) -> Guarded:
        """Return what the guard makes of the words that the device has taken."""
        guarded = frame_guard(into.words, self.rows, self.columns, timeout)
        assert not guarded.open, "the test is void: the last frame of the stream is not complete"
        return guarded

    def depth(self, out: AxisMonitor, count: int) -> np.ndarray:
        """Return the depth codes (frames, rows, columns) of `count` frames that left, and check their side-bands."""
        beats = out.words
        assert len(beats) == count * self.pixels, f"{len(beats)} beats left, expected those of {count} frames"
        for place, beat in enumerate(beats):
            assert beat.user == (place % self.pixels == 0), f"tuser of beat {place}"
            assert beat.last == (place % self.columns == self.columns - 1), f"tlast of beat {place}"
        codes = np.array([self.watch.signed(beat.data) for beat in beats], np.int64)
        return codes.reshape(-1, self.rows, self.columns)

    def used(
        self, into: AxisMonitor, out: AxisMonitor, candidates: Sequence[Sequence[Content]], timeout: int = 0
    ) -> list[Content]:
        """Return the content of the tables that each frame used, among the candidates of each.

        The pins do not show the cycle in which a stalled frame takes its tables. If there are several candidates, the
        whole depth map distinguishes them; if none gives the map that left, the first is returned.
        """
        frames, _ = self.frames(into, timeout)
        left = iter(self.depth(out, sum(not frame.bad for frame in frames)))
        chosen, light = [], copy(self.light)
        for frame, contents in zip(frames, candidates, strict=True):
            if not frame.bad:
                depth = next(left)
                if len(contents) > 1:
                    matching = []
                    for content in contents:
                        lit = self.light_of(frame.pixels, content, copy(light))
                        codes = self.frame(frame.pixels, content, lit, Monitor())[1]
                        matching += [content] if np.array_equal(codes, depth) else []
                    contents = matching or contents
            self.light_of(frame.pixels, contents[0], light, frame.bad)
            chosen.append(contents[0])
        return chosen

    def compare(
        self, into: AxisMonitor, out: AxisMonitor, timeout: int, contents: Content | Sequence[Content], drained: bool
    ) -> Checked:
        """Compare the output with the models of the input, and update the expected counters.

        `drained` also checks the latency from the last pixel to the first depth, which holds if no sink stalled before
        it, and to the last depth of each frame of which no beat waited.
        """
        guarded = self.guarded(into, timeout)
        frames, faults, hunting = guarded.frames, guarded.faults, self.hunting
        self.hunting = guarded.hunting if into.words else self.hunting
        for word in into.words:
            if word is not None:
                self.size.take(word.last, word.user)
        each = [contents] * len(frames) if isinstance(contents, Content) else contents
        monitor, made, lefts = Monitor(), [], []
        for number, (frame, content) in enumerate(zip(frames, each, strict=True)):
            light = self.light_of(frame.pixels, content, self.light, frame.bad)
            resumed = frame.resumed or (hunting and not number)
            made.append(self.frame(frame.pixels, content, light, monitor, resumed))
            lefts.append(self.residual(frame.pixels, content, light) if self.config.self_check else 0)
        clipped = monitor.saturations.total()
        good = [index for index, frame in enumerate(frames) if not frame.bad]
        codes = self.depth(out, len(good))
        check_maps(codes, np.array([made[index][1] for index in good]).reshape(codes.shape))
        taken = [(into.taken[frame.first], into.taken[frame.last]) for frame in frames]
        first_depths, last_depths = out.offered[:: self.pixels], out.offered[self.pixels - 1 :: self.pixels]
        for place, (index, clock, end) in enumerate(zip(good, first_depths, last_depths, strict=True)):
            first, last = taken[index]
            own = slice(place * self.pixels, (place + 1) * self.pixels)
            waited = out.offered[own] != out.taken[own]
            self.latency = clock - first
            if drained:
                assert clock - last == last_pixel_to_first_depth(self.config), f"{clock - last} clocks from last pixel"
            if drained and not waited:
                assert end - last == last_pixel_to_last_depth(self.config), f"{end - last} clocks to the last depth"
        leaves = dict(zip(good, out.taken[self.pixels - 1 :: self.pixels], strict=True))
        ends = [min((leaves[n] for n in good if n >= index), default=math.inf) for index in range(len(frames))]
        flags = [made[index][2] for index in good]
        beside = [
            self.beside
            or any(
                made[n][2].depth_clipped and taken[n][0] <= leaves[index] and start <= ends[n] for n in range(len(made))
            )
            for index, start in ((index, taken[index][0]) for index in good)
        ]
        self.beside = False
        self.watch.check_events(codes, [taken[index][0] for index in good], flags, beside)
        self.counters["FRAMES_IN"] += len(good)
        self.counters["FRAMES_OUT"] += len(good)
        self.counters["FRAMES_DROPPED"] += len(faults)
        self.counters["SATURATIONS"] += clipped
        dark = sum(own.dark for _, _, own in made)
        self.counters["DARK_PIXELS"] += dark
        beyond = sum(own.residual for own in flags)
        self.counters["RESIDUALS"] += beyond
        if self.config.self_check:
            self.largest = max([self.largest, *(lefts[index] for index in good)])
        self.sticky |= {STICKY.get(fault, fault) for fault in faults}
        self.sticky |= {
            name for name, count in (("saturation", clipped), ("dark", dark), ("residual", beyond)) if count
        }
        return Checked(codes, flags, faults, taken, first_depths)

    async def check_registers(self, registers: RegisterClient, counters: bool = True) -> None:
        """Compare counters, status bits, settings and the latency that the hardware measured."""
        if counters:
            have = {name: await registers.read(name) for name in self.counters}
            assert have == self.counters, f"counters are {have}, expected {self.counters}"
            largest = await registers.read("LARGEST_RESIDUAL")
            assert largest == self.largest, f"LARGEST_RESIDUAL is {largest}, expected {self.largest}"
        await registers.read("STATUS")  # the next read has the bits of the last events
        status = STATUS.unpack(await registers.read("STATUS"))
        assert not status.pop("busy"), "STATUS.busy is high after every frame has left"
        assert status.pop("contact") == self.watch.comparator.contact
        assert status.pop("touching") == self.watch.events.touching
        assert status.pop("hunting") == self.hunting, "STATUS.hunting"
        assert not status.pop("stalled"), "STATUS.stalled is high after every frame has left"
        arrived = ARRIVED.unpack(await registers.read("ARRIVED"))
        assert arrived == {"rows": self.size.rows, "columns": self.size.columns}, f"ARRIVED is {arrived}"
        bits = {name for name, value in status.items() if value}
        assert bits == self.sticky, f"sticky bits {bits}, expected {self.sticky}"
        for name in SETTINGS:
            assert await registers.read(name) == self.watch.setting(name) % 2**32, (
                f"{name} differs from the value that the cores use"
            )
        latency = await registers.read("FIRST_DEPTH_LATENCY")
        assert latency == self.latency, f"FIRST_DEPTH_LATENCY is {latency}, at the pins it was {self.latency}"
