# SPDX-License-Identifier: Apache-2.0
"""row_pairs against its model: codes, latency, saturations; gaps, pauses, extremes, reset."""

from typing import Any

import numpy as np

from formal.entries import ONE_ORDER, ROUNDING, Proof
from tactile_depth.chip.common.td_round_saturate import Monitor
from tactile_depth.chip.poisson.transform.commutator import from_beats, to_beats
from tactile_depth.chip.poisson.transform.row_pairs import latency as row_pairs_latency
from tactile_depth.chip.poisson.transform.row_pairs import row_pairs
from tb.poisson.burst_core import BurstCore
from tb.stream import parameters
from tb.structures import ICARUS, VERILATOR, of_parameters

built = of_parameters("Size Width Paths")
STRUCTURES = (
    built(32, 27, 4, on=VERILATOR),
    built(16, 9, 1, on=ICARUS),
    built(16, 9, 4, on=ICARUS),
    built(8, 9, 2, on=ICARUS, mutants=ICARUS),
    built(64, 27, 2),
)
PROTOCOL = {"protocol_beats": {"Beats": "Size / Paths"}}
PROOFS = tuple(
    Proof(
        f"{ONE_ORDER}; {ROUNDING}",
        {"Size": size, "Paths": paths},
        steps=1,
    )
    for size, paths in ((8, 2), (8, 1), (16, 4))
)


def model(dut: Any, x: Any, monitor: Monitor) -> Any:
    (width,) = parameters(dut, "Width")
    a, b = (from_beats(x[..., row], 0) for row in (0, 1))
    return np.stack([to_beats(part, x.shape[2], 0) for part in row_pairs(a, b, width, monitor)], axis=-1)


CORE = BurstCore(
    model,
    lambda dut: row_pairs_latency(*parameters(dut, "Size", "Paths")),
    fields=("a", "b"),
    ports={"out_fields": ("re", "im")},
)
bursts, many_bursts, limits, reset_in_mid_burst, *_ = CORE.tests()
