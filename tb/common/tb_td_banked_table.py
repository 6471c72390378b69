# SPDX-License-Identifier: Apache-2.0
"""td_banked_table against its model in every clock; with parity some words of its file have a flipped bit."""

from pathlib import Path
from typing import Any

import cocotb
from cocotb_tools.runner import as_sv_literal

from formal.entries import WORD_FREE, Proof
from tactile_depth.chip.common.td_banked_table import BankedTable
from tactile_depth.chip.rom_files import write_words
from tb.common.tb_td_parity_ram import flipped_at_random
from tb.lockstep import WORD, Pins, play
from tb.stream import parameters
from tb.structures import ICARUS, VERILATOR, Structure
from tb.table_bus import at_power_up, change_over

DISTRIBUTED, BLOCK = range(2)


def built(width: int, depth: int, style: int, parity: int, **runs: Any) -> Structure:
    def contents(folder: Path) -> None:
        words = [word % (1 << width + parity) for word in flipped_at_random(width, depth)]
        write_words(folder / "table.hex", words, width + parity)

    parameters = {"Width": width, "Depth": depth, "Style": style, "File": as_sv_literal("table.hex")}
    return Structure(parameters | {"Parity": parity}, roms=contents, **runs)


STRUCTURES = (
    built(24, 36, BLOCK, 1, on=VERILATOR),
    built(5, 6, DISTRIBUTED, 0, on=ICARUS, mutants=ICARUS),
    built(5, 6, DISTRIBUTED, 1, on=ICARUS, mutants=ICARUS),
    built(42, 64, BLOCK, 0),
)
PROOFS = tuple(Proof(WORD_FREE, {"Parity": parity}) for parity in (0, 1))


@cocotb.test
async def frames_and_bus(dut: Any) -> None:
    depth, width, parity = parameters(dut, "Depth", "Width", "Parity")
    late: int | None = None  # address of a word that is written a clock later

    def legal(table: BankedTable, pins: Pins) -> None:
        """Read first when a frame that has begun changes over; write no word that is read, and none in a reset."""
        nonlocal late
        change_over(table, pins, False)
        pins["change"] &= table.named is not None
        pins["read"] |= pins["change"]
        pins["free_write"] &= table.settled(pins["table_bank"]) and not pins["rst"]
        written = pins["free_write_address"] if pins["free_write"] else None
        pins["free_read"] &= pins["free_read_address"] not in (written, late)
        late = written if parity else None

    words = [int(line, 16) for line in Path("table.hex").read_text().split()]
    choices: dict[str, Any] = dict.fromkeys(("en", "frame_start", "change", "read", "free_write", "free_read"), 1.0)
    choices |= dict.fromkeys(("read_address", "free_write_address", "free_read_address"), range(depth))
    choices |= {"table_bank": (0,), "commit": 0.3, "free_write_word": WORD}
    await play(dut, BankedTable(at_power_up(words), width * parity), choices, legal)
