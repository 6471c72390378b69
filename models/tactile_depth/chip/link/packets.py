# SPDX-License-Identifier: Apache-2.0
"""Packets of the link: kind and fields of each as bytes, and the packets on a line. docs/link.md has the tables.

Numbers are little-endian. A packet is a named tuple; `pack` gives its kind and fields, `to_line` its bytes on a
line, and `PacketReader` the packets of a line.
"""

from __future__ import annotations

from collections.abc import Callable, Collection
from enum import IntEnum
from struct import Struct, error
from typing import Final, NamedTuple, TypeAlias

from tactile_depth.base.errors import InputError
from tactile_depth.chip.contact.contact_events import WORD_BITS, WORDS, Record, record
from tactile_depth.chip.link.depth_formats import DepthFormat
from tactile_depth.chip.link.framing import DELIMITER, LONGEST_ON_LINE, from_line

VERSION: Final = 2
OTHER_VERSION: Final = "install a version of tactile-depth that knows it, or update the device"
MOST_ACCESSES: Final = 128  # of registers, in a packet
LARGEST_GRID: Final = 4096  # rows and columns
LARGEST_SHIFT: Final = 16


class Kind(IntEnum):
    """First byte of a packet; 0x80 and more come from the device."""

    ASK = 0x01
    SELECT = 0x02
    READ = 0x03
    WRITE = 0x04
    PICTURE = 0x05
    STATUS = 0x81
    READ_REPLY = 0x83
    WRITE_REPLY = 0x84
    DEPTH = 0x90  # plus the DepthFormat
    TRAILER = 0x98
    RECORD = 0x99


TO_DEVICE: Final = (Kind.ASK, Kind.SELECT, Kind.READ, Kind.WRITE, Kind.PICTURE)
SELECT: Final = Struct("<BBB")  # kind, format, shift
REQUEST: Final = Struct("<BB")  # kind, number of the request
ADDRESS: Final = Struct("<H")
VALUE: Final = Struct("<I")
ADDRESS_VALUE: Final = Struct("<HI")
REPLY: Final = Struct("<BBB")  # kind, request, accesses done
PICTURE_HEADER: Final = Struct("<BIHH")  # kind, number, row, first column
STATUS: Final = Struct("<BBHHHBBBBIII")
DEPTH_HEADER: Final = Struct("<BIHH")  # kind, number, row, first column
TRAILER: Final = Struct(f"<BIHBBHHBI{WORDS}I")
RECORD: Final = Struct(f"<B{WORDS}I")
PIXEL_BYTES: Final = 3
MOST_PIXELS: Final = 256  # in a packet
BOTTOM_FIRST, SENDING = 1, 2  # bits of flags


class Ask(NamedTuple):
    """Request of a status; the device forgets the number of the last request."""

    def pack(self) -> bytes:
        """Return kind and fields."""
        return bytes((Kind.ASK,))


class Select(NamedTuple):
    """Choice of the depth format from the next frame on; the reply is a status.

    Attributes
    ----------
    depth_format : DepthFormat
    shift : int
        Bits that the 16-bit formats drop, 0 to 16.
    """

    depth_format: DepthFormat
    shift: int

    def pack(self) -> bytes:
        """Return kind and fields."""
        return SELECT.pack(Kind.SELECT, *self)


class Read(NamedTuple):
    """Register reads, in order.

    Attributes
    ----------
    request : int
        Number of the request, 0 to 255, other than that of the request before.
    addresses : tuple of int
        1 to MOST_ACCESSES byte addresses.
    """

    request: int
    addresses: tuple[int, ...]

    def pack(self) -> bytes:
        """Return kind and fields. Raises InputError for no access or too many."""
        _check_count(len(self.addresses))
        return REQUEST.pack(Kind.READ, self.request) + b"".join(map(ADDRESS.pack, self.addresses))


class Write(NamedTuple):
    """Register writes, in order.

    Attributes
    ----------
    request : int
        Number of the request, 0 to 255, other than that of the request before.
    pairs : tuple of (int, int)
        1 to MOST_ACCESSES byte addresses, each with a value of 32 bits, unsigned.
    """

    request: int
    pairs: tuple[tuple[int, int], ...]

    def pack(self) -> bytes:
        """Return kind and fields. Raises InputError for no access or too many."""
        _check_count(len(self.pairs))
        return REQUEST.pack(Kind.WRITE, self.request) + b"".join(ADDRESS_VALUE.pack(*pair) for pair in self.pairs)


class Picture(NamedTuple):
    """Pixels of a picture, in raster order from a position on.

    Attributes
    ----------
    number : int
        Number of the picture, 32 bits; each picture has another than the one before.
    row, column : int
        Position of the first pixel.
    pixels : bytes
        Red, green and blue of 1 to MOST_PIXELS pixels.
    """

    number: int
    row: int
    column: int
    pixels: bytes

    def pack(self) -> bytes:
        """Return kind and fields."""
        return PICTURE_HEADER.pack(Kind.PICTURE, *self[:3]) + self.pixels


