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
from tb.stream import StreamDriver, StreamMonitor, at_every_edge, check_bursts

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


async def check_beats(
    dut: Any, words: Any, model: Any, latency: int, *, fields: Sequence[str], paths: int, **behaviour: Any
) -> Any:
    """Send bursts (count, beats, paths, fields); `model` takes and returns such arrays. See `check_bursts`."""
    count, beats = words.shape[:2]

    def flat(words: Any) -> Any:
        return np.moveaxis(words, -1, 2).reshape(*words.shape[:2], -1)

    def on_beats(flat_words: Any, monitor: Any) -> Any:
        shaped = flat_words.reshape(count, beats, len(fields), paths)
        return flat(model(np.moveaxis(shaped, 2, -1), monitor))

    names = [f"{field}{path}" for field in fields for path in range(paths)]
    return await check_bursts(
        dut,
        flat(words),
        on_beats,
        latency,
        in_fields=names,
        out_fields=names,
        driver=BeatsDriver(dut, "in", fields, paths),
        source=BeatsMonitor(dut, "in", fields, beats, paths),
        sink=BeatsMonitor(dut, "out", fields, beats, paths),
        **behaviour,
    )


def one_path(dut: Any, beats: int) -> dict[str, Any]:
    """Return driver and monitors for `check_bursts` of a core with the field data, one word a cycle."""
    return {
        "driver": BeatsDriver(dut, "in", ["data"], 1),
        "source": BeatsMonitor(dut, "in", ["data"], beats, 1),
        "sink": BeatsMonitor(dut, "out", ["data"], beats, 1),
    }


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
    """Return whether the first row of each burst (count, beats, words) comes alone: its first word is odd."""
    return np.asarray(bursts)[:, 0, 0] % 2 == 1


class AloneDriver(BeatsDriver):
    """BeatsDriver of bursts of two rows; in_alone counts with a start."""

    async def _driver_send(self, transaction: Any, sync: bool = True) -> None:
        self.entity.in_alone.value = int(alone([transaction])[0])
        await super()._driver_send(transaction, sync)
