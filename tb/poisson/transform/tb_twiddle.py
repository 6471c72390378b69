# SPDX-License-Identifier: Apache-2.0
"""twiddle against its model: codes, latency, saturations; gaps, pauses, extremes, reset."""

from typing import Any

import numpy as np

from formal.entries import ROUNDING, Proof
from formal.tables import factor_rom
from tactile_depth.chip.common.td_round_saturate import Monitor
from tactile_depth.chip.poisson.transform.commutator import positions
from tactile_depth.chip.poisson.transform.fft import path_factors
from tactile_depth.chip.poisson.transform.twiddle import LATENCY, ones, phase_factors, twiddle
from tactile_depth.chip.rom_files import write_factors
from tb.poisson.burst_core import BurstCore
from tb.settings import RUN
from tb.stream import parameters
from tb.structures import ICARUS, VERILATOR, Structure

PARAMETERS = ("Paths", "Beats", "Block", "InWidth", "OutWidth", "CoeffWidth", "Drop", "RealOnly")


def factors_of(kind: str, paths: int, beats: int, block: int, coeff: int) -> Any:
    """Return the factors of each beat of a block and each path."""
    name, direction = kind.split("_")
    inverse, size = direction == "inverse", paths * beats
    if name == "phase":
        return phase_factors(size, inverse, coeff)[positions(size, paths, 0)]
    return path_factors(size, paths, paths * block, inverse, coeff)


def built(kind: str, *values: int, **runs: object) -> Structure:
    parameters = dict(zip(PARAMETERS, values, strict=True))
    coeff = parameters["CoeffWidth"]
    words = factors_of(kind, values[0], values[1], values[2], coeff)
    return Structure(
        {**parameters, "Ones": ones(words, coeff)},
        device={"factors": kind},
        roms=lambda folder: write_factors(folder / "twiddle_inverse_0.hex", words, coeff),
        **runs,  # type: ignore[arg-type]
    )


STRUCTURES = (
    built("twiddle_inverse", 4, 8, 8, 27, 27, 18, 17, 0, on=VERILATOR),
    built("twiddle_forward", 4, 4, 4, 9, 9, 6, 5, 0, on=ICARUS, mutants=ICARUS),
    built("phase_forward", 2, 4, 4, 15, 12, 10, 12, 1, on=ICARUS),
    built("phase_inverse", 4, 2, 2, 9, 9, 7, 4, 0, on=ICARUS),
    built("twiddle_inverse", 1, 32, 16, 6, 6, 5, 4, 0, on=ICARUS, mutants=ICARUS),
    built("twiddle_forward", 1, 16, 8, 35, 35, 24, 23, 0),
    built("phase_inverse", 1, 64, 64, 24, 27, 18, 14, 0),
    built("phase_inverse", 2, 128, 128, 27, 27, 18, 17, 0),
)
PROTOCOL = "protocol_beats"
PROOFS = tuple(
    Proof(
        f"paths with multipliers and without; one path whose factors repeat; {ROUNDING}",
        {"Paths": paths, "Beats": beats, "Block": 2, "RealOnly": real_only, "Ones": ones_of_paths},
        roms=factor_rom(paths, 2, ones_of_paths),
    )
    for paths, beats, real_only, ones_of_paths in ((2, 2, 0, 1), (2, 2, 1, 0), (1, 4, 0, 0))
)


def factors(dut: Any) -> Any:
    return factors_of(RUN.device["factors"], *parameters(dut, "Paths", "Beats", "Block", "CoeffWidth"))


def model(dut: Any, x: Any, monitor: Monitor) -> Any:
    drop, width, real_only = parameters(dut, "Drop", "OutWidth", "RealOnly")
    re, im = np.moveaxis(x, -1, 0).reshape(2, len(x), -1)
    own = factors(dut).reshape(-1, 2)
    return np.stack(twiddle(re, im, own, drop, width, monitor, real_only=bool(real_only)), axis=-1).reshape(x.shape)


CORE = BurstCore(model, lambda dut: LATENCY, "InWidth")
bursts, many_bursts, limits, reset_in_mid_burst, *_ = CORE.tests()
