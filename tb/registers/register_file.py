# SPDX-License-Identifier: Apache-2.0
"""Bench of hdl/registers/axil_registers.sv: a checker of every output in every cycle, and tables behind the bus."""

from __future__ import annotations

import random
from collections.abc import Coroutine
from typing import Any

from cocotb.triggers import RisingEdge

from tactile_depth.chip.limits import LIGHT_GAIN
from tactile_depth.chip.registers.axil_port import LATE_CLOCKS, Response, response, strobed_bits
from tactile_depth.chip.registers.axil_registers import RECORD, AxilRegisters, Build, Events, Live
from tactile_depth.chip.registers.event_registers import EVENTS, LEVELS
from tactile_depth.chip.registers.register_map import MAP, REGISTERS, WORD
from tactile_depth.chip.registers.table_banks import CAPTURES
from tb import axil, pins, structs
from tb.axil import OFFSET
from tb.registers import axil_pins
from tb.registers.axil_pins import PortChecker

CONTROL, LIGHT = REGISTERS["CONTROL"], REGISTERS["LIGHT"]
INPUTS = (
    *axil_pins.INPUTS,
    *("s_axil_awprot", "s_axil_arprot", "cold_rst", "events", "levels", "record", "light_gains", "frame_start"),
    *("first_depth_latency", "first_depth_latency_valid", "table_answer", "table_in_use"),
    *(f"{table}_status" for table in CAPTURES),
)
PARAMETERS = (
    *("Tridiagonal", "Neumann", "Rows", "Columns", "DataWidth", "GradientWidth", "GradientFraction", "BitsPerChannel"),
    *("FlatField", "Polynomial", "Corrections", "LightGains", "ZeroOffset", "Lanes", "BlockLog2", "GainWidth"),
    *("DepthMantissa", "DepthExponent", "SlopeMantissa", "SlopeExponent", "PitchNm"),
)


def entry(table: int, index: int) -> tuple[int, int]:
    """Return the words (high, low) of an entry of a table; they differ for each entry."""
    low = (index + 1) * 0x9E37_79B1 + (table + 1) * 0x85EB_CA6B & WORD
    return low * 0xC2B2_AE35 >> 5 & WORD, low


class Checker(PortChecker):
    """Checker of axil_registers, with tables behind the bus that change their banks after `lag` cycles."""

    inputs = INPUTS

    def __init__(self, dut: Any, lag: int = 0) -> None:
        super().__init__(dut)
        parameters = {name: getattr(dut, name).value.to_signed() for name in PARAMETERS}
        self.build = Build(parameters)
        self.model = AxilRegisters(self.build, entry)
        self.tables = Tables(dut, lag)
        self.late_answer = 0, Response.OKAY
        self.low: int | None = None  # the lower word on the table bus: the strobed bytes of the last word taken
        self.asked = ""  # the port to a table that was read last
        self.responses: dict[str, list[Response]] = {"read": [], "write": []}
        self.table_command = structs.reader(dut.table_command, "table_command_t")
        self.light_command = structs.reader(dut.light_command, "light_command_t")

    def tasks(self) -> list[Coroutine[Any, Any, None]]:
        return [*super().tasks(), self.tables.run()]

    def begin(self) -> None:
        self.model.banks.bank = self.pin("table_bank")  # value of the test before: it survives a reset

    def status(self, flag: str) -> frozenset[str]:
        """Return the tables whose capture has a flag of its status up."""
        return frozenset(t for t in CAPTURES if structs.unpack("capture_status_t", self.pin(f"{t}_status"))[flag])

    def live(self) -> Live:
        """Return the inputs that reads and writes of this cycle use."""
        record, gains = self.pin("record"), self.pin("light_gains")
        return Live(
            **{name: bool(high) for name, high in structs.unpack("levels_t", self.pin("levels")).items()},
            capturing=self.status("busy"),
            ending=self.status("done"),
            in_use=self.pin("table_in_use"),
            record=tuple(record >> 32 * word & WORD for word in range(len(RECORD))),
            light_gains=tuple(gains >> LIGHT_GAIN.width * c & (1 << LIGHT_GAIN.width) - 1 for c in range(3)),
        )

    def settings(self) -> dict[str, int]:
        """Return the outputs that show settings."""
        values = self.model.values
        control = CONTROL.unpack(values["CONTROL"])
        names = ("THRESHOLD", "OFF_THRESHOLD", "AREA_THRESHOLD", "MINIMUM_AREA", "DEBOUNCE")
        contact = {name.lower(): values[name] for name in names}
        contact |= {name: control[name] for name in ("hold_contact", "drop_frames")}
        return {
            "contact_settings": structs.pack("contact_settings_t", contact),
            "timeout": values["TIMEOUT"],
            "dark_level": values["DARK_LEVEL"],
            "irq": int(self.model.events.irq),
        }

    def step(self) -> None:
        """Compare the outputs of one cycle."""
        model, port, offered = self.model, self.port, axil_pins.pins(self.pin)
        resets, starts = bool(self.pin("rst")), bool(self.pin("frame_start"))
        outputs = axil_pins.expected(port, resets) | self.settings()
        outputs["table_bank"] = model.banks.wanted(starts and not resets)
        command = {"select": model.table, "index": model.values["TABLE_INDEX"], "high": model.values["TABLE_HIGH"]}
        light = LIGHT.unpack(model.values["LIGHT"])
        log2 = {t: register.unpack(model.values[register.name])["log2_frames"] for t, register in CAPTURES.items()}

        # In this order: a table read in the previous cycle, a read, a write.
        asked_before, reads_table = self.asked if port.late == LATE_CLOCKS else "", False
        if asked_before:
            self.late_answer = model.read(OFFSET[asked_before])
            reads_table = self.late_answer[1] == Response.OKAY
        answer, is_late = (0, Response.OKAY), False
        offset, writes = port.asked, port.write()
        if offset is not None:
            is_late = model.is_port(offset)
            self.asked = next((r.name for r in MAP if r.offset == offset), "")
            answer = answer if is_late else model.read(offset, self.live())
        written, started, refused = len(model.table_writes), len(model.captures), False
        gains_before = len(model.gains_written)
        if writes is not None:
            assert port.data is not None
            refused = model.write(writes.offset, *port.data, live=self.live()) != Response.OKAY
            if not resets:
                self.responses["write"].append(response(refused))

        command |= {"write": len(model.table_writes) - written, "read": int(reads_table and not resets)}
        got = self.table_command()
        low = got.pop("low")
        assert got == command, f"clock {self.clocks}: table_command is {got}, expected {command}"
        if self.low is not None:
            assert low == self.low, f"clock {self.clocks}: table_command.low is {low}, expected {self.low}"
        got = self.light_command()
        gain, colours = got.pop("gain"), model.gains_written[gains_before:]
        light["write"] = sum(1 << colour for colour, _ in colours)
        assert got == light, f"clock {self.clocks}: light_command is {got}, expected {light}"
        assert all(gain == written for _, written in colours), f"clock {self.clocks}: gain {gain}, expected {colours}"
        for table in CAPTURES:
            request = {"request": int(model.captures[started:] == [table]), "log2_frames": log2[table]}
            outputs[f"{table}_command"] = structs.pack("capture_command_t", request)
        for name, value in outputs.items():
            self.expect(name, value)

        if offered.write_data is not None and port.data is None:
            self.low = offered.write_data[0] & strobed_bits(offered.write_data[1])
        self.take_edge(resets, starts)
        if resets:
            port.reset()
        else:
            if port.late == 1 or (offset is not None and not is_late):
                self.responses["read"].append((self.late_answer if port.late == 1 else answer)[1])
            port.clock(offered, refused, answer, is_late, self.late_answer)

    def take_edge(self, resets: bool, starts: bool) -> None:
        """Take the clock edge in the model of the registers."""
        events = structs.unpack("events_t", self.pin("events"))
        saturations = events.pop("saturations")
        valid = self.pin("first_depth_latency_valid")
        self.model.clock(
            Events(
                frozenset(name for name, happens in events.items() if happens),
                saturations,
                self.pin("first_depth_latency") if valid else None,
                frame_start=starts and not resets,
                captured=self.status("done"),
            )
        )
        if resets:
            self.model.reset()
        if self.pin("cold_rst"):
            self.model.cold_reset()


