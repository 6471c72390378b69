# SPDX-License-Identifier: Apache-2.0
"""td_async_fifo: RTL against the model."""

from collections.abc import Callable
from typing import Any

from tb.structures import BOTH, ICARUS, Structure


def built(width: int, depth_log2: int, **runs: Any) -> Structure:
    return Structure({"Width": width, "DepthLog2": depth_log2}, **runs)


STRUCTURES = (
    built(10, 4, on=BOTH),
    built(3, 2, on=ICARUS, mutants=True),
)
REFUSED = {
    "DepthLog2=1": "DepthLog2_must_be_at_least_2",
}


def test_rtl(run_tb: Callable[..., None], structure: Structure) -> None:
    run_tb(structure)
