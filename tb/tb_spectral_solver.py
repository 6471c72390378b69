# SPDX-License-Identifier: Apache-2.0
"""spectral_solver against its model: codes, fixed latency, one frame every N^2 clocks, saturations."""

import cocotb
import numpy as np
from stream import Bench, StreamDriver, StreamMonitor, parameters, uniform

from models.configuration import Configuration
from models.latency import spectral_solver_latency
from models.round_saturate import Monitor
from models.spectral_solver import spectral_solver


@cocotb.test(timeout_time=100, timeout_unit="ms")
@cocotb.parametrize(gap=[0.0, 0.3], pause=[0.0, 0.3], amplitude=[0.05, 1.0])
async def frames(dut, gap, pause, amplitude):
    size, data_width, coeff = parameters(dut, "Size", "DataWidth", "CoeffWidth")
    config = Configuration(columns=size, data_width=data_width, coefficient_width=coeff)
    bench = Bench(dut, pause)
    driver = StreamDriver(dut, "in", "valid", ["data"])
    source = StreamMonitor(dut, "in", "valid", ["data"])
    sink = StreamMonitor(dut, "out", "start", ["data"], length=size)
    await bench.start()

    f = uniform((3, size, size), config.divergence.width, amplitude)
    for row in f.reshape(-1, size):
        for word in row.reshape(-1, 1):
            while bench.random.random() < gap:
                await bench.clocks(1)
            await driver.send([word])
    await bench.clocks(spectral_solver_latency(size) + size * size)

    monitor = Monitor()
    z = spectral_solver(np.array(source.words).reshape(f.shape), config, monitor)
    np.testing.assert_array_equal(np.array(sink.words).reshape(f.shape), z)
    assert bench.saturations == monitor.saturations.total()
    assert (amplitude < 1) or bench.saturations > 0, "full scale everywhere must clip somewhere"
    last_pixels = source.starts[size * size - 1 :: size * size]
    first_depths = sink.starts[::size]
    latency = {depth - pixel for depth, pixel in zip(first_depths, last_pixels, strict=True)}
    assert latency == {spectral_solver_latency(size)}
    if not gap:
        assert set(np.diff(first_depths)) == {size * size}
