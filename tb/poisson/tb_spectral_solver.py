# SPDX-License-Identifier: Apache-2.0
"""spectral_solver against its model: codes, fixed latency, one frame every N^2 cycles, saturations; reset."""

from typing import Any

import cocotb
import numpy as np

from tactile_depth.chip.common.td_round_saturate import Monitor
from tactile_depth.chip.poisson.spectral_solver import latency as spectral_solver_latency
from tactile_depth.chip.poisson.spectral_solver import spectral_solver
from tb.stream import (
    MANY,
    Bench,
    StreamDriver,
    StreamMonitor,
    check_frame_starts,
    check_maps,
    configuration,
    interrupt,
    parametrize,
    send_apart,
    uniform,
)


def codes(frames: int, amplitude: float) -> Any:
    """Return a random divergence, whose depth fits at 0.002 of full scale. None: mostly the lowest and the highest
    word."""
    config = configuration()
    shape, width = (frames, config.columns, config.columns), config.divergence.width
    return uniform(shape, width, amplitude)


async def check(dut: Any, f: Any, gap: float = 0.0, pause: float = 0.0, interrupts: Any = (), strays: int = 0) -> Any:
    config = configuration()
    size = config.columns
    bench = Bench(dut, pause)
    driver = StreamDriver(dut, "in", "valid", ["data"])
    source = StreamMonitor(dut, "in", "valid", ["data"])
    sink = StreamMonitor(dut, "out", "start", ["data"], length=size)
    await bench.start()

    words = f.reshape(-1, 1).tolist()

    async def send(count: int) -> None:
        await send_apart(bench, driver, (words * (count // len(words) + 1))[:count], gap, size * size)

    await interrupt(bench, send, interrupts, (source, sink), quiet=spectral_solver_latency(size))
    await send_apart(bench, driver, words[:strays], gap, size * size)
    await send_apart(bench, driver, words, gap, size * size)
    await bench.clocks(spectral_solver_latency(size) + size * size)

    source.forget_but(len(words))
    sink.forget_but(len(words) // size)
    np.testing.assert_array_equal(np.array(source.words), words, "the driver sent other words than the test gave it")
    monitor = Monitor()
    z = spectral_solver(np.array(source.words).reshape(f.shape), config, monitor)
    check_maps(sink.words, z)
    assert strays or bench.saturations == monitor.saturations.total()
    check_frame_starts([source], size * size)
    check_frame_starts([sink], size)
    last_pixels = source.starts[size * size - 1 :: size * size]
    first_depths = sink.starts[::size]
    latency = {depth - pixel for depth, pixel in zip(first_depths, last_pixels, strict=True)}
    assert latency == {spectral_solver_latency(size)}
    if not gap:
        assert set(np.diff(first_depths)) <= {size * size}
    return bench


@cocotb.test(timeout_time=100, timeout_unit="ms")
@parametrize((("gap", "pause"), [(0.0, 0.0), (0.3, 0.3)]))
async def frames_that_fit(dut: Any, gap: float, pause: float) -> None:
    await check(dut, codes(3, 0.002), gap=gap, pause=pause)


@cocotb.test(timeout_time=200, timeout_unit="ms")
@parametrize(amplitude=[0.002, 0.05, None])
async def many_frames(dut: Any, amplitude: float) -> None:
    """Reach ties of every rounding, and clip every value that can clip."""
    await check(dut, codes(MANY, amplitude))


@cocotb.test(timeout_time=100, timeout_unit="ms")
async def frames_that_saturate(dut: Any) -> None:
    f = codes(3, 1.0)
    f[1], f[2] = f.max(), f.min()
    bench = await check(dut, f, gap=0.1)
    assert bench.saturations > 0, "full scale everywhere must clip somewhere"


@cocotb.test(timeout_time=100, timeout_unit="ms")
@parametrize(amplitude=[0.002, 1.0])
async def reset_in_mid_frame(dut: Any, amplitude: float) -> None:
    """Reset as the third frame enters and the first one leaves: every core is active, and clips if it can."""
    size = configuration().columns
    first = 2 * size * size + 10 * size + size // 2
    await check(dut, codes(1, amplitude), interrupts=[first, first + size // 3])


@cocotb.test(timeout_time=100, timeout_unit="ms")
@parametrize(rows=[1, 3])
async def a_frame_begins_afresh(dut: Any, rows: int) -> None:
    """Start a frame after rows of an incomplete frame, and after part of another row."""
    columns = configuration().columns
    await check(dut, codes(2, 0.002), strays=rows * columns + 5)
