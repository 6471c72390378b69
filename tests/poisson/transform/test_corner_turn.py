# SPDX-License-Identifier: Apache-2.0
"""corner_turn: RTL against the model, the model against Makhoul's order."""

from collections.abc import Callable

import numpy as np
import pytest

from tactile_depth.poisson.transform.corner_turn import corner_turn


@pytest.mark.structures(
    "columns width lanes",
    verilator=[(32, 24, 4)],
    icarus=[(16, 12, 2), (16, 12, 4), (64, 12, 8)],
    regress=[(32, 24, 4), (128, 24, 16), (256, 24, 32), (64, 24, 32)],
)
def test_rtl(run_tb: Callable[..., None], columns: int, width: int, lanes: int) -> None:
    run_tb("corner_turn", {"Columns": columns, "Width": width, "Lanes": lanes})


def test_a_beat_holds_even_words_of_the_first_half_and_odd_words_of_the_second() -> None:
    assert corner_turn(np.arange(8)[None], 4).tolist() == [[[0, 7, 1, 6], [2, 5, 3, 4]]]
