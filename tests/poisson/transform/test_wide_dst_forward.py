# SPDX-License-Identifier: Apache-2.0
"""wide_dst_forward: RTL against the model of dst_forward."""

from typing import Any

import numpy as np
import pytest

from formal.entries import Proof
from formal.tables import wide_roms
from tactile_depth.chip.poisson.transform.dst_forward import dst_forward
from tactile_depth.chip.poisson.transform.orders import makhoul
from tactile_depth.chip.poisson.transform.transform import Transform
from tactile_depth.chip.poisson.transform.wide_dst_forward import latency as wide_dst_forward_latency
from tactile_depth.chip.poisson.transform.wide_dst_forward import wide_dst_forward
from tactile_depth.chip.poisson.transform.wide_rows import wide_rows
from tactile_depth.chip.rom_files import write_direction
from tb.structures import ICARUS, VERILATOR, Mutants, Structure
from tests.rtl import test_rtl as test_rtl

PARAMETERS = ("Size", "Words", "InWidth", "Width", "CoeffWidth", "OutputDrop", "OutWidth", "Sine")


def built(*values: int, **runs: Any) -> Structure:
    parameters = dict(zip(PARAMETERS, values, strict=True))
    size, words, coeff = (parameters[name] for name in ("Size", "Words", "CoeffWidth"))
    return Structure(parameters, roms=lambda folder: write_direction(folder, size, words, False, coeff), **runs)


STRUCTURES = (
    built(16, 4, 23, 27, 18, 3, 24, 1, on=VERILATOR),
    built(16, 2, 23, 27, 18, 3, 24, 1, on=ICARUS),
    built(16, 8, 15, 15, 10, 3, 12, 1, on=ICARUS),
    built(8, 4, 9, 9, 7, 3, 6, 1, on=ICARUS, mutants=True),
    built(32, 4, 9, 9, 7, 1, 6, 0, on=ICARUS),
    built(128, 4, 27, 27, 18, 0, 27, 1),
)
REFUSED = {
    "Words=1": "Words_must_be_a_power_of_two_2_to_Size_2",
    "Words=3": "Words_must_be_a_power_of_two_2_to_Size_2",
    "Words=128": "Words_must_be_a_power_of_two_2_to_Size_2",
}
MUTANTS = Mutants(flat=False)
PROOFS = (
    Proof(
        "start and frame_start leave with their burst, at the latency of its model",
        "the smallest transform, every core of a longer one is in it",
        {"Size": 8, "Words": 2, "Latency": wide_dst_forward_latency(8, 2)},
        depth=60,
        roms=wide_roms(2, 4),
    ),
)


@pytest.mark.parametrize("words", [2, 4, 8])
def test_the_modes_of_a_row_are_those_of_dst_forward(words: int) -> None:
    row = np.random.default_rng(words).integers(-(2**20), 2**20, 32)
    want = dst_forward(row[makhoul(32)], Transform(0, 27, 18, 1, 27))
    np.testing.assert_array_equal(wide_dst_forward(wide_rows(row, words), Transform(0, 27, 18, 1, 27)).ravel(), want)
