# SPDX-License-Identifier: Apache-2.0
"""fft against its model: codes, latency, saturations; gaps, pauses, extremes, reset."""

from typing import Any

import cocotb
import numpy as np

from formal.entries import Proof
from formal.tables import transform_roms
from tactile_depth.chip.common.td_round_saturate import Monitor
from tactile_depth.chip.poisson.transform.commutator import from_beats, to_beats
from tactile_depth.chip.poisson.transform.fft import fft
from tactile_depth.chip.poisson.transform.fft import latency as fft_latency
from tactile_depth.chip.rom_files import write_direction
from tb.beats import all_stages_clip, check_beats
from tb.stream import MANY, extremes, parameters, parametrize, uniform
from tb.structures import ICARUS, VERILATOR, Mutants, Structure


def built(size: int, paths: int, width: int, coeff: int, inverse: int, **runs: Any) -> Structure:
    return Structure(
        {"Size": size, "Paths": paths, "Width": width, "CoeffWidth": coeff, "Inverse": inverse},
        roms=lambda folder: write_direction(folder, size, paths, bool(inverse), coeff),
        **runs,
    )


STRUCTURES = (
    built(16, 4, 27, 18, 1, on=VERILATOR),
    built(16, 2, 27, 18, 0, on=ICARUS),
    built(8, 4, 12, 10, 0, on=ICARUS),
    built(8, 2, 12, 10, 1, on=ICARUS, mutants=ICARUS),
    built(32, 4, 9, 7, 1, on=ICARUS),
    built(32, 1, 12, 10, 1, on=ICARUS, mutants=ICARUS),
    built(16, 1, 27, 18, 0),
    built(128, 1, 35, 24, 1),
    built(32, 8, 27, 18, 0),
    built(64, 32, 15, 10, 0),
    built(64, 32, 15, 10, 1),
    built(128, 16, 27, 18, 1),
    built(128, 4, 35, 24, 0),
    built(256, 8, 27, 18, 1),
    built(512, 4, 27, 18, 0),
)
PROTOCOL = {"protocol_beats": {"Beats": "Size / Paths"}}
MUTANTS = Mutants(flat=False)
PROOFS = tuple(
    Proof(
        "the smallest transform: pair, twiddle and lone butterfly; longer ones chain more of these",
        {"Size": 8, "Paths": paths, "Inverse": inverse, "Latency": fft_latency(8, paths)},
        roms=transform_roms(paths, 8 // paths),
    )
    for paths, inverse in ((1, 0), (1, 1), (2, 0), (2, 1), (4, 1))
)


def model_of(dut: Any) -> Any:
    width, coeff, inverse, size, paths = parameters(dut, "Width", "CoeffWidth", "Inverse", "Size", "Paths")
    high = (size // paths).bit_length() - 1
    before, behind = (0, high) if inverse else (high, 0)

    def model(x: Any, monitor: Monitor) -> Any:
        re, im = (from_beats(x[..., part], before) for part in (0, 1))
        out = fft(re, im, bool(inverse), width, coeff, monitor)
        return np.stack([to_beats(part, paths, behind) for part in out], axis=-1)

    return model


async def check(dut: Any, words: Any, **behaviour: Any) -> Any:
    size, paths = parameters(dut, "Size", "Paths")
    return await check_beats(
        dut, words, model_of(dut), fft_latency(size, paths), fields=["re", "im"], paths=paths, **behaviour
    )


def shape(dut: Any, bursts: int) -> tuple[int, ...]:
    size, paths = parameters(dut, "Size", "Paths")
    return bursts, size // paths, paths, 2


@cocotb.test(timeout_time=10, timeout_unit="ms")
@parametrize((("gap", "pause"), [(0, 0.0), (30, 0.0), (0, 0.3), (3, 0.0)]), ("amplitude", [0.3, 1.0]))
async def bursts(dut: Any, gap: float, pause: float, amplitude: float) -> None:
    (width,) = parameters(dut, "Width")
    await check(dut, uniform(shape(dut, 8), width, amplitude), gap=gap, pause=pause)


@cocotb.test(timeout_time=50, timeout_unit="ms")
@parametrize(amplitude=[0.1, None])
async def many_bursts(dut: Any, amplitude: float) -> None:
    """Reach ties of every rounding, and clip every value that can clip."""
    (width,) = parameters(dut, "Width")
    await check(dut, uniform(shape(dut, 4 * MANY), width, amplitude))


@cocotb.test(timeout_time=10, timeout_unit="ms")
async def limits(dut: Any) -> None:
    size, width = parameters(dut, "Size", "Width")
    _, sink = await check(dut, extremes(size, width, 2).reshape(shape(dut, 8)))
    assert not np.any(sink.words[: shape(dut, 1)[1]]), "zero in, but not zero out"


@cocotb.test(timeout_time=10, timeout_unit="ms")
@parametrize(late=[False, True])
async def reset_in_mid_burst(dut: Any, late: bool) -> None:
    """Reset in each cycle in which a burst begins to enter, or to leave."""
    size, width, paths = parameters(dut, "Size", "Width", "Paths")
    first = fft_latency(size, paths) - 3 if late else 1
    await check(dut, uniform(shape(dut, 2), width), interrupts=range(first, first + 8))


@cocotb.test(timeout_time=50, timeout_unit="ms")
async def every_stage_clips_at_once(dut: Any) -> None:
    (width,) = parameters(dut, "Width")
    await check(dut, all_stages_clip(shape(dut, 20 * MANY), width, model_of(dut), lambda node: width))
