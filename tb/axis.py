# SPDX-License-Identifier: Apache-2.0
"""AXI4-Stream: drivers of source and sink, a monitor that checks the rules, and whole and broken video frames.

A word is a tuple in the order of the bus's fields: data, last, user unless said otherwise.
"""

import random
from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import cycle, repeat
from typing import Any

import cocotb
from cocotb.triggers import RisingEdge
from cocotb_bus.drivers import BusDriver
from cocotb_bus.monitors import BusMonitor

from tactile_depth.chip.video.frame_guard import Word
from tb.pins import unsigned
from tb.stream import at_every_edge

VIDEO = ("data", "last", "user")

# Profiles: generators of one bool per cycle. For a sink True means ready, for a source True means that a word is
# offered. Names have up to 10 letters, because cocotb puts only short ones into the names of tests.

PROFILES: dict[str, Callable[[random.Random], Iterator[bool]]] = {
    "none": lambda rng: repeat(True),
    "one_in_4": lambda rng: cycle((True, True, True, False)),
    "alternate": lambda rng: cycle((False, True)),
    "long": lambda rng: cycle([True] * 150 + [False] * 200),
    "random": lambda rng: (rng.random() >= 0.4 for _ in repeat(None)),
}


def profile(name: str, seed: int = 0) -> Iterator[bool]:
    """Return a profile by its name. Random profiles depend on `seed` and on the seed of cocotb."""
    return PROFILES[name](random.Random(f"{cocotb.RANDOM_SEED} {seed}"))


def _signals(fields: Sequence[str], prefix: str) -> dict[str, str]:
    return {name: prefix + name for name in ("valid", "ready", *fields)}


class AxisSource(BusDriver):  # type: ignore[misc]
    """Driver that offers words and holds each until it is taken. In a transaction None is a cycle without a word.

    `offers` is a profile: when it is False no new word is offered. Pins are "<name>_<prefix>valid" and so on.
    """

    def __init__(
        self, dut: Any, name: str, fields: Sequence[str] = VIDEO, prefix: str = "", offers: Iterator[bool] | None = None
    ) -> None:
        self._signals = _signals(fields, prefix)
        self.offers = offers or repeat(True)
        super().__init__(dut, name, dut.clk)
        self.pins = [getattr(self.bus, field) for field in fields]
        self.aborted = False
        self.bus.valid.value = 0

    def abort(self) -> None:
        """Withdraw the offered word and drop the remaining words of the transaction. Use it in a reset only."""
        self.aborted = True
        self.clear()
        self.bus.valid.value = 0

    async def _driver_send(self, transaction: Iterable[Sequence[int] | None], sync: bool = True) -> None:
        valid, ready, edge = self.bus.valid, unsigned(self.bus.ready), RisingEdge(self.clock)
        self.aborted = False
        offered = None  # a pin is written where it changes: each write costs as much as a read
        before: Any = repeat(None, len(self.pins))
        for word in transaction:
            while word is None or not next(self.offers):
                if offered != 0:
                    valid.value = offered = 0
                await edge
                if self.aborted:
                    return
                if word is None:
                    break
            if word is None:
                continue
            for pin, value, last in zip(self.pins, word, before, strict=True):
                if value != last:
                    pin.value = int(value)
            before = word
            if offered != 1:
                valid.value = offered = 1
            await edge
            while not ready() and not self.aborted:
                await edge
            if self.aborted:
                return
        valid.value = 0


class AxisSink(BusDriver):  # type: ignore[misc]
    """Driver of ready by a profile, independent of valid; `stall(profile)` changes the profile."""

    def __init__(self, dut: Any, name: str, prefix: str = "", accepts: Iterable[bool] | None = None) -> None:
        self._signals = {"ready": prefix + "ready"}
        super().__init__(dut, name, dut.clk)
        self.stall(accepts or repeat(True))
        self.append(None)

    def stall(self, accepts: Iterable[bool]) -> None:
        self.accepts = iter(accepts)

    async def _driver_send(self, transaction: None, sync: bool = True) -> None:
        at_every_edge(self.clock, self._drive())

    def _drive(self) -> Iterator[None]:
        before = None
        while True:
            ready = int(next(self.accepts))
            if ready != before:
                self.bus.ready.value = before = ready
            yield


class AxisMonitor(BusMonitor):  # type: ignore[misc]
    """Monitor that keeps the words and checks the rules: a valid word stays the same until ready; none in reset.

    valid and ready are never unknown, nor is a field while valid is high (on Icarus X raises where it is
    read). Values are unsigned.

    Attributes
    ----------
    words : list of tuple
        As they were taken. With `silence`, also None for each clock in which nothing was offered.
    taken, offered : list of int
        For each entry of `words`, the clock of its handshake, and the first in which it stood on the pins.
    """

    def __init__(
        self, dut: Any, name: str, fields: Sequence[str] = VIDEO, prefix: str = "", silence: bool = False
    ) -> None:
        self._signals = _signals(fields, prefix)
        self.clock_count = 0
        self.silence = silence
        self.forget()
        super().__init__(dut, name, dut.clk)
        self.pins = [getattr(self.bus, field) for field in fields]
        self.make: Any = Word._make if tuple(fields) == VIDEO else tuple

    def forget(self) -> None:
        self.words: list[Any] = []
        self.taken: list[int] = []
        self.offered: list[int] = []

    async def _monitor_recv(self) -> None:
        at_every_edge(self.clock, self._watch())

    def _watch(self) -> Iterator[None]:
        valid, ready, reset = unsigned(self.bus.valid), unsigned(self.bus.ready), unsigned(self.entity.rst)
        pins = [unsigned(pin) for pin in self.pins]
        was_reset = True  # so that nothing is read before the first edge
        held, since = None, 0
        while True:
            yield
            clock = self.clock_count = self.clock_count + 1
            if reset():
                assert clock == 1 or not was_reset or not valid(), f"{self}: valid in reset"
                was_reset, held = True, None
                continue
            if not valid():
                assert held is None, f"{self}: clock {clock}: valid fell before ready came"
                ready()  # raises if it is unknown
                if self.silence:
                    self.words.append(None)
                    self.taken.append(clock)
                    self.offered.append(clock)
                was_reset = False
                continue
            assert not was_reset, f"{self}: clock {clock}: valid right after reset"
            word = self.make([pin() for pin in pins])
            if held is None:
                since = clock
            else:
                assert word == held, f"{self}: clock {clock}: {held} became {word} before ready came"
            held = word
            if ready():
                held = None
                for part in self.parts(word):
                    self.words.append(part)
                    self.taken.append(clock)
                    self.offered.append(since)
                self._recv(word)

    def parts(self, word: Any) -> Iterable[Any]:
        """Return the entries of `words` that a word becomes."""
        return (word,)


