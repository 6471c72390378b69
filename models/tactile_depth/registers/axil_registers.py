# SPDX-License-Identifier: Apache-2.0
"""Behavioural model of hdl/registers/axil_registers.sv: the results of reads, and the effects of writes and events.

The model does not count cycles. In one cycle a read sees the registers first, then the write takes effect, then the
events. This order makes setting win over clearing. A read of a table entry comes in a cycle without a write.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from enum import IntEnum

from tactile_depth.registers.register_map import REGISTERS, TABLES, WORD_BITS

WORD = (1 << WORD_BITS) - 1
BYTES = WORD_BITS // 8
BY_OFFSET = {register.offset: register for register in REGISTERS.values()}

SELECT = REGISTERS["TABLE_SELECT"].field("select")
STATUS = REGISTERS["STATUS"]
CONTROL = REGISTERS["CONTROL"]
CAPTURES = {"reference": REGISTERS["CAPTURE"], "floor": REGISTERS["FLOOR_CAPTURE"]}
"""Registers that start a capture, by the table that is captured."""
RECORD = tuple(name for name in REGISTERS if name.startswith("RECORD_"))  # in the order of the words
STICKY_EVENTS = tuple(f.name for f in STATUS.fields if f.access == "w1c" and f.name != "saturation")
EVENT_COUNTERS = {
    "frame_in": "FRAMES_IN",
    "frame_out": "FRAMES_OUT",
    "frame_dropped": "FRAMES_DROPPED",
    "dark": "DARK_PIXELS",
    "depth_dropped": "DEPTH_DROPPED",
    "record_lost": "RECORDS_LOST",
}
SATURATIONS = "SATURATIONS"
COUNTERS = (*EVENT_COUNTERS.values(), SATURATIONS)
COMMIT = REGISTERS["TABLE_COMMIT"]


class Response(IntEnum):
    """AXI responses (IHI 0022, table A3-4) that the registers use."""

    OKAY = 0
    SLVERR = 2


@dataclass(frozen=True)
class Build:
    """Parameters of hdl/registers/axil_registers.sv."""

    rows: int
    columns: int
    data_width: int
    gradient_width: int
    gradient_fraction: int
    bits_per_channel: int
    coefficient_words: int = 0
    reference_words: int = 0
    floor_words: int = 0

    @property
    def table_sizes(self) -> dict[int, int]:
        """Number of entries of each table that TABLE_SELECT can name; 0: the build does not have the table."""
        gradient_words = 1 << 3 * self.bits_per_channel if self.bits_per_channel else 0
        sizes = {"gradient": gradient_words, "coefficients": self.coefficient_words}
        sizes |= {"reference": self.reference_words, "floor": self.floor_words}
        return {code: sizes[name] for name, code in TABLES.items()}

    @property
    def index_width(self) -> int:
        """Bits of TABLE_INDEX."""
        return (max(self.table_sizes.values()) - 1).bit_length()


@dataclass(frozen=True)
class Events:
    """Events that the pipeline reports in one cycle.

    Attributes
    ----------
    flags : frozenset of str
        Names of `STICKY_EVENTS` and keys of `EVENT_COUNTERS`; some are both.
    saturations : int
        Number of values clipped.
    first_depth_latency : int or None
        Latency of the frame whose first depth value leaves; None without one.
    frame_start : bool
        True if the first pixel of a frame is at the input of the pipeline.
    captured : frozenset of str
        Tables whose capture has ended and that request a change-over: `reference`, `floor`.
    """

    flags: frozenset[str] = frozenset()
    saturations: int = 0
    first_depth_latency: int | None = None
    frame_start: bool = False
    captured: frozenset[str] = frozenset()


@dataclass(frozen=True)
class Live:
    """Inputs that a read or a write of this cycle uses.

    Attributes
    ----------
    in_use : int
        Bit by bit, the bank in use of each table.
    capturing, ending : frozenset of str
        Tables with a capture in progress, and those in the last cycle of their capture.
    record : tuple of int
        Words of the contact record.
    """

    busy: bool = False
    contact: bool = False
    in_use: int = 0
    touching: bool = False
    capturing: frozenset[str] = frozenset()
    ending: frozenset[str] = frozenset()
    record: tuple[int, ...] = (0,) * len(RECORD)


def signed(word: int, width: int) -> int:
    """Return the lowest `width` bits of a word as a two's complement number."""
    word &= (1 << width) - 1
    return word - (1 << width) if word >> (width - 1) else word


def strobed_bits(strobe: int) -> int:
    """Return a mask of the bits of a word whose bytes are strobed."""
    return sum(0xFF << 8 * byte for byte in range(BYTES) if strobe >> byte & 1)


