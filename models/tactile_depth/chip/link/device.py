# SPDX-License-Identifier: Apache-2.0
"""Model of the device's side of the link: bytes of a host to register accesses and pixels; packets out, in order."""

from __future__ import annotations

import zlib
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

from tactile_depth.base.npy import Codes
from tactile_depth.chip.contact.contact_events import Record
from tactile_depth.chip.link.depth_formats import (
    VALUES_A_PACKET,
    DepthFormat,
    exact_shift,
    sent_shape,
    to_bytes,
    value_bytes,
)
from tactile_depth.chip.link.framing import to_line
from tactile_depth.chip.link.packets import (
    PIXEL_BYTES,
    TO_DEVICE,
    Ask,
    Depth,
    Packet,
    PacketReader,
    Picture,
    Read,
    ReadReply,
    RecordPacket,
    Select,
    Status,
    Trailer,
    Write,
    WriteReply,
)
from tactile_depth.chip.video.frame_guard import Word


@dataclass(frozen=True)
class Build:
    """Properties of a pipeline that the link depends on.

    Attributes
    ----------
    rows, columns : int
        The grid.
    data_width : int
        Bits of a depth code.
    bottom_first : bool
        The bottom row of the picture leaves first, as with the tridiagonal solver.
    """

    rows: int
    columns: int
    data_width: int
    bottom_first: bool


class _Frame(NamedTuple):
    """The frame that is being sent."""

    number: int
    depth_format: DepthFormat
    shift: int
    values: bytes
    record: Record