class Status(NamedTuple):
    """State of the device.

    Attributes
    ----------
    resets : int
        Resets since power-up, modulo 2^16; a reset does not clear it.
    rows, columns : int
        The grid.
    data_width : int
        Bits of a depth code.
    bottom_first : bool
        The bottom row of the picture leaves first.
    sending : bool
        Frame `sent` is not yet complete.
    depth_format : DepthFormat
    shift : int
        Bits that the 16-bit formats drop.
    sent : int
        Number of the last depth frame that the device began to send, modulo 2^32; a reset does not clear it.
    skipped : int
        Depth frames since the reset that a newer one replaced before they were sent.
    bad_packets : int
        Pieces since the reset that the device received and could not use.
    """

    resets: int
    rows: int
    columns: int
    data_width: int
    bottom_first: bool
    sending: bool
    depth_format: DepthFormat
    shift: int
    sent: int
    skipped: int
    bad_packets: int

    @property
    def shape(self) -> tuple[int, int, int, bool]:
        """Rows, columns, bits of a depth code, and True where the bottom row leaves first."""
        return self.rows, self.columns, self.data_width, self.bottom_first

    def pack(self) -> bytes:
        """Return kind and fields."""
        flags = BOTTOM_FIRST * self.bottom_first | SENDING * self.sending
        return STATUS.pack(Kind.STATUS, VERSION, *self[:4], flags, *self[6:])


class ReadReply(NamedTuple):
    """Values of register reads; fewer than requested if one was refused, which ended the request."""

    request: int
    values: tuple[int, ...]

    def pack(self) -> bytes:
        """Return kind and fields."""
        return REPLY.pack(Kind.READ_REPLY, self.request, len(self.values)) + b"".join(map(VALUE.pack, self.values))


class WriteReply(NamedTuple):
    """Number of register writes done; fewer than requested if one was refused, which ended the request."""

    request: int
    done: int

    def pack(self) -> bytes:
        """Return kind and fields."""
        return REPLY.pack(Kind.WRITE_REPLY, *self)


class Depth(NamedTuple):
    """Depth values of a frame, from a position on, in the order in which they leave.

    Attributes
    ----------
    depth_format : DepthFormat
    number : int
        Number of the frame on the link.
    row, column : int
        Position of the first value; rows count in the order in which they leave.
    values : bytes
        Little-endian words.
    """

    depth_format: DepthFormat
    number: int
    row: int
    column: int
    values: bytes

    def pack(self) -> bytes:
        """Return kind and fields."""
        return DEPTH_HEADER.pack(Kind.DEPTH + self.depth_format, *self[1:4]) + self.values


class Trailer(NamedTuple):
    """End of a depth frame.

    Attributes
    ----------
    number : int
        Number of the frame on the link, modulo 2^32: 1 for the first frame after power-up. A reset does not clear it.
    resets : int
        As in `Status`.
    depth_format : DepthFormat
    shift : int
        Depth code = value * 2^shift.
    rows, columns : int
        Values that were sent.
    bottom_first : bool
    crc : int
        CRC-32 over the bytes of all values.
    record : Record
        The contact record, with the frame's number and time in the pipeline.
    """

    number: int
    resets: int
    depth_format: DepthFormat
    shift: int
    rows: int
    columns: int
    bottom_first: bool
    crc: int
    record: Record

    def pack(self) -> bytes:
        """Return kind and fields."""
        return TRAILER.pack(*(Kind.TRAILER, *self[:6], BOTTOM_FIRST * self.bottom_first, self.crc), *self.record.words)


class RecordPacket(NamedTuple):
    """The contact record of a frame, whether its depth is sent or not."""

    record: Record

    def pack(self) -> bytes:
        """Return kind and fields."""
        return RECORD.pack(Kind.RECORD, *self.record.words)


Packet: TypeAlias = (
    Ask | Select | Read | Write | Picture | Status | ReadReply | WriteReply | Depth | Trailer | RecordPacket
)


def _check_count(count: int) -> None:
    if not 1 <= count <= MOST_ACCESSES:
        remedy = "use several packets"
        raise InputError(f"{count} register accesses in a packet", accepted=range(1, MOST_ACCESSES + 1), remedy=remedy)


# Decoders raise ValueError or struct.error for a length or a field that is wrong.


def _require(is_right: bool) -> None:
    if not is_right:
        raise ValueError


def _require_accesses(body: bytes, size: int) -> None:
    _require(1 <= (len(body) - REQUEST.size) / size <= MOST_ACCESSES)


def _ask(body: bytes) -> Packet:
    _require(len(body) == 1)
    return Ask()


def _select(body: bytes) -> Packet:
    _, depth_format, shift = SELECT.unpack(body)
    _require(shift <= LARGEST_SHIFT)
    return Select(DepthFormat(depth_format), shift)


def _read(body: bytes) -> Packet:
    _require_accesses(body, ADDRESS.size)
    return Read(body[1], tuple(address for (address,) in ADDRESS.iter_unpack(body[REQUEST.size :])))


