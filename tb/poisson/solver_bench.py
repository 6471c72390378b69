# SPDX-License-Identifier: Apache-2.0
"""Tests of the solvers against their models: codes, latency of each row, throughput, clips."""

from typing import Any

import cocotb
import numpy as np

from tactile_depth.chip.common.td_round_saturate import Monitor
from tactile_depth.chip.latency import by_solver_core
from tactile_depth.chip.tactile_depth import solve
from tb.beats import BeatsMonitor
from tb.stream import (
    MANY,
    REGRESS,
    Bench,
    StreamDriver,
    StreamMonitor,
    check_frame_starts,
    check_maps,
    configuration,
    parametrize,
    sample,
    send_words,
    uniform,
)


async def check(dut: Any, f: Any, gap: float = 0.0, pause: float = 0.0, strays: int = 0, **behaviour: Any) -> Any:
    """Send frames f (frames, rows, columns) and compare; see stream.send_words."""
    config = configuration()
    pixels = config.rows * config.columns
    bench = Bench(dut, pause)
    driver = StreamDriver(dut, "in", "valid", ["data"])
    source = StreamMonitor(dut, "in", "valid", ["data"])
    sink = BeatsMonitor(dut, "out", ["data"], config.columns // config.lanes, config.lanes, lead=0)
    latency = sum(cycles for _, cycles in by_solver_core(config))
    words = f.reshape(-1, 1).tolist()
    behaviour |= {"frame": pixels, "gap": gap, "strays": strays, "quiet": latency + pixels + config.columns}
    await send_words(bench, driver, source, sink, words, **behaviour)
    sink.forget_but(len(words) // config.columns)
    monitor = Monitor()
    check_maps(sink.words, solve(f, config, monitor))
    assert strays or bench.saturations == monitor.saturations.total()
    check_frame_starts([source], pixels)
    check_frame_starts([sink], config.rows)
    last_pixels, first_depths = source.starts[pixels - 1 :: pixels], sink.starts[:: config.rows]
    assert {depth - pixel for depth, pixel in zip(first_depths, last_pixels, strict=True)} == {latency}
    rows_apart = np.diff(np.array(sink.starts).reshape(-1, config.rows), axis=1)
    assert np.all(rows_apart == config.columns // config.lanes), "a frame leaves with a pause between two rows"
    if not gap:
        assert set(np.diff(first_depths)) <= {pixels}
    return monitor.saturations


def codes(frames: int, amplitude: float | None) -> Any:
    """Return a random divergence, whose depth fits at 0.002 of full scale. None: mostly the lowest and the highest
    word."""
    config = configuration()
    shape, width = (frames, config.rows, config.columns), config.divergence.width
    return uniform(shape, width, amplitude)


@cocotb.test
@parametrize((("gap", "pause"), sample([(0.0, 0.0), (0.3, 0.0), (0.0, 0.3), (0.3, 0.3)])))
async def frames(dut: Any, gap: float, pause: float) -> None:
    assert not await check(dut, codes(4, 0.002), gap, pause)


@cocotb.test
@parametrize(amplitude=[0.002, 0.05, None])
async def many_frames(dut: Any, amplitude: float | None) -> None:
    """Reach ties of every rounding, and clip every value that can clip."""
    await check(dut, codes(MANY, amplitude))


@cocotb.test
async def full_scale_saturates(dut: Any) -> None:
    f = codes(3 + MANY, 1.0)
    f[1], f[2] = f.max(), f.min()
    f[3:] = codes(MANY, None)[..., :1]  # rows of one word clip in many paths at once
    assert await check(dut, f), "full scale everywhere must clip somewhere"


@cocotb.test
@parametrize(amplitude=[0.002, 1.0])
async def reset_in_mid_frame(dut: Any, amplitude: float) -> None:
    """Reset at two positions in a row, four in `make regress`, as the first frame leaves: every core is active, and
    clips if it can."""
    config = configuration()
    latency = sum(cycles for _, cycles in by_solver_core(config))
    first = 3 * config.rows * config.columns // 2 + latency + 3
    places = [first + step * (config.columns // 4 + 1) for step in range(4 if REGRESS else 2)]
    await check(dut, codes(2, amplitude), interrupts=places)


@cocotb.test
@parametrize(rows=[1, 3])
async def a_frame_begins_afresh(dut: Any, rows: int) -> None:
    """Start a frame after rows of an incomplete frame, and after part of another row."""
    columns = configuration().columns
    await check(dut, codes(2, 0.002), strays=rows * columns + 5)