class LinkDevice:
    """The device's side of the link.

    Parameters
    ----------
    build : Build
    read : function of a byte address
        Reads a register: its value, or None if the access is refused.
    write : function of a byte address and a value
        Writes a register: False if the access is refused.

    Attributes
    ----------
    resets, sent, skipped : int
        As in `Status`.
    pixels : list of Word
        Words for `s_axis` from the pictures of the host. Whoever takes words removes them.
    """

    def __init__(self, build: Build, read: Callable[[int], int | None], write: Callable[[int, int], bool]) -> None:
        self.build = build
        self.resets = 0
        self.sent = 0
        self._read, self._write = read, write
        self._clear()

    def _clear(self) -> None:
        self._reader = PacketReader(TO_DEVICE)
        self._depth_format = DepthFormat.WORDS
        self._shift = exact_shift(self.build.data_width)
        self._status_due = True
        self._reply: ReadReply | WriteReply | None = None  # to the last request, unless forgotten
        self._replies: list[ReadReply | WriteReply] = []  # to be sent
        self._record: Record | None = None  # to be sent
        self._depth_is_next = False
        self._waiting: tuple[Codes, Record] | None = None  # the newest frame
        self._frame: _Frame | None = None
        self._position = 0  # of the next value of the frame
        self._picture: tuple[int, int, int] | None = None  # its number, and its next row and column
        self.pixels: list[Word] = []
        self.skipped = 0

    def reset(self) -> None:
        """Take a reset: everything is cleared but the numbers of resets and of frames; a status is due."""
        self.resets = (self.resets + 1) % (1 << 16)
        self._clear()

    # Frames in.

    def offer(self, codes: Codes, record: Record) -> None:
        """Take a whole frame of the pipeline. It replaces the frame, and the record, that still wait.

        Parameters
        ----------
        codes : int32 array (rows, columns)
            Depth codes, in the order in which rows leave.
        record : Record
        """
        self._record = record
        if self._depth_format != DepthFormat.NONE:
            self.skipped += self._waiting is not None
            self._waiting = codes, record

    # Bytes in.

    def receive(self, data: bytes) -> None:
        """Take bytes of the host."""
        for packet in self._reader.feed(data):
            self._take(packet)

    def _take(self, packet: Packet) -> None:
        if isinstance(packet, Ask):
            self._status_due, self._reply = True, None
        elif isinstance(packet, Select):
            self._depth_format, self._shift, self._status_due = packet.depth_format, packet.shift, True
            if packet.depth_format == DepthFormat.NONE:
                self._waiting = None
        elif isinstance(packet, Read | Write):
            kind = ReadReply if isinstance(packet, Read) else WriteReply
            reply = self._reply
            if not isinstance(reply, kind) or reply.request != packet.request:
                reply = self._reply = self._access(packet)
            self._replies.append(reply)
        elif isinstance(packet, Picture):
            self._take_pixels(packet)

    def _access(self, packet: Read | Write) -> ReadReply | WriteReply:
        if isinstance(packet, Write):
            done = 0
            while done < len(packet.pairs) and self._write(*packet.pairs[done]):
                done += 1
            return WriteReply(packet.request, done)
        values: list[int] = []
        for address in packet.addresses:
            value = self._read(address)
            if value is None:
                break
            values.append(value)
        return ReadReply(packet.request, tuple(values))

    def _take_pixels(self, packet: Picture) -> None:
        """Take the pixels if they begin a picture or continue the one that comes; after a loss wait for the next.

        Pixels behind the end of the picture are dropped.
        """
        rows, columns, count = self.build.rows, self.build.columns, len(packet.pixels) // PIXEL_BYTES
        begins = packet.row == packet.column == 0
        if not begins and self._picture != (packet.number, packet.row, packet.column):
            return
        first = packet.row * columns + packet.column
        end = min(first + count, rows * columns)
        for index in range(first, end):
            red, green, blue = packet.pixels[PIXEL_BYTES * (index - first) :][:PIXEL_BYTES]
            self.pixels.append(
                Word(red << 16 | blue << 8 | green, int(index % columns == columns - 1), int(index == 0))
            )
        self._picture = packet.number, *divmod(end, columns)

    # Bytes out.

    def next_packet(self) -> bytes:
        """Return the bytes of the next packet on the line, none if nothing is to be sent.

        Status and replies go first, then records, then depth. Behind a record depth goes before the next record.
        """
        packet = self._next()
        return b"" if packet is None else to_line(packet.pack())

    def _next(self) -> Packet | None:
        if self._status_due:
            self._status_due = False
            return self.status()
        if self._replies:
            return self._replies.pop(0)
        depth_due = self._frame is not None or self._waiting is not None
        if self._record is not None and not (self._depth_is_next and depth_due):
            packet, self._record, self._depth_is_next = RecordPacket(self._record), None, True
            return packet
        self._depth_is_next = False
        return self._next_of_depth()

    def status(self) -> Status:
        """Return the status as it is now."""
        build, sending = self.build, self._frame is not None
        return Status(
            *(self.resets, build.rows, build.columns, build.data_width, build.bottom_first, sending),
            *(self._depth_format, self._shift, self.sent, self.skipped, self._reader.bad_packets),
        )

    def _next_of_depth(self) -> Packet | None:
        if self._frame is None:
            if self._waiting is None:
                return None
            self._begin(*self._waiting)
        frame, build = self._frame, self.build
        assert frame is not None
        rows, columns = sent_shape(frame.depth_format, build.rows, build.columns)
        size = value_bytes(frame.depth_format, build.data_width)
        if self._position < rows * columns:
            values = frame.values[self._position * size :][: VALUES_A_PACKET * size]
            position = divmod(self._position, columns)
            self._position += VALUES_A_PACKET
            return Depth(frame.depth_format, frame.number, *position, values)
        self._frame = None
        crc = zlib.crc32(frame.values)
        shape = frame.depth_format, frame.shift, rows, columns
        return Trailer(frame.number, self.resets, *shape, build.bottom_first, crc, frame.record)

    def _begin(self, codes: Codes, record: Record) -> None:
        depth_format, width = self._depth_format, self.build.data_width
        self.sent = (self.sent + 1) % (1 << 32)
        shift = 0 if depth_format == DepthFormat.WORDS else self._shift
        values = to_bytes(codes, depth_format, width, shift)
        self._frame = _Frame(self.sent, depth_format, shift, values, record)
        self._position, self._waiting = 0, None
