# SPDX-License-Identifier: Apache-2.0
"""two_pipelines: each wrapper has the depth of its own configuration and its own calibration."""

import random
from dataclasses import replace
from typing import Any

import cocotb
import numpy as np
from cocotb.triggers import ClockCycles, RisingEdge, gather

from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.latency import first_depth_latency
from tactile_depth.chip.tactile_depth import tactile_depth
from tactile_depth.sensor.sensor import Sensor
from tactile_depth.sensor.synthetic import synthetic
from tb.axis import AxisMonitor, AxisSource, video
from tb.pixels import unpack
from tb.settings import RUN
from tb.stream import start_clock

STEEPNESS = {"left": 1.0, "right": -0.5}  # slope of each gel, relative to the synthetic sensor


def calibration(side: str, config: Configuration) -> Sensor:
    """Return the calibration of a pipeline: the colours of the synthetic sensor, for scaled slopes."""
    sensor = synthetic(config.bits_per_channel)
    assert sensor.gradient is not None
    return replace(sensor, gradient=sensor.gradient * STEEPNESS[side])


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def codes(dut: Any) -> None:
    """Send a frame to each pipeline at the same time, and compare each depth map with its model."""
    start_clock(dut.clk)
    rng = random.Random(cocotb.RANDOM_SEED)
    configs = {side: Configuration(**choices) for side, choices in RUN.device["configurations"].items()}
    sources = {side: AxisSource(dut, f"{side}_s_axis", prefix="t") for side in configs}
    outputs = {side: AxisMonitor(dut, f"{side}_m_axis", prefix="t") for side in configs}
    dut.rst.value = dut.left_m_axis_tready.value = dut.right_m_axis_tready.value = 1
    await ClockCycles(dut.clk, 3)
    dut.rst.value = 0
    await RisingEdge(dut.clk)
    pixels = {side: [rng.getrandbits(24) for _ in range(c.rows * c.columns)] for side, c in configs.items()}
    sending = [cocotb.start_soon(sources[side].send(video(pixels[side], c.columns))) for side, c in configs.items()]
    await gather(*sending)
    await ClockCycles(dut.clk, max(2 * first_depth_latency(config) for config in configs.values()))
    for side, config in configs.items():
        frame = unpack(pixels[side]).reshape(1, config.rows, config.columns, 3)
        want, others = (
            tactile_depth(frame, calibration(name, config), config) for name in (side, *configs.keys() - {side})
        )
        assert (want != others).any(), "the test is void: the calibrations give the same depth"
        width = 8 * ((config.data_width + 7) // 8)
        got = [(word.data ^ 1 << width - 1) - (1 << width - 1) for word in outputs[side].words]
        np.testing.assert_array_equal(got, want.ravel(), f"the depth map of {side}")
