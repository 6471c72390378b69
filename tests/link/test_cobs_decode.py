# SPDX-License-Identifier: Apache-2.0
"""cobs_decode: RTL against the model, and the model against the decoder of the host."""

from hypothesis import given
from hypothesis import strategies as st

from tactile_depth.chip.link.cobs_decode import LONGEST_PIECE, CobsDecode
from tactile_depth.chip.link.framing import RUN, cobs_decode, cobs_encode


def decoded(piece: bytes) -> bytes | None:
    """Return what the model makes of a piece, None if it is bad."""
    model = CobsDecode()
    seen = [model.clock(in_valid=1, in_data=byte) for byte in (0, *piece, 0)] + [model.clock()]
    assert seen[-1]["out_end"] == bool(piece)
    return None if seen[-1].get("out_bad") else bytes(out["out_data"] for out in seen if out["out_valid"])


bytes_without_zero = st.lists(st.integers(1, 255), max_size=20).map(bytes)
runs = st.lists(st.sampled_from((0, 1, 5, RUN - 1, RUN, RUN + 1, 2 * RUN)), min_size=1, max_size=2)


@given(bytes_without_zero)
def test_any_piece_is_decoded_as_by_the_host(piece: bytes) -> None:
    assert decoded(piece) == cobs_decode(piece)


@given(runs)
def test_data_comes_back(lengths: list[int]) -> None:
    data = bytes(1).join(b"\7" * length for length in lengths)
    assert decoded(cobs_encode(data)) == data


def test_a_piece_longer_than_the_longest_is_bad() -> None:
    piece = b"\1" * LONGEST_PIECE
    assert decoded(piece) == bytes(LONGEST_PIECE - 1)
    assert decoded(piece + b"\1") is None
