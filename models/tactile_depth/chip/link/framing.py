# SPDX-License-Identifier: Apache-2.0
"""Framing of packets on a line: a CRC-32 at the end, COBS, and a zero byte before and after.

COBS is consistent overhead byte stuffing (S. Cheshire and M. Baker, IEEE/ACM Transactions on Networking 7(2), 1999). It
removes zero bytes: a code byte c stands for the c - 1 bytes behind it and a zero; the code 255 for 254 bytes and no
zero. The last zero is not part of the data.
"""

from __future__ import annotations

import zlib
from typing import Final

from tactile_depth.base.errors import InputError

DELIMITER: Final = b"\0"
CRC_BYTES: Final = 4
LONGEST_ON_LINE: Final = 1400  # bytes, with both delimiters
RUN: Final = 254  # bytes of data behind the code 255, none of them zero
LONGEST_BODY: Final = 1392 - CRC_BYTES  # of which the CRC, COBS and the delimiters make LONGEST_ON_LINE
_FULL: Final = b"\xff"
_CODES: Final = tuple(bytes((length + 1,)) for length in range(RUN))


def cobs_encode(data: bytes) -> bytes:
    """Return data without zero bytes, as COBS encodes it. It grows by 1 byte, or 1 in 254."""
    *blocks, last = data.split(DELIMITER)
    out = [_CODES[len(block)] + block if len(block) < RUN else _long_block(block, False) for block in blocks]
    out.append(_CODES[len(last)] + last if len(last) < RUN else _long_block(last, True))
    return b"".join(out)


def _long_block(block: bytes, is_last: bool) -> bytes:
    """Return the code of 254 and more bytes; an empty rest is only encoded if a zero follows."""
    full = len(block) // RUN * RUN
    out = b"".join(_FULL + block[first : first + RUN] for first in range(0, full, RUN))
    rest = block[full:]
    return out if is_last and not rest else out + _CODES[len(rest)] + rest


def cobs_decode(encoded: bytes) -> bytes | None:
    """Return the data, or None if the last code points beyond the end. `encoded` has no zero byte."""
    data, end = bytearray(encoded), len(encoded)
    at, runs = 0, []
    while at < end:  # each code becomes the zero that it stands for, with the length of its block as distance
        code = data[at]
        data[at] = 0
        at += code
        if code == RUN + 1:
            runs.append(at)
    if at != end:
        return None
    for code_without_zero in reversed(runs):
        del data[code_without_zero : code_without_zero + 1]
    return bytes(data[1:])


def to_line(body: bytes) -> bytes:
    """Return the bytes on the line for a packet whose kind and fields are `body`.

    Raises InputError if it has more than LONGEST_BODY bytes.
    """
    if len(body) > LONGEST_BODY:
        remedy = "send it as several packets"
        raise InputError(f"a packet of {len(body)} bytes: accepted are up to {LONGEST_BODY}", remedy=remedy)
    crc = zlib.crc32(body).to_bytes(CRC_BYTES, "little")
    return DELIMITER + cobs_encode(body + crc) + DELIMITER


def from_line(piece: bytes) -> bytes | None:
    """Return kind and fields of what came between two delimiters; None if it is no packet, or a broken one."""
    if len(piece) > LONGEST_ON_LINE - 2:
        return None
    data = cobs_decode(piece)
    if data is None or len(data) <= CRC_BYTES:
        return None
    body = data[:-CRC_BYTES]
    return body if zlib.crc32(body) == int.from_bytes(data[-CRC_BYTES:], "little") else None


def most_on_line(body_bytes: int) -> int:
    """Return the most bytes that a packet with so many bytes of kind and fields takes on the line."""
    data = body_bytes + CRC_BYTES
    return data + -(-data // RUN) + 2
