# SPDX-License-Identifier: Apache-2.0
"""td_banked_table: RTL against the model; the model's banks."""

import numpy as np
import pytest

from tactile_depth.chip.common.td_banked_table import BankedTable


def test_a_bank_is_written_while_the_other_is_in_use() -> None:
    table = BankedTable.of(np.array([1, 2, 3]))
    table.write(0, 9)
    assert table.begin_frame().tolist() == [1, 2, 3]
    table.wanted = 1
    with pytest.raises(ValueError, match="entry 1 is written while a change-over is due"):
        table.write(1, 8)
    assert table.begin_frame().tolist() == [9, 2, 3]
    assert table.free.tolist() == [1, 2, 3]
