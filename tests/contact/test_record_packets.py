# SPDX-License-Identifier: Apache-2.0
"""record_packets: RTL against the model, and the model against its rules."""

from hypothesis import given
from hypothesis import strategies as st

from tactile_depth.chip.contact.record_packets import RecordPackets


@given(st.lists(st.tuples(st.booleans(), st.booleans()), max_size=100))
def test_each_record_is_sent_whole_or_lost(clocks: list[tuple[bool, bool]]) -> None:
    model, made, sent, lost = RecordPackets(), [], [], 0
    for clock, (new, ready) in enumerate([*clocks, *[(False, True)] * 12]):
        sent += list(model.sending)[: int(ready)]
        made += [clock] * new
        lost += model.clock((clock, -clock, clock) if new else None, ready)
    packets = [sent[index : index + 3] for index in range(0, len(sent), 3)]
    assert [packet[0] for packet in packets] == sorted(packet[0] for packet in packets)
    assert all(packet == [packet[0], -packet[0], packet[0]] for packet in packets)
    assert len(packets) == len(made) - lost
    assert not made or packets[-1][0] == made[-1], "the newest record was lost"
