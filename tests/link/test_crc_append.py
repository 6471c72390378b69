# SPDX-License-Identifier: Apache-2.0
"""crc_append: RTL against zlib."""

from tactile_depth.chip.link.framing import cobs_decode, to_line
from tb.link.tb_crc_append import with_crc


def test_the_crc_is_that_of_the_line() -> None:
    for packet in (b"\1", b"123456789", bytes(range(256)) * 4):
        assert cobs_decode(to_line(packet)[1:-1]) == with_crc(packet)
