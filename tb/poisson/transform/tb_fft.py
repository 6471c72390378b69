# SPDX-License-Identifier: Apache-2.0
"""fft against its model: codes, latency, saturations; gaps, pauses, extremes, reset."""

from functools import partial
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
from tb.beats import all_stages_clip
from tb.flips import no_flips as no_flips
from tb.poisson.burst_core import BurstCore
from tb.stream import MANY, parameters
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
    built(32, 2, 12, 10, 1, on=ICARUS, mutants=ICARUS),
    built(32, 4, 9, 7, 1, on=ICARUS),
    built(16, 1, 12, 10, 1, on=ICARUS, mutants=ICARUS),
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


def model(dut: Any, x: Any, monitor: Monitor) -> Any:
    width, coeff, inverse = parameters(dut, "Width", "CoeffWidth", "Inverse")
    _, beats, paths, _ = x.shape
    high = beats.bit_length() - 1
    before, behind = (0, high) if inverse else (high, 0)
    re, im = (from_beats(x[..., part], before) for part in (0, 1))
    out = fft(re, im, bool(inverse), width, coeff, monitor)
    return np.stack([to_beats(part, paths, behind) for part in out], axis=-1)


CORE = BurstCore(model, lambda dut: fft_latency(*parameters(dut, "Size", "Paths")))
bursts, many_bursts, limits, reset_in_mid_burst, *_ = CORE.tests()


@cocotb.test
async def every_stage_clips_at_once(dut: Any) -> None:
    (width,) = parameters(dut, "Width")
    await CORE.check(dut, all_stages_clip(CORE.shape(dut, 7 * MANY), width, partial(model, dut), lambda node: width))
