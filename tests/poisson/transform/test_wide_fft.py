# SPDX-License-Identifier: Apache-2.0
"""wide_fft: RTL against the model of sdf_fft, the order of its words, its ROMs."""

from typing import Any

import numpy as np
import pytest

from formal.entries import Proof
from formal.tables import transform_roms, wide_roms
from tactile_depth.chip.poisson.transform.sdf_fft import sdf_fft
from tactile_depth.chip.poisson.transform.wide_fft import latency as wide_fft_latency
from tactile_depth.chip.poisson.transform.wide_fft import wide_fft
from tactile_depth.chip.rom_files import write_direction
from tb.structures import ICARUS, VERILATOR, Mutants, Structure
from tests.rtl import test_rtl as test_rtl


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
    built(8, 2, 12, 10, 1, on=ICARUS, mutants=True),
    built(32, 4, 9, 7, 1, on=ICARUS),
    built(16, 1, 12, 10, 1, on=ICARUS),
    built(32, 8, 27, 18, 0),
    built(64, 32, 15, 10, 0),
    built(64, 32, 15, 10, 1),
    built(128, 16, 27, 18, 1),
    built(128, 4, 35, 24, 0),
    built(256, 8, 27, 18, 1),
    built(512, 4, 27, 18, 0),
)
MUTANTS = Mutants(flat=False)
REFUSED = {
    "Size=4": "Size_must_be_a_power_of_two_at_least_8",
    "Size=24": "Size_must_be_a_power_of_two_at_least_8",
    "Paths=0": "Paths_must_be_a_power_of_two_1_to_Size_2",
    "Paths=128": "Paths_must_be_a_power_of_two_1_to_Size_2",
    "Paths=3": "Paths_must_be_a_power_of_two_1_to_Size_2",
}
PROOFS = tuple(
    Proof(
        "start and frame_start leave with their burst, at the latency of its model",
        "the smallest transform: pair, twiddle and lone butterfly; longer ones chain more of these",
        {"Size": 8, "Paths": paths, "Inverse": inverse, "Latency": wide_fft_latency(8, paths)},
        depth=60,
        roms=wide_roms(paths, 8 // paths) if paths > 1 else transform_roms,
    )
    for paths, inverse in ((1, 0), (2, 0), (2, 1), (4, 1))
)


@pytest.mark.parametrize("inverse", [False, True])
@pytest.mark.parametrize("paths", [1, 2, 8])
def test_words_enter_and_leave_at_the_positions_of_the_header(paths: int, inverse: bool) -> None:
    re, im = np.random.default_rng(paths).integers(-(2**20), 2**20, (2, 32))
    want = sdf_fft(re, im, inverse, 27, 18)
    sent = [in_beats(part, paths, by_path=not inverse) for part in (re, im)]
    got = wide_fft(sent[0], sent[1], inverse, 27, 18)
    np.testing.assert_array_equal(got, [in_beats(part, paths, by_path=inverse) for part in want])


def in_beats(words: np.ndarray, paths: int, by_path: bool) -> np.ndarray:
    """Return words as beats: neighbours lie in one path, or in one beat."""
    return words.reshape(paths, -1).T if by_path else words.reshape(-1, paths)
