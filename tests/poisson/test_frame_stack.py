# SPDX-License-Identifier: Apache-2.0
"""frame_stack: RTL against the model."""

from collections.abc import Callable

import pytest


@pytest.mark.structures(
    "columns width rows words_per_row lanes",
    verilator=[(16, 24, 8, 3, 1), (16, 24, 9, 3, 4)],
    icarus=[(8, 16, 3, 1, 1), (4, 4, 3, 1, 1), (8, 16, 3, 2, 1), (4, 4, 4, 3, 1), (8, 12, 5, 1, 2), (16, 12, 8, 1, 4)],
    regress=[
        (4, 4, 4, 2, 1),
        (5, 6, 2, 2, 1),
        (2, 5, 2, 6, 1),
        (16, 24, 8, 3, 1),
        (8, 16, 2, 1, 1),
        (16, 16, 17, 1, 1),
        (16, 9, 17, 3, 1),
        (16, 12, 5, 6, 1),
        (16, 24, 9, 3, 4),
        (4, 6, 2, 1, 2),
        (4, 6, 3, 1, 2),
        (64, 12, 5, 5, 8),  # fewer rows than lanes
        (64, 12, 21, 3, 8),
    ],
)
def test_rtl(run_tb: Callable[..., None], columns: int, width: int, rows: int, words_per_row: int, lanes: int) -> None:
    parameters = {"Columns": columns, "Width": width, "Rows": rows, "WordsPerRow": words_per_row, "Lanes": lanes}
    run_tb("frame_stack", parameters)
