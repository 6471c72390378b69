# SPDX-License-Identifier: Apache-2.0
"""axil_registers against its model in every clock; the cores inside have testbenches of their own."""

import random
from typing import Any

import cocotb

from formal.entries import FULL_WIDTH, Proof
from tactile_depth.chip.common.td_node_map import side
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.fixed_point import codes
from tactile_depth.chip.limits import LIGHT_GAIN
from tactile_depth.chip.registers.axil_port import LATE_CLOCKS, AxilPort
from tactile_depth.chip.registers.axil_registers import GAINS, RECORD, AxilRegisters, Build, Events, Live
from tactile_depth.chip.registers.register_map import REGISTERS
from tactile_depth.chip.registers.table_access import LOW
from tactile_depth.chip.registers.table_banks import CAPTURES
from tactile_depth.chip.registers.table_signatures import TableSignatures
from tactile_depth.chip.tactile_depth import config_value, default_parameters, top_parameters
from tb.axil import CLIENT
from tb.lockstep import CLOCKS, WORD, Pins, play
from tb.registers.bus import CHANNELS, NAME_AT, OFFSET, PINS, begin_low
from tb.registers.tb_table_signatures import advance, captured_words
from tb.structs import members, pack, unpack
from tb.structures import ICARUS, VERILATOR, Mutants, Structure


def fields_of(**choices: Any) -> dict[str, int]:
    """Return the fields of a configuration."""
    return top_parameters(Configuration(**choices), 0.0634)


EXTREMES = default_parameters() | {
    "Tridiagonal": 1,
    "Neumann": 1,
    "Rows": 65535,
    "Columns": 1,
    "DataWidth": 32,
    "GradientWidth": 32,
    "GradientFraction": 31,
    "BitsPerChannel": 1,
    "FlatField": 1,
    "Polynomial": 0,
    "LightGains": 1,
    "ZeroOffset": 1,
    "Lanes": 32,
    "BlockLog2": 0,
    "GainWidth": 32,
    "DepthMantissa": (1 << 24) - 1,
    "DepthExponent": -128,
    "SlopeMantissa": 1 << 23,
    "SlopeExponent": 127,
    "PitchNm": (1 << 31) - 1,
    "ResidualBound": (1 << 31) - 1,
}
QUADRATIC = fields_of(columns=128, rows=96, solver="tridiagonal", flat_field=True, gradient_model="quadratic")


def built(name: str, fields: dict[str, int], **runs: Any) -> Structure:
    return Structure({"Config": config_value(fields)}, name=name, **runs)


STRUCTURES = (
    built("128", fields_of(columns=128), on=VERILATOR),
    built("extremes", EXTREMES, on=ICARUS, mutants=VERILATOR),
    built("quadratic", QUADRATIC),
)
PROTOCOL = CLIENT | {"counts": "live"}
MUTANTS = Mutants(flat=False)
PROOFS = tuple(
    Proof(
        f"{FULL_WIDTH}; each gradient model, with a camera or without, all options",
        {"Polynomial": polynomial, "Corrections": corrections, "Camera": camera},
        free=("signature_data",),  # table_signatures proves it
    )
    for polynomial, corrections, camera in ((0, 0, 0), (1, 0, 1), (1, 1, 0))
)

CONTROL = REGISTERS["CONTROL"]
SELF_TEST = CONTROL.field("self_test").mask
CAPTURED = (1 << sum(width for _, width in members("captured_t").values())) - 1
CONTACT = ("THRESHOLD", "OFF_THRESHOLD", "AREA_THRESHOLD", "MINIMUM_AREA", "DEBOUNCE")


def words(vector: int, count: int, width: int) -> tuple[int, ...]:
    """Return the words of a vector, the lowest first."""
    return tuple(vector >> width * n & (1 << width) - 1 for n in range(count))


