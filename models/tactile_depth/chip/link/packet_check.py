# SPDX-License-Identifier: Apache-2.0
"""Cycle-accurate model of hdl/link/packet_check.sv."""

from __future__ import annotations

import zlib
from dataclasses import dataclass, field
from typing import Final

from tactile_depth.chip.link.framing import CRC_BYTES

NOTHING: Final = {"out_valid": 0, "out_end": 0}  # outputs behind a clock in which nothing came


@dataclass
class PacketCheck:
    """State of the check between two clock edges.

    Attributes
    ----------
    packet : bytearray
        Bytes of the packet that came.
    out : dict
        Outputs, but those that do not count.
    """

    packet: bytearray = field(default_factory=bytearray)
    out: dict[str, int] = field(default_factory=NOTHING.copy)

    def clock(
        self, *, rst: int = 0, in_valid: int = 0, in_data: int = 0, in_end: int = 0, in_bad: int = 0
    ) -> dict[str, int]:
        """Advance by one clock edge; return the outputs before it."""
        out, self.out = self.out, NOTHING.copy()
        if in_end:
            body, crc = self.packet[:-CRC_BYTES], self.packet[-CRC_BYTES:]
            good = not in_bad and len(body) > 0 and zlib.crc32(body) == int.from_bytes(crc, "little")
            self.out |= {"out_end": 1, "out_good": good}
        elif in_valid:
            self.packet.append(in_data)
            if len(self.packet) > CRC_BYTES:
                self.out |= {"out_valid": 1, "out_data": self.packet[-CRC_BYTES - 1]}
        if in_end or rst:
            self.packet.clear()
        if rst:
            self.out = NOTHING.copy()
        return out
