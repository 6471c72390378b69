# SPDX-License-Identifier: Apache-2.0
"""Model of boards/ulx3s/serial_link.sv, and the packets of bytes that a host sends and reads on a serial line."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from tactile_depth.video.frame_guard import Word

END, ESCAPE, ESCAPED_END, ESCAPED_ESCAPE = 0xC0, 0xDB, 0xDC, 0xDD  # RFC 1055
ESCAPES = {END: (ESCAPE, ESCAPED_END), ESCAPE: (ESCAPE, ESCAPED_ESCAPE)}
FRAME, WRITE = 1, 2  # first byte of a packet to the board
WORD_BYTES = 4
COLOURS = 3


def packet(content: Iterable[int]) -> bytes:
    """Return the bytes on the line for a packet, with an END byte before and after it."""
    escaped = (part for byte in content for part in ESCAPES.get(byte, (byte,)))
    return bytes((END, *escaped, END))


def frame_packet(pixels: NDArray[np.uint8]) -> bytes:
    """Return the bytes that send a frame of uint8 RGB pixels (rows, columns, 3)."""
    return packet((FRAME, *pixels.tobytes()))


def write_packet(address: int, value: int) -> bytes:
    """Return the bytes that write a 32-bit register at a byte address, a multiple of 4 below 1024."""
    return packet((WRITE, address // WORD_BYTES, *(value % (1 << 32)).to_bytes(WORD_BYTES, "little")))


def _unescaped(line: Iterable[int | None]) -> Iterator[int | bool]:
    """Yield the bytes of packets, True where a packet ends, and False where a packet breaks.

    Nothing is yielded between a break and the next END byte.
    """
    good, escaped = False, False
    for byte in line:
        if byte == END:
            yield True
            good, escaped = True, False
        elif good and (byte is None or (escaped and byte not in (ESCAPED_END, ESCAPED_ESCAPE))):
            yield False
            good = False
        elif good and not escaped and byte == ESCAPE:
            escaped = True
        elif good and byte is not None:
            yield byte if not escaped else END if byte == ESCAPED_END else ESCAPE
            escaped = False


def packets(line: Iterable[int | None]) -> list[bytes]:
    """Return the contents of the complete packets on a line without empty ones; None stands for a broken byte."""
    found: list[bytes] = []
    content: list[int] = []
    for byte in _unescaped(line):
        if byte is True and content:
            found.append(bytes(content))
        if isinstance(byte, bool):
            content = []
        else:
            content.append(byte)
    return found


def words_of(content: bytes) -> tuple[int, ...]:
    """Return the words of a packet that the board sends."""
    return tuple(np.frombuffer(content, "<u4").tolist())


@dataclass
class Taken:
    """Pixels and register writes that the board decodes from a line.

    Attributes
    ----------
    pixels : list of Word
        Pixels on the pipeline's input.
    writes : list of tuple of int
        Address, value, and the number of pixels that came before the write.
    """

    pixels: list[Word] = field(default_factory=list)
    writes: list[tuple[int, int, int]] = field(default_factory=list)


def serial_link(line: Iterable[int | None], columns: int) -> Taken:
    """Decode the bytes on a line as the board does; None stands for a broken byte.

    When a packet breaks, the pixels before the break have already left. They form an incomplete frame.
    """
    taken = Taken()
    content: list[int] = []
    for byte in _unescaped(line):
        if byte is True and len(content) == 2 + WORD_BYTES and content[0] == WRITE:
            taken.writes.append(
                (content[1] * WORD_BYTES, int.from_bytes(bytes(content[2:]), "little"), len(taken.pixels))
            )
        if isinstance(byte, bool):
            content = []
            continue
        content.append(byte)
        place, colour = divmod(len(content) - 2, COLOURS)
        if content[0] == FRAME and place >= 0 and colour == COLOURS - 1:
            red, green, blue = content[-COLOURS:]
            word = red << 16 | blue << 8 | green
            taken.pixels.append(Word(word, int(place % columns == columns - 1), int(place == 0)))
    return taken
