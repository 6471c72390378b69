# SPDX-License-Identifier: Apache-2.0
"""Stream of pixels between the cores of the camera block: one slot for each cycle with `en`.

A slot is a dict of pins. A pixel has `in_valid`, a broken frame ends with `in_abort`; in every other slot the data
pins hold random values.
"""

import random
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

import cocotb
import numpy as np

from tactile_depth.chip.camera.block_weights import block_weights, pixels_of
from tactile_depth.chip.camera.camera_front_end import SETTINGS
from tactile_depth.chip.camera.pixel_format import stream
from tactile_depth.chip.camera_configuration import CameraConfiguration
from tactile_depth.chip.video.frame_guard import Word
from tb.axis import video

Slot = dict[str, int]
CONTROL = ("in_valid", "in_abort", "rst")


class Slots:
    """Source of slots for a device with these data pins and their widths."""

    def __init__(self, pins: Mapping[str, int], control: Sequence[str] = CONTROL) -> None:
        self.pins, self.control = pins, control
        self.random = random.Random(cocotb.RANDOM_SEED)

    def idle(self, **pins: int) -> Slot:
        """Return a slot without a pixel; data pins hold random values."""
        noise = {pin: self.random.getrandbits(width) for pin, width in self.pins.items()}
        return noise | dict.fromkeys(self.control, 0) | pins

    def apart(self, words: Iterable[Slot], gap: float) -> Iterator[Slot]:
        """Yield the words, each after a random number of idle slots; `gap` is the probability of each idle slot."""
        for word in words:
            while self.random.random() < gap:
                yield self.idle()
            yield self.idle(in_valid=1, **word)


def packed(values: Iterable[int], width: int) -> int:
    """Return words of `width` bits side by side, the first lowest."""
    return sum((int(value) & ((1 << width) - 1)) << (width * place) for place, value in enumerate(values))


def unpacked(word: Any, width: int, count: int) -> list[int]:
    """Return the signed words of `width` bits that stand side by side in the value of a pin."""
    bits = int(word)
    values = [bits >> (width * place) & ((1 << width) - 1) for place in range(count)]
    return [value - (value >> (width - 1) << width) for value in values]


class Window:
    """Geometry of a window: `rows` x `columns` blocks of numerator / denominator pixels."""

    def __init__(self, rows: int, columns: int, numerator: int, denominator: int) -> None:
        self.height, self.width = (pixels_of(count, numerator, denominator) for count in (rows, columns))
        self.row_ends = block_weights(self.height, numerator, denominator)[1]
        self.column_ends = block_weights(self.width, numerator, denominator)[1]

    def completes(self) -> np.ndarray:
        """Return which pixels are the last of a block, bool (height, width)."""
        return np.logical_and.outer(self.row_ends, self.column_ends)

    def marks(self) -> list[Slot]:
        """Return the marks of the pixels in raster order."""
        return [
            {"in_row_start": int(column == 0), "in_frame_start": int(row == column == 0)}
            for row in range(self.height)
            for column in range(self.width)
        ]


def camera_words(words: np.ndarray, camera: CameraConfiguration) -> list[Word]:
    """Return the stream of a picture in the camera's format, (rows, columns), one word for each pixel or byte."""
    words = stream(words, camera)
    return video(words.reshape(-1).tolist(), words.shape[1])


def pack_settings(settings: Mapping[str, int]) -> int:
    """Return the value of a `camera_settings_t`, the first member on top."""
    bits = 0
    for name, width in SETTINGS.items():
        bits = bits << width | settings[name]
    return bits