class Tables:
    """Tables behind the table bus. The words of an entry arrive at the latest allowed cycle, after other words.

    A table changes its bank `lag` cycles after the frame start. Light gains hold what is written.
    """

    def __init__(self, dut: Any, lag: int = 0) -> None:
        self.dut, self.lag = dut, lag
        self.random = random.Random(lag)

    async def run(self) -> None:
        dut, late, due, edge = self.dut, 0, [], RisingEdge(self.dut.clk)
        read_light = structs.reader(dut.light_command, "light_command_t")
        read_command = structs.reader(dut.table_command, "table_command_t")
        table_bank, table_in_use = pins.value(dut.table_bank), pins.value(dut.table_in_use)
        reset = pins.unsigned(dut.rst)
        gains = [0, 0, 0]
        while True:
            await edge
            light = read_light()
            if light["write"]:
                assert light["gain"] is not None
                gains = [light["gain"] if light["write"] >> c & 1 else gain for c, gain in enumerate(gains)]
                dut.light_gains.value = sum(gain << LIGHT_GAIN.width * c for c, gain in enumerate(gains))
            command = read_command()
            if command["read"]:
                assert command["select"] is not None
                assert command["index"] is not None
                due = [*[None] * (LATE_CLOCKS - 2), entry(command["select"], command["index"])]
                dut.table_answer.value = self.random.getrandbits(64)
            if due and (words := due.pop(0)) is not None:
                dut.table_answer.value = structs.pack("table_answer_t", dict(zip(("high", "low"), words, strict=True)))
            wanted, used = table_bank(), table_in_use()
            late = late + 1 if wanted != used else 0
            if reset() or late > self.lag:
                dut.table_in_use.value = int(wanted)
                late = 0


async def pulse(dut: Any, *events: str, saturations: int = 0, settle: int = 1, **values: int) -> None:
    """Raise events and other inputs for one cycle; return `settle` cycles later, when registers show them."""
    members = dict.fromkeys(events, 1) | {"saturations": saturations}
    for name, value in {"events": structs.pack("events_t", members), **values}.items():
        getattr(dut, name).value = value
    await RisingEdge(dut.clk)
    for name in ("events", *values):
        getattr(dut, name).value = 0
    for _ in range(settle):
        await RisingEdge(dut.clk)


async def write(dut: Any, name: str, data: int, strobe: int = 0xF) -> int:
    """Write a register; return the response."""
    return await axil.write(dut, OFFSET[name], data, strobe)


async def everything_happens(dut: Any) -> None:
    """Raise every event for one cycle."""
    await pulse(dut, *EVENTS, saturations=1)


def levels(**high: int) -> int:
    """Return the vector of the levels that STATUS shows."""
    assert high.keys() <= set(LEVELS)
    return structs.pack("levels_t", high)
