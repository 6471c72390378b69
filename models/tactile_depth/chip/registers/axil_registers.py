# SPDX-License-Identifier: Apache-2.0
"""Behavioural model of hdl/registers/axil_registers.sv: the results of reads, and the effects of writes and events.

The model does not count cycles; axil_port.py does. In one cycle a read sees the registers first, then the write takes
effect, then the events. This order makes setting win over clearing. A read of a table entry comes in a cycle without a
write.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from tactile_depth.chip.limits import CUBIC
from tactile_depth.chip.registers.axil_port import Response, offset_of, strobed_bits
from tactile_depth.chip.registers.device_description import arithmetic_word
from tactile_depth.chip.registers.event_registers import ARRIVED, LEVELS, SELF_TEST, STATUS, EventRegisters
from tactile_depth.chip.registers.register_map import MAP, REGISTERS, TABLES
from tactile_depth.chip.registers.setting_registers import SettingRegisters
from tactile_depth.chip.registers.table_access import PORTS, SIZE, TableAccess
from tactile_depth.chip.registers.table_banks import CAPTURES, COMMIT, TableBanks

BY_OFFSET = {register.offset: register for register in MAP}
SELECT = REGISTERS["TABLE_SELECT"].field("select")
VERSION = REGISTERS["DEVICE"].field("version").reset or 0
GAINS = tuple(name for name in REGISTERS if name.startswith("LIGHT_GAIN_"))  # of red, green, blue
RECORD = tuple(name for name in REGISTERS if name.startswith("RECORD_"))  # in the order of the words


@dataclass(frozen=True)
class Build:
    """Parameters of hdl/registers/axil_registers.sv, those of hdl/tactile_depth.sv by name.

    Attributes
    ----------
    parameters : mapping
        See `tactile_depth.chip.tactile_depth.top_parameters`.
    """

    parameters: Mapping[str, int]

    @property
    def table_sizes(self) -> dict[int, int]:
        """Number of entries of each table that TABLE_SELECT can name; 0: the build does not have the table."""
        p = self.parameters
        nodes = (
            (p["Rows"] >> p["BlockLog2"]) * (p["Columns"] >> p["BlockLog2"]) if p["FlatField"] or p["ZeroOffset"] else 0
        )
        sizes = {
            "gradient": 0 if p["Polynomial"] and not p["Corrections"] else 1 << 3 * p["BitsPerChannel"],
            "coefficients": math.prod(CUBIC) if p["Polynomial"] else 0,
            "reference": 4 * nodes if p["FlatField"] else 0,
            "zero": nodes if p["ZeroOffset"] else 0,
        }
        return {code: sizes[name] for name, code in TABLES.items()}

    @property
    def present(self) -> int:
        """Tables that the build has, bit by bit."""
        return sum(1 << table for table, size in self.table_sizes.items() if size)

    @property
    def description(self) -> dict[str, int]:
        """Words of the registers that describe the build."""
        p, depth, slope = self.parameters, REGISTERS["DEPTH_UNIT"], REGISTERS["SLOPE_UNIT"]
        exponent = (1 << depth.field("exponent").width) - 1
        return {
            "GRID": REGISTERS["GRID"].pack(rows=p["Rows"], columns=p["Columns"]),
            "FORMAT": REGISTERS["FORMAT"].pack(
                data_width=p["DataWidth"],
                gradient_width=p["GradientWidth"],
                gradient_fraction=p["GradientFraction"],
                bits_per_channel=0 if p["Polynomial"] and not p["Corrections"] else p["BitsPerChannel"],
            ),
            "DEVICE": REGISTERS["DEVICE"].pack(
                solver=p["Tridiagonal"],
                boundary=p["Neumann"],
                gradient_model=p["Polynomial"],
                flat_field=p["FlatField"],
                zero_offset=p["ZeroOffset"],
                light_gains=p["LightGains"],
                lanes=p["Lanes"],
                gain_width=p["GainWidth"] if p["FlatField"] else 0,
                version=VERSION,
            ),
            "DEPTH_UNIT": depth.pack(mantissa=p["DepthMantissa"], exponent=p["DepthExponent"] & exponent),
            "SLOPE_UNIT": slope.pack(mantissa=p["SlopeMantissa"], exponent=p["SlopeExponent"] & exponent),
            "ARITHMETIC": arithmetic_word(p),
            "RESIDUAL_BOUND": p["ResidualBound"],
        }


@dataclass(frozen=True)
class Events:
    """Events that the pipeline reports in one cycle.

    Attributes
    ----------
    flags : frozenset of str
        Names of tactile_depth.chip.registers.event_registers.EVENTS.
    saturations : int
        Number of values clipped.
    residual : int
        Of the last frame.
    first_depth_latency : int or None
        Latency of the frame whose first depth value leaves; None without one.
    frame_start : bool
        True if the first pixel of a frame is at the input of the pipeline.
    captured : frozenset of str
        Tables whose capture has ended and that request a change-over: `reference`, `zero`.
    """

    flags: frozenset[str] = frozenset()
    saturations: int = 0
    residual: int = 0
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
    light_gains : tuple of int
        Gains of red, green, blue.
    signature : int
        TABLE_SIGNATURE.
    held : frozenset of str
        Tables whose bank in use comes from a capture.
    """

    busy: bool = False
    contact: bool = False
    in_use: int = 0
    touching: bool = False
    hunting: bool = False
    stalled: bool = False
    arrived_columns: int = 0
    arrived_rows: int = 0
    self_test: int = 0
    residual: int = 0
    capturing: frozenset[str] = frozenset()
    ending: frozenset[str] = frozenset()
    record: tuple[int, ...] = (0,) * len(RECORD)
    light_gains: tuple[int, ...] = (0,) * len(GAINS)
    signature: int = 0
    held: frozenset[str] = frozenset()