class Registers:
    """The model at the pins of the core.

    Attributes
    ----------
    asked, had_entry : str, bool
        Port to a table that was read last, and whether there was an entry.
    in_use : int
        Bank that each table used a clock before.
    waiting : set of str
        Channels whose word of the clock before was not taken.
    """

    def __init__(self, build: Build) -> None:
        self.port, self.model = AxilPort(), AxilRegisters(build)
        p = build.parameters
        self.signatures = TableSignatures(side=side(p["Lanes"], p["BlockLog2"]))
        self.asked, self.had_entry = "", False
        self.in_use = 0
        self.waiting: set[str] = set()

    def settings(self) -> dict[str, int | None]:
        """Return the outputs that are settings."""
        values = self.model.values
        control = REGISTERS["CONTROL"].unpack(values["CONTROL"])
        contact = {name.lower(): values[name] for name in CONTACT}
        contact |= {name: control[name] for name in ("hold_contact", "drop_frames")}
        return {
            "contact_settings": pack("contact_settings_t", contact),
            "timeout": values["TIMEOUT"],
            "dark_level": values["DARK_LEVEL"],
            "slope_limit": values["SLOPE_LIMIT"],
            "irq": self.model.events.irq,
        }

    def clock(self, **pins: int) -> dict[str, int | None]:
        """Advance by one clock edge; return the outputs before it, None where one does not count."""
        model, port = self.model, self.port
        bus, values = port.outputs(pins["rst"]), model.values
        bus["write"] = bus["write"] and not pins["rst"]  # what a reset withdraws commands nothing
        status = {table: unpack("capture_status_t", pins[f"{table}_status"]) for table in CAPTURES}
        busy, done = (frozenset(table for table in CAPTURES if status[table][flag]) for flag in ("busy", "done"))
        live = Live(
            **unpack("levels_t", pins["levels"]),  # type: ignore[arg-type]
            capturing=busy,
            ending=done,
            in_use=self.in_use,
            record=words(pins["record"], len(RECORD), 32),
            light_gains=words(pins["light_gains"], len(GAINS), LIGHT_GAIN.width),
            signature=self.signatures.shown,
            held=self.signatures.held(pins["table_in_use"]),
        )
        starts = bool(pins["frame_start"] and not pins["rst"])
        offset, at, (ones, mask) = port.address or 0, port.asked or 0, port.data or (0, 0)
        table = {"select": model.table, "index": values["TABLE_INDEX"], "high": values["TABLE_HIGH"], "low": ones}
        table |= {"read": 0, "write": 0}
        light = REGISTERS["LIGHT"].unpack(values["LIGHT"])
        log2 = {name: register.unpack(values[register.name])["log2_frames"] for name, register in CAPTURES.items()}
        out = {name: value for name, value in bus.items() if name.startswith("s_axil")} | self.settings()
        out["table_bank"] = model.banks.wanted(starts)

        # In this order: a table read in the previous cycle, a read, a write.
        if port.late == LATE_CLOCKS:
            self.had_entry = model.access.read(self.asked, model.table) is not None
            table["read"] = self.had_entry and not pins["rst"]
        late = unpack("table_answer_t", pins["table_answer"])["low" if self.asked == LOW else "high"]
        answers = dict.fromkeys(("read_data", "read_refused", "read_late", "write_refused"), 0)
        answers |= {"late_data": late if self.had_entry else 0, "late_refused": not self.had_entry}
        if bus["read"]:
            answers["read_late"] = model.is_port(at)
            if answers["read_late"]:
                self.asked = NAME_AT[at]
            else:
                answers["read_data"], answers["read_refused"] = model.read(at, live)
        written, started, colour = len(model.table_writes), len(model.captures), NAME_AT.get(offset)
        if bus["write"]:
            strobe = sum((mask >> 8 * byte & 1) << byte for byte in range(4))
            answers["write_refused"] = model.write(offset, ones, strobe, live)

        gains = [name == colour for name in GAINS]
        before = sum(gain for gain, is_written in zip(live.light_gains, gains, strict=True) if is_written)
        light["write"] = sum(is_written << n for n, is_written in enumerate(gains)) if bus["write"] else 0
        light["gain"] = (ones | before & ~mask) & (1 << LIGHT_GAIN.width) - 1
        table["write"] = len(model.table_writes) > written
        if None not in (port.address, port.data):
            out["self_test"] = colour == CONTROL.name and bool(bus["write"] and ones & SELF_TEST)
            out |= {"light_command": pack("light_command_t", light), "table_command": pack("table_command_t", table)}
        for name in CAPTURES:
            request = {"request": model.captures[started:] == [name], "log2_frames": log2[name]}
            out[f"{name}_command"] = pack("capture_command_t", request)
        if None not in (port.address, port.data, port.asked):
            command = {name: value or 0 for name, value in bus.items() if name.startswith(("write", "read_offset"))}
            out["register_command"] = pack("register_command_t", command)

        status_words = {f"{table}_captured": pins[f"{table}_status"] & CAPTURED for table in CAPTURES}
        written_to = {"write": int(bus["write"] or 0), "write_offset": offset, "write_mask": mask}
        advance(
            self.signatures, pins | written_to | status_words, {name: int(value or 0) for name, value in table.items()}
        )

        events = unpack("events_t", pins["events"])
        saturations, valid = events.pop("saturations"), pins["first_depth_latency_valid"]
        flags = frozenset(name for name in events if events[name])
        latency = pins["first_depth_latency"] if valid else None
        residual = unpack("levels_t", pins["levels"])["residual"]
        model.clock(Events(flags, saturations, residual, latency, starts, done))
        if pins["rst"]:
            model.reset()
        if pins["cold_rst"]:
            model.cold_reset()
        port.advance(pins | answers)
        self.in_use = pins["table_in_use"]
        taken = {channel for channel in ("aw", "w", "ar") if bus[f"s_axil_{channel}ready"] or pins["rst"]}
        self.waiting = {channel for channel in ("aw", "w", "ar") if pins[f"s_axil_{channel}valid"]} - taken
        return out


