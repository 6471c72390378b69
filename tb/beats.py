# SPDX-License-Identifier: Apache-2.0
"""Driver and monitor of streams with several words per cycle, whose starts come some cycles before their words.

A word of these streams is a beat: a tuple of the words of all paths of the first field, then of those of the next one.
"""

import math
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import cocotb
import numpy as np

from tactile_depth.chip.common.td_round_saturate import Monitor
from tactile_depth.chip.poisson.transform.commutator import LEAD
from tb.pins import Late, Read, signed, unsigned
from tb.stream import Bench, StreamDriver, StreamMonitor, at_every_edge, check_frame_starts, check_words, interrupt

WORDS_TRIED, BURSTS_OF_A_STAGE = 1 << 20, 8  # enough to fill fft's clip count in each of six seeds


class BeatsMonitor(StreamMonitor):
    """StreamMonitor of beats; `starts` holds the cycles of the first beats."""

    def __init__(self, dut: Any, name: str, fields: Sequence[str], length: int, paths: int, lead: int = LEAD) -> None:
        self.paths, self.lead, self.late = paths, lead, [Late(getattr(dut, f"{name}_start"), lead)]
        super().__init__(dut, name, "start", fields, length)

    def reads(self) -> tuple[Read, Read | None, list[Read]]:
        words = [signed(getattr(self.bus, f), path, self.paths) for f in self.fields for path in range(self.paths)]
        begins_frame = None
        if self.frame_pin is not None:
            begins_frame = Late(self.frame_pin, self.lead)
            self.late.append(begins_frame)
        return self.late[0], begins_frame, words

    @property
    def in_reset(self) -> bool:
        reset = super().in_reset
        if reset:
            for pin in self.late:
                pin.clear()
        return reset


class BeatsDriver(StreamDriver):
    """StreamDriver of beats: the start of a burst goes out at once, its words follow some cycles with en later."""

    def __init__(self, dut: Any, name: str, fields: Sequence[str], paths: int, lead: int = LEAD) -> None:
        self.paths, self.lead, self.bursts = paths, lead, deque[Any]()
        self.words = [getattr(dut, f"{name}_{field}") for field in fields]
        super().__init__(dut, name, "start", [])
        at_every_edge(self.clock, self._drive())

    async def _driver_send(self, transaction: Any, sync: bool = True) -> None:
        self.bursts.append(transaction)
        await super()._driver_send([() for _ in transaction], sync)

    def _drive(self) -> Iterator[None]:
        """Set the words of each cycle; the start on the pin says when those of the next burst are due."""
        beats: deque[Any] = deque()
        begun: deque[Any] = deque([()] * (self.lead - LEAD))  # bursts whose words come later
        en, start = unsigned(self.entity.en), unsigned(self.bus.start)
        while True:
            yield
            if not en():
                continue
            if beats:
                beat = beats.popleft()
                for index, pin in enumerate(self.words):
                    width = len(pin) // self.paths
                    words = beat[index * self.paths : (index + 1) * self.paths]
                    pin.value = sum((word & (1 << width) - 1) << path * width for path, word in enumerate(words))
            begun.append(self.bursts.popleft() if start() else ())
            beats = deque(begun.popleft()) or beats


