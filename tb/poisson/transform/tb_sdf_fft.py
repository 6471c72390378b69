# SPDX-License-Identifier: Apache-2.0
"""sdf_fft against its model: codes, latency, saturations; gaps, pauses, extremes, reset."""

from typing import Any

import cocotb
import numpy as np

from formal.entries import Proof
from formal.tables import transform_roms
from tactile_depth.chip.common.td_round_saturate import Monitor
from tactile_depth.chip.poisson.transform.sdf_fft import latency as sdf_fft_latency
from tactile_depth.chip.poisson.transform.sdf_fft import sdf_fft
from tactile_depth.chip.rom_files import write_direction
from tb.stream import MANY, check_bursts, extremes, parameters, parametrize, uniform
from tb.structures import ICARUS, VERILATOR, Structure


def built(size: int, width: int, coeff: int, inverse: int, **runs: Any) -> Structure:
    return Structure(
        {"Size": size, "Width": width, "CoeffWidth": coeff, "Inverse": inverse},
        roms=lambda folder: write_direction(folder, size, 0, bool(inverse), coeff),
        **runs,
    )


STRUCTURES = (
    built(32, 27, 18, 0, on=VERILATOR),
    built(32, 27, 18, 1, on=ICARUS),
    built(8, 12, 10, 0, on=ICARUS),
    built(8, 12, 10, 1, mutants=ICARUS),
    built(16, 27, 18, 0),
    built(16, 27, 18, 1),
    built(64, 15, 10, 0),
    built(64, 15, 10, 1),
    built(128, 35, 24, 0),
    built(128, 35, 24, 1),
)
PROTOCOL = {"protocol_bursts": {"Columns": "Size"}}
PROOFS = tuple(
    Proof(
        "the smallest transform: pair, twiddle and lone butterfly; longer ones chain more of these",
        {"Size": 8, "Inverse": inverse, "Latency": sdf_fft_latency(8)},
        roms=transform_roms,
    )
    for inverse in (0, 1)
)


FIELDS = ["re", "im"]


async def check(dut: Any, x: Any, **behaviour: Any) -> Any:
    width, coeff, inverse = parameters(dut, "Width", "CoeffWidth", "Inverse")

    def model(x: Any, monitor: Monitor) -> Any:
        return np.stack(sdf_fft(x[..., 0], x[..., 1], bool(inverse), width, coeff, monitor), axis=-1)

    latency = sdf_fft_latency(x.shape[1])
    return await check_bursts(dut, x, model, latency, in_fields=FIELDS, out_fields=FIELDS, **behaviour)


@cocotb.test(timeout_time=10, timeout_unit="ms")
@parametrize((("gap", "pause"), [(0, 0.0), (30, 0.0), (0, 0.3)]), ("amplitude", [0.3, 1.0]))
async def bursts(dut: Any, gap: float, pause: float, amplitude: float) -> None:
    size, width = parameters(dut, "Size", "Width")
    await check(dut, uniform((5, size, 2), width, amplitude), gap=gap, pause=pause)


@cocotb.test(timeout_time=50, timeout_unit="ms")
@parametrize(amplitude=[0.1, None])
async def many_bursts(dut: Any, amplitude: float) -> None:
    """Reach ties of every rounding, and clip every value that can clip."""
    size, width = parameters(dut, "Size", "Width")
    await check(dut, uniform((2 * MANY, size, 2), width, amplitude))


@cocotb.test(timeout_time=10, timeout_unit="ms")
async def limits(dut: Any) -> None:
    size, width = parameters(dut, "Size", "Width")
    _, sink = await check(dut, extremes(size, width, 2))
    assert not np.any(sink.words[:size]), "zero in, but not zero out"


@cocotb.test(timeout_time=10, timeout_unit="ms")
@parametrize(late=[False, True])
async def reset_in_mid_burst(dut: Any, late: bool) -> None:
    """Reset in each cycle in which a burst begins to enter, or to leave."""
    size, width = parameters(dut, "Size", "Width")
    first = sdf_fft_latency(size) - 3 if late else 1
    await check(dut, uniform((2, size, 2), width), interrupts=range(first, first + 8))
