# SPDX-License-Identifier: Apache-2.0
"""frame_tags against its model: every output in every cycle; frames close together and apart, pauses, resets."""

import random
from typing import Any

import cocotb
from cocotb.triggers import RisingEdge

from formal.entries import WORD_FREE, Proof
from tactile_depth.chip.depth.frame_tags import FrameTags
from tb.cases import on_bench
from tb.stream import parameters, parametrize, start_clock
from tb.structures import ICARUS, VERILATOR, of_parameters

# Two frames in flight, one, exactly two, four; the first again, for mutants.
built = of_parameters("Width Latency Pixels")
STRUCTURES = (
    built(33, 37, 24, on=VERILATOR),
    built(4, 9, 16, on=ICARUS),
    built(33, 32, 16),
    built(33, 50, 13),
    built(4, 9, 6, mutants=ICARUS),
)
PROOFS = tuple(
    Proof(
        f"one, two and three places; {WORD_FREE}",
        {"Latency": latency, "Pixels": pixels},
    )
    for latency, pixels in ((3, 4), (5, 4), (7, 3))
)


class Bench:
    """Driver of one cycle at a time; it compares the outputs with the model."""

    def __init__(self, dut: Any) -> None:
        self.dut = dut
        self.random = random.Random(cocotb.RANDOM_SEED)
        self.width, latency, self.pixels = parameters(dut, "Width", "Latency", "Pixels")
        self.model = FrameTags(latency)

    async def start(self) -> None:
        start_clock(self.dut.clk)
        self.dut.rst.value, self.dut.en.value, self.dut.push.value = 1, 1, 0
        await RisingEdge(self.dut.clk)

    async def clock(self, push: Any, en: bool = True, rst: bool = False) -> None:
        tag = self.random.getrandbits(self.width)
        dut, model = self.dut, self.model
        dut.push.value, dut.tag.value, dut.en.value, dut.rst.value = int(push), tag, int(en), int(rst)
        await RisingEdge(dut.clk)
        assert bool(dut.held.value) == model.held
        assert bool(dut.due.value) == (model.due is not None), f"{len(model.due_clock)} tags, clock {model.now}"
        assert int(dut.due_tag.value) == (model.due or 0)
        if rst:
            model.reset()
        elif en:
            model.clock(tag if push else None)

    async def frames(self, count: int, apart: Any, pause: float = 0.0, reset: float = 0.0) -> None:
        """Push `count` tags, with `apart()` enabled cycles from one to the next."""
        for _ in range(count):
            left = apart()
            while left:
                en = self.random.random() >= pause
                rst = self.random.random() < reset
                await self.clock(push=left == 1, en=en, rst=rst)
                left -= en or rst


@on_bench(Bench)
@parametrize(pause=[0.0, 0.4])
async def frames_as_close_as_they_can_be(bench: Bench, pause: float) -> None:
    await bench.frames(30, lambda: bench.pixels, pause)


@on_bench(Bench)
@parametrize(reset=[0.0, 0.01])
async def frames_apart(bench: Bench, reset: Any) -> None:
    """Send frames at each distance, from the closest until the one before has left; then at random."""
    distances = iter(range(bench.pixels, bench.model.latency + bench.pixels + 2))
    await bench.frames(bench.model.latency + 2, lambda: next(distances), reset=reset)
    await bench.frames(60, lambda: bench.pixels + bench.random.randrange(2 * bench.model.latency), 0.2, reset)
