# SPDX-License-Identifier: Apache-2.0
"""sdf_fft against models.sdf_fft: codes, latency, saturations; bursts back to back and apart, with pauses."""

import cocotb
import numpy as np
from stream import check_bursts, parameters, uniform

from models.latency import sdf_fft_latency
from models.sdf_fft import sdf_fft


@cocotb.test(timeout_time=10, timeout_unit="ms")
@cocotb.parametrize(gap=[0, 30], pause=[0.0, 0.3], amplitude=[0.3, 1.0])
async def bursts(dut, gap, pause, amplitude):
    size, width, coeff, inverse = parameters(dut, "Size", "Width", "CoeffWidth", "Inverse")

    def model(x, monitor):
        return np.stack(sdf_fft(x[..., 0], x[..., 1], bool(inverse), width, coeff, monitor), axis=-1)

    x = uniform((5, size, 2), width, amplitude)
    fields = ["re", "im"]
    await check_bursts(
        dut, x, model, sdf_fft_latency(size), in_fields=fields, out_fields=fields, gap=gap, pause=pause
    )
