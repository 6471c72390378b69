# SPDX-License-Identifier: Apache-2.0
"""dvp_receive: RTL against the model."""

from collections.abc import Callable
from typing import Any

from tb.structures import BOTH, ICARUS, Structure


def built(fifo_log2: int, **runs: Any) -> Structure:
    return Structure({"FifoLog2": fifo_log2}, **runs)


STRUCTURES = (
    built(4, on=BOTH),
    built(3, on=ICARUS, mutants=True),
)
REFUSED = {
    "FifoLog2=2": "FifoLog2_must_be_at_least_3_or_nearly_equal_clocks_lose_every_frame",
}


def test_rtl(run_tb: Callable[..., None], structure: Structure) -> None:
    run_tb(structure)
