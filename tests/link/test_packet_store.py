# SPDX-License-Identifier: Apache-2.0
"""packet_store: RTL against the model, and the model against its rules."""

from hypothesis import given
from hypothesis import strategies as st

from tactile_depth.chip.link.packet_store import PacketStore

packets = st.lists(st.tuples(st.binary(min_size=1, max_size=12), st.booleans(), st.integers(0, 30)), max_size=12)


@given(packets, st.integers(0, 3))
def test_good_packets_leave_in_order_and_the_others_are_counted(
    line: list[tuple[bytes, bool, int]], patience: int
) -> None:
    model, out, bad = PacketStore(8), [b""], 0
    inputs: list[tuple[int | None, bool, bool]] = []
    for data, good, pause in line:
        inputs += [(byte, False, False) for byte in data] + [(None, True, good)] + [(None, False, False)] * pause
    for clock, (byte, ends, good) in enumerate(inputs + [(None, False, False)] * 200):
        offer, ready = model.offer, clock % (patience + 1) == 0
        if offer is not None and ready:
            out[-1] += bytes((offer.byte,))
            out += [b""] if offer.last else []
        model.clock(byte, ends, good, ready, False)
        bad += model.bad
    assert len(out) - 1 + bad == len(line)
    kept = iter(data[:8] for data, good, _ in line if good)
    assert all(any(packet == data for data in kept) for packet in out[:-1]), "another packet, or another order"
