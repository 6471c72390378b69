# SPDX-License-Identifier: Apache-2.0
"""Driver and monitors of lanes: row b of a frame is a burst in lane b mod lanes, one step after the row before it.

A step has the cycles of a burst divided by the number of lanes.
"""

from typing import Any

import numpy as np
from cocotb.triggers import RisingEdge

from tactile_depth.common.td_round_saturate import Monitor
from tb.stream import Bench, StreamMonitor, check_frame_starts, check_words, interrupt


class LanePin:
    """Part of a pin that belongs to one lane. A pin may have parts for the first lanes only."""

    def __init__(self, handle: Any, lane: int, lanes: int) -> None:
        self.handle, width = handle, len(handle) // lanes
        self.bits = (lane + 1) * width - 1, lane * width
        self.mine = width > 0 or lane == 0

    @property
    def value(self) -> Any:
        if not self.mine:
            return 0
        high, low = self.bits
        return self.handle.value[high:low] if high >= low else self.handle.value


class LaneMonitor(StreamMonitor):
    """StreamMonitor of one lane."""

    def __init__(self, lane: int, lanes: int, *arguments: Any, **more: Any) -> None:
        self.lane, self.lanes = lane, lanes
        super().__init__(*arguments, **more)

    def pins(self) -> tuple[Any, Any, Any]:
        def part(handle: Any) -> LanePin:
            return LanePin(handle, self.lane, self.lanes)

        return part(self.bus.start), part(self.frame_pin), [(part(self.bus.data), False)]


class BeatMonitor(StreamMonitor):
    """StreamMonitor of one stream whose words are tuples, one element per lane, the first in the lowest bits."""

    def __init__(self, dut: Any, name: str, length: int, lanes: int) -> None:
        self.lanes = lanes
        super().__init__(dut, name, "start", ["data"], length)

    def pins(self) -> tuple[Any, Any, Any]:
        words = [(LanePin(self.bus.data, lane, self.lanes), False) for lane in range(self.lanes)]
        return self.bus.start, self.frame_pin, words


class LanesMonitor:
    """Monitor that keeps the bursts of all lanes in the order in which they begin; see StreamMonitor."""

    def __init__(self, dut: Any, name: str, length: int, lanes: int) -> None:
        self.name, self.length, self.kept = name, length, 0
        self.monitors = [LaneMonitor(lane, lanes, dut, name, "start", ["data"], length) for lane in range(lanes)]
        self.frame_pin: Any = self.monitors[0].frame_pin
        self.marks = len(self.frame_pin)  # number of marked bursts at the beginning of a frame

    @property
    def bursts(self) -> list[Any]:
        """Return start, frame mark and words of each burst."""
        bursts = [
            (start, frame_start, monitor.words[index * self.length : (index + 1) * self.length])
            for monitor in self.monitors
            for index, (start, frame_start) in enumerate(zip(monitor.starts, monitor.frame_starts, strict=True))
        ]
        return sorted(bursts, key=lambda burst: burst[0])[-self.kept :]

    @property
    def starts(self) -> list[int]:
        return [start for start, _, _ in self.bursts]

    @property
    def frame_starts(self) -> list[bool]:
        return [frame_start for _, frame_start, _ in self.bursts]

    @property
    def words(self) -> list[Any]:
        return [word for _, _, words in self.bursts for word in words]

    def forget(self) -> None:
        for monitor in self.monitors:
            monitor.forget()

    def forget_but(self, starts: int) -> None:
        """Keep the last `starts` bursts."""
        self.kept = starts


class LanesDriver:
    """Driver that sends frames (rows, size) with in_start, in_frame_start and in_data of all lanes."""

    def __init__(self, dut: Any, lanes: int) -> None:
        self.dut, self.lanes, self.width = dut, lanes, len(dut.in_data) // lanes
        self.idle()

    def idle(self) -> None:
        self.dut.in_start.value, self.dut.in_frame_start.value = 0, 0

    async def send(self, frame: Any, clocks: int | None = None) -> None:
        """Send a frame, or its first cycles."""
        dut, marks = self.dut, len(self.dut.in_frame_start)
        rows, size = frame.shape
        step = size // self.lanes
        words = (frame & (1 << self.width) - 1).tolist()
        total = (rows - 1) * step + size
        for clock in range(min(total, clocks or total)):
            data = start = 0
            for row in range(max(0, -(-(clock + 1 - size) // step)), min(rows - 1, clock // step) + 1):
                lane, position = row % self.lanes, clock - row * step
                data |= words[row][position] << lane * self.width
                start |= (position == 0) << lane
            dut.in_data.value, dut.in_start.value = data, start
            dut.in_frame_start.value = start if clock // step < marks else 0
            await RisingEdge(dut.clk)
            while not dut.en.value:
                await RisingEdge(dut.clk)
        self.idle()


async def check_lanes(
    dut: Any,
    frames: Any,
    model: Any,
    latency: int,
    *,
    lanes: int,
    sink: Any,
    gap: int = 0,
    pause: float = 0.0,
    interrupts: Any = (),
    strays: int = 0,
) -> None:
    """Send frames (count, rows, size); compare the output with the model of the words seen at the input.

    `model` takes the frames and a Monitor, and returns as many words. `latency` is the number of cycles from the start
    of a row at the input to its start at the output. Up to `gap` cycles lie between frames, more than a core needs
    between two frames. `interrupts`: see stream.interrupt, in cycles of a frame. `strays` are rows of an incomplete
    frame that is sent first.
    """
    bench = Bench(dut, pause)
    count, rows, size = frames.shape
    driver, source = LanesDriver(dut, lanes), LanesMonitor(dut, "in", size, lanes)
    await bench.start()

    async def send(clocks: int) -> None:
        await driver.send(frames[0], clocks)

    await interrupt(bench, send, interrupts, (source, sink), quiet=latency + 4)
    for frame in [frames[0, :strays]] * bool(strays) + list(frames):
        await driver.send(frame)
        await bench.clocks(size // lanes + 1 + bench.random.randint(0, gap))
    await bench.clocks(latency + 2 * size)
    source.forget_but(count * rows)
    sink.forget_but(count * rows)
    sent = np.array(source.words).reshape(frames.shape)
    np.testing.assert_array_equal(sent, frames, "the driver sent other words than the test gave it")
    clipped = Monitor()
    fields = lanes if isinstance(sink, BeatMonitor) else 1
    expected = model(sent, clipped).reshape(-1, fields)
    check_words(np.array(sink.words).reshape(-1, fields), expected, size // fields, rows)
    check_frame_starts((source, sink), rows)
    measured = {after - before for before, after in zip(source.starts, sink.starts, strict=True)}
    assert measured == {latency}, f"latency {measured}, expected {latency}"
    total = clipped.saturations.total()
    assert strays or bench.saturations == total, f"{bench.saturations} values clipped, {total} in the model"
