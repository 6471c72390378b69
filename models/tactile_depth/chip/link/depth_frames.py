# SPDX-License-Identifier: Apache-2.0
"""Depth frames from the packets of a link: a frame is delivered whole, or counted as lost."""

from __future__ import annotations

import zlib
from dataclasses import dataclass

import numpy as np

from tactile_depth.base.by_value import ByValue
from tactile_depth.base.npy import Codes
from tactile_depth.chip.contact.contact_events import Record
from tactile_depth.chip.link.depth_formats import DepthFormat, from_bytes, sent_shape, value_bytes
from tactile_depth.chip.link.packets import Depth, Packet, PacketReader, Status, Trailer

NUMBERS = 1 << 32  # of frames; they wrap
RESETS = 1 << 16


@dataclass(frozen=True, eq=False)
class DepthFrame(ByValue):
    """A depth frame of a device.

    Attributes
    ----------
    codes : int32 array (rows, columns)
        Depth codes, rows in the order of the picture. With the averaged format half as many rows and columns as the
        grid has.
    depth_format : DepthFormat
    shift : int
        The codes are multiples of 2^shift, which the 16-bit formats round to.
    number : int
        Number of the frame on the link, modulo 2^32.
    resets : int
        Resets of the device since its power-up, modulo 2^16.
    record : Record
        The contact record, with the frame's number and time in the pipeline.
    """

    codes: Codes
    depth_format: DepthFormat
    shift: int
    number: int
    resets: int
    record: Record


class DepthFrames:
    """Assembles depth frames from the bytes of a link, which keeps their order.

    It delivers nothing before a status: ask for one. It holds at most one packet and one frame.

    Attributes
    ----------
    reader : PacketReader
        With counts of bad and unknown packets.
    status : Status or None
        The last one.
    delivered, lost : int
        Frames since the first status. A frame is lost if the device began to send it and a part of it did not come. It
        is counted when a later packet of a frame, or a status, comes.
    resets : int
        Resets and power-ups of the device since the first status.
    """

    def __init__(self) -> None:
        self.reader = PacketReader()
        self.status: Status | None = None
        self.delivered = 0
        self.lost = 0
        self.resets = 0
        self._done = 0  # number of the last frame that is delivered or lost
        self._last_resets = 0
        self._restart(DepthFormat.NONE)

    def feed(self, data: bytes) -> list[DepthFrame]:
        """Return the frames that are complete with these bytes of the line.

        Raises InputError for the status of another version of the protocol.
        """
        return [frame for packet in self.reader.feed(data) if (frame := self.take(packet)) is not None]

    def take(self, packet: Packet) -> DepthFrame | None:
        """Return the frame that is complete with this packet. Packets of other kinds are ignored."""
        if isinstance(packet, Depth):
            self._take_depth(packet)
        elif isinstance(packet, Trailer):
            return self._take_trailer(packet)
        elif isinstance(packet, Status):
            self._take_status(packet)
        return None

    def _take_status(self, status: Status) -> None:
        # A status that waits while a trailer leaves says that the trailer's frame is being sent.
        is_old = status.sending and status.sent == self._done
        done = status.sent if is_old else (status.sent - status.sending) % NUMBERS
        if self.status is None:
            self._done, self._last_resets = done, status.resets
            self._restart(DepthFormat.NONE)
        elif self.status.shape != status.shape:
            self._restart(DepthFormat.NONE)
        self.status = status
        self._count_resets(status.resets)
        self._account(done)

    def _take_depth(self, packet: Depth) -> None:
        if self.status is None or not self._is_new(packet.number):
            return
        if self._format == DepthFormat.NONE:
            self._restart(packet.depth_format)
        columns = sent_shape(packet.depth_format, self.status.rows, self.status.columns)[1]
        size = value_bytes(packet.depth_format, self.status.shape[2])
        first = (packet.row * columns + packet.column) * size
        if (
            packet.depth_format == self._format
            and first == len(self._values)
            and first + len(packet.values) <= self._size
        ):
            self._values += packet.values

    def _take_trailer(self, trailer: Trailer) -> DepthFrame | None:
        if self.status is None or not self._is_new(trailer.number):
            return None
        self._count_resets(trailer.resets)
        self._done = trailer.number
        values, status = bytes(self._values), self.status
        matches = (
            self._begun
            and trailer.depth_format == self._format
            and (trailer.rows, trailer.columns) == sent_shape(self._format, status.rows, status.columns)
            and trailer.bottom_first == status.bottom_first
            and len(values) == self._size
            and zlib.crc32(values) == trailer.crc
        )
        self._restart(DepthFormat.NONE)
        if not matches:
            self.lost += 1
            return None
        self.delivered += 1
        codes = from_bytes(values, value_bytes(trailer.depth_format, status.data_width))
        codes = codes.reshape(trailer.rows, trailer.columns) << trailer.shift
        codes = np.ascontiguousarray(codes[::-1]) if trailer.bottom_first else codes
        return DepthFrame(codes, trailer.depth_format, trailer.shift, trailer.number, trailer.resets, trailer.record)

    def _restart(self, depth_format: DepthFormat) -> None:
        """Begin a frame of this format; NONE: of the format of its first packet."""
        self._format = depth_format
        self._values = bytearray()
        self._size = 0
        if self.status is not None and depth_format != DepthFormat.NONE:
            rows, columns = sent_shape(depth_format, self.status.rows, self.status.columns)
            self._size = rows * columns * value_bytes(depth_format, self.status.data_width)

    def _is_new(self, number: int) -> bool:
        """Return False for the frame that was delivered or lost last; frames between it and this one are lost."""
        if number == self._done:
            return False
        self._account((number - 1) % NUMBERS)
        return True

    def _account(self, done: int) -> None:
        """Count frames up to this number as lost, as far as they are neither delivered nor lost."""
        more = (done - self._done) % NUMBERS
        if not more:
            return
        back = more >= NUMBERS // 2  # the device was powered up again: only the frame that was begun is known
        self.lost += self._begun if back else more
        self.resets += back
        self._done = done
        self._restart(DepthFormat.NONE)

    @property
    def _begun(self) -> bool:
        return self._format != DepthFormat.NONE

    def _count_resets(self, resets: int) -> None:
        more = (resets - self._last_resets) % RESETS
        self.resets += more if more < RESETS // 2 else 0
        self._last_resets = resets
