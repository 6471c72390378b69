# SPDX-License-Identifier: Apache-2.0
"""beat_peak: RTL against the model, and the model against numpy."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from tactile_depth.chip.contact.beat_peak import beat_peak


@given(st.lists(st.tuples(st.booleans(), st.integers(-4, 3)), min_size=8, max_size=8))
def test_the_peak_is_that_of_numpy(beat: list[tuple[bool, int]]) -> None:
    above, depths = (np.array(values) for values in zip(*beat, strict=True))
    peak = beat_peak(above.tolist(), depths.tolist())
    if not above.any():
        assert peak is None
        return
    masked = np.where(above, depths, -5)
    assert peak == (int(masked.max()), int(masked.argmax()))