class WholeTable:
    """A host that now and then writes all entries of the gradient table, takes it into use and reads its signature.

    Attributes
    ----------
    left : int
        Clocks until it is done; 0: it waits.
    sent : dict
        Words of a channel that were taken.
    """

    def __init__(self, chance: random.Random, entries: int) -> None:
        self.chance, self.entries, self.left = chance, entries, 0
        self.writes: list[tuple[str, int]] = []
        self.sent: dict[str, int] = {}
        self.offered: set[str] = set()

    def drive(self, registers: Registers, pins: Pins) -> None:
        """Turn pins into those of the host while it writes and reads."""
        if not self.left:
            held = registers.port.address_held or registers.port.data_held or registers.waiting & {"aw", "w"}
            if held or self.chance.random() > 0.001:
                return
            entry = "TABLE_HIGH", "TABLE_LOW"
            self.writes = [("TABLE_SELECT", 0), ("TABLE_INDEX", 0)]
            self.writes += [(name, self.chance.getrandbits(32)) for _ in range(self.entries) for name in entry]
            self.writes.append(("TABLE_COMMIT", 1))
            self.left, self.sent, self.offered = 10 * len(self.writes), {"aw": 0, "w": 0}, set()
        self.left -= 1
        pins |= {"rst": 0, "cold_rst": 0, "table_in_use": 0, **{f"{table}_status": 0 for table in CAPTURES}}
        pins |= {"s_axil_bready": 1, "s_axil_rready": 1}
        for channel in self.offered - registers.waiting:
            self.sent[channel] += 1
        self.offered = set()
        for channel, done in self.sent.items():
            pins[f"s_axil_{channel}valid"] = int(done < len(self.writes))
            if done < len(self.writes):
                self.offered.add(channel)
                name, word = self.writes[done]
                pins |= (
                    {"s_axil_awaddr": OFFSET[name]} if channel == "aw" else {"s_axil_wdata": word, "s_axil_wstrb": 15}
                )
        if "ar" not in registers.waiting:
            pins["s_axil_araddr"] = OFFSET["TABLE_SIGNATURE"]


@cocotb.test
async def registers(dut: Any) -> None:
    numbers = codes(int(dut.Config.value), len(default_parameters()), 32)
    model = Registers(Build(dict(zip(default_parameters(), numbers, strict=True))))
    bits = [1 << bit for bit in range(len(dut.events))]
    status = [pack("capture_status_t", {"busy": busy, "done": done}) for busy, done in ((0, 0), (1, 0), (1, 1))]
    own, width, chance = [*OFFSET.values()], len(dut.s_axil_awaddr), random.Random(cocotb.RANDOM_SEED)
    near = [offset ^ 1 << bit for offset in own for bit in range(width)]
    addresses = [*own * 2 * width, *near, *[OFFSET[LOW]] * len(near)]
    pins = {
        **PINS,
        **dict.fromkeys(("s_axil_awprot", "s_axil_arprot", "first_depth_latency", "table_answer"), WORD),
        **dict.fromkeys(("levels", "record", "light_gains", "register_answer"), WORD),
        "cold_rst": 0.1,
        "events": [0, sum(bits), *bits],
        "first_depth_latency_valid": 1.0,
        "frame_start": 1.0,
        "table_in_use": [0, 15, 1, 2, 4, 8],
        **{
            f"{table}_status": [state | words for words in captured_words(chance) for state in status]
            for table in CAPTURES
        },
    }

    p = model.model.build.parameters
    entries = 1 << 3 * p["BitsPerChannel"]
    host = WholeTable(chance, entries) if entries <= 8 and not p["Polynomial"] else None

    def legal(registers: Registers, pins: Pins) -> None:
        """Draw addresses and data that wait for nobody. What stands for the bank in use is where it differs."""
        data = (chance.getrandbits(32), 1 << chance.randrange(32), chance.getrandbits(4), (1 << 32) - 1)
        for channel, pin, values in (("aw", "awaddr", addresses), ("ar", "araddr", addresses), ("w", "wdata", data)):
            if channel not in registers.waiting:
                pins[f"s_axil_{pin}"] = chance.choice(values)
        if host:
            host.drive(registers, pins)
        pins["table_in_use"] ^= registers.model.banks.bank

    begin_low(dut)
    await play(dut, model, pins, legal, CHANNELS, clocks=max(CLOCKS, 20_000))
