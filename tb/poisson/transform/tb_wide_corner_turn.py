# SPDX-License-Identifier: Apache-2.0
"""wide_corner_turn against its model: positions, latency; rows alone, gaps, pauses, reset."""

from typing import Any

import cocotb
import numpy as np

from formal.entries import ONE_ORDER, WORD_FREE, Proof
from tactile_depth.chip.common.td_round_saturate import Monitor
from tactile_depth.chip.poisson.transform.wide_commutator import LEAD, from_beats
from tactile_depth.chip.poisson.transform.wide_corner_turn import latency as wide_corner_turn_latency
from tactile_depth.chip.poisson.transform.wide_corner_turn import wide_corner_turn
from tb.stream import parameters, parametrize, uniform
from tb.structures import ICARUS, VERILATOR, of_parameters
from tb.wide import RowPairDriver, WideMonitor, check_row_pairs

built = of_parameters("Size Width Paths")
STRUCTURES = (
    built(32, 24, 4, on=VERILATOR),
    built(16, 12, 1, on=ICARUS),
    built(32, 12, 8, on=ICARUS),
    built(16, 12, 2, on=ICARUS),
    built(8, 9, 2, on=ICARUS, mutants=ICARUS),
    built(64, 24, 16),
    built(128, 24, 4),
)
PROTOCOL = {"protocol_wide_bursts": {"Beats": "Size / Paths", "OutBeats": "Size / Paths / 2", "OutLead": 0}}
PROOFS = tuple(
    Proof(f"{ONE_ORDER}; {WORD_FREE}", {"Size": size, "Paths": paths}, steps=2)
    for size, paths in ((8, 1), (8, 2), (16, 4))
)


BURSTS = 12


async def check(dut: Any, **behaviour: Any) -> None:
    width, size, paths = parameters(dut, "Width", "Size", "Paths")
    beats = size // paths

    def model(words: Any, monitor: Monitor) -> Any:
        rows = np.moveaxis(words.reshape(-1, beats, 2, paths), 2, 1)
        return wide_corner_turn(from_beats(rows, beats.bit_length() - 1), paths)

    await check_row_pairs(
        dut,
        uniform((BURSTS, beats, 2 * paths), width),
        model,
        wide_corner_turn_latency(size, paths) - LEAD,
        driver=RowPairDriver(dut, "in", ["a", "b"], paths),
        source=WideMonitor(dut, "in", ["a", "b"], beats, paths),
        sink=WideMonitor(dut, "out", ["data"], beats // 2, 2 * paths, lead=0),
        **behaviour,
    )


@cocotb.test(timeout_time=1, timeout_unit="ms")
@parametrize((("gap", "pause"), [(0, 0.0), (9, 0.0), (0, 0.3), (200, 0.3)]))
async def bursts(dut: Any, gap: int, pause: float) -> None:
    await check(dut, gap=gap, pause=pause)


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def reset_in_mid_burst(dut: Any) -> None:
    """Reset in each cycle of a burst, as it enters and as it leaves."""
    size, paths = parameters(dut, "Size", "Paths")
    await check(dut, interrupts=range(1, 2 * size // paths + 6))
