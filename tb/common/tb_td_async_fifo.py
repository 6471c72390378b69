# SPDX-License-Identifier: Apache-2.0
"""td_async_fifo against its model, at every edge of both clocks: ratios, jitter, gaps, stalls."""

import itertools
import random
from typing import Any

import cocotb
from cocotb.triggers import ClockCycles, RisingEdge

from formal.entries import WORD_FREE, Proof
from tactile_depth.chip.common.td_async_fifo import AsyncFifo
from tb.axis import profile
from tb.stream import REGRESS, parameters, parametrize
from tb.structures import BOTH, ICARUS, of_parameters
from tb.two_clocks import RATIOS, run_clock, watch

built = of_parameters("Width DepthLog2")
STRUCTURES = (built(10, 4, on=BOTH), built(3, 2, on=ICARUS, mutants=ICARUS))
REFUSED = {"DepthLog2_must_be_at_least_2": "DepthLog2=1"}
PROTOCOL = {"read_data": "read_valid"}
PROOFS = (
    Proof(f"codes of three bits, words are only counted; {WORD_FREE}", free=("written_code_q", "fetched_code_q")),
)


WORDS = 400 if REGRESS else 150


async def start(dut: Any, ratio: str) -> Any:
    """Start both clocks, remove a word that the first edges may have written, and return the record of their edges."""
    dut.write_valid.value = dut.read_ready.value = dut.write_data.value = 0
    clocks = dut.write_clk, dut.read_clk
    for seed, (clock, period) in enumerate(zip(clocks, RATIOS[ratio], strict=True)):
        cocotb.start_soon(run_clock(clock, period, seed))
    await ClockCycles(dut.write_clk, 4)
    dut.read_ready.value = 1
    await ClockCycles(dut.read_clk, 8)
    dut.read_ready.value = 0
    for clock in clocks:  # until every count has crossed
        await ClockCycles(clock, 4)
    events: Any = []
    cocotb.start_soon(watch(dut.write_clk, (dut.write_valid, dut.write_ready, dut.write_data), events, "write"))
    cocotb.start_soon(watch(dut.read_clk, (dut.read_valid, dut.read_ready, dut.read_data), events, "read"))
    return events


async def write(dut: Any, words: Any, offers: str) -> None:
    """Offer each word until it is taken."""
    edge, moves = RisingEdge(dut.write_clk), profile(offers, 1)
    for word in words:
        while not next(moves):
            dut.write_valid.value = 0
            await edge
        dut.write_valid.value, dut.write_data.value = 1, word
        await edge
        while not dut.write_ready.value:
            await edge
    dut.write_valid.value = 0


async def read(dut: Any, count: int, accepts: str) -> list[int]:
    """Take `count` words."""
    edge, moves = RisingEdge(dut.read_clk), profile(accepts, 2)
    words: list[int] = []
    while len(words) < count:
        ready = next(moves)
        dut.read_ready.value = int(ready)
        await edge
        if ready and dut.read_valid.value:
            words.append(int(dut.read_data.value))
    dut.read_ready.value = 0
    return words


def check_edges(events: Any, depth: int) -> None:
    """Compare the outputs before each edge with the model, which takes the inputs before that edge."""
    model = AsyncFifo(depth)
    for time, edges in itertools.groupby(events, key=lambda event: event[0]):
        pins = {side: values for _, side, values in edges}
        inputs, outputs = pins.get("write"), pins.get("read")
        if inputs:
            assert bool(inputs["write_ready"]) == model.write_ready, f"write_ready at {time} ps"
        if outputs:
            assert bool(outputs["read_valid"]) == (model.read_data is not None), f"read_valid at {time} ps"
            if model.read_data is not None:
                assert int(outputs["read_data"]) == model.read_data, f"read_data at {time} ps"
        word = int(inputs["write_data"]) if inputs and inputs["write_valid"] else None
        model.edges(word, bool(outputs and outputs["read_ready"]), bool(inputs), bool(outputs))


@cocotb.test(timeout_time=2, timeout_unit="ms")
@parametrize(ratio=list(RATIOS), offers=["none", "random"], accepts=["none", "random"])
async def words(dut: Any, ratio: str, offers: str, accepts: str) -> None:
    """Send words at every ratio of the clocks: all leave in order, and every output equals the model at every edge."""
    width, depth_log2 = parameters(dut, "Width", "DepthLog2")
    rng = random.Random(cocotb.RANDOM_SEED)
    sent = [rng.getrandbits(width) for _ in range(WORDS)]
    events = await start(dut, ratio)
    cocotb.start_soon(write(dut, sent, offers))
    assert await read(dut, len(sent), accepts) == sent
    check_edges(events, 1 << depth_log2)


@cocotb.test(timeout_time=2, timeout_unit="ms")
async def fills_up(dut: Any) -> None:
    """Fill the queue without a reader: it takes as many words as it holds, and one more that waits at the output."""
    width, depth_log2 = parameters(dut, "Width", "DepthLog2")
    events = await start(dut, "equal")
    sent = [word % (1 << width) for word in range((1 << depth_log2) + 1)]
    await write(dut, sent, "none")
    for _ in range(20):
        await RisingEdge(dut.write_clk)
        assert not dut.write_ready.value
    assert await read(dut, len(sent), "none") == sent
    check_edges(events, 1 << depth_log2)
