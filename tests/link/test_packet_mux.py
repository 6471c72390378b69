# SPDX-License-Identifier: Apache-2.0
"""packet_mux: RTL against the model, and the model against the rules of the page."""

from itertools import pairwise

from hypothesis import given
from hypothesis import strategies as st

from tactile_depth.chip.link.packet_mux import DEPTH, RECORD, PacketMux

FOUR = st.tuples(*[st.booleans()] * 4)


@given(st.lists(FOUR, max_size=60))
def test_no_record_follows_a_record_while_depth_waits(offered: list[tuple[bool, ...]]) -> None:
    mux, chosen = PacketMux(), []
    for valid in offered:
        mux.clock(valid, (True,) * 4, True)
        if mux.chosen is None:
            assert not any(valid)
            continue
        assert valid[mux.chosen]
        assert not any(valid[: min(mux.chosen, RECORD)])
        chosen.append((mux.chosen, valid[DEPTH]))
        mux.clock(valid, (True,) * 4, True)
        assert mux.chosen is None
    in_turn = [choice for choice in chosen if choice[0] >= RECORD]
    assert all(not (before == after == RECORD and depth) for (before, _), (after, depth) in pairwise(in_turn))