async def check_bursts(
    dut: Any,
    bursts: Any,
    model: Any,
    latency: int | None,
    *,
    fields: Sequence[str] = ("data",),
    out_fields: Sequence[str] = (),
    driver: Any = BeatsDriver,
    source: Any = BeatsMonitor,
    sink: Any = BeatsMonitor,
    frame: int = 3,
    gap: int = 0,
    gap_every: int = 1,
    pause: float = 0.0,
    interrupts: Any = (),
    strays: int = 0,
    settle: int = 40,
) -> tuple[Any, ...]:
    """Send bursts (count, beats, paths, fields); compare the output with the model of the words seen at the input.

    `model` takes such int64 bursts and a Monitor, and returns the expected bursts. `latency` is the number of cycles
    from each start at the input to its start at the output, or None if the core regroups bursts. Up to `gap` idle
    cycles lie before every `gap_every`-th burst. A frame begins every `frame` bursts. `interrupts`: see `interrupt`.
    `strays` bursts of an incomplete frame come right before; their results are not compared.

    Return the monitors of both sides.
    """
    bench = Bench(dut, pause)
    count, size, paths, _ = bursts.shape
    driver = driver(dut, "in", fields, paths)
    source = source(dut, "in", fields, size, paths)
    sink = sink(dut, "out", out_fields or fields, size, paths)
    await bench.start()

    def flat(bursts: Any) -> Any:
        return np.moveaxis(bursts, -1, -2).reshape(count, size, -1)

    beats = flat(bursts)

    async def send(words: int) -> None:
        for index, sent in enumerate(range(0, words, size)):
            if gap and index % gap_every == 0:
                await bench.clocks(bench.random.randint(0, gap))
            driver.frame_start = index % frame == 0
            await driver.send(beats[index % count, : words - sent].tolist())

    await interrupt(bench, send, interrupts, (source, sink), quiet=(latency or 0) + 4)
    await send(strays * size)
    await send(count * size)
    await bench.clocks(driver.lead + 1)
    source.forget_but(count)
    words_in = np.moveaxis(np.array(source.words).reshape(count, size, -1, paths), 2, -1)
    np.testing.assert_array_equal(words_in, bursts, "the driver sent other words than the test gave it")
    clipped = Monitor()
    expected = flat(model(words_in, clipped))
    await bench.clocks((latency or count * size) + 2 * size + settle)
    if strays:
        sink.forget_but(count)
    check_words(np.array(sink.words), expected.reshape(count * size, -1), size, frame)
    check_frame_starts((source, sink), frame)
    if latency is not None:
        measured = {after - before for before, after in zip(source.starts, sink.starts, strict=True)}
        assert measured == {latency}, f"latency {measured}, expected {latency}"
    total = clipped.saturations.total()
    assert strays or bench.saturations == total, f"{bench.saturations} values clipped, {total} in the model"
    return source, sink


class Clips(Monitor):
    """Count of the values that clip in each burst, by stage; `width` returns the bits of a node."""

    def __init__(self, width: Callable[[str], int]) -> None:
        super().__init__()
        self.width, self.stages = width, dict[str, Any]()

    def rounded(self, node: str, values: np.ndarray) -> None:
        limit = 1 << (self.width(node) - 1)
        clips = (values < -limit) | (values >= limit)
        stage = node.removesuffix(".re").removesuffix(".im")
        self.stages[stage] = self.stages.get(stage, 0) + clips.sum(axis=tuple(range(1, values.ndim)))


def all_stages_clip(
    shape: tuple[int, ...], width: int, model: Callable[[np.ndarray, Monitor], Any], width_of: Callable[[str], int]
) -> np.ndarray:
    """Return bursts (count, ..) of words at their limits, chosen so that all stages of a transform clip in one cycle.

    They are the bursts in which a stage clips most, or a stage and the next one, in a random order: other stages have
    other bursts at the same time. `width_of` returns the bits of a node of the model.
    """
    random_words = np.random.default_rng(cocotb.RANDOM_SEED)
    low, high = -(1 << (width - 1)), (1 << (width - 1)) - 1
    tried = random_words.choice([low, high], (WORDS_TRIED // math.prod(shape[1:]), *shape[1:]))
    clips = Clips(width_of)
    model(tried, clips)
    counts = np.array(list(clips.stages.values()))
    most = [np.argsort(count, kind="stable")[-BURSTS_OF_A_STAGE:] for count in (*counts, *(counts[:-1] + counts[1:]))]
    return tried[random_words.choice(np.concatenate(most), shape[0])]


def alone(bursts: Any) -> Any:
    """Return whether the first row of each burst (count, beats, ..) comes alone: its first word is odd."""
    return np.asarray(bursts).reshape(len(bursts), -1)[:, 0] % 2 == 1


class AloneDriver(BeatsDriver):
    """BeatsDriver of bursts of two rows; in_alone counts with a start."""

    async def _driver_send(self, transaction: Any, sync: bool = True) -> None:
        self.entity.in_alone.value = int(alone([transaction])[0])
        await super()._driver_send(transaction, sync)
