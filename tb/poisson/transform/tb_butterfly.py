# SPDX-License-Identifier: Apache-2.0
"""butterfly against its model: codes, latency, saturations; gaps, pauses, extremes, reset."""

from typing import Any

import cocotb
import numpy as np

from formal.entries import ROUNDING, Proof
from tactile_depth.chip.common.td_round_saturate import Monitor
from tactile_depth.chip.poisson.transform.butterfly import LATENCY, butterfly
from tb.beats import check_beats
from tb.stream import extremes, parameters, parametrize, uniform
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


async def check(dut: Any, words: Any, **behaviour: Any) -> Any:
    paths, path_bit, rotate_bit, inverse, halve, width = parameters(
        dut, "Paths", "PathBit", "RotateBit", "Inverse", "Halve", "Width"
    )

    def model(x: Any, monitor: Monitor) -> Any:
        parts = butterfly(x[..., 0], x[..., 1], path_bit, rotate_bit, bool(inverse), bool(halve), width, monitor)
        return np.stack(parts, axis=-1)

    return await check_beats(dut, words, model, LATENCY, fields=["re", "im"], paths=paths, **behaviour)


def shape(dut: Any, bursts: int) -> tuple[int, ...]:
    paths, beats = parameters(dut, "Paths", "Beats")
    return bursts, beats, paths, 2


@cocotb.test(timeout_time=1, timeout_unit="ms")
@parametrize((("gap", "pause"), [(0, 0.0), (9, 0.0), (0, 0.3)]), ("amplitude", [0.3, 1.0]))
async def bursts(dut: Any, gap: float, pause: float, amplitude: float) -> None:
    (width,) = parameters(dut, "Width")
    await check(dut, uniform(shape(dut, 12), width, amplitude), gap=gap, pause=pause)


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def limits(dut: Any) -> None:
    paths, beats, width = parameters(dut, "Paths", "Beats", "Width")
    _, sink = await check(dut, extremes(paths * beats, width, 2).reshape(shape(dut, 8)))
    assert not np.any(sink.words[:beats]), "zero in, but not zero out"


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def limits_in_every_pairing(dut: Any) -> None:
    (width,) = parameters(dut, "Width")
    await check(dut, uniform(shape(dut, 30), width, None))


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def reset_in_mid_burst(dut: Any) -> None:
    """Reset in each cycle in which a burst enters or leaves."""
    beats, width = parameters(dut, "Beats", "Width")
    await check(dut, uniform(shape(dut, 3), width, None), interrupts=range(1, beats + LATENCY + 4))
