# SPDX-License-Identifier: Apache-2.0
"""corner_turn against its model: positions, latency; rows alone, gaps, pauses, reset."""

from typing import Any

import cocotb
import numpy as np

from formal.entries import ONE_ORDER, WORD_FREE, Proof
from tactile_depth.chip.poisson.transform.commutator import LEAD, from_beats
from tactile_depth.chip.poisson.transform.corner_turn import corner_turn
from tactile_depth.chip.poisson.transform.corner_turn import latency as corner_turn_latency
from tb.beats import AloneDriver, BeatsMonitor, alone
from tb.stream import Bench, check_words, interrupt, parameters, parametrize, uniform
from tb.structures import ICARUS, VERILATOR, of_parameters

built = of_parameters("Size Width Lanes")
STRUCTURES = (
    built(32, 24, 8, on=VERILATOR),
    built(16, 12, 1, on=ICARUS, mutants=ICARUS),
    built(16, 12, 2, on=ICARUS),
    built(32, 12, 16, on=ICARUS),
    built(16, 12, 4, on=ICARUS),
    built(8, 9, 4, on=ICARUS, mutants=ICARUS),
    built(64, 24, 32),
    built(128, 24, 8),
)
PROTOCOL = {"protocol_two_rows": {"Beats": "Size / Paths", "OutBeats": "Size / Lanes"}}
PROOFS = tuple(
    Proof(f"{ONE_ORDER}; {WORD_FREE}", {"Size": size, "Lanes": lanes}, steps=2)
    for size, lanes in ((8, 1), (8, 2), (8, 4), (16, 8))
)


BURSTS, FRAME = 12, 3


async def check(dut: Any, gap: int = 0, pause: float = 0.0, interrupts: Any = ()) -> None:
    """Send bursts of two rows, as fast as they leave, and compare the rows."""
    width, size, lanes = parameters(dut, "Width", "Size", "Lanes")
    paths = max(1, lanes // 2)
    beats, out_beats = size // paths, size // lanes
    bursts = uniform((BURSTS, beats, 2 * paths), width)
    bench = Bench(dut, pause)
    await bench.start()
    driver = AloneDriver(dut, "in", ["a", "b"], paths)
    source = BeatsMonitor(dut, "in", ["a", "b"], beats, paths)
    sink = BeatsMonitor(dut, "out", ["data"], out_beats, lanes, lead=0)
    latency = corner_turn_latency(size, paths) - LEAD
    lone = alone(bursts)

    async def send(words: int) -> None:
        for index, sent in enumerate(range(0, words, beats)):
            driver.frame_start = index % FRAME == 0
            await driver.send(bursts[index % BURSTS, : words - sent].tolist())
            waits = (1 if lone[index % BURSTS] else 2) * out_beats - beats
            await bench.clocks(max(0, waits) + (bench.random.randint(0, gap) if gap else 0))

    await interrupt(bench, send, interrupts, (source, sink), quiet=latency + LEAD + 4)
    await send(BURSTS * beats)
    await bench.clocks(latency + 2 * beats + 2 * out_beats + 20)
    source.forget_but(BURSTS)
    words_in = np.array(source.words).reshape(bursts.shape)
    np.testing.assert_array_equal(words_in, bursts, "the driver sent other words than the test gave it")
    rows = np.moveaxis(words_in.reshape(BURSTS, beats, 2, paths), 2, 1)
    turned = corner_turn(from_beats(rows, beats.bit_length() - 1))
    leaves = np.stack((np.ones(BURSTS, bool), ~lone), axis=1)
    check_words(np.array(sink.words), turned[leaves].reshape(-1, lanes), out_beats, 0)
    starts = np.array(source.starts)[:, None] + latency + np.array([0, out_beats])
    assert sink.starts == starts[leaves].tolist(), f"rows leave at {sink.starts}, expected {starts[leaves]}"
    begins = np.stack((np.arange(BURSTS) % FRAME == 0, np.zeros(BURSTS, bool)), axis=1)
    assert sink.frame_starts == begins[leaves].tolist(), f"frames begin at {sink.frame_starts}"


@cocotb.test
@parametrize((("gap", "pause"), [(0, 0.0), (9, 0.0), (0, 0.3), (200, 0.3)]))
async def bursts(dut: Any, gap: int, pause: float) -> None:
    await check(dut, gap=gap, pause=pause)


@cocotb.test
async def reset_in_mid_burst(dut: Any) -> None:
    """Reset in each cycle of a burst, as it enters and as it leaves."""
    size, lanes = parameters(dut, "Size", "Lanes")
    await check(dut, interrupts=range(1, 2 * size // max(1, lanes // 2) + 6))
