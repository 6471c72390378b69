# SPDX-License-Identifier: Apache-2.0
"""frame_tags against models.frame_tags: the head in every clock, at every filling, through resets."""

import os
import random

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import RisingEdge
from stream import CLOCK_NS, parameters

from models.frame_tags import CAPACITY, FrameTags

CLOCKS = 3000


class Bench:
    """Drives one clock at a time and compares the head with the model."""

    def __init__(self, dut):
        dut._log.info("SEED=%s", os.environ["COCOTB_RANDOM_SEED"])
        self.dut, self.model = dut, FrameTags()
        self.random = random.Random(cocotb.RANDOM_SEED)
        (self.width,) = parameters(dut, "Width")

    async def start(self):
        Clock(self.dut.clk, CLOCK_NS, unit="ns").start()
        await self.clock(push=False, pop=False, rst=True)

    async def clock(self, push, pop, rst=False):
        tag = self.random.getrandbits(self.width)
        self.dut.push.value, self.dut.pop.value, self.dut.tag.value = int(push), int(pop), tag
        self.dut.rst.value = int(rst)
        await RisingEdge(self.dut.clk)
        if self.model.head is not None:
            assert int(self.dut.head.value) == self.model.head, f"the head of {len(self.model.tags)} tags"
        if rst:
            self.model.reset()
        else:
            self.model.clock(tag if push else None, pop)


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def fillings(dut):
    """Every way of filling it up and emptying it, one in and one out at each filling; twice around."""
    bench = Bench(dut)
    await bench.start()
    for _ in range(2 * CAPACITY + 1):
        for held in range(1, CAPACITY + 1):
            for _ in range(held):
                await bench.clock(push=True, pop=False)
            for _ in range(2 * CAPACITY + 1):
                await bench.clock(push=True, pop=True)
            for _ in range(held):
                await bench.clock(push=False, pop=True)
        await bench.clock(push=True, pop=False)
        await bench.clock(push=False, pop=True)


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def random_traffic(dut):
    bench = Bench(dut)
    await bench.start()
    for _ in range(CLOCKS):
        held = len(bench.model.tags)
        pop = held > 0 and bench.random.random() < 0.5
        push = held - pop < CAPACITY and bench.random.random() < 0.5
        await bench.clock(push, pop, rst=bench.random.random() < 0.01)
