# SPDX-License-Identifier: Apache-2.0
"""table_signatures against its model in every clock."""

import random
from pathlib import Path
from typing import Any

import cocotb

from formal.entries import Proof
from tactile_depth.chip.common.signature import Captured
from tactile_depth.chip.registers.register_map import WORD_BITS
from tactile_depth.chip.registers.table_banks import CAPTURES
from tactile_depth.chip.registers.table_signatures import REFERENCE, ZERO, TableSignatures
from tactile_depth.chip.rom_files import write_words
from tb import structs
from tb.lockstep import Pins, play
from tb.registers.bus import OFFSET, STROBES
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
    Structure({"File": FILE, "Side": 4}, roms=write_file, on=ICARUS, mutants=ICARUS),
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
    index : int
        Of the entry that is next.
    """

    def __init__(self, model: TableSignatures) -> None:
        self.model, self.index = model, 0

    def clock(self, **pins: int) -> dict[str, int]:
        """Advance by one clock edge; return the outputs before it."""
        command = structs.unpack("table_command_t", pins["table_command"])
        held = self.model.held(pins["table_in_use"])
        shown = {OFFSET["TABLE_SIGNATURE"]: self.model.shown}
        shown |= {register.offset: register.pack(held=table in held) for table, register in CAPTURES.items()}
        advance(self.model, pins, command)
        if command["write"]:
            self.index = (command["index"] + 1) % ENTRIES
        return {"read_data": shown.get(pins["read_offset"], 0)}


@cocotb.test()
async def signatures(dut: Any) -> None:
    has_file = bool(dut.File.value)
    model = TableSignatures(WORDS if has_file else [0] * 8, int(dut.Side.value))
    chance = random.Random(cocotb.RANDOM_SEED)
    own = [OFFSET[name] for name in NAMES]
    pins = {
        "write": 1.0,
        "write_offset": own,
        "write_mask": STROBES,
        "read_offset": own,
        "table": [0, 0, 1, 2, 3],
        "astray": 0.05,
        "lower": 1.0,
        "reads": 0.05,
        "cold_rst": 0.01,
        "table_in_use": range(16),
        "reference_captured": captured_words(chance),
        "zero_captured": captured_words(chance),
    }
    far = [OFFSET["TABLE_SIGNATURE"] ^ 1 << bit for bit in range(2, 32)]

    pins |= {"table_command": [0]}

    def legal(signatures: Signatures, pins: Pins) -> None:
        """Write TABLE_HIGH and TABLE_LOW of one entry after another, seldom anything else."""
        astray, table, lower = pins.pop("astray"), pins.pop("table"), pins.pop("lower")
        reads, data = pins.pop("reads"), chance.getrandbits(32)
        if not astray:
            pins["write_offset"] = OFFSET["TABLE_LOW" if lower else "TABLE_HIGH"]
            pins["write_mask"] = STROBES[0]
        pins["read_offset"] = chance.choice((OFFSET["TABLE_SIGNATURE"], pins["read_offset"], chance.choice(far)))
        writes = pins["write"] and pins["write_offset"] == OFFSET["TABLE_LOW"] and not pins["rst"]
        index = signatures.index ^ (astray and chance.randrange(4))
        command = {"write": int(writes), "read": int(reads), "select": table, "index": index, "low": data}
        pins["table_command"] = structs.pack("table_command_t", command)

    await play(dut, Signatures(model), pins, legal)
