# SPDX-License-Identifier: Apache-2.0
"""crc_append: RTL against zlib."""

from formal.entries import FULL_WIDTH, Proof
from tactile_depth.chip.link.framing import cobs_decode, to_line
from tb.link.tb_crc_append import with_crc
from tb.structures import BOTH, Mutants, Structure
from tests.rtl import test_rtl as test_rtl

STRUCTURES = (Structure(on=BOTH, mutants=True),)
MUTANTS = Mutants(repeats=2)
PROOFS = (
    Proof(
        "bytes pass unchanged and at once, then the CRC-32 over them, last with its fourth byte; stable under stall",
        FULL_WIDTH,
        depth=30,
        engine="smtbmc bitwuzla -- --noincr",
        steps=2,
    ),
)


def test_the_crc_is_that_of_the_line() -> None:
    for packet in (b"\1", b"123456789", bytes(range(256)) * 4):
        assert cobs_decode(to_line(packet)[1:-1]) == with_crc(packet)
