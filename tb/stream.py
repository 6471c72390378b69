# SPDX-License-Identifier: Apache-2.0
"""Drivers and monitors of the streams between cores, and the loop that most testbenches share."""

from __future__ import annotations

import gc
import itertools
import random
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from typing import Any, ClassVar

import cocotb
import numpy as np
from cocotb.triggers import RisingEdge
from cocotb_bus.drivers import BusDriver
from cocotb_bus.monitors import BusMonitor

from tactile_depth.chip.configuration import Configuration
from tb import pins
from tb.pins import CLOCK_NS as CLOCK_NS
from tb.pins import Read
from tb.pins import start_clock as start_clock
from tb.settings import RUN
from tb.structures import Structure

gc.freeze()  # what was imported stays; a collection costs more than what a short simulation leaves
gc.set_threshold(200_000, 50, 100)

REGRESS = RUN.full  # play the full product instead of a selection
# Frames or bursts of tests whose cases are rare: ties, values that just clip. Mutants get more.
MANY = RUN.repeats or (15 if REGRESS else 2)


def sample(values: list[Any]) -> list[Any]:
    """Return all values in `make regress`, and the first and the last in `make test`."""
    return values if REGRESS else [values[0], values[-1]]


def parametrize(*options: Any, **named: Any) -> Callable[[Any], Any]:
    """Return cocotb.parametrize, with every combination of values in `make regress` and `make mutate`.

    In `make test` each value of each parameter takes part once at least: the first of each, the second of each, ..
    """
    parts = [*options, *named.items()]
    if REGRESS or RUN.mutants or len(parts) < 2 or not all(values for _, values in parts):
        return cocotb.parametrize(*parts)
    names = [name for part, _ in parts for name in ((part,) if isinstance(part, str) else part)]
    columns = [[(value,) if isinstance(part, str) else value for value in values] for part, values in parts]
    longest = max(map(len, columns))
    repeated = (itertools.islice(itertools.cycle(column), longest) for column in columns)
    return cocotb.parametrize((names, [tuple(itertools.chain(*row)) for row in zip(*repeated, strict=True)]))


def parameters(dut: Any, *names: str) -> tuple[int, ...]:
    """Return the values of these parameters of the device."""
    return tuple(getattr(dut, name).value.to_signed() for name in names)


def configuration() -> Configuration:
    """Return the configuration of the device."""
    return Configuration(**RUN.device["configuration"])


def of_configuration(parameters: Callable[[Configuration], Any], write: Any = None) -> Callable[..., Structure]:
    """Return a function from choices, and fields of `Structure`, to the structure of their configuration.

    `parameters` returns those of the core, `write` writes its ROMs into a folder.
    """

    def built(choices: Any, **fields: Any) -> Structure:
        config = Configuration(**choices)
        roms = write and partial(write, config=config)
        return Structure(parameters(config), device={"configuration": choices}, roms=roms, **fields)

    return built


def uniform(shape: int | tuple[int, ...], width: int, amplitude: float | None = 1.0) -> np.ndarray:
    """Return random words of `width` signed bits, up to `amplitude` of full scale; a seed gives the same words.

    An amplitude of None gives mostly the lowest and the highest word, whose sums and differences clip in every pairing.
    """
    random_words = np.random.default_rng(cocotb.RANDOM_SEED)
    if amplitude is None:
        low, high = -(1 << (width - 1)), (1 << (width - 1)) - 1
        return random_words.choice([*6 * [low, high], -1, 0], shape)
    limit = amplitude * 2.0 ** (width - 1)
    return np.clip(np.rint(random_words.uniform(-limit, limit, shape)), -limit, limit - 1).astype(np.int64)


def places(count: int, width: int) -> np.ndarray:
    """Return `count` words of `width` signed bits that identify their positions: all differ, and every bit changes
    often."""
    factor = round(2.0**width * 0.618) | 1  # odd, so that no two products are the same in `width` bits
    words = [place * factor % (1 << width) for place in range(1, count + 1)]
    return np.array([word - (word >> (width - 1) << width) for word in words], np.int64)


