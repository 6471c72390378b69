# SPDX-License-Identifier: Apache-2.0
"""td_gain_map against its model: random and extreme gains, rewritten and changed over while frames stream."""

import random
from typing import Any

import cocotb
import numpy as np

from tactile_depth.configuration import Configuration
from tactile_depth.gradient.flat_field import interpolated_gains
from tactile_depth.latency import GAIN_MAP
from tb.gains import Gains, Grid, first_gains, random_gains, reads_as_a_pause_ends, watch_active
from tb.stream import REGRESS, Bench, StreamDriver, StreamMonitor, check_words, parameters, places, sample, send_apart

PLACES = 2048  # that a test sends, at least


class Nodes(Gains):
    """Node memory of any width, with one to three channels."""

    def __init__(self, dut: Any, config: Configuration) -> None:
        (self.count,) = parameters(dut, "Channels")
        super().__init__(dut, config)

    def at_power_up(self) -> Any:
        return first_gains(*self.config.reference_nodes, self.count, self.width)

    def random(self, chance: random.Random) -> Any:
        return random_gains(self.config, chance, self.count, self.width)


class Map:
    """Device, and the gains that each frame should get."""

    def __init__(self, dut: Any, gap: float, pause: float) -> None:
        self.dut, self.gap = dut, gap
        self.config = Grid.of(dut)
        size = self.config.rows * self.config.columns
        self.places = [(word,) for word in places(size, *parameters(dut, "DataWidth")).tolist()]
        self.frames = max(2, PLACES // len(self.places))
        self.large = len(self.places) > PLACES  # so that a large grid gets a few frames only
        self.bench = Bench(dut, pause)
        self.gains = Nodes(dut, self.config)
        self.driver = StreamDriver(dut, "in", "valid", ["data"])
        self.source = StreamMonitor(dut, "in", "valid", ["data"])
        self.sink = StreamMonitor(dut, "out", "valid", ["gains", "data"], unsigned=["gains"])
        self.expected: list[Any] = []

    async def start(self, written: bool = True) -> None:
        await self.bench.start()
        cocotb.start_soon(watch_active(self.dut, GAIN_MAP))
        await self.gains.settle(written)

    async def send(self, frames: int = 1) -> None:
        """Send frames back to back, each with the bank at its beginning."""
        for _ in range(frames):
            while self.bench.random.random() < self.gap:
                await self.bench.clocks(1)
            self.expected.append(interpolated_gains(self.gains.begin_frame(), self.config))
            await self.words(self.places[:1])
            await self.words(self.places[1:], self.gap)

    async def words(self, places: Any, gap: float = 0.0) -> None:
        """Return random data of a frame, or of a part of it."""
        await send_apart(self.bench, self.driver, places, gap, len(self.places) if places[0] == self.places[0] else 0)

    async def check(self) -> None:
        await self.bench.clocks(GAIN_MAP + 2)
        sent = [place for _ in self.expected for place in self.places]
        assert self.source.words == sent, "the driver sent other words than the test gave it"
        words = np.concatenate([gains.reshape(-1, self.gains.channels) for gains in self.expected]).tolist()
        want = [
            (sum(gain << self.gains.width * channel for channel, gain in enumerate(word)), place)
            for word, (place,) in zip(words, sent, strict=True)
        ]
        rows, columns = self.expected[0].shape[:2]
        check_words(np.array(self.sink.words), np.array(want), columns, rows)
        assert self.sink.starts == [clock + GAIN_MAP for clock in self.source.starts]


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def at_power_up(dut: Any) -> None:
    """Read both banks at power-up: they hold the words of the files."""
    device = Map(dut, 0.0, 0.0)
    await device.start(written=False)
    await device.send()
    device.gains.change()
    await device.send()
    await device.check()
    assert np.array_equal(device.expected[0], interpolated_gains(device.gains.at_power_up(), device.config))


@cocotb.test(timeout_time=60, timeout_unit="ms")
@cocotb.parametrize((("gap", "pause"), sample([(0.0, 0.0), (0.0, 0.3), (0.3, 0.0), (0.7, 0.5)])))
async def frames_while_the_bus_rewrites(dut: Any, gap: float, pause: float) -> None:
    """Rewrite gains while frames stream: the frame before a change-over has the old gains, the frame after it the
    new."""
    device = Map(dut, gap, pause)
    await device.start()
    await device.gains.write(device.gains.random(device.bench.random))
    device.gains.due = True
    going_on = [True]
    rewriter = cocotb.start_soon(device.gains.rewrite(device.bench.random, lambda: going_on[0]))
    await device.send(device.frames)
    going_on.clear()
    going_on.append(False)
    await rewriter
    await device.check()
    used = {gains.tobytes() for gains in device.expected}
    assert len(used) > 1, "the test is void: no change-over was seen"


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def read_as_a_pause_ends(dut: Any) -> None:
    device = Map(dut, 0.0, 0.0)
    await device.start()
    await reads_as_a_pause_ends(device)
    await device.check()


@cocotb.test(timeout_time=20, timeout_unit="ms")
@cocotb.parametrize(pause=[0.0, 0.3])
async def named_inside_a_frame(dut: Any, pause: float) -> None:
    """Select the other bank at any pixel of a frame: the next frame uses it."""
    device = Map(dut, 0.0, pause)
    await device.start()
    columns = device.config.columns
    stride = columns + 1 if REGRESS or len(device.places) < 500 else 3 * columns + 1
    for count in range(3, len(device.places), len(device.places) if device.large else stride):
        await device.gains.write(device.gains.random(device.bench.random))
        device.expected.append(interpolated_gains(device.gains.begin_frame(), device.config))
        await device.words(device.places[:count])
        device.gains.change()
        await device.words(device.places[count:])
        await device.send()
    await device.check()


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def captured(dut: Any) -> None:
    """Capture all channels at once into both banks; the bus reads the same values, and unused entries stay."""
    device = Map(dut, 0.0, 0.0)
    await device.start()
    for _ in range(2):
        await device.gains.capture(device.gains.random(device.bench.random))
        for index in range(0, 4 * device.gains.banks[0][..., 0].size, 5 if device.large else 1):
            await device.gains.read(index)
        device.gains.due = True
        await device.send()
    await device.check()


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def resets(dut: Any) -> None:
    """Reset inside a frame: gains and banks stay, a due change-over takes place, and the next frame is right."""
    device = Map(dut, 0.0, 0.0)
    await device.start()
    columns = device.config.columns
    counts = (1, 2, 3, 4, 6, columns, 2 * columns + 3, 5 * columns // 2)
    for count in counts[-1:] if device.large else counts:
        await device.gains.write(device.gains.random(device.bench.random))
        await device.words(device.places[:count])
        if count % 2:
            device.gains.change()
        await device.bench.reset()
        device.expected.clear()
        device.source.forget()
        device.sink.forget()
        await device.send()
        await device.check()