def _write(body: bytes) -> Packet:
    _require_accesses(body, ADDRESS_VALUE.size)
    return Write(body[1], tuple(ADDRESS_VALUE.iter_unpack(body[REQUEST.size :])))


def _picture(body: bytes) -> Packet:
    pixels, rest = divmod(len(body) - PICTURE_HEADER.size, PIXEL_BYTES)
    _require(not rest and 1 <= pixels <= MOST_PIXELS)
    _, number, row, column = PICTURE_HEADER.unpack_from(body)
    return Picture(number, row, column, body[PICTURE_HEADER.size :])


def _status(body: bytes) -> Packet:
    version = body[1] if len(body) > 1 else VERSION
    if version != VERSION:
        problem = f"the device speaks version {version} of the link"
        raise InputError(problem, accepted=str(VERSION), remedy=OTHER_VERSION)
    _, _, resets, rows, columns, width, flags, depth_format, *others = STATUS.unpack(body)
    _require(1 <= rows <= LARGEST_GRID and 1 <= columns <= LARGEST_GRID and 1 <= width <= WORD_BITS)
    signs = bool(flags & BOTTOM_FIRST), bool(flags & SENDING)
    return Status(resets, rows, columns, width, *signs, DepthFormat(depth_format), *others)


def _read_reply(body: bytes) -> Packet:
    _, request, count = REPLY.unpack_from(body)
    values = tuple(value for (value,) in VALUE.iter_unpack(body[REPLY.size :]))
    _require(len(values) == count)
    return ReadReply(request, values)


def _write_reply(body: bytes) -> Packet:
    return WriteReply(*REPLY.unpack(body)[1:])


def _depth(body: bytes) -> Packet:
    kind, number, row, column = DEPTH_HEADER.unpack_from(body)
    _require(len(body) > DEPTH_HEADER.size)
    return Depth(DepthFormat(kind - Kind.DEPTH), number, row, column, body[DEPTH_HEADER.size :])


def _trailer(body: bytes) -> Packet:
    _, number, resets, depth_format, shift, rows, columns, flags, crc, *words = TRAILER.unpack(body)
    _require(shift <= LARGEST_SHIFT)
    bottom_first = bool(flags & BOTTOM_FIRST)
    return Trailer(number, resets, DepthFormat(depth_format), shift, rows, columns, bottom_first, crc, record(words))


def _record(body: bytes) -> Packet:
    return RecordPacket(record(RECORD.unpack(body)[1:]))


_DECODERS: Final[dict[int, Callable[[bytes], Packet]]] = {
    Kind.ASK: _ask,
    Kind.SELECT: _select,
    Kind.READ: _read,
    Kind.WRITE: _write,
    Kind.PICTURE: _picture,
    Kind.STATUS: _status,
    Kind.READ_REPLY: _read_reply,
    Kind.WRITE_REPLY: _write_reply,
    **{Kind.DEPTH + depth_format: _depth for depth_format in DepthFormat if depth_format},
    Kind.TRAILER: _trailer,
    Kind.RECORD: _record,
}


def unpack(body: bytes) -> Packet | None:
    """Return the packet of a known kind; None if its length or a field is wrong.

    Raises KeyError for an unknown kind, and InputError for the status of another version of the protocol.
    """
    decode = _DECODERS[body[0]]
    try:
        return decode(body)
    except InputError:
        raise
    except (ValueError, error):
        return None


class PacketReader:
    """Packets of a line, whose bytes come in parts. It holds at most the bytes of one packet.

    Parameters
    ----------
    kinds : collection of int
        Kinds that are known; by default all.

    Attributes
    ----------
    bad_packets : int
        Pieces between delimiters whose COBS, CRC, length or fields are wrong, or that are too long.
    unknown_packets : int
        Packets of an unknown kind, which are skipped.
    """

    def __init__(self, kinds: Collection[int] = tuple(_DECODERS)) -> None:
        self._kinds = frozenset(kinds)
        self.bad_packets = 0
        self.unknown_packets = 0
        self._rest = b""
        self._skips = True  # up to the next delimiter

    def feed(self, data: bytes) -> list[Packet]:
        """Return the packets that are complete with these bytes of the line.

        Bytes before the first delimiter are dropped. Raises InputError for the status of another version of the
        protocol; `data` is then dropped.
        """
        pieces = (self._rest + data).split(DELIMITER)
        rest, self._rest = pieces.pop(), b""
        if self._skips and pieces:
            self._skips = False
            del pieces[0]
        if len(rest) > LONGEST_ON_LINE - len(2 * DELIMITER):
            self.bad_packets += not self._skips
            self._skips = True
        if not self._skips:
            self._rest = rest
        return [packet for piece in pieces if piece and (packet := self._packet(piece)) is not None]

    def _packet(self, piece: bytes) -> Packet | None:
        body = from_line(piece)
        if body is not None and body[0] not in self._kinds:
            self.unknown_packets += 1
            return None
        packet = None if body is None else unpack(body)
        self.bad_packets += packet is None
        return packet