def extremes(size: int, width: int, fields: int = 1) -> np.ndarray:
    """Return bursts (8, size, fields) of words at their limits; the first is all zero.

    The others are: highest, lowest, both in turn, by halves, in turn over the fields, a single word at either end.
    """
    low, high = -(1 << (width - 1)), (1 << (width - 1)) - 1
    bursts = np.zeros((8, size, fields), np.int64)
    bursts[1], bursts[2] = high, low
    bursts[3, 0::2], bursts[3, 1::2] = high, low
    bursts[4, : size // 2], bursts[4, size // 2 :] = low, high
    bursts[5] = np.where(np.arange(fields) % 2, low, high)
    bursts[6, 0], bursts[7, -1] = high, low
    return bursts


def raster(rows: int, columns: int) -> list[Any]:
    """Return the marks of the pixels of a frame in order: bit 0 first row, 1 first column, 2 last row, 3 last
    column."""
    return [
        (row == 0) | (column == 0) << 1 | (row == rows - 1) << 2 | (column == columns - 1) << 3
        for row in range(rows)
        for column in range(columns)
    ]


def depth_position(frame_start: Any, row_end: Any, frame_end: Any) -> int:
    """Pack the position of a depth as depth_position_t of hdl/td_types_pkg.sv."""
    return int(frame_start) << 2 | int(row_end) << 1 | int(frame_end)


class EveryEdge:
    """Generators that advance at each rising edge of a clock, in one task: a task for each takes as long as most do."""

    of: ClassVar[dict[Any, EveryEdge]] = {}

    def __init__(self, clock: Any) -> None:
        self.clock = clock
        self.generators: list[Iterator[None]] = []
        self.task = cocotb.start_soon(self._advance())

    async def _advance(self) -> None:
        edge = RisingEdge(self.clock)
        while True:
            await edge
            for generator in self.generators:
                next(generator)


def at_every_edge(clock: Any, generator: Iterator[None]) -> None:
    """Advance a generator that does not end to its first `yield`, and from then on at each rising edge of the clock."""
    every = EveryEdge.of.get(clock)
    if every is None or every.task.done():  # a task ends with its test
        every = EveryEdge.of[clock] = EveryEdge(clock)
    next(generator)
    every.generators.append(generator)


class StreamDriver(BusDriver):
    """Driver of words with a qualifier: `start` (at the first word of a burst) or `valid` (at each word).

    A transaction is a list of tuples, one word each, in the order of `fields`. A word counts in a clock with
    `en`. Where the device has a pin `frame_start`, it is high with the first word of a transaction sent while
    `frame_start` is true.
    """

    def __init__(self, dut: Any, name: str, qualifier: str, fields: Any) -> None:
        self._signals = [qualifier, *fields]
        super().__init__(dut, name, dut.clk)
        self.qualifier, self.fields = qualifier, fields
        self.frame_start = False
        self.frame_pin = getattr(dut, f"{name}_frame_start", None)
        self.idle()

    def idle(self) -> None:
        getattr(self.bus, self.qualifier).value = 0
        if self.frame_pin is not None:
            self.frame_pin.value = 0

    async def _driver_send(self, transaction: Any, sync: bool = True) -> None:
        qualifier, en, edge = getattr(self.bus, self.qualifier), pins.unsigned(self.entity.en), RisingEdge(self.clock)
        driven = [getattr(self.bus, field) for field in self.fields]
        before: Any = itertools.repeat(None, len(driven))
        for index, word in enumerate(transaction):
            if index < 2:  # later ones are as the second
                qualifier.value = int(index == 0 or self.qualifier == "valid")
                if self.frame_pin is not None:
                    self.frame_pin.value = int(index == 0 and self.frame_start)
            for pin, value, last in zip(driven, word, before, strict=True):
                if value != last:  # a write costs more than a read
                    pin.value = int(value)
            before = word
            await edge
            while not en():
                await edge
        self.idle()


class StreamMonitor(BusMonitor):
    """Monitor that keeps (cycle, word) of every word, a tuple of signed values in the order of `fields`.

    With `start` a burst lasts `length` cycles; a burst cut short by another start is an error. `starts` holds the
    cycles of the qualifier, `frame_starts` whether each begins a frame; no frame may begin in another cycle.
    """

    def __init__(self, dut: Any, name: str, qualifier: str, fields: Any, length: int = 1, unsigned: Any = ()) -> None:
        self._signals = [qualifier, *fields]
        self.qualifier, self.fields, self.length, self.unsigned = qualifier, fields, length, unsigned
        self.words: list[Any] = []
        self.starts: list[Any] = []
        self.frame_starts: list[Any] = []
        self.frame_pin: Any = getattr(dut, f"{name}_frame_start", None)
        self.reset = pins.unsigned(dut.rst)
        super().__init__(dut, name, dut.clk)

    async def _monitor_recv(self) -> None:
        at_every_edge(self.clock, self._watch())

    def _watch(self) -> Iterator[None]:
        left, clock = 0, 0  # `clock` counts clocks with en
        is_present, begins_frame, reads = self.reads()
        en = pins.unsigned(self.entity.en)
        while True:
            yield
            if self.in_reset:
                left = 0
                continue
            if not en():
                continue
            clock += 1
            frame_start = begins_frame is not None and bool(begins_frame())
            try:
                present = is_present()
            except ValueError as error:
                raise AssertionError(f"{self.qualifier}: no reset, or a driver made behind Bench.start?") from error
            if present:
                assert left == 0, f"burst cut short at clock {clock}"
                self.starts.append(clock)
                self.frame_starts.append(frame_start)
                left = self.length
            else:
                assert not frame_start, f"a frame begins in clock {clock}, but no word"
            if left:
                left -= 1
                self.words.append(self.word(reads))
                self._recv(self.words[-1])

    def word(self, reads: Sequence[Read]) -> Any:
        """Return the values of the fields; a message names the position of a word with bits that are not known."""
        try:
            return tuple([read() for read in reads])
        except ValueError:
            burst, position = divmod(len(self.words), self.length)
            got = ", ".join(f"{field} {getattr(self.bus, field).value}" for field in self.fields)
            raise AssertionError(f"RTL leaves unknown bits: burst {burst}, word {position} of it: got {got}") from None

    def reads(self) -> tuple[Read, Read | None, list[Read]]:
        """Return the functions that read the qualifier, the start of a frame, and each field."""
        begins_frame = None if self.frame_pin is None else pins.unsigned(self.frame_pin)
        fields = [(pins.unsigned if f in self.unsigned else pins.signed)(getattr(self.bus, f)) for f in self.fields]
        return pins.unsigned(getattr(self.bus, self.qualifier)), begins_frame, fields

    def forget(self) -> None:
        self.words.clear()
        self.starts.clear()
        self.frame_starts.clear()

    def forget_but(self, starts: Any) -> None:
        """Keep the last `starts` bursts or words."""
        self.words = self.words[-starts * self.length :]
        self.starts, self.frame_starts = self.starts[-starts:], self.frame_starts[-starts:]

    @property
    def in_reset(self) -> bool:
        return bool(self.reset())


class Bench:
    """Clock, reset, an enable that pauses at random, and the sum of the `saturations` output."""

    def __init__(self, dut: Any, pause: float = 0.0) -> None:
        self.dut, self.pause = dut, pause
        self.random = random.Random(cocotb.RANDOM_SEED)
        self.clock, self.saturations = 0, 0  # cycles with en; values clipped
        self.in_reset: int | None = None  # en in the cycle of a reset

    async def start(self) -> None:
        start_clock(self.dut.clk)
        self.dut.rst.value, self.dut.en.value = 1, 1
        for _ in range(3):
            await RisingEdge(self.dut.clk)
        self.dut.rst.value = 0
        await RisingEdge(self.dut.clk)
        at_every_edge(self.dut.clk, self._run())

    def _run(self) -> Iterator[None]:
        en, rst = pins.unsigned(self.dut.en), pins.unsigned(self.dut.rst)
        saturations = pins.unsigned(self.dut.saturations) if hasattr(self.dut, "saturations") else None
        while True:
            moves = int(self.random.random() >= self.pause) if self.in_reset is None else self.in_reset
            if moves != en():  # a write costs more than a read
                self.dut.en.value = moves
            yield
            self.clock += en()
            if saturations is not None and not rst():
                self.saturations += saturations()

    async def reset(self, en: Any = False) -> None:
        """Reset for one cycle, in which the words inside move only with `en`."""
        self.in_reset = int(en)
        self.dut.rst.value, self.dut.en.value = 1, self.in_reset
        await RisingEdge(self.dut.clk)
        self.dut.rst.value = 0
        self.in_reset = None
        self.saturations = 0

    async def clocks(self, count: int) -> None:
        """Wait for `count` cycles with en."""
        last = self.clock + count
        while self.clock < last:
            await RisingEdge(self.dut.clk)


def check_words(got: Any, expected: Any, size: int, rows: int) -> None:
    """Compare words (count, fields) in the order in which they leave; a message names frame, row and column.

    A burst of `size` words is a row, `rows` of them are a frame.
    """
    assert len(got) == len(expected), f"{len(got)} words left, {len(expected)} expected"
    differing = np.flatnonzero(np.any(got != expected, axis=1))
    if len(differing):
        index = differing[0]
        row, column = divmod(int(index), size)
        frame, row = divmod(row, rows) if rows else (0, row)
        raise AssertionError(
            f"RTL differs from the model in {len(differing):,} of {len(expected):,} words; first at frame {frame}, "
            f"row {row}, column {column}: got {plain(got[index])}, expected {plain(expected[index])}"
        )


def check_maps(got: Any, expected: Any) -> None:
    """Compare maps, int array (frames, rows, columns); a message names frame, row and column."""
    maps = np.asarray(expected)
    check_words(np.reshape(got, (-1, 1)), maps.reshape(-1, 1), maps.shape[2], maps.shape[1])


def plain(word: Any) -> Any:
    """Return a word as a number, or as a list of the numbers of its fields."""
    return word.tolist() if len(word) > 1 else int(word[0])


def check_frame_starts(monitors: Any, frame: Any) -> None:
    """Check that frames begin at every `frame`-th start that a monitor saw, and nowhere else."""
    for monitor in monitors:
        if monitor.frame_pin is not None:
            want = [index % frame == 0 for index in range(len(monitor.starts))]
            assert monitor.frame_starts == want, f"{monitor.name}: frames begin at {monitor.frame_starts}"


def with_and_without_en(counts: Any) -> list[Any]:
    """Return each count twice, because `interrupt` resets with and without en in turn."""
    return [count for count in counts for _ in range(2)]


async def interrupt(bench: Any, send: Any, interrupts: Any, monitors: Any, quiet: Any) -> None:
    """For each count in `interrupts` send so many words and reset, with and without en in turn.

    Nothing of them may leave in `quiet` cycles.

    After the last one it does not wait, so that the next word comes right after a reset.
    """
    for index, count in enumerate(interrupts):
        await send(count)
        await bench.reset(en=index % 2)
        for monitor in monitors:
            monitor.forget()
        if index < len(interrupts) - 1:
            await bench.clocks(quiet)
            assert not any(monitor.starts for monitor in monitors), f"words left after a reset at {count}"
            assert bench.saturations == 0, f"clipped words were counted after a reset at {count}"


async def send_words(
    bench: Bench,
    driver: StreamDriver,
    source: StreamMonitor,
    sink: StreamMonitor,
    words: Sequence[Any],
    *,
    quiet: int,
    frame: int = 0,
    gap: float = 0.0,
    interrupts: Any = (),
    strays: int = 0,
) -> None:
    """Send words (tuples) one by one, each after an idle cycle with probability `gap`, and wait `quiet` cycles.

    A frame begins every `frame` words; 0: no frame begins. `strays` words of an incomplete frame come right before, and
    before them what `interrupt` sends: the last words, so that others stand in memories.
    """

    async def send(count: int) -> None:
        for index in range(count):
            while bench.random.random() < gap:
                await bench.clocks(1)
            driver.frame_start = bool(frame) and index % frame == 0
            await driver.send([words[(index - count) % len(words)]])

    await bench.start()
    await interrupt(bench, send, interrupts, (source, sink), quiet)
    await send(strays)
    await send(len(words))
    await bench.clocks(quiet)
    source.forget_but(len(words))
    np.testing.assert_array_equal(source.words, words, "the driver sent other words than the test gave it")


async def drive(dut: Any, stimuli: Any, outputs: Any, pause: float = 0.0) -> Any:
    """Drive the pins with one dict of values per cycle; return lists of the values of all pins at the cycles' ends.

    Use it for cores without a stream. A pin `en` pauses at random, and only cycles with `en` count.
    """
    chance = random.Random(cocotb.RANDOM_SEED)
    edge, write, has_en = RisingEdge(dut.clk), pins.Driver(dut), hasattr(dut, "en")
    start_clock(dut.clk)
    write(**dict.fromkeys(stimuli[0], 0))  # a pin that is random at first may write a word
    write(**{pin: 1 for pin in ("rst", "en") if hasattr(dut, pin)})
    await edge
    await edge
    write(**{"rst": 0} if hasattr(dut, "rst") else {})
    pin_values: Any = {pin: [] for pin in (*stimuli[0], *outputs)}
    reads = [(values.append, pins.value(getattr(dut, pin))) for pin, values in pin_values.items()]
    for clock in stimuli:
        write(**clock)
        paused = True
        while paused:
            paused = has_en and chance.random() < pause
            write(**{"en": not paused} if has_en else {})
            await edge
        for append, read in reads:
            append(read())
    return pin_values
