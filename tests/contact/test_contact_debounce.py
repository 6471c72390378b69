# SPDX-License-Identifier: Apache-2.0
"""contact_debounce: RTL against the model, and the model against its definition."""

from hypothesis import given
from hypothesis import strategies as st

from tactile_depth.chip.contact.contact_debounce import BEGAN, ENDED, TOUCHING, ContactDebounce


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
