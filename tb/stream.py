# SPDX-License-Identifier: Apache-2.0
"""Drivers and monitors of the streams between cores, and the one loop that most testbenches need."""

import random

import cocotb
import numpy as np
from cocotb.clock import Clock
from cocotb.triggers import RisingEdge
from cocotb_bus.drivers import BusDriver
from cocotb_bus.monitors import BusMonitor

from models.round_saturate import Monitor

CLOCK_NS = 6


def parameters(dut, *names):
    """Values of the device's parameters."""
    return tuple(int(getattr(dut, name).value) for name in names)


def uniform(shape, width, amplitude=1.0):
    """Random words of `width` signed bits, up to `amplitude` of full scale, the same for a seed."""
    limit = amplitude * 2.0 ** (width - 1)
    words = np.random.default_rng(cocotb.RANDOM_SEED).uniform(-limit, limit, shape)
    return np.clip(np.rint(words), -limit, limit - 1).astype(np.int64)


class StreamDriver(BusDriver):
    """Sends words under a qualifier: `start` (with the first word of a burst) or `valid` (with each word).

    A transaction is a list of tuples, one word each, in the order of `fields`. A word counts in a clock with `en`.
    """

    def __init__(self, dut, name, qualifier, fields):
        self._signals = [qualifier, *fields]
        super().__init__(dut, name, dut.clk)
        self.qualifier, self.fields = qualifier, fields
        self.idle()

    def idle(self):
        getattr(self.bus, self.qualifier).value = 0

    async def _driver_send(self, transaction, sync=True):
        qualifier = getattr(self.bus, self.qualifier)
        for index, word in enumerate(transaction):
            qualifier.value = int(index == 0 or self.qualifier == "valid")
            for field, value in zip(self.fields, word, strict=True):
                getattr(self.bus, field).value = int(value)
            await RisingEdge(self.clock)
            while not self.entity.en.value:
                await RisingEdge(self.clock)
        self.idle()


class StreamMonitor(BusMonitor):
    """Keeps (clock, word) of every word, one tuple of signed values in the order of `fields`.

    With `start` a burst lasts `length` clocks; a burst cut short by another start is an error.
    """

    def __init__(self, dut, name, qualifier, fields, length=1, unsigned=()):
        self._signals = [qualifier, *fields]
        self.qualifier, self.fields, self.length, self.unsigned = qualifier, fields, length, unsigned
        self.words, self.starts = [], []
        super().__init__(dut, name, dut.clk)

    async def _monitor_recv(self):
        left, clock = 0, 0  # `clock` counts clocks with en
        qualifier = getattr(self.bus, self.qualifier)
        handles = [(getattr(self.bus, field), field in self.unsigned) for field in self.fields]
        while True:
            await RisingEdge(self.clock)
            if self.in_reset or not self.entity.en.value:
                continue
            clock += 1
            if qualifier.value:
                assert left == 0, f"burst cut short at clock {clock}"
                self.starts.append(clock)
                left = self.length
            if left:
                left -= 1
                self.words.append(
                    tuple(int(h.value) if unsigned else h.value.to_signed() for h, unsigned in handles)
                )
                self._recv(self.words[-1])

    @property
    def in_reset(self):
        return bool(self.entity.rst.value)


class Bench:
    """Clock, reset, an enable that pauses at random, and the sum of the `saturations` output."""

    def __init__(self, dut, pause=0.0):
        self.dut, self.pause = dut, pause
        self.random = random.Random(cocotb.RANDOM_SEED)
        self.clock, self.saturations = 0, 0  # clocks with en; values clipped

    async def start(self):
        Clock(self.dut.clk, CLOCK_NS, unit="ns").start()
        self.dut.rst.value, self.dut.en.value = 1, 1
        for _ in range(3):
            await RisingEdge(self.dut.clk)
        self.dut.rst.value = 0
        await RisingEdge(self.dut.clk)
        cocotb.start_soon(self._run())

    async def _run(self):
        counts = hasattr(self.dut, "saturations")
        while True:
            self.dut.en.value = int(self.random.random() >= self.pause)
            await RisingEdge(self.dut.clk)
            self.clock += int(self.dut.en.value)
            if counts:
                self.saturations += int(self.dut.saturations.value)

    async def clocks(self, count):
        """Wait for `count` clocks with en."""
        last = self.clock + count
        while self.clock < last:
            await RisingEdge(self.dut.clk)


async def check_bursts(dut, bursts, model, latency, *, in_fields, out_fields, gap=0, pause=0.0, settle=40):
    """Send bursts (count, size, fields); compare what leaves with the model of what was seen going in.

    `model` takes int64 (count, size, fields) and a Monitor, and returns the expected bursts. `latency` is the number of
    clocks from each start in to its start out, or None where the core regroups bursts. Up to `gap` idle clocks lie
    between bursts.
    """
    bench = Bench(dut, pause)
    driver = StreamDriver(dut, "in", "start", in_fields)
    source = StreamMonitor(dut, "in", "start", in_fields, length=bursts.shape[1])
    sink = StreamMonitor(dut, "out", "start", out_fields, length=bursts.shape[1])
    await bench.start()
    for burst in bursts:
        if gap:
            await bench.clocks(bench.random.randint(0, gap))
        await driver.send(burst.tolist())
    await bench.clocks(1)
    seen = np.array(source.words).reshape(bursts.shape)
    np.testing.assert_array_equal(seen, bursts, "the driver sent something else")
    clipped = Monitor()
    expected = model(seen, clipped).reshape(-1, len(out_fields))
    await bench.clocks((latency or len(expected)) + 2 * bursts.shape[1] + settle)
    np.testing.assert_array_equal(np.array(sink.words), expected)
    if latency is not None:
        measured = {after - before for before, after in zip(source.starts, sink.starts, strict=True)}
        assert measured == {latency}, f"latency {measured}, expected {latency}"
    total = clipped.saturations.total()
    assert bench.saturations == total, f"{bench.saturations} values clipped, {total} in the model"
    return bench, sink
