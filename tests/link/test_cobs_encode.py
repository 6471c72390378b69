# SPDX-License-Identifier: Apache-2.0
"""cobs_encode: the model against the framing of the host."""

from hypothesis import given
from hypothesis import strategies as st

from tactile_depth.chip.link.cobs_encode import CobsEncode
from tactile_depth.chip.link.framing import DELIMITER, RUN, cobs_encode

runs = st.sampled_from((0, 1, 5, RUN - 1, RUN, RUN + 1, 2 * RUN)).map(lambda length: b"\7" * length)


@given(st.lists(st.one_of(runs, st.binary(max_size=9)), max_size=3).map(DELIMITER.join).filter(len))
def test_the_line_is_that_of_the_host(packet: bytes) -> None:
    model, line = CobsEncode(), b""
    for place, byte in enumerate(packet):
        model.clock(in_valid=1, in_data=byte, in_last=place == len(packet) - 1)
        while (out := model.clock())["out_valid"]:
            line += bytes((out["out_data"],))
    assert line == DELIMITER + cobs_encode(packet) + DELIMITER
