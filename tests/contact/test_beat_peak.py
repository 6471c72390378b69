# SPDX-License-Identifier: Apache-2.0
"""beat_peak: RTL against the model, and the model against numpy."""

from typing import Any

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from formal.entries import Proof
from tactile_depth.chip.contact.beat_peak import beat_peak
from tb.structures import ICARUS, VERILATOR, Refused, of_parameters
from tests.rtl import test_rtl as test_rtl

built = of_parameters("Width Lanes")
STRUCTURES = (
    built(24, 8, on=VERILATOR),
    built(6, 4, on=ICARUS, mutants=True),
    built(6, 2, on=ICARUS),
    built(32, 32),
    built(12, 16),
)


def refused(missing: str) -> dict[str, Any]:
    """Return the refused parameters of a core of one beat; Verilator stops earlier, for want of a name."""
    rule = "Lanes_must_be_a_power_of_two_at_least_2"
    return {"Lanes=1": Refused(rule, {"verilator": f"can't find definition of '{missing}'"}), "Lanes=12": rule}


REFUSED = refused("top_at")
PROOFS = (Proof("peak of an arbitrary beat, 2 clocks later", "comparisons are exact at any width"),)


@given(st.lists(st.tuples(st.booleans(), st.integers(-4, 3)), min_size=8, max_size=8))
def test_the_peak_is_that_of_numpy(beat: list[tuple[bool, int]]) -> None:
    above, depths = (np.array(values) for values in zip(*beat, strict=True))
    peak = beat_peak(above.tolist(), depths.tolist())
    if not above.any():
        assert peak is None
        return
    masked = np.where(above, depths, -5)
    assert peak == (int(masked.max()), int(masked.argmax()))