@dataclass
class AxilRegisters:
    """State of the registers of one build.

    Attributes
    ----------
    values : dict
        Register name to word, as a read returns it, without the fields in `Live`.
    table_writes : list of (table, index, high, low)
        All entries written since the start.
    captures : list of str
        Tables whose capture was requested since the start, in order.
    gains_written : list of (colour, gain)
        All light gains written since the start.
    entry : callable
        Function from table and index to the words (high, low) of the entry.
    """

    build: Build
    entry: Callable[[int, int], tuple[int, int]] = lambda table, index: (0, 0)
    values: dict[str, int] = field(default_factory=dict)
    table_writes: list[tuple[int, int, int, int]] = field(default_factory=list)
    captures: list[str] = field(default_factory=list)
    gains_written: list[tuple[int, int]] = field(default_factory=list)
    _arrived: Events = Events()
    _mask: int = 0

    def __post_init__(self) -> None:
        self.values.update({register.name: register.reset or 0 for register in MAP} | self.build.description)
        self.settings = SettingRegisters({"PITCH": self.build.parameters["PitchNm"]}, self.values)
        self.events = EventRegisters(self.values)
        self.banks = TableBanks(self.build.present)
        self.access = TableAccess(self.build.table_sizes, self.values)

    def reset(self) -> None:
        """Set every register to its reset value; tables and their banks do not change."""
        for core in (self.settings, self.events, self.banks, self.access):
            core.reset()
        self._arrived, self._mask = Events(), 0

    def cold_reset(self) -> None:
        """Set the banks to 0, beside what a reset does."""
        self.banks.bank = 0

    @property
    def table(self) -> int:
        """Code of the selected table."""
        return self.values["TABLE_SELECT"] >> SELECT.low & (1 << SELECT.width) - 1

    def is_port(self, address: int) -> bool:
        """Return True if a read of this address reads a table."""
        register = BY_OFFSET.get(offset_of(address))
        return register is not None and register.name in PORTS

    def read(self, address: int, live: Live = Live()) -> tuple[int, Response]:
        """Return data and response of a read."""
        register = BY_OFFSET.get(offset_of(address))
        if register is None:
            return 0, Response.SLVERR
        if register.name in PORTS:
            index = self.access.read(register.name, self.table)
            if index is None:
                return 0, Response.SLVERR
            return self.entry(self.table, index)[PORTS.index(register.name)], Response.OKAY
        shown = dict(zip(RECORD, live.record, strict=True)) | {
            ARRIVED.name: ARRIVED.pack(rows=live.arrived_rows, columns=live.arrived_columns),
            SELF_TEST: live.self_test,
            STATUS.name: STATUS.pack(**{name: int(getattr(live, name)) for name in LEVELS}),
            **{
                capture.name: capture.pack(busy=int(table in live.capturing), held=int(table in live.held))
                for table, capture in CAPTURES.items()
            },
            "TABLE_SIGNATURE": live.signature,
            COMMIT.name: self.banks.pending(live.in_use),
            SIZE: self.access.sizes.get(self.table, 0),
            **(dict(zip(GAINS, live.light_gains, strict=True)) if self.build.parameters["LightGains"] else {}),
        }
        return self.values[register.name] | shown.get(register.name, 0), Response.OKAY

    def write(self, address: int, data: int, strobe: int = 0xF, live: Live = Live()) -> Response:
        """Return the response of a write, which takes effect unless the response is an error."""
        register = BY_OFFSET.get(offset_of(address))
        if register is None or not register.writable:
            return Response.SLVERR
        name, mask = register.name, strobed_bits(strobe)
        ones, closed = data & mask, self.banks.closed(live.in_use, live.capturing)
        if self.access.refuses(name, mask, self.table, closed):
            return Response.SLVERR
        if self.banks.refuses(name, ones, live.in_use, live.ending):
            return Response.SLVERR
        entry, capture = self.access.write(name, ones, mask, self.table), self.banks.started(name, ones)
        self.table_writes += [entry] if entry else []
        self.captures += [capture] if capture else []
        self.banks.write(name, ones, live.in_use, live.capturing)
        if name in GAINS:
            colour = GAINS.index(name)
            gain = (ones | live.light_gains[colour] & ~mask) & REGISTERS[name].mask()
            self.gains_written.append((colour, gain))
        self.settings.write(name, ones, mask)
        self.events.write(name, ones)
        return Response.OKAY

    def clock(self, events: Events) -> None:
        """Take the events of one cycle, after the write of that cycle. Counters and status see them one cycle later."""
        self.banks.clock(events.frame_start, events.captured)
        self.events.clock(
            self._arrived.flags,
            self._arrived.saturations,
            events.residual,
            events.first_depth_latency,
            self._mask,
        )
        self._arrived, self._mask = events, self.values["INTERRUPT_MASK"]
