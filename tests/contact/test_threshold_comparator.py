# SPDX-License-Identifier: Apache-2.0
"""threshold_comparator: RTL against the model."""

from collections.abc import Callable
from typing import Any

from tb.structures import BOTH, ICARUS, VERILATOR, Structure


def built(width: int, lanes: int, **runs: Any) -> Structure:
    return Structure({"Width": width, "Lanes": lanes}, **runs)


STRUCTURES = (
    built(12, 1, on=BOTH, mutants=True),
    built(32, 1, on=VERILATOR),
    built(12, 4, on=ICARUS, mutants=True),
    built(24, 32),
    built(32, 2),
)
REFUSED = {
    "Width=33": "Width_must_be_2_to_32",
    "Lanes=0": "Lanes_must_be_at_least_1",
}


def test_rtl(run_tb: Callable[..., None], structure: Structure) -> None:
    run_tb(structure)
