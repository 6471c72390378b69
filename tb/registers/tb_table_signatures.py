# SPDX-License-Identifier: Apache-2.0
"""table_signatures against its model in every clock."""

import random
from pathlib import Path
from typing import Any

import cocotb
from cocotb_tools.runner import as_sv_literal

from formal.entries import Proof
from tactile_depth.chip.common.signature import Captured
from tactile_depth.chip.registers.register_map import WORD, WORD_BITS
from tactile_depth.chip.registers.table_banks import CAPTURES
from tactile_depth.chip.registers.table_signatures import GRADIENT, REFERENCE, ZERO, TableSignatures
from tactile_depth.chip.rom_files import write_words
from tb import structs
from tb.lockstep import CLOCKS, Pins, play
from tb.registers.bus import OFFSET, STROBES, begin_low
from tb.structures import ICARUS, VERILATOR, Structure

FILE, WORDS = "signatures.hex", [0x11111111 * n for n in range(8)]
NAMES = (
    "TABLE_HIGH",
    "TABLE_INDEX",
    "TABLE_LOW",
    "TABLE_SIGNATURE",
    *(register.name for register in CAPTURES.values()),
)
ENTRIES = 3  # of each table


def write_file(folder: Path) -> None:
    write_words(folder / FILE, WORDS, WORD_BITS)


STRUCTURES = (
    Structure({"Side": 1}, on=VERILATOR, mutants=ICARUS),
    Structure({"File": as_sv_literal(FILE), "Side": 4}, roms=write_file, on=ICARUS, mutants=ICARUS),
)
PROTOCOL = {"counts": "live"}
PROOFS = (Proof("any bank of any table, at the widths in use"),)


def advance(model: TableSignatures, pins: Pins, command: Pins) -> None:
    """Advance the model by a clock, with the pins of the core and the members of table_command."""
    captured = {REFERENCE: "reference_captured", ZERO: "zero_captured"}
    words = {table: Captured(**structs.unpack("captured_t", pins[pin])) for table, pin in captured.items()}
    write_offset = pins["write_offset"] if pins["write"] else None
    resets = pins["rst"], pins["cold_rst"]
    model.clock(command, pins["table_in_use"], words, write_offset, pins["write_mask"], *resets)


def captured_words(chance: random.Random) -> list[int]:
    """Return what a capture may say in a clock, mostly nothing, or a step."""
    steps = (Captured(writes=1, steps=1, ends=end, word=chance.getrandbits(32)) for end in (0, 0, 0, 1))
    return [each.bits for each in (Captured(), Captured(starts=1), Captured(writes=1), *steps)]


class Signatures:
    """The model at the pins of the core, and a host that writes tables from the first entry to the last.

    Attributes
    ----------
    index, half : int, bool
        Of the entry that is next; its upper word was written.
    """

    def __init__(self, model: TableSignatures) -> None:
        self.model, self.index, self.half = model, 0, False

    def clock(self, **pins: int) -> dict[str, int]:
        """Advance by one clock edge; return the outputs before it."""
        command = structs.unpack("table_command_t", pins["table_command"])
        held = self.model.held(pins["table_in_use"])
        shown = {OFFSET["TABLE_SIGNATURE"]: self.model.shown}
        shown |= {register.offset: register.pack(held=table in held) for table, register in CAPTURES.items()}
        advance(self.model, pins, command)
        upper = pins["write"] and pins["write_offset"] == OFFSET["TABLE_HIGH"]
        if command["write"]:
            self.index = (command["index"] + 1) % ENTRIES
        if command["write"] or upper or pins["rst"]:
            self.half = not (command["write"] or pins["rst"] or self.half) and command["select"] == GRADIENT
        return {"read_data": shown.get(pins["read_offset"], 0)}


class Writers:
    """Writers of tables for a while: the host, from the first entry of a table to the last, or a capture; or anything.

    Attributes
    ----------
    kind : str
        `host`, `reference`, `zero` or `any`.
    """

    def __init__(self, chance: random.Random) -> None:
        self.chance, self.kind, self.left, self.in_use, self.table = chance, "any", 0, 0, 0
        self.words = captured_words(chance)

    def drive(self, signatures: Signatures, pins: Pins) -> None:
        """Turn pins that may be anything into those of whatever writes, but for a few."""
        chance = self.chance
        pins["rst"] |= chance.random() < 0.01  # also as a run ends
        if not self.left:
            self.words = captured_words(chance)
            self.kind = chance.choice(("host", "host", "reference", "zero", "any"))
            self.left, self.table = chance.randrange(20, 80), chance.choice((0, 0, 1, 2, 3))
        self.left -= 1
        stray = self.kind == "any" or chance.random() < 0.03
        if stray or chance.random() < 0.05:
            self.in_use = pins["table_in_use"]
        pins["table_in_use"] = self.in_use
        table = chance.randrange(4) if stray else self.table
        upper = table == GRADIENT and not signatures.half
        if not stray:
            pins["write"] = int(self.kind == "host" and chance.random() < 0.7)
            pins["write_offset"], pins["write_mask"] = OFFSET["TABLE_HIGH" if upper else "TABLE_LOW"], STROBES[0]
            for name in CAPTURES:
                pins[f"{name}_captured"] = chance.choice(self.words) if name == self.kind else 0
            if chance.random() < 0.02:  # a word that is not whole
                pins["write_mask"] = chance.choice((*STROBES, WORD ^ 1 << chance.randrange(32)))
            if chance.random() < 0.12:  # another register, mostly near one that matters
                near = chance.choice((OFFSET["TABLE_INDEX"], OFFSET["TABLE_HIGH"]))
                pins["write_offset"] = near ^ (chance.random() < 0.8) << chance.randrange(2, 32)
        writes = pins["write"] and pins["write_offset"] == OFFSET["TABLE_LOW"] and not pins["rst"]
        index = chance.randrange(4) if stray and chance.random() < 0.3 else signatures.index
        command = {"write": int(writes), "read": int(stray and chance.random() < 0.3), "select": table}
        command |= {"index": index, "low": chance.getrandbits(32)}
        pins["table_command"] = structs.pack("table_command_t", command)
        if chance.random() < 0.6:
            pins["read_offset"] = OFFSET["TABLE_SIGNATURE"]
        pins["read_offset"] ^= (chance.random() < 0.2) << chance.randrange(2, 32)


@cocotb.test
async def signatures(dut: Any) -> None:
    chance, own = random.Random(cocotb.RANDOM_SEED), [OFFSET[name] for name in NAMES]
    writers = Writers(chance)
    pins = {
        **{
            "write": 1.0,
            "write_offset": own,
            "write_mask": STROBES,
            "read_offset": own,
            "rst": 0.002,
            "cold_rst": 0.002,
        },
        "table_in_use": range(16),
        "table_command": [0],
        **{f"{name}_captured": writers.words for name in CAPTURES},
    }
    model = TableSignatures(WORDS if dut.File.value else [0] * 8, int(dut.Side.value))
    begin_low(dut)
    await play(dut, Signatures(model), pins, writers.drive, clocks=6 * CLOCKS)
