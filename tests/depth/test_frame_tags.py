# SPDX-License-Identifier: Apache-2.0
"""frame_tags: RTL against the model."""

from collections.abc import Callable
from typing import Any

from tb.structures import ICARUS, VERILATOR, Structure


# Two frames in flight, one, exactly two, four; the first again, for mutants.
def built(width: int, latency: Any, pixels: int, **runs: Any) -> Structure:
    return Structure({"Width": width, "Latency": latency, "Pixels": pixels}, **runs)


STRUCTURES = (
    built(33, 37, 24, on=VERILATOR),
    built(4, 9, 16, on=ICARUS),
    built(33, 32, 16),
    built(33, 50, 13),
    built(4, 9, 6, mutants=True),
)


def test_rtl(run_tb: Callable[..., None], structure: Structure) -> None:
    run_tb(structure)
