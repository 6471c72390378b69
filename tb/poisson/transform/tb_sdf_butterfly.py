# SPDX-License-Identifier: Apache-2.0
"""sdf_butterfly against its model: codes, latency, saturations; gaps, pauses, extremes, reset."""

from typing import Any

import numpy as np

from formal.entries import ROUNDING, Proof
from tactile_depth.chip.common.td_round_saturate import Monitor
from tactile_depth.chip.poisson.transform.sdf_butterfly import LATENCY, Stage, sdf_butterfly
from tb.poisson.burst_core import BurstCore
from tb.stream import parameters
from tb.structures import ICARUS, VERILATOR, of_parameters

built = of_parameters("Size Delay RotateBlock Inverse Halve Width")
STRUCTURES = (
    built(16, 8, 16, 1, 1, 27, on=VERILATOR),
    built(16, 8, 0, 0, 0, 27, on=ICARUS),
    built(16, 4, 16, 0, 1, 9, on=ICARUS, mutants=ICARUS),
    built(32, 4, 8, 1, 0, 12, on=ICARUS),
    built(32, 2, 8, 0, 1, 35, on=ICARUS),
    built(16, 2, 4, 1, 1, 9),
    built(16, 1, 4, 0, 1, 9),
    built(8, 1, 0, 1, 1, 15),
    built(8, 1, 0, 0, 0, 15),
    built(64, 32, 64, 0, 0, 27),
)
PROTOCOL = {"protocol_beats": {"Beats": "Size"}}
PROOFS = tuple(
    Proof(
        f"stages as they occur in a transform of 8, one with its line in memory; {ROUNDING}",
        {"Size": size, "Delay": delay, "RotateBlock": block, "Inverse": inverse, "Halve": halve},
    )
    for size, delay, block, inverse, halve in (
        (8, 4, 0, 0, 0),
        (8, 2, 8, 0, 1),
        (8, 4, 8, 1, 1),
        (8, 1, 0, 1, 1),
        (16, 8, 0, 0, 0),
    )
)


def model(dut: Any, x: Any, monitor: Monitor) -> Any:
    width, delay, rotate_block, inverse, halve = parameters(dut, "Width", "Delay", "RotateBlock", "Inverse", "Halve")
    stage = Stage(rotate_block or 2 * delay, delay, bool(rotate_block), bool(halve))
    re, im = np.moveaxis(x[..., 0, :], -1, 0)
    return np.stack(sdf_butterfly(re, im, stage, bool(inverse), width, monitor), axis=-1).reshape(x.shape)


CORE = BurstCore(model, lambda dut: parameters(dut, "Delay")[0] + LATENCY)
bursts, many_bursts, limits, reset_in_mid_burst, *_ = CORE.tests()
