# SPDX-License-Identifier: Apache-2.0
"""packet_check: RTL against the model, and the model with the decoder against the host's."""

from hypothesis import given
from hypothesis import strategies as st

from tactile_depth.chip.link.framing import CRC_BYTES, LONGEST_BODY, cobs_decode, from_line, to_line
from tactile_depth.chip.link.packet_check import PacketCheck


def checked(piece: bytes) -> bytes | None:
    """Return what the models make of a piece between two delimiters, None if it is bad."""
    model, data = PacketCheck(), cobs_decode(piece)
    seen = [model.clock(in_valid=1, in_data=byte) for byte in data or b""]
    seen += [model.clock(in_end=1, in_bad=data is None), model.clock()]
    body = bytes(out["out_data"] for out in seen if out["out_valid"])
    return body if seen[-1]["out_good"] else None


@given(st.binary(max_size=300), st.data())
def test_a_packet_is_good_if_the_host_says_so(body: bytes, data: st.DataObject) -> None:
    piece = bytearray(to_line(body)[1:-1])
    assert checked(bytes(piece)) == from_line(bytes(piece)) == (body or None)
    piece[data.draw(st.integers(0, len(piece) - 1))] = data.draw(st.integers(1, 255))
    assert checked(bytes(piece)) == from_line(bytes(piece))


def test_the_longest_packet_and_the_shortest() -> None:
    for length in (1, LONGEST_BODY):
        assert checked(to_line(bytes(length))[1:-1]) == bytes(length)
    assert checked(b"\1" * (CRC_BYTES + 1)) is None
