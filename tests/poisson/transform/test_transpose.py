# SPDX-License-Identifier: Apache-2.0
"""transpose: RTL against the model, the model against numpy."""

from typing import Any

import numpy as np
import pytest

from tactile_depth.chip.poisson.transform.orders import makhoul
from tactile_depth.chip.poisson.transform.transpose import transpose


@pytest.mark.parametrize("makhoul_out", [False, True])
@pytest.mark.parametrize("makhoul_in", [False, True])
def test_rows_become_columns(makhoul_in: Any, makhoul_out: Any) -> None:
    columns = 16
    frames = np.arange(3 * columns * columns).reshape(3, columns, columns)
    order = makhoul(columns)
    sent = frames[..., order] if makhoul_in else frames
    out = transpose(sent, makhoul_in, makhoul_out)
    for frame, bursts in zip(frames, out, strict=True):
        for c, burst in enumerate(bursts):
            column = frame[:, c]
            np.testing.assert_array_equal(burst, column[order] if makhoul_out else column)
