# SPDX-License-Identifier: Apache-2.0
"""td_banked_table against its model, every cycle: frames of any length, both ports of the free bank, pauses, resets."""

import random
from pathlib import Path
from typing import Any

import cocotb
import numpy as np
from cocotb.triggers import RisingEdge
from cocotb_tools.runner import as_sv_literal

from formal.entries import WORD_FREE, Proof
from tactile_depth.chip.common.td_banked_table import BankedTable
from tactile_depth.chip.rom_files import write_words
from tb.pins import Driver, by_name
from tb.stream import parameters, parametrize, start_clock
from tb.structures import ICARUS, VERILATOR, Structure

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
PROOFS = (
    Proof(
        WORD_FREE,
    ),
)


CLOCKS = 6000


class Bench:
    """Random stimuli that the header of the core allows, one cycle at a time."""

    banks: Any = None  # contents; they survive a reset, so the next test begins with them

    def __init__(self, dut: Any, pause: float) -> None:
        self.dut, self.pause = dut, pause
        self.drive, self.pin, self.edge = Driver(dut), by_name(dut), RisingEdge(dut.clk)
        self.width, self.depth = parameters(dut, "Width", "Depth")
        self.chance = random.Random(cocotb.RANDOM_SEED)
        self.named = 0  # bank of the next frame
        self.begun: int | None = None  # clocks with en since frame_start, until the change
        self.word: int | None = None  # entry that is read
        self.free_word: int | None = None
        self.changes = 0

    async def start(self) -> None:
        """Start and reset. On Verilator pins are random at first, and may write a word (test_power_up)."""
        pins = ("en", "frame_start", "change", "read", "free_write", "free_read", "table_bank")
        self.drive(**dict.fromkeys(pins, 0), rst=1)
        start_clock(self.dut.clk)
        await self.edge
        if Bench.banks is None:
            Bench.banks = BankedTable.of(np.array([int(line, 16) for line in Path("table.hex").read_text().split()]))
            if cocotb.SIM_NAME == "Verilator":
                await self.rewrite()
        self.banks.wanted = 0
        self.banks.begin_frame()
        self.drive(table_bank=0)
        await self.edge
        self.drive(rst=0)

    async def rewrite(self) -> None:
        """Write the words of both banks anew; in reset table_bank counts at once."""
        for bank in range(2):
            self.drive(table_bank=bank)
            await self.edge
            for address, word in enumerate(self.banks.words[1 - bank].tolist()):
                self.drive(free_write=1, free_write_address=address, free_write_word=word)
                await self.edge
            self.drive(free_write=0)

    async def clock(self, reset: bool = False) -> None:
        chance, banks = self.chance, self.banks
        en = chance.random() >= self.pause
        if banks.wanted == banks.in_use and chance.random() < 0.1:  # also while a frame that has begun is on its way
            banks.wanted ^= 1
        settled = banks.wanted == banks.in_use and not reset
        start = chance.random() < (0.2 if self.begun is None else 0.1)
        change = self.begun is not None and (self.begun >= 2 or chance.random() < 0.5)
        address, free_address, write_address = (chance.randrange(self.depth) for _ in range(3))
        write = settled and chance.random() < 0.5
        read = not reset and chance.random() < 0.5 and not (write and write_address == free_address)
        written = chance.getrandbits(self.width)
        read_frame = chance.random() < 0.8 or change
        self.drive(rst=reset, en=en, table_bank=banks.wanted, frame_start=start, change=change)
        self.drive(read=read_frame, read_address=address, free_read=read, free_read_address=free_address)
        self.drive(free_write=write, free_write_address=write_address, free_write_word=written)
        await self.edge
        self.check()
        self.free_word = None
        if reset:
            banks.begin_frame()
            self.named, self.begun, self.word = banks.in_use, None, None
            return
        if en:
            if change:
                self.changes += self.named != banks.in_use
                banks.in_use, self.begun = self.named, None
            elif self.begun is not None:
                self.begun += 1
            if start:
                self.named, self.begun = banks.wanted, 0
            self.word = int(banks.words[banks.in_use][address]) if read_frame else None
        if read:  # in the cycle of a change: of the previous bank
            self.free_word = int(banks.free[free_address])
        if write:
            banks.write(write_address, written)

    def check(self) -> None:
        assert self.pin("table_in_use") == self.banks.in_use, "table_in_use"
        if self.word is not None:
            assert self.pin("read_word") == self.word, "read_word"
        if self.free_word is not None:
            assert self.pin("free_word") == self.free_word, "free_word"


@cocotb.test()
@parametrize(pause=[0.0, 0.5])
async def frames_and_bus(dut: Any, pause: float) -> None:
    """Read in frames while both ports of the free bank are in use; reset from time to time."""
    bench = Bench(dut, pause)
    await bench.start()
    for _ in range(CLOCKS):
        await bench.clock(bench.chance.random() < 0.005)
    assert bench.changes > CLOCKS // 100, f"the test is void: {bench.changes} change-overs"
