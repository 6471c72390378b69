# SPDX-License-Identifier: Apache-2.0
"""transpose: RTL against the model, the model against numpy."""

from typing import Any

import numpy as np
import pytest

from formal.entries import ONE_ORDER, WORD_FREE, Proof
from tactile_depth.chip.poisson.transform.orders import makhoul
from tactile_depth.chip.poisson.transform.transpose import transpose
from tb.structures import ICARUS, VERILATOR, Mutants, of_parameters
from tests.rtl import test_rtl as test_rtl

built = of_parameters("Columns Width MakhoulIn MakhoulOut")
STRUCTURES = (
    built(16, 24, 0, 1, on=VERILATOR),
    built(8, 16, 0, 0, on=ICARUS),
    built(8, 16, 0, 1, on=ICARUS),
    built(8, 16, 1, 0, on=ICARUS),
    built(8, 16, 1, 1),
    built(4, 5, 0, 1, mutants=True),
)
MUTANTS = Mutants("bursts", rows_are="Columns")
REFUSED = {
    "Columns=12": "Columns_must_be_a_power_of_two_at_least_4",
    "Columns=2": "Columns_must_be_a_power_of_two_at_least_4",
}
PROOFS = tuple(
    Proof(
        "an arbitrary word at its place in its column; latency 2 from the first word of the last row",
        f"{ONE_ORDER}; {WORD_FREE}",
        {"Columns": 4, "MakhoulIn": makhoul_in, "MakhoulOut": makhoul_out},
        depth=45,
    )
    for makhoul_in, makhoul_out in ((0, 1), (1, 0))
)


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


def test_twice_is_the_frame() -> None:
    frame = np.arange(64).reshape(8, 8)
    np.testing.assert_array_equal(transpose(transpose(frame, False, True), True, False), frame)
