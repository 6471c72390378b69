# SPDX-License-Identifier: Apache-2.0
"""sdf_butterfly against its model: codes, latency, saturations; gaps, pauses, extremes, reset."""

from typing import Any

import cocotb
import numpy as np

from formal.entries import ROUNDING, Proof
from tactile_depth.chip.common.td_round_saturate import Monitor
from tactile_depth.chip.poisson.transform.sdf_butterfly import LATENCY, Stage, sdf_butterfly
from tb.beats import check_beats
from tb.stream import extremes, parameters, parametrize, uniform
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


async def check(dut: Any, x: Any, **behaviour: Any) -> Any:
    width, delay, rotate_block, inverse, halve = parameters(dut, "Width", "Delay", "RotateBlock", "Inverse", "Halve")
    stage = Stage(rotate_block or 2 * delay, delay, bool(rotate_block), bool(halve))

    def model(x: Any, monitor: Monitor) -> Any:
        re, im = np.moveaxis(x[..., 0, :], -1, 0)
        return np.stack(sdf_butterfly(re, im, stage, bool(inverse), width, monitor), axis=-1)[..., None, :]

    return await check_beats(dut, x, model, delay + LATENCY, fields=["re", "im"], paths=1, **behaviour)


@cocotb.test(timeout_time=1, timeout_unit="ms")
@parametrize((("gap", "pause"), [(0, 0.0), (9, 0.0), (0, 0.3)]), ("amplitude", [0.3, 1.0]))
async def bursts(dut: Any, gap: float, pause: float, amplitude: float) -> None:
    size, width = parameters(dut, "Size", "Width")
    await check(dut, uniform((8, size, 1, 2), width, amplitude), gap=gap, pause=pause)


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def limits(dut: Any) -> None:
    size, width = parameters(dut, "Size", "Width")
    _, sink = await check(dut, extremes(size, width, 2)[..., None, :])
    assert not np.any(sink.words[:size]), "zero in, but not zero out"


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def limits_in_every_pairing(dut: Any) -> None:
    size, width = parameters(dut, "Size", "Width")
    await check(dut, uniform((30, size, 1, 2), width, None))


@cocotb.test(timeout_time=1, timeout_unit="ms")
@parametrize(late=[False, True])
async def reset_in_mid_burst(dut: Any, late: bool) -> None:
    """Reset in each cycle in which a burst begins to enter, or to leave."""
    size, width, delay = parameters(dut, "Size", "Width", "Delay")
    first = max(delay + LATENCY, 4) - 3 if late else 1
    await check(dut, uniform((2, size, 1, 2), width), interrupts=range(first, first + 8))
