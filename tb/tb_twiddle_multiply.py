# SPDX-License-Identifier: Apache-2.0
"""twiddle_multiply against its model: codes, latency, saturations; gaps, pauses, extremes, reset."""

import os

import cocotb
import numpy as np
from stream import check_bursts, extremes, parameters, uniform

from models.latency import TWIDDLE_MULTIPLY
from models.twiddle_multiply import phase_factors, twiddle_factors, twiddle_multiply

FIELDS = ["re", "im"]


async def check(dut, x, **behaviour):
    width, coeff, drop, block, real_only = parameters(dut, "OutWidth", "CoeffWidth", "Drop", "Block", "RealOnly")
    kind, direction = os.environ["FACTORS"].split("_")
    factors = {"twiddle": twiddle_factors, "phase": phase_factors}[kind](block, direction == "inverse", coeff)

    def model(x, monitor):
        out = twiddle_multiply(x[..., 0], x[..., 1], factors, drop, width, monitor, real_only=bool(real_only))
        return np.stack(out, axis=-1)

    return await check_bursts(dut, x, model, TWIDDLE_MULTIPLY, in_fields=FIELDS, out_fields=FIELDS, **behaviour)


@cocotb.test(timeout_time=1, timeout_unit="ms")
@cocotb.parametrize((("gap", "pause"), [(0, 0.0), (9, 0.0), (0, 0.3)]), amplitude=[0.3, 1.0])
async def bursts(dut, gap, pause, amplitude):
    size, width = parameters(dut, "Size", "InWidth")
    await check(dut, uniform((6, size, 2), width, amplitude), gap=gap, pause=pause)


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def limits(dut):
    size, width = parameters(dut, "Size", "InWidth")
    _, sink = await check(dut, extremes(size, width, 2))
    assert not np.any(sink.words[:size]), "zero in, but not zero out"


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def reset_in_mid_burst(dut):
    """In each clock of a burst, as it enters and as it leaves."""
    size, width = parameters(dut, "Size", "InWidth")
    await check(dut, uniform((2, size, 2), width), interrupts=range(1, size + TWIDDLE_MULTIPLY + 2))
