# SPDX-License-Identifier: Apache-2.0
"""twiddle_multiply against its model: codes, latency, saturations; gaps, pauses, extremes, reset."""

from typing import Any

import cocotb
import numpy as np

from formal.entries import ROUNDING, Proof
from formal.tables import factor_rom
from tactile_depth.chip.common.td_round_saturate import Monitor
from tactile_depth.chip.poisson.transform.twiddle_multiply import (
    LATENCY,
    phase_factors,
    twiddle_factors,
    twiddle_multiply,
)
from tactile_depth.chip.rom_files import write_factors
from tb.settings import RUN
from tb.stream import check_bursts, extremes, parameters, parametrize, uniform
from tb.structures import ICARUS, VERILATOR, Structure

MAKERS = {"twiddle": twiddle_factors, "phase": phase_factors}


def built(
    factors: Any,
    size: int,
    block: Any,
    in_width: int,
    out_width: int,
    coeff: int,
    drop: int,
    real_only: int,
    **runs: Any,
) -> Structure:
    kind, direction = factors.split("_")
    return Structure(
        {
            "Size": size,
            "Block": block,
            "InWidth": in_width,
            "OutWidth": out_width,
            "CoeffWidth": coeff,
            "Drop": drop,
            "RealOnly": real_only,
        },
        device={"factors": factors},
        roms=lambda folder: write_factors(
            folder / "twiddle_forward_0.hex", MAKERS[kind](block, direction == "inverse", coeff), coeff
        ),
        **runs,
    )


STRUCTURES = (
    built("twiddle_forward", 32, 32, 27, 27, 18, 17, 0, on=VERILATOR),
    built("twiddle_inverse", 32, 8, 12, 12, 10, 9, 0, on=ICARUS),
    built("twiddle_forward", 16, 8, 35, 35, 24, 23, 0, on=ICARUS),
    built("phase_forward", 16, 16, 27, 24, 18, 20, 1, on=ICARUS),
    built("phase_forward", 16, 16, 15, 15, 10, 9, 1),
    built("phase_inverse", 64, 64, 24, 27, 18, 14, 0),
    built("twiddle_inverse", 16, 8, 6, 6, 5, 4, 0, mutants=ICARUS),
)
PROTOCOL = {"protocol_bursts": {"Columns": "Size"}}
PROOFS = tuple(
    Proof(
        f"the address is the burst's position; {ROUNDING}",
        {"Size": 8, "Block": block, "RealOnly": real_only},
        roms=factor_rom(block),
    )
    for block, real_only in ((4, 0), (8, 1))
)


FIELDS = ["re", "im"]


def factors_of(dut: Any) -> Any:
    coeff, block = parameters(dut, "CoeffWidth", "Block")
    kind, direction = RUN.device["factors"].split("_")
    return {"twiddle": twiddle_factors, "phase": phase_factors}[kind](block, direction == "inverse", coeff)


async def check(dut: Any, x: Any, **behaviour: Any) -> Any:
    width, drop, real_only = parameters(dut, "OutWidth", "Drop", "RealOnly")
    factors = factors_of(dut)

    def model(x: Any, monitor: Monitor) -> Any:
        out = twiddle_multiply(x[..., 0], x[..., 1], factors, drop, width, monitor, real_only=bool(real_only))
        return np.stack(out, axis=-1)

    return await check_bursts(dut, x, model, LATENCY, in_fields=FIELDS, out_fields=FIELDS, **behaviour)


@cocotb.test(timeout_time=1, timeout_unit="ms")
@parametrize((("gap", "pause"), [(0, 0.0), (9, 0.0), (0, 0.3)]), ("amplitude", [0.3, 1.0]))
async def bursts(dut: Any, gap: float, pause: float, amplitude: float) -> None:
    size, width = parameters(dut, "Size", "InWidth")
    await check(dut, uniform((6, size, 2), width, amplitude), gap=gap, pause=pause)


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def limits(dut: Any) -> None:
    size, width = parameters(dut, "Size", "InWidth")
    _, sink = await check(dut, extremes(size, width, 2))
    assert not np.any(sink.words[:size]), "zero in, but not zero out"


@cocotb.test(timeout_time=1, timeout_unit="ms")
@parametrize(part=[0, 1])
async def ties(dut: Any, part: Any) -> None:
    """Send a burst of products that drop exactly half a step, then for each lower bit one of half a step and that bit
    alone.

    The kept part is even, so each of those bits decides between rounding down and up. If the real part of the factor is
    odd, there is a word for every remainder of the product, for any other part of the word.
    """
    size, width, drop = parameters(dut, "Size", "InWidth", "Drop")
    half, modulus = 1 << drop - 1, 1 << drop + 1
    remainders = [half, *(half + (1 << bit) for bit in range(drop - 1))]
    words = uniform((len(remainders), size, 2), width, 0.3)
    factors = [tuple(map(int, pair)) for pair in factors_of(dut)] * (size // len(factors_of(dut)))
    for burst, remainder in zip(words, remainders, strict=True):
        for word, (re, im) in zip(burst, factors, strict=True):
            if re % 2:
                other = int(word[1 - part]) * im * (-1 if part else 1)
                wanted = (remainder + other) * pow(re, -1, modulus) % modulus
                word[part] = wanted - modulus * (wanted >= modulus // 2)
    assert any(re % 2 for re, _ in factors), "the test is void: no factor is odd"
    await check(dut, words)


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def reset_in_mid_burst(dut: Any) -> None:
    """Reset in each cycle of a burst, as it enters and as it leaves."""
    size, width = parameters(dut, "Size", "InWidth")
    await check(dut, uniform((2, size, 2), width), interrupts=range(1, size + LATENCY + 2))
