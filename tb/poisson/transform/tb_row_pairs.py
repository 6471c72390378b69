# SPDX-License-Identifier: Apache-2.0
"""row_pairs against its model: codes, latency, saturations; gaps, pauses, extremes, reset."""

from typing import Any

import cocotb
import numpy as np

from formal.entries import ONE_ORDER, Proof
from tactile_depth.chip.common.td_round_saturate import Monitor
from tactile_depth.chip.poisson.transform.commutator import from_beats, to_beats
from tactile_depth.chip.poisson.transform.row_pairs import latency as row_pairs_latency
from tactile_depth.chip.poisson.transform.row_pairs import row_pairs
from tb.beats import BeatsDriver, BeatsMonitor
from tb.stream import check_bursts, extremes, parameters, parametrize, uniform
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
        f"{ONE_ORDER}; sums are linear but for saturation, which is proven of td_round_saturate",
        {"Size": size, "Paths": paths},
    )
    for size, paths in ((8, 2), (8, 1))
)


async def check(dut: Any, bursts: Any, **behaviour: Any) -> Any:
    width, size, paths = parameters(dut, "Width", "Size", "Paths")

    def model(words: Any, monitor: Monitor) -> Any:
        a, b = (from_beats(words[..., row * paths : (row + 1) * paths], 0) for row in (0, 1))
        return np.concatenate([to_beats(part, paths, 0) for part in row_pairs(a, b, width, monitor)], axis=-1)

    beats = size // paths
    return await check_bursts(
        dut,
        bursts,
        model,
        row_pairs_latency(size, paths),
        in_fields=["word"] * 2 * paths,
        out_fields=["word"] * 2 * paths,
        driver=BeatsDriver(dut, "in", ["a", "b"], paths),
        source=BeatsMonitor(dut, "in", ["a", "b"], beats, paths),
        sink=BeatsMonitor(dut, "out", ["re", "im"], beats, paths),
        **behaviour,
    )


def shape(dut: Any, bursts: int) -> tuple[int, ...]:
    size, paths = parameters(dut, "Size", "Paths")
    return bursts, size // paths, 2 * paths


@cocotb.test(timeout_time=1, timeout_unit="ms")
@parametrize((("gap", "pause"), [(0, 0.0), (9, 0.0), (0, 0.3), (200, 0.3)]), ("amplitude", [0.4, None]))
async def bursts(dut: Any, gap: float, pause: float, amplitude: float) -> None:
    (width,) = parameters(dut, "Width")
    await check(dut, uniform(shape(dut, 12), width, amplitude), gap=gap, pause=pause)


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def limits(dut: Any) -> None:
    size, width = parameters(dut, "Size", "Width")
    await check(dut, extremes(2 * size, width).reshape(shape(dut, 8)))


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def reset_in_mid_burst(dut: Any) -> None:
    """Reset in each cycle of a burst, as it enters and as it leaves; clips after a reset are not counted."""
    _, beats, _ = shape(dut, 1)
    (width,) = parameters(dut, "Width")
    await check(dut, uniform(shape(dut, 3), width, None), interrupts=range(1, 2 * beats + 4))
