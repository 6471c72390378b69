# SPDX-License-Identifier: Apache-2.0
"""cobs_encode: RTL against the framing of the host."""

from hypothesis import given
from hypothesis import strategies as st

from formal.entries import Proof
from tactile_depth.chip.link.framing import RUN, cobs_encode
from tb.link.tb_cobs_encode import cases, on_line
from tb.structures import BOTH, ICARUS, VERILATOR, Mutants, of_parameters
from tests.rtl import test_rtl as test_rtl

built = of_parameters("Run")
STRUCTURES = (
    built(254, on=BOTH),
    built(3, on=ICARUS, late=VERILATOR, mutants=True),
    built(2),
)
REFUSED = {
    "Run=1": "Run_is_2_to_254",
    "Run=255": "Run_is_2_to_254",
}
MUTANTS = Mutants(repeats=2)
PROOFS = tuple(
    Proof(
        "the line, decoded, has each packet as it came, between two zeros; no other zero, no code that is not needed; "
        "stable under stall; memory as td_ram.sv asks",
        "the length of a run is only counted; an arbitrary byte is followed",
        {"Run": run},
        depth=40,
    )
    for run in (2, 3)
)


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
