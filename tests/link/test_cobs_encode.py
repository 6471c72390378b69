# SPDX-License-Identifier: Apache-2.0
"""cobs_encode: RTL against the framing of the host."""

from hypothesis import given
from hypothesis import strategies as st

from tactile_depth.chip.link.framing import RUN, cobs_encode
from tb.link.tb_cobs_encode import cases, on_line


@given(st.binary(min_size=1, max_size=40))
def test_short_runs_are_those_of_cobs(packet: bytes) -> None:
    assert on_line(packet, RUN) == b"\0" + cobs_encode(packet) + b"\0"
    encoded, data = on_line(packet, 3)[1:-1], b""
    assert 0 not in encoded
    while encoded:
        code, encoded = encoded[0], encoded[1:]
        block, encoded = encoded[: code - 1], encoded[code - 1 :]
        data += block + (b"" if code == 4 or not encoded else b"\0")
    assert data == packet


def test_the_rules_of_the_page_give_the_bytes_of_the_host() -> None:
    for packet in cases(RUN):
        assert on_line(packet, RUN)[1:-1] == cobs_encode(packet)
