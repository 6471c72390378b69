# SPDX-License-Identifier: Apache-2.0
"""Bench of contact_events, one cycle at a time, and depth maps that reach its special cases."""

import random
from collections.abc import Iterator
from typing import Any

import cocotb
import numpy as np
from cocotb.triggers import RisingEdge

from tb.pins import Driver, by_name
from tb.stream import depth_position, parameters, start_clock

WORD_LOW, WORD_HIGH = -(1 << 31), (1 << 31) - 1


class DepthBench:
    """Driver of depth maps; the bench of a core defines one cycle (`edge`)."""

    def __init__(self, dut: Any, gap: float = 0.0) -> None:
        self.dut, self.gap = dut, gap
        self.random = random.Random(cocotb.RANDOM_SEED)
        self.width, self.rows, self.columns, self.lanes, self.bottom_first = parameters(
            dut, "Width", "Rows", "Columns", "Lanes", "BottomFirst"
        )
        self.pixels = self.rows * self.columns
        self.beats = self.pixels // self.lanes
        self.low, self.high = -(1 << self.width - 1), (1 << self.width - 1) - 1
        self.drive, self.read = Driver(dut), by_name(dut)
        self.now = 0

    async def start(self) -> None:
        start_clock(self.dut.clk)
        self.dut.rst.value = 1
        self.drive(in_valid=0)
        await RisingEdge(self.dut.clk)
        await RisingEdge(self.dut.clk)
        self.dut.rst.value = 0

    async def edge(
        self, valid: bool, depths: list[int], position: tuple[Any, Any, Any], settings: Any = None, time: Any = None
    ) -> None:
        """Run one cycle with the depths of a beat; `position` has frame_start, row_end and frame_end.

        The first beat of a frame comes with settings.
        """
        raise NotImplementedError

    def drive_depth(self, valid: bool, depths: list[int], position: tuple[Any, Any, Any]) -> None:
        mask = (1 << self.width) - 1
        data = sum((depth & mask) << lane * self.width for lane, depth in enumerate(depths))
        self.drive(in_valid=int(valid), in_data=data, in_position=depth_position(*position))

    def in_turn(self, depths: list[int], position: tuple[Any, Any, Any]) -> Iterator[tuple[int, Any, Any, Any]]:
        """Yield the depths of a beat as a model takes them: single depths, each with its position."""
        frame_start, row_end, frame_end = position
        for lane, depth in enumerate(depths):
            last = lane == self.lanes - 1
            yield depth, frame_start and lane == 0, row_end and last, frame_end and last

    async def idle(self, clocks: int = 1) -> None:
        for _ in range(clocks):
            coin = self.random.getrandbits
            depths = [coin(self.width) + self.low for _ in range(self.lanes)]
            await self.edge(False, depths, (coin(1), coin(1), coin(1)))

    async def frame(self, depth: np.ndarray, settings: Any, time: int = 0, words: int | None = None) -> None:
        """Send a map, row 0 at the top, or its first beats."""
        stream = (depth[::-1] if self.bottom_first else depth).reshape(-1, self.lanes)
        row = self.columns // self.lanes
        for index, depths in enumerate(stream.tolist()[:words]):
            while self.gap and self.random.random() < self.gap:
                await self.idle()
            position = index == 0, index % row == row - 1, index == len(stream) - 1
            await self.edge(True, depths, position, *((settings, time) if index == 0 else ()))

    def full(self, value: int) -> np.ndarray:
        return np.full((self.rows, self.columns), value, np.int64)

    def lone(self, value: int, *positions: tuple[int, int]) -> np.ndarray:
        """Return a map of the lowest code, except at a few positions."""
        depth = self.full(self.low)
        for row, column in positions:
            depth[row, column] = value
        return depth

    def random_map(self, rng: np.random.Generator) -> np.ndarray:
        """Return a random map of one of several kinds."""
        low, high = self.low, self.high
        shape: Any = (self.rows, self.columns)
        match rng.integers(10):
            case 0:  # full range
                return rng.integers(low, high, shape, endpoint=True)
            case 1:  # few values: ties
                return rng.integers(-2, 3, shape)
            case 2:  # all equal
                return np.full(shape, rng.choice([low, -1, 0, 1, high, int(rng.integers(low, high))]))
            case 3:  # ends of the range
                return rng.choice([low, high], shape)
            case 4:  # negative throughout
                return rng.integers(low, 0, shape)
            case 5:  # lone peaks, equal ones too
                depth = np.full(shape, rng.choice([low, 0, -5]))
                for _ in range(rng.integers(1, 4)):
                    depth[tuple(rng.integers(shape))] = rng.choice([high, 1, 2])
                return depth
            case 6:  # the edge
                depth = np.zeros(shape, np.int64)
                depth[:: self.rows - 1] = rng.integers(-1, 4, self.columns)
                depth[:, :: self.columns - 1] += rng.integers(-1, 4, (self.rows, 1))
                return depth
        y, x = np.indices(shape)  # caps on a noisy zero offset, some cut by the edge
        depth = rng.normal(0, 1, shape)
        for _ in range(rng.integers(1, 4)):
            centre = rng.uniform(-1, 1 + np.array(shape))
            radius, height = rng.uniform(1, max(shape) / 2), 2.0 ** rng.uniform(2, self.width - 1)
            cap = 1 - ((y - centre[0]) ** 2 + (x - centre[1]) ** 2) / radius**2
            depth = np.maximum(depth, np.where(cap > 0, np.floor(height * cap), depth))
        return np.clip(np.rint(depth), low, high).astype(np.int64)

    def random_thresholds(self, rng: np.random.Generator, depth: np.ndarray) -> tuple[int, int]:
        """Return random thresholds near the values of the map, or at their limits."""
        values = [*rng.choice(depth.ravel(), 3), 0, depth.max(), depth.min(), depth.max() - 1]
        on, off = np.clip(rng.choice(values, 2) - rng.integers(0, 2, 2), WORD_LOW, WORD_HIGH)
        if rng.random() < 0.05:
            on, off = rng.choice([WORD_LOW, WORD_HIGH, self.low, self.high], 2)
        return int(on), int(off)
