# SPDX-License-Identifier: Apache-2.0
"""mode_pairs against tactile_depth.chip.poisson.transform.mode_pairs: codes, latency; gaps, pauses, reset."""

from typing import Any

import cocotb
import numpy as np

from formal.entries import ONE_ORDER, WORD_FREE, Proof
from tactile_depth.chip.common.td_round_saturate import Monitor
from tactile_depth.chip.poisson.transform.mode_pairs import latency as mode_pairs_latency
from tactile_depth.chip.poisson.transform.mode_pairs import mode_pairs
from tb.stream import check_bursts, parameters, parametrize, uniform
from tb.structures import ICARUS, VERILATOR, of_parameters

built = of_parameters("Size Width")
STRUCTURES = (
    built(32, 24, on=VERILATOR),
    built(8, 27, on=ICARUS),
    built(16, 12),
    built(64, 24),
    built(8, 4, mutants=ICARUS),
)
PROTOCOL = {"protocol_bursts": {"Columns": "Size"}}
PROOFS = tuple(Proof(f"{ONE_ORDER}; at 8 the delay line is in memory; {WORD_FREE}", {"Size": size}) for size in (4, 8))


async def check(dut: Any, x: Any, **behaviour: Any) -> None:
    def model(x: Any, monitor: Monitor) -> Any:
        return np.stack(mode_pairs(x[..., 0]), axis=-1)

    await check_bursts(
        dut, x, model, mode_pairs_latency(x.shape[1]), in_fields=["mode"], out_fields=["mode", "mirrored"], **behaviour
    )


@cocotb.test(timeout_time=1, timeout_unit="ms")
@parametrize((("gap", "pause"), [(0, 0.0), (9, 0.0), (0, 0.3), (200, 0.3)]))
async def bursts(dut: Any, gap: float, pause: float) -> None:
    size, width = parameters(dut, "Size", "Width")
    await check(dut, uniform((6, size, 1), width), gap=gap, pause=pause)


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def reset_in_mid_burst(dut: Any) -> None:
    """Reset in each cycle of a burst, as it enters and as it leaves."""
    size, width = parameters(dut, "Size", "Width")
    await check(dut, uniform((2, size, 1), width), interrupts=range(1, size + size // 2 + 3))
