# SPDX-License-Identifier: Apache-2.0
"""Cycle-accurate model of hdl/link/packet_check.sv."""

from __future__ import annotations

import zlib
from dataclasses import dataclass, field
from typing import NamedTuple

from tactile_depth.chip.link.framing import CRC_BYTES


class Checked(NamedTuple):
    """Outputs of the check in a clock: a byte, or the end of a packet, or nothing.

    Attributes
    ----------
    byte : int or None
    ends, good : bool
        A packet ends; it is good.
    """

    byte: int | None = None
    ends: bool = False
    good: bool = False


@dataclass
class PacketCheck:
    """State of the check between two clock edges.

    Attributes
    ----------
    packet : bytearray
        Bytes of the packet that came.
    """

    packet: bytearray = field(default_factory=bytearray)

    def clock(self, data: int | None, ends: bool = False, bad: bool = False) -> Checked:
        """Advance by one clock edge and return the outputs behind it.

        `data` is the byte that came, None for none; `ends` and `bad` are of the packet.
        """
        if ends:
            body, crc = self.packet[:-CRC_BYTES], self.packet[-CRC_BYTES:]
            good = not bad and len(body) > 0 and zlib.crc32(body) == int.from_bytes(crc, "little")
            self.packet.clear()
            return Checked(ends=True, good=good)
        if data is None:
            return Checked()
        self.packet.append(data)
        return Checked(self.packet[-CRC_BYTES - 1] if len(self.packet) > CRC_BYTES else None)

    def reset(self) -> None:
        """Advance by one clock edge in reset."""
        self.packet.clear()
