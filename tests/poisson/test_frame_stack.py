# SPDX-License-Identifier: Apache-2.0
"""frame_stack: RTL against the model."""

from collections.abc import Callable
from typing import Any

import pytest

SOURCES = ["burst_counter.sv", "ram.sv", "frame_stack.sv"]


@pytest.mark.structures(
    "size width rows words_per_row",
    verilator=[(16, 24, 8, 3)],
    icarus=[(8, 16, 3, 1), (4, 4, 3, 1), (8, 16, 3, 2), (4, 4, 4, 3)],
    regress=[
        (4, 4, 4, 2),
        (5, 6, 2, 2),
        (2, 5, 2, 6),
        (16, 24, 8, 3),
        (8, 16, 2, 1),
        (16, 16, 17, 1),
        (16, 9, 17, 3),
        (16, 12, 5, 6),
    ],
)
def test_rtl(run_tb: Callable[..., None], size: int, width: int, rows: int, words_per_row: Any) -> None:
    run_tb("frame_stack", SOURCES, {"Size": size, "Width": width, "Rows": rows, "WordsPerRow": words_per_row})
