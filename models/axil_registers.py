# SPDX-License-Identifier: Apache-2.0
"""Behavioural model of hdl/axil_registers.sv: what reads return, what writes and events change.

It knows no clock. In one clock a read sees the registers first, then the write takes effect, then the events:
that order is what makes setting win over clearing.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import IntEnum

from models.register_map import REGISTERS, WORD_BITS

WORD = (1 << WORD_BITS) - 1
BYTES = WORD_BITS // 8
BY_OFFSET = {register.offset: register for register in REGISTERS.values()}

STATUS = REGISTERS["STATUS"]
CONTROL = REGISTERS["CONTROL"]
STICKY_EVENTS = tuple(f.name for f in STATUS.fields if f.access == "w1c" and f.name != "saturation")
FRAME_COUNTERS = {"frame_in": "FRAMES_IN", "frame_out": "FRAMES_OUT", "frame_dropped": "FRAMES_DROPPED"}
SATURATIONS = "SATURATIONS"
COUNTERS = (*FRAME_COUNTERS.values(), SATURATIONS)


class Response(IntEnum):
    """AXI responses (IHI 0022, table A3-4), of which these two are given."""

    OKAY = 0
    SLVERR = 2


@dataclass(frozen=True)
class Build:
    """The parameters of hdl/axil_registers.sv."""

    rows: int
    columns: int
    data_width: int
    gradient_width: int
    gradient_fraction: int
    bits_per_channel: int


@dataclass(frozen=True)
class Events:
    """What the pipeline reports in one clock.

    Attributes
    ----------
    flags : frozenset of str
        Names of `STICKY_EVENTS` and keys of `FRAME_COUNTERS`.
    saturations : int
        Values clipped.
    first_depth_latency : int or None
        Reported by the frame whose first depth value leaves.
    """

    flags: frozenset[str] = frozenset()
    saturations: int = 0
    first_depth_latency: int | None = None


def signed(word: int, width: int) -> int:
    """The lowest `width` bits of a word, as two's complement."""
    word &= (1 << width) - 1
    return word - (1 << width) if word >> (width - 1) else word


def strobed_bits(strobe: int) -> int:
    """Ones at the bits of a word whose bytes are strobed."""
    return sum(0xFF << 8 * byte for byte in range(BYTES) if strobe >> byte & 1)


@dataclass
class AxilRegisters:
    """The registers of one build.

    Attributes
    ----------
    values : dict
        Register name to word: what a read returns, but for the live bits of STATUS.
    table_writes : list of (index, gx, gy)
        Every write to the gradient table since the start, slopes signed.
    """

    build: Build
    values: dict[str, int] = field(default_factory=dict)
    table_writes: list[tuple[int, int, int]] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.reset()

    def reset(self) -> None:
        """Every register to its reset value."""
        build = self.build
        self.values = {register.name: register.reset or 0 for register in REGISTERS.values()}
        self.values["GRID"] = REGISTERS["GRID"].pack(rows=build.rows, columns=build.columns)
        self.values["FORMAT"] = REGISTERS["FORMAT"].pack(
            data_width=build.data_width,
            gradient_width=build.gradient_width,
            gradient_fraction=build.gradient_fraction,
            bits_per_channel=build.bits_per_channel,
        )

    def read(self, address: int, busy: bool = False, contact: bool = False) -> tuple[int, Response]:
        """Data and response of a read; `busy` and `contact` are the live inputs in that clock."""
        register = BY_OFFSET.get(address & ~(BYTES - 1))
        if register is None or register.access == "wo":
            return 0, Response.SLVERR
        live = STATUS.pack(busy=int(busy), contact=int(contact)) if register is STATUS else 0
        return self.values[register.name] | live, Response.OKAY

    def write(self, address: int, data: int, strobe: int = 0xF, busy: bool = False) -> Response:
        """Response of a write, which takes effect unless it is an error."""
        register = BY_OFFSET.get(address & ~(BYTES - 1))
        if register is None or register.access == "ro":
            return Response.SLVERR
        values, name = self.values, register.name
        strobed = data & strobed_bits(strobe)
        merged = strobed | values[name] & ~strobed_bits(strobe)
        gradient_width, table_size = self.build.gradient_width, 1 << 3 * self.build.bits_per_channel
        if name == "TABLE_GY":
            if busy or strobe != (1 << BYTES) - 1:
                return Response.SLVERR
            index = values["TABLE_INDEX"]
            gx, gy = (signed(word, gradient_width) for word in (values["TABLE_GX"], data))
            self.table_writes.append((index, gx, gy))
            values["TABLE_INDEX"] = (index + 1) % table_size
        elif name == "TABLE_GX":
            values[name] = signed(merged, gradient_width) & WORD
        elif name == "TABLE_INDEX":
            values[name] = merged % table_size
        elif register is STATUS:
            values[name] &= ~strobed
        elif register is CONTROL:
            values[name] = merged & CONTROL.field("hold_contact").mask
            if strobed & CONTROL.field("clear_counters").mask:
                values.update(dict.fromkeys(COUNTERS, 0))
        else:
            values[name] = merged
        return Response.OKAY

    def clock(self, events: Events) -> None:
        """Take the events of one clock, after the write of that clock."""
        values = self.values
        for name in STICKY_EVENTS:
            values["STATUS"] |= STATUS.pack(**{name: int(name in events.flags)})
        values["STATUS"] |= STATUS.pack(saturation=int(events.saturations > 0))
        counts = {name: int(flag in events.flags) for flag, name in FRAME_COUNTERS.items()}
        for name, count in {**counts, SATURATIONS: events.saturations}.items():
            values[name] = min(values[name] + count, WORD)
        if events.first_depth_latency is not None:
            values["FIRST_DEPTH_LATENCY"] = events.first_depth_latency