@dataclass
class AxilRegisters:
    """State of the registers of one build.

    Attributes
    ----------
    values : dict
        Register name to word, as a read returns it, without the fields in `Live`.
    bank, requested : int
        Bit by bit, the bank requested for each table, and the tables that change over with the next frame.
    table_writes : list of (table, index, high, low)
        All entries written since the start.
    captures : list of str
        Tables whose capture was requested since the start, in order.
    entry : callable
        Function from table and index to the words (high, low) of the entry.
    """

    build: Build
    entry: Callable[[int, int], tuple[int, int]] = lambda table, index: (0, 0)
    values: dict[str, int] = field(default_factory=dict)
    bank: int = 0
    requested: int = 0
    table_writes: list[tuple[int, int, int, int]] = field(default_factory=list)
    captures: list[str] = field(default_factory=list)
    _committed: int = 0

    def __post_init__(self) -> None:
        self.reset()

    def reset(self) -> None:
        """Set every register to its reset value; tables and their banks do not change."""
        build = self.build
        self.requested = self._committed = 0
        self.values = {register.name: register.reset or 0 for register in REGISTERS.values()}
        self.values["GRID"] = REGISTERS["GRID"].pack(rows=build.rows, columns=build.columns)
        self.values["FORMAT"] = REGISTERS["FORMAT"].pack(
            data_width=build.data_width,
            gradient_width=build.gradient_width,
            gradient_fraction=build.gradient_fraction,
            bits_per_channel=build.bits_per_channel,
        )

    @property
    def present(self) -> int:
        """Tables that the build has, bit by bit."""
        return sum(1 << table for table, size in self.build.table_sizes.items() if size)

    @property
    def table(self) -> int:
        """Code of the selected table."""
        return self.values["TABLE_SELECT"] >> SELECT.low & (1 << SELECT.width) - 1

    @property
    def table_size(self) -> int:
        return self.build.table_sizes.get(self.table, 0)

    def pending(self, in_use: int) -> int:
        """Return TABLE_COMMIT: the tables that have not changed over, or change over with the next frame."""
        return self.requested | (self.bank ^ in_use) & self.present

    def closed(self, live: Live) -> int:
        """Return the tables that the bus can neither write nor commit now, bit by bit."""
        return self.pending(live.in_use) | COMMIT.pack(**dict.fromkeys(live.capturing, 1))

    def bank_wanted(self, frame_start: bool) -> int:
        """Return the bank requested for each table in a cycle with or without the start of a frame."""
        return self.bank ^ self.requested if frame_start else self.bank

    def is_port(self, address: int) -> bool:
        """Return True if a read of this address reads a table."""
        register = BY_OFFSET.get(address & ~(BYTES - 1))
        return register is not None and any(f.access == "port" for f in register.fields)

    def _next_entry(self) -> None:
        self.values["TABLE_INDEX"] = (self.values["TABLE_INDEX"] + 1) % self.table_size

    def read(self, address: int, live: Live = Live()) -> tuple[int, Response]:
        """Return data and response of a read."""
        register = BY_OFFSET.get(address & ~(BYTES - 1))
        if register is None:
            return 0, Response.SLVERR
        if self.is_port(address):
            index = self.values["TABLE_INDEX"]
            if index >= self.table_size:
                return 0, Response.SLVERR
            high, low = self.entry(self.table, index)
            if register.name == "TABLE_HIGH":
                return high, Response.OKAY
            self._next_entry()
            return low, Response.OKAY
        shown = dict(zip(RECORD, live.record, strict=True)) | {
            "STATUS": STATUS.pack(busy=int(live.busy), contact=int(live.contact), touching=int(live.touching)),
            **{capture.name: capture.pack(busy=int(table in live.capturing)) for table, capture in CAPTURES.items()},
            "TABLE_COMMIT": self.pending(live.in_use),
            "TABLE_SIZE": self.table_size,
        }
        return self.values[register.name] | shown.get(register.name, 0), Response.OKAY

    def write(self, address: int, data: int, strobe: int = 0xF, live: Live = Live()) -> Response:
        """Return the response of a write, which takes effect unless the response is an error."""
        register = BY_OFFSET.get(address & ~(BYTES - 1))
        if register is None or not register.writable:
            return Response.SLVERR
        values, name = self.values, register.name
        strobed = data & strobed_bits(strobe)
        merged = strobed | values[name] & ~strobed_bits(strobe)
        closed = self.closed(live)
        for table, capture in CAPTURES.items():
            if register is capture and strobed & capture.field("start").mask:
                bit = COMMIT.field(table).mask
                due = table == "floor" and (self.pending(live.in_use) & bit or table in live.ending)
                if not self.present & bit or due:
                    return Response.SLVERR
                self.captures.append(table)
        if name == "TABLE_LOW":
            index, number = values["TABLE_INDEX"], self.table
            if index >= self.table_size or strobe != (1 << BYTES) - 1 or closed >> number & 1:
                return Response.SLVERR
            self.table_writes.append((number, index, values["TABLE_HIGH"], data))
            self._next_entry()
        elif name == "TABLE_COMMIT":
            self._committed |= strobed & self.present & ~closed
        elif name == "TABLE_INDEX":
            values[name] = merged & (1 << self.build.index_width) - 1
        else:
            values[name] &= ~(strobed & register.mask("w1c"))
            values[name] = merged & register.mask("rw", "port") | values[name] & ~register.mask("rw", "port")
        if strobed & CONTROL.field("clear_counters").mask and register is CONTROL:
            values.update(dict.fromkeys(COUNTERS, 0))
        return Response.OKAY

    def clock(self, events: Events) -> None:
        """Take the events of one cycle, after the write of that cycle."""
        values = self.values
        if events.frame_start:
            self.bank ^= self.requested
            self.requested = 0
        self.requested |= self._committed  # takes effect after the frame that starts in this cycle
        self.requested |= COMMIT.pack(**dict.fromkeys(events.captured, 1)) & self.present
        self._committed = 0
        for name in STICKY_EVENTS:
            values["STATUS"] |= STATUS.pack(**{name: int(name in events.flags)})
        values["STATUS"] |= STATUS.pack(saturation=int(events.saturations > 0))
        counts = {name: int(flag in events.flags) for flag, name in EVENT_COUNTERS.items()}
        for name, count in {**counts, SATURATIONS: events.saturations}.items():
            values[name] = min(values[name] + count, WORD)
        if events.first_depth_latency is not None:
            values["FIRST_DEPTH_LATENCY"] = events.first_depth_latency
