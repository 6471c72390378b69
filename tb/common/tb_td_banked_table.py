# SPDX-License-Identifier: Apache-2.0
"""td_banked_table against its model in every clock."""

import random
from pathlib import Path
from typing import Any

import cocotb
from cocotb_tools.runner import as_sv_literal

from formal.entries import WORD_FREE, Proof
from tactile_depth.chip.common.td_banked_table import BankedTable
from tactile_depth.chip.rom_files import write_words
from tb.lockstep import WORD, Pins, play
from tb.stream import parameters
from tb.structures import ICARUS, VERILATOR, Structure
from tb.table_bus import at_power_up, change_over

DISTRIBUTED, BLOCK = range(2)


def built(width: int, depth: int, style: int, **runs: Any) -> Structure:
    def contents(folder: Path) -> None:
        chance = random.Random(depth)
        write_words(folder / "table.hex", [chance.getrandbits(width) for _ in range(depth)], width)

    parameters = {"Width": width, "Depth": depth, "Style": style, "File": as_sv_literal("table.hex")}
    return Structure(parameters, roms=contents, **runs)


STRUCTURES = (
    built(24, 36, BLOCK, on=VERILATOR),
    built(5, 6, DISTRIBUTED, on=ICARUS, mutants=ICARUS),
    built(42, 64, BLOCK),
)
PROOFS = (Proof(WORD_FREE),)


def legal(table: BankedTable, pins: Pins) -> None:
    """Read first when a frame that has begun changes over; write no word that is read, and none in a reset."""
    change_over(table, pins, False)
    pins["change"] &= table.named is not None
    pins["read"] |= pins["change"]
    pins["free_write"] &= table.settled(pins["table_bank"]) and not pins["rst"]
    pins["free_read"] &= not (pins["free_write"] and pins["free_read_address"] == pins["free_write_address"])


@cocotb.test
async def frames_and_bus(dut: Any) -> None:
    (depth,) = parameters(dut, "Depth")
    words = [int(line, 16) for line in Path("table.hex").read_text().split()]
    choices: dict[str, Any] = dict.fromkeys(("en", "frame_start", "change", "read", "free_write", "free_read"), 1.0)
    choices |= dict.fromkeys(("read_address", "free_write_address", "free_read_address"), range(depth))
    choices |= {"table_bank": (0,), "commit": 0.3, "free_write_word": WORD}
    await play(dut, BankedTable(at_power_up(words)), choices, legal)
