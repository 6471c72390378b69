# SPDX-License-Identifier: Apache-2.0
"""wide_twiddle against its model: codes, latency, saturations; gaps, pauses, extremes, reset."""

from typing import Any

import cocotb
import numpy as np

from formal.entries import ROUNDING, Proof
from formal.tables import wide_factor_rom
from tactile_depth.chip.common.td_round_saturate import Monitor
from tactile_depth.chip.poisson.transform.twiddle_multiply import phase_factors
from tactile_depth.chip.poisson.transform.wide_commutator import positions
from tactile_depth.chip.poisson.transform.wide_fft import wide_factors
from tactile_depth.chip.poisson.transform.wide_twiddle import LATENCY, ones, wide_twiddle
from tactile_depth.chip.rom_files import write_wide_factors
from tb.settings import RUN
from tb.stream import extremes, parameters, parametrize, uniform
from tb.structures import ICARUS, VERILATOR, Structure
from tb.wide import check_wide

PARAMETERS = ("Paths", "Beats", "InWidth", "OutWidth", "CoeffWidth", "Drop", "RealOnly")


def built(factors: str, *values: int, **runs: object) -> Structure:
    parameters = dict(zip(PARAMETERS, values, strict=True))
    paths, size, coeff = parameters["Paths"], parameters["Paths"] * parameters["Beats"], parameters["CoeffWidth"]
    kind, direction = factors.split("_")
    inverse = direction == "inverse"
    if kind == "phase":
        words = phase_factors(size, inverse, coeff)[positions(size, paths, 0)]
    else:
        words = wide_factors(size, paths, size, inverse, coeff)
    return Structure(
        {**parameters, "Ones": ones(words, coeff)},
        device={"factors": factors},
        roms=lambda folder: write_wide_factors(folder / "wide_twiddle_inverse_0.hex", words, coeff),
        **runs,  # type: ignore[arg-type]
    )


STRUCTURES = (
    built("twiddle_inverse", 4, 8, 27, 27, 18, 17, 0, on=VERILATOR),
    built("twiddle_forward", 4, 4, 9, 9, 7, 6, 0, on=ICARUS, mutants=ICARUS),
    built("phase_forward", 2, 4, 15, 12, 10, 12, 1, on=ICARUS),
    built("phase_inverse", 4, 2, 9, 9, 7, 4, 0, on=ICARUS),
    built("phase_inverse", 1, 8, 9, 9, 7, 6, 0, on=ICARUS),
    built("phase_inverse", 2, 128, 27, 27, 18, 17, 0),
)
PROTOCOL = "protocol_wide_bursts"
PROOFS = tuple(
    Proof(
        f"paths with multipliers and without; {ROUNDING}",
        {"Paths": 2, "Beats": 2, "RealOnly": real_only, "Ones": ones_of_paths},
        roms=wide_factor_rom(2, 2, ones_of_paths),
    )
    for real_only, ones_of_paths in ((0, 1), (1, 0))
)


async def check(dut: Any, words: Any, **behaviour: Any) -> Any:
    paths, beats, coeff, drop, width, real_only = parameters(
        dut, "Paths", "Beats", "CoeffWidth", "Drop", "OutWidth", "RealOnly"
    )
    inverse = RUN.device["factors"].endswith("inverse")
    if RUN.device["factors"].startswith("phase"):
        factors = phase_factors(paths * beats, inverse, coeff)[positions(paths * beats, paths, 0)]
    else:
        factors = wide_factors(paths * beats, paths, paths * beats, inverse, coeff)

    def model(x: Any, monitor: Monitor) -> Any:
        products = wide_twiddle(x[..., 0], x[..., 1], factors, drop, width, monitor, real_only=bool(real_only))
        return np.stack(products, axis=-1)

    return await check_wide(dut, words, model, LATENCY, fields=["re", "im"], paths=paths, **behaviour)


def shape(dut: Any, bursts: int) -> tuple[int, ...]:
    paths, beats = parameters(dut, "Paths", "Beats")
    return bursts, beats, paths, 2


@cocotb.test(timeout_time=1, timeout_unit="ms")
@parametrize((("gap", "pause"), [(0, 0.0), (9, 0.0), (0, 0.3)]), ("amplitude", [0.3, 1.0, None]))
async def bursts(dut: Any, gap: float, pause: float, amplitude: float) -> None:
    (width,) = parameters(dut, "InWidth")
    await check(dut, uniform(shape(dut, 12), width, amplitude), gap=gap, pause=pause)


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def limits(dut: Any) -> None:
    paths, beats, width = parameters(dut, "Paths", "Beats", "InWidth")
    _, sink = await check(dut, extremes(paths * beats, width, 2).reshape(shape(dut, 8)))
    assert not np.any(sink.words[:beats]), "zero in, but not zero out"


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def reset_in_mid_burst(dut: Any) -> None:
    """Reset in each cycle in which a burst enters or leaves."""
    beats, width = parameters(dut, "Beats", "InWidth")
    await check(dut, uniform(shape(dut, 3), width, None), interrupts=range(1, beats + LATENCY + 4))
