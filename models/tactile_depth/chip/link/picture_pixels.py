# SPDX-License-Identifier: Apache-2.0
"""Cycle-accurate model of hdl/link/picture_pixels.sv."""

from __future__ import annotations

import struct
from dataclasses import dataclass

from tactile_depth.chip.link.packets import PIXEL_BYTES
from tactile_depth.chip.video.frame_guard import Word

HEADER = struct.Struct("<IHH")  # number, row, column


@dataclass
class PicturePixels:
    """State of the core.

    Attributes
    ----------
    packet : bytes
        What came of a packet: of its header, and of the pixel that comes.
    number, place : int
        Of the picture that began, and its next pixel.
    wanted : bool
        The packet begins the picture, or continues it.
    out : Word or None
        The pixel that is offered.
    """

    rows: int
    columns: int
    packet: bytes = b""
    number: int = 0
    place: int = 0
    wanted: bool = False
    out: Word | None = None

    def __post_init__(self) -> None:
        self.place = self.size

    @property
    def size(self) -> int:
        """Return the number of pixels of a picture."""
        return self.rows * self.columns

    def _take(self, data: int, last: int) -> None:
        self.packet += bytes((data,))
        if len(self.packet) == HEADER.size:
            number, *place = HEADER.unpack(self.packet)
            if place == [0, 0]:
                self.number, self.place = number, 0
            self.wanted = (number, *place) == (self.number, *divmod(self.place, self.columns))
        elif len(self.packet) == HEADER.size + PIXEL_BYTES:
            red, green, blue = self.packet[HEADER.size :]
            self.packet = self.packet[: HEADER.size]
            if self.wanted and self.place < self.size:
                row_ends = self.place % self.columns == self.columns - 1
                self.out = Word(red << 16 | blue << 8 | green, int(row_ends), int(self.place == 0))
                self.place += 1
        if last:
            self.packet = b""

    def clock(self, **pins: int) -> dict[str, int | None]:
        """Advance by one clock edge; return the outputs before it, None where one does not count."""
        data, last, user = self.out or (None, None, None)
        out = {"m_axis_tvalid": self.out is not None, "m_axis_tdata": data, "m_axis_tlast": last, "m_axis_tuser": user}
        out["picture_ready"] = self.out is None
        if self.out is None and pins["picture_valid"]:
            self._take(pins["picture_data"], pins["picture_last"])
        elif pins["m_axis_tready"]:
            self.out = None
        if pins["rst"]:
            self.packet, self.place, self.out = b"", self.size, None
        return out
