# SPDX-License-Identifier: Apache-2.0
"""cobs_decode: RTL against the model, and the model against the decoder of the host."""

from hypothesis import given
from hypothesis import strategies as st

from formal.entries import Proof
from tactile_depth.chip.link.cobs_decode import LONGEST_PIECE, CobsDecode
from tactile_depth.chip.link.framing import RUN, cobs_decode, cobs_encode
from tb.structures import BOTH, ICARUS, QUICK_FIRST, VERILATOR, Mutants, of_parameters
from tests.rtl import test_rtl as test_rtl

built = of_parameters("Longest")
STRUCTURES = (
    built(LONGEST_PIECE, on=VERILATOR),
    built(300, on=BOTH, mutants=True),
    built(2, on=ICARUS),
)
MUTANTS = Mutants(simulators=QUICK_FIRST)
REFUSED = {"Longest=0": "Longest_must_be_at_least_1"}
PROOFS = (
    Proof(
        "what comes out is what the codes of the piece stand for, at once and in order; a piece is bad if a code "
        "points beyond its end, a byte was broken, or it is too long; nothing before the first delimiter",
        "the length of a piece is only counted",
        {"Longest": 5},
        depth=16,
        engine="smtbmc bitwuzla -- --noincr",
        steps=3,
    ),
)


def decoded(piece: bytes) -> bytes | None:
    """Return what the model makes of a piece, None if it is bad."""
    model = CobsDecode()
    model.clock(0)
    data = bytes(out.byte for byte in piece if (out := model.clock(byte)).byte is not None)
    end = model.clock(0)
    assert end.ends == bool(piece)
    return None if end.bad else data


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
