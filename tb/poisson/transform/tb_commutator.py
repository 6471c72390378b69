# SPDX-License-Identifier: Apache-2.0
"""commutator against its model: positions, latency; gaps, pauses, reset."""

from typing import Any

import cocotb
import numpy as np

from formal.entries import ONE_ORDER, WORD_FREE, Proof
from tactile_depth.chip.common.td_round_saturate import Monitor
from tactile_depth.chip.poisson.transform.commutator import commutator
from tb.beats import check_beats
from tb.stream import parameters, parametrize, uniform
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


BURSTS = 12


async def check(dut: Any, **behaviour: Any) -> None:
    width, paths, beats, delay, up = parameters(dut, "Width", "Paths", "Beats", "Delay", "Up")
    words = uniform((BURSTS, beats, paths, 2), width)

    def model(x: Any, monitor: Monitor) -> Any:
        return np.stack([commutator(x[..., part], delay, bool(up)) for part in (0, 1)], axis=-1)

    await check_beats(dut, words, model, delay, fields=["re", "im"], paths=paths, **behaviour)


@cocotb.test(timeout_time=1, timeout_unit="ms")
@parametrize((("gap", "pause"), [(0, 0.0), (9, 0.0), (0, 0.3), (2, 0.3)]))
async def bursts(dut: Any, gap: int, pause: float) -> None:
    await check(dut, gap=gap, pause=pause)


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def reset_in_mid_burst(dut: Any) -> None:
    """Reset in each cycle of a burst, as it enters and as it leaves."""
    beats, delay = parameters(dut, "Beats", "Delay")
    await check(dut, interrupts=range(1, beats + delay + 2))
