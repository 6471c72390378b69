# SPDX-License-Identifier: Apache-2.0
"""Host of a device written from docs/link.md alone: depth frames from the bytes of a line. It imports no package.

Numbers in brackets are the steps of the page's section on a depth frame.
"""

import zlib

ASK = bytes.fromhex("00 06 01 1b df 05 a5 00")
VERSION, WRAP = 2, 1 << 32
STATUS, TRAILER, RECORD, HEAD = 24, 78, 61, 9  # bytes of kind and fields; of a depth packet those before its values


def get(body: bytes, at: int, size: int) -> int:
    return int.from_bytes(body[at : at + size], "little")


def decoded(piece: bytes) -> bytes | None:
    """Return kind and fields of the bytes between two zeros; None if they are bad."""
    out, at = bytearray(), 0
    while at < len(piece):
        code = piece[at]
        if at + code > len(piece) or len(piece) > 1398:
            return None
        out += piece[at + 1 : at + code]
        at += code
        if code != 255 and at < len(piece):
            out.append(0)
    return bytes(out[:-4]) if len(out) >= 5 and zlib.crc32(out) == 0x2144DF1C else None


class PageHost:
    """Depth frames, as rows of values times 2^shift, by number in `frames`; counts of those lost and of bad pieces."""

    def __init__(self) -> None:
        self.piece: bytearray | None = None  # None before the first zero
        self.status: bytes | None = None
        self.frames: list[tuple[int, list[list[int]]]] = []
        self.lost = self.bad = self.done = self.format = 0
        self.values = bytearray()

    def feed(self, data: bytes) -> None:
        for byte in data:
            if byte and self.piece is not None:
                self.piece.append(byte)
            elif not byte:
                piece, self.piece = self.piece, bytearray()
                if piece:
                    self.take(decoded(bytes(piece)))

    def take(self, body: bytes | None) -> None:
        kind = body[0] if body else 0
        sizes = {0x81: STATUS, 0x98: TRAILER, 0x99: RECORD}
        if body is not None and kind == 0x81 and len(body) > 1 and body[1] != VERSION:
            raise ValueError(f"version {body[1]} of the protocol, this host has {VERSION}")
        if body is None or len(body) != sizes.get(kind, len(body)):
            self.bad += 1
        elif kind == 0x81:
            self.take_status(body)
        elif self.status is not None and (0x91 <= kind <= 0x93 or kind == 0x98) and self.is_next(get(body, 1, 4)):
            self.take_trailer(body) if kind == 0x98 else self.take_depth(body)

    def drop(self) -> None:
        self.values, self.format = bytearray(), 0

    def account(self, done: int) -> None:
        """Count the frames between `done` and this number as lost; behind `done` the device was powered up."""
        if done != self.done:
            ahead = (done - self.done) % WRAP
            self.lost += ahead if ahead < WRAP // 2 else bool(self.format)
            self.done = done
            self.drop()

    def take_status(self, body: bytes) -> None:  # 1, 6
        first, before = self.status is None, self.status
        sent = get(body, 12, 4)
        done = (sent - 1) % WRAP if body[9] & 2 and (first or sent != self.done) else sent
        self.status = body
        if before is None:
            self.done = done
        elif (before[4:9], before[9] & 1) != (body[4:9], body[9] & 1):
            self.drop()
        self.account(done)

    def is_next(self, number: int) -> bool:  # 2, 3
        if number == self.done:
            return False
        self.account((number - 1) % WRAP)
        return True

    def shape(self) -> tuple[int, int, int]:
        """Return rows, columns and bytes of the values of the format."""
        assert self.status is not None
        rows, columns, width = get(self.status, 4, 2), get(self.status, 6, 2), self.status[8]
        return {1: (rows, columns, -(-width // 8)), 2: (rows, columns, 2), 3: (rows // 2, columns // 2, 2)}[self.format]

    def take_depth(self, body: bytes) -> None:  # 4
        self.format = self.format or body[0] - 0x90
        rows, columns, size = self.shape()
        at = (get(body, 5, 2) * columns + get(body, 7, 2)) * size
        if body[0] - 0x90 == self.format and at == len(self.values) <= rows * columns * size - len(body) + HEAD:
            self.values += body[HEAD:]

    def take_trailer(self, body: bytes) -> None:  # 5
        number, values, expected = get(body, 1, 4), bytes(self.values), (0, 0, 0)
        if self.format == body[7]:
            expected = self.shape()
        rows, columns, size = get(body, 9, 2), get(body, 11, 2), expected[2]
        assert self.status is not None
        bottom_first = body[13] & 1
        is_whole = (rows, columns) == expected[:2] and len(values) == rows * columns * size
        self.done = number
        self.drop()
        if not is_whole or bottom_first != self.status[9] & 1 or zlib.crc32(values) != get(body, 14, 4):
            self.lost += 1
            return
        flat = [
            int.from_bytes(values[i : i + size], "little", signed=True) << body[8] for i in range(0, len(values), size)
        ]
        frame = [flat[row * columns : (row + 1) * columns] for row in range(rows)]
        self.frames.append((number, frame[::-1] if bottom_first else frame))
