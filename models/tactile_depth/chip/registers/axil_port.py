# SPDX-License-Identifier: Apache-2.0
"""Cycle-accurate model of hdl/registers/axil_port.sv: an AXI4-Lite port with one write and one read in flight."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import IntEnum

from tactile_depth.chip.registers.register_map import WORD_BITS

BYTES = WORD_BITS // 8
LATE_CLOCKS = 4
"""Clocks from the address of a read to its late answer."""


class Response(IntEnum):
    """AXI responses (IHI 0022, table A3-4) that the registers use."""

    OKAY = 0
    SLVERR = 2


def strobed_bits(strobe: int) -> int:
    """Return a mask of the bits of a word whose bytes are strobed."""
    return sum(0xFF << 8 * byte for byte in range(BYTES) if strobe >> byte & 1)


def response(refused: int) -> Response:
    """Return the response of an access."""
    return Response.SLVERR if refused else Response.OKAY


def offset_of(address: int) -> int:
    """Return the offset of the register with this byte address."""
    return address & ~(BYTES - 1)


@dataclass
class AxilPort:
    """Transactions in flight.

    Attributes
    ----------
    address, data : int, (int, int)
        Offset of the latest write whose address was taken; latest word taken, 0 in bytes without strobe, and the mask
        of its bytes. None before the first.
    address_held, data_held : bool
        True while that transaction is under way.
    written : Response or None
        Response of the write, while it waits for its ready.
    answer : (int, Response) or None
        Data and response of the read, while they wait for their ready.
    asked : int or None
        Offset of the latest read whose address was taken, None before the first.
    reads : bool
        True in the cycle behind that in which it was taken: it is looked up in this one.
    late : int
        Cycles until the late answer of a read; 0: none is under way.
    """

    address: int | None = None
    data: tuple[int, int] | None = None
    address_held: bool = False
    data_held: bool = False
    written: Response | None = None
    answer: tuple[int, Response] | None = None
    asked: int | None = None
    reads: bool = False
    late: int = 0

    def outputs(self, rst: int) -> dict[str, int | None]:
        """Return the outputs in this cycle, None where one does not count.

        A write that takes effect may be in the first cycle of a reset.
        """
        ones, mask = self.data or (None, None)
        rdata, rresp = self.answer or (None, None)
        busy = self.answer is not None or self.reads or self.late
        return {
            "s_axil_awready": not (self.address_held or rst),
            "s_axil_wready": not (self.data_held or rst),
            "s_axil_bvalid": self.written is not None,
            "s_axil_bresp": self.written,
            "s_axil_arready": not (busy or rst),
            "s_axil_rvalid": self.answer is not None,
            "s_axil_rdata": rdata,
            "s_axil_rresp": rresp,
            "write": self.address_held and self.data_held and self.written is None and not (self.reads or self.late),
            "write_offset": self.address,
            "write_ones": ones,
            "write_mask": mask,
            "read": self.reads,
            "read_offset": self.asked,
        }

    def advance(self, pins: Mapping[str, int]) -> None:
        """Advance by one clock edge with these inputs."""
        out = self.outputs(pins["rst"])
        if pins["s_axil_rready"]:
            self.answer = None
        if self.late == 1:
            self.answer = pins["late_data"], response(pins["late_refused"])
        self.late = max(0, self.late - 1)
        if out["read"] and pins["read_late"]:
            self.late = LATE_CLOCKS
        elif out["read"]:
            self.answer = pins["read_data"], response(pins["read_refused"])
        if out["write"]:
            self.written = response(pins["write_refused"])
        elif self.written is not None and pins["s_axil_bready"]:
            self.address_held, self.data_held, self.written = False, False, None
        if out["s_axil_awready"] and pins["s_axil_awvalid"]:
            self.address, self.address_held = offset_of(pins["s_axil_awaddr"]), True
        if out["s_axil_wready"] and pins["s_axil_wvalid"]:
            mask = strobed_bits(pins["s_axil_wstrb"])
            self.data, self.data_held = (pins["s_axil_wdata"] & mask, mask), True
        self.reads = bool(out["s_axil_arready"] and pins["s_axil_arvalid"])
        if self.reads:
            self.asked = offset_of(pins["s_axil_araddr"])
        if pins["rst"]:
            self.address_held, self.data_held, self.written, self.answer, self.late = False, False, None, None, 0

    def clock(self, **pins: int) -> dict[str, int | None]:
        """Advance by one clock edge; return the outputs before it."""
        out = self.outputs(pins["rst"])
        self.advance(pins)
        return out
