# SPDX-License-Identifier: Apache-2.0
"""wide_twiddle: RTL against the model, the model against twiddle_multiply, the paths without a multiplier."""

import numpy as np
import pytest

from formal.entries import ROUNDING, Proof
from formal.tables import wide_factor_rom
from tactile_depth.chip.poisson.transform.twiddle_multiply import phase_factors, twiddle_factors, twiddle_multiply
from tactile_depth.chip.poisson.transform.wide_commutator import positions, to_beats
from tactile_depth.chip.poisson.transform.wide_fft import twiddle_window, wide_factors
from tactile_depth.chip.poisson.transform.wide_twiddle import ones, wide_twiddle
from tactile_depth.chip.rom_files import write_wide_factors
from tb.structures import ICARUS, VERILATOR, Structure
from tests.rtl import test_rtl as test_rtl

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
    built("twiddle_forward", 4, 4, 9, 9, 7, 6, 0, on=ICARUS, mutants=True),
    built("phase_forward", 2, 4, 15, 12, 10, 12, 1, on=ICARUS),
    built("phase_inverse", 4, 2, 9, 9, 7, 4, 0, on=ICARUS),
    built("phase_inverse", 1, 8, 9, 9, 7, 6, 0, on=ICARUS),
    built("phase_inverse", 2, 128, 27, 27, 18, 17, 0),
)
REFUSED = {
    "Ones=1 Drop=16": "Ones_must_be_0_unless_words_keep_their_format",
    "Ones=1 OutWidth=26": "Ones_must_be_0_unless_words_keep_their_format",
    "Ones=1 RealOnly=1": "Ones_must_be_0_unless_words_keep_their_format",
    "Paths=3": "Paths_and_Beats_must_be_powers_of_two_and_Beats_at_least_2",
    "Paths=0": "Paths_and_Beats_must_be_powers_of_two_and_Beats_at_least_2",
    "Beats=24": "Paths_and_Beats_must_be_powers_of_two_and_Beats_at_least_2",
    "Beats=1": "Paths_and_Beats_must_be_powers_of_two_and_Beats_at_least_2",
}
PROOFS = tuple(
    Proof(
        "the product of every word with the factor of its path and beat, and the clip count; latency 5",
        f"paths with multipliers and without; {ROUNDING}",
        {"Paths": 2, "Beats": 2, "RealOnly": real_only, "Ones": ones_of_paths},
        depth=35,
        roms=wide_factor_rom(2, 2, ones_of_paths),
    )
    for real_only, ones_of_paths in ((0, 1), (1, 0))
)


@pytest.mark.parametrize("inverse", [False, True])
@pytest.mark.parametrize(("paths", "block"), [(2, 32), (4, 32), (4, 8), (8, 32)])
def test_products_are_those_of_twiddle_multiply(paths: int, block: int, inverse: bool) -> None:
    re, im = np.random.default_rng(paths).integers(-(2**25), 2**25, (2, 3, 32))
    want = twiddle_multiply(re, im, twiddle_factors(block, inverse, 18), 17, 27)
    window = twiddle_window(32, paths, block, inverse)
    factors = wide_factors(32, paths, block, inverse, 18)
    got = wide_twiddle(to_beats(re, paths, window), to_beats(im, paths, window), factors, 17, 27)
    np.testing.assert_array_equal(got, [to_beats(part, paths, window) for part in want])


@pytest.mark.parametrize("inverse", [False, True])
@pytest.mark.parametrize("paths", [4, 8, 16])
def test_a_quarter_of_the_paths_needs_no_multiplier(paths: int, inverse: bool) -> None:
    for block in (128, 32):
        factors = wide_factors(128, paths, block, inverse, 18)
        assert ones(factors, 18).bit_count() == paths // 4
