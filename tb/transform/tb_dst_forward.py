# SPDX-License-Identifier: Apache-2.0
"""dst_forward against its model: codes, latency, saturations; gaps, pauses, extremes, reset."""

import cocotb
import numpy as np

from tactile_depth.latency import dst_forward_latency
from tactile_depth.transform.dst_forward import dst_forward
from tb.stream import MANY, check_bursts, corners, extremes, parameters, uniform


async def check(dut, x, **behaviour):
    *formats, alternate = parameters(dut, "InputDrop", "Width", "CoeffWidth", "OutputDrop", "OutWidth", "Alternate")

    def model(x, monitor):
        return dst_forward(x[..., 0], *formats, monitor, alternate=bool(alternate))

    latency = dst_forward_latency(x.shape[1])
    return await check_bursts(dut, x, model, latency, in_fields=["data"], out_fields=["data"], **behaviour)


@cocotb.test(timeout_time=2, timeout_unit="ms")
@cocotb.parametrize((("gap", "pause"), [(0, 0.0), (30, 0.0), (0, 0.3)]), amplitude=[0.3, 1.0, None])
async def bursts(dut, gap, pause, amplitude):
    size, width = parameters(dut, "Size", "InWidth")
    shape = (5, size, 1)
    words = corners(shape, width) if amplitude is None else uniform(shape, width, amplitude)
    await check(dut, words, gap=gap, pause=pause)


@cocotb.test(timeout_time=50, timeout_unit="ms")
@cocotb.parametrize(amplitude=[0.1, None])
async def many_bursts(dut, amplitude):
    """Ties of every rounding, and clips of every one that can."""
    size, width = parameters(dut, "Size", "InWidth")
    shape = (2 * MANY, size, 1)
    await check(dut, corners(shape, width) if amplitude is None else uniform(shape, width, amplitude))


@cocotb.test(timeout_time=2, timeout_unit="ms")
async def limits(dut):
    size, width = parameters(dut, "Size", "InWidth")
    _, sink = await check(dut, extremes(size, width))
    assert not np.any(sink.words[:size]), "zero in, but not zero out"


@cocotb.test(timeout_time=2, timeout_unit="ms")
@cocotb.parametrize(late=[False, True], clips=[False, True])
async def reset_in_mid_burst(dut, late, clips):
    """In each of the clocks in which a burst begins to enter, or to leave; what clips then is not counted."""
    size, width = parameters(dut, "Size", "InWidth")
    first = dst_forward_latency(size) - 3 if late else 1
    words = (corners if clips else uniform)((2, size, 1), width)
    await check(dut, words, interrupts=[count for count in range(first, first + 12) for _ in "en"])