class BeatMonitor(AxisMonitor):
    """AxisMonitor of video with several values per beat, the first in the lowest bits; `words` holds single values."""

    def __init__(self, dut: Any, name: str, lanes: int, prefix: str = "") -> None:
        self.lanes = lanes
        super().__init__(dut, name, prefix=prefix)

    def parts(self, word: Any) -> Iterable[Any]:
        width = len(self.bus.data) // self.lanes
        for lane in range(self.lanes):
            value = word.data >> lane * width & (1 << width) - 1
            yield Word(value, int(word.last and lane == self.lanes - 1), int(word.user and not lane))


# Video frames.


def video(pixels: Iterable[int], columns: int) -> list[Word]:
    """Return the words of a frame of pixels in raster order."""
    return [
        Word(int(pixel), int(position % columns == columns - 1), int(position == 0))
        for position, pixel in enumerate(pixels)
    ]


# Each way to break a frame, and some that break nothing, with the faults that it raises between whole frames.
# `inner` is False at the beginning of a row.
BREAKS: dict[str, Callable[[bool], tuple[str, ...]]] = {
    "whole": lambda inner: (),
    "waited": lambda inner: (),  # silent for exactly as long as the time-out allows
    "row_short": lambda inner: ("row_short",),  # the row ends at the position, the next follows
    "end_extra": lambda inner: ("row_short",),  # tlast there, and the row goes on
    "row_long": lambda inner: ("row_long",),  # one pixel too many
    "end_missing": lambda inner: ("row_long",),  # no tlast, and the next row follows
    "start_missing": lambda inner: ("start_missing",),
    "stray": lambda inner: ("start_missing",),  # so many words without a start, and then the next frame
    "start_late": lambda inner: ("start_missing", "row_short" if inner else "start_early"),  # so many pixels late
    "start_early": lambda inner: ("start_early",),  # the frame ends there, the next one follows
    "start_extra": lambda inner: ("start_early", "row_short" if inner else "start_early"),  # and the frame goes on
    "timed_out": lambda inner: ("timed_out",),  # silent for longer than the time-out, then the frame goes on
    "broken_off": lambda inner: ("timed_out",),  # silent for longer than the time-out, then the next frame follows
}
SILENT = ("waited", "timed_out", "broken_off")
WITHOUT_START = ("start_missing", "stray", "start_late")


def positions(kind: str, rows: int, columns: int) -> list[int]:
    """Return the positions at which a frame can be broken in this way."""
    pixels = range(rows * columns)
    if kind in ("whole", "start_missing"):
        return [0]
    if kind in ("row_short", "end_extra"):
        return [p for p in pixels if p % columns < columns - 1]
    if kind in ("row_long", "end_missing"):
        return [p for p in pixels if p % columns == columns - 1]
    assert kind in BREAKS, kind
    return list(pixels[1:])


def faults_of(kind: str, position: int, columns: int) -> tuple[str, ...]:
    """Return the faults that a frame broken in this way raises between whole frames."""
    return BREAKS[kind](position % columns > 0)


def broken(words: Sequence[Word], kind: str, position: int, columns: int, silent: int = 0) -> list[Word | None]:
    """Return a frame with one break at a position, continued as a camera would continue it.

    A break that is a silence lasts `silent` cycles.
    """
    before: list[Word | None] = list(words[:position])
    word, after = words[position], list(words[position + 1 :])
    without_start: list[Word | None] = [other._replace(user=0) for other in words[:position]]
    match kind:
        case "whole":
            return list(words)
        case "row_short":
            return [*before, word._replace(last=1), *after[columns - 1 - position % columns :]]
        case "end_extra":
            return [*before, word._replace(last=1), *after]
        case "row_long":
            return [*before, word._replace(last=0), word._replace(user=0), *after]
        case "end_missing":
            return [*before, word._replace(last=0), *after]
        case "start_missing":
            return [word._replace(user=0), *after]
        case "stray":
            return without_start
        case "start_late":
            return [*without_start, word._replace(user=1), *after]
        case "start_early":
            return before
        case "start_extra":
            return [*before, word._replace(user=1), *after]
        case "broken_off":
            return [*before, *[None] * silent]
    assert kind in ("waited", "timed_out"), kind
    return [*before, *[None] * silent, word, *after]
