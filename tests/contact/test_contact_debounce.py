# SPDX-License-Identifier: Apache-2.0
"""contact_debounce: RTL against the model, and the model against its definition."""

from collections.abc import Callable

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tactile_depth.contact.contact_debounce import BEGAN, ENDED, TOUCHING, ContactDebounce


@pytest.mark.structures("area_width", verilator=[(15,)], icarus=[(5,)], regress=[(21,)])
def test_rtl(run_tb: Callable[..., None], area_width: int) -> None:
    run_tb("contact_debounce", {"AreaWidth": area_width})


@given(st.lists(st.booleans(), max_size=60), st.integers(0, 5))
def test_it_changes_after_so_many_frames_in_a_row(large: list[bool], debounce: int) -> None:
    model, touching, since = ContactDebounce(), False, 0  # frames before the last change
    needed = max(debounce, 1)
    for frame, enough in enumerate(large, 1):
        before, status = touching, model.frame(int(enough), 1, debounce)
        if frame - since >= needed and all(now != touching for now in large[frame - needed : frame]):
            touching, since = not touching, frame
        changed = BEGAN * (touching > before) | ENDED * (touching < before)
        assert status == TOUCHING * touching | changed
        assert model.touching == touching
