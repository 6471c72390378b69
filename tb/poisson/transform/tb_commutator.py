# SPDX-License-Identifier: Apache-2.0
"""commutator against its model: positions, latency; gaps, pauses, reset."""

from typing import Any

import numpy as np

from formal.entries import ONE_ORDER, WORD_FREE, Proof
from tactile_depth.chip.common.td_round_saturate import Monitor
from tactile_depth.chip.poisson.transform.commutator import commutator
from tb.poisson.burst_core import BurstCore
from tb.stream import parameters
from tb.structures import ICARUS, VERILATOR, of_parameters

built = of_parameters("Width Paths Beats Delay Up")
STRUCTURES = (
    built(27, 4, 16, 8, 1, on=VERILATOR),
    built(12, 2, 4, 2, 0, on=ICARUS),
    built(12, 8, 2, 1, 1, on=ICARUS),
    built(9, 4, 8, 2, 0, on=ICARUS, mutants=ICARUS),
    built(12, 4, 16, 8, 0),
)
PROTOCOL = "protocol_beats"
PROOFS = tuple(
    Proof(f"{ONE_ORDER}; {WORD_FREE}", {"Paths": paths, "Beats": 4, "Delay": delay, "Up": up})
    for paths, delay, up in ((4, 2, 1), (4, 1, 0), (2, 2, 0))
)


def model(dut: Any, x: Any, monitor: Monitor) -> Any:
    delay, up = parameters(dut, "Delay", "Up")
    return np.stack([commutator(x[..., part], delay, bool(up)) for part in (0, 1)], axis=-1)


CORE = BurstCore(model, lambda dut: parameters(dut, "Delay")[0])
bursts, many_bursts, limits, reset_in_mid_burst, *_ = CORE.tests()
