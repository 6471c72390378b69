# SPDX-License-Identifier: Apache-2.0
"""Frames of depth for zero_offset and zero_capture: words with the marks of frames and rows."""

import random
from typing import Any

import numpy as np

from tb.stream import StreamDriver, depth_position, send_apart


def packed(words: Any, width: int) -> list[int]:
    """Return one number for each beat of words (beats, lanes), with the first lane in the lowest bits."""
    mask = (1 << width) - 1
    return [sum((word & mask) << width * lane for lane, word in enumerate(beat)) for beat in words.tolist()]


def depth_words(frame: Any, width: int, lanes: int = 1) -> list[Any]:
    """Return depths (rows, columns) as beats: frame_start, row_end, frame_end, data of all lanes."""
    rows, columns = frame.shape[0], frame.shape[1] // lanes
    end = rows * columns - 1
    data = packed(frame.reshape(-1, lanes), width)
    return [(at == 0, at % columns == columns - 1, at == end, depths) for at, depths in enumerate(data)]


def random_depths(shape: Any, width: int, chance: random.Random) -> Any:
    """Return random depths: full range, the limits, one value, or small ones, whose mean is often a tie."""
    generator = np.random.default_rng(chance.getrandbits(32))
    low, high = -(1 << width - 1), (1 << width - 1) - 1
    match chance.randrange(5):
        case 0:
            return np.full(shape, chance.choice((low, high)))
        case 1:
            return generator.choice([*3 * [low, high], low + 1, high - 1, -1, 0], shape)
        case 2:
            return generator.integers(-3, 3, shape, endpoint=True)
    return generator.integers(low, high, shape, endpoint=True)


class DepthDriver(StreamDriver):
    """Driver whose marks and data are random between words. The device has a position, or only the marks that it
    needs."""

    def __init__(self, dut: Any, bench: Any, gap: float) -> None:
        self.bench, self.gap = bench, gap
        marks = ["position"] if hasattr(dut, "in_position") else ["frame_start", "frame_end"]
        super().__init__(dut, "in", "valid", [*marks, "data"])

    def idle(self) -> None:
        super().idle()
        for field in self.fields:
            pin = getattr(self.bus, field)
            pin.value = self.bench.random.getrandbits(len(pin))

    async def words(self, words: Any) -> None:
        """Send a frame of `depth_words`, or a part of one."""
        if "position" in self.fields:
            words = [(depth_position(*marks), data) for *marks, data in words]
        else:
            words = [(frame_start, frame_end, data) for frame_start, _, frame_end, data in words]
        if self.gap:
            await send_apart(self.bench, self, words, self.gap)
        elif words:
            await self.send(words)
