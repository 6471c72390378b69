# SPDX-License-Identifier: Apache-2.0
"""butterfly against its model: codes, latency, saturations; gaps, pauses, extremes, reset."""

from typing import Any

import numpy as np

from formal.entries import ROUNDING, Proof
from tactile_depth.chip.common.td_round_saturate import Monitor
from tactile_depth.chip.poisson.transform.butterfly import LATENCY, butterfly
from tb.poisson.burst_core import BurstCore
from tb.stream import parameters
from tb.structures import ICARUS, VERILATOR, of_parameters

built = of_parameters("Width Paths Beats PathBit RotateBit Inverse Halve")
STRUCTURES = (
    built(27, 4, 8, 1, 0, 1, 1, on=VERILATOR),
    built(9, 2, 4, 0, 2, 0, 1, on=ICARUS, mutants=ICARUS),
    built(9, 4, 2, 0, 1, 1, 0, on=ICARUS, mutants=ICARUS),
    built(12, 8, 2, 2, -1, 0, 0, on=ICARUS),
    built(12, 2, 4, 0, 1, 1, 1, on=ICARUS),
)
PROTOCOL = "protocol_beats"
PROOFS = tuple(
    Proof(
        f"rotation by a bit of the path, of the beat, and none; {ROUNDING}",
        {"Paths": 4, "Beats": 2, "PathBit": bit, "RotateBit": rotate, "Inverse": inverse, "Halve": halve},
    )
    for bit, rotate, inverse, halve in ((0, 1, 1, 1), (1, 2, 0, 0), (1, -1, 0, 1))
)


def model(dut: Any, x: Any, monitor: Monitor) -> Any:
    bit, rotate, inverse, halve, width = parameters(dut, "PathBit", "RotateBit", "Inverse", "Halve", "Width")
    parts = butterfly(x[..., 0], x[..., 1], bit, rotate, bool(inverse), bool(halve), width, monitor)
    return np.stack(parts, axis=-1)


CORE = BurstCore(model, lambda dut: LATENCY)
bursts, many_bursts, limits, reset_in_mid_burst, *_ = CORE.tests()
