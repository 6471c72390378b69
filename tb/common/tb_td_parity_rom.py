# SPDX-License-Identifier: Apache-2.0
"""td_parity_rom against its model in every clock; some words of its file have a flipped bit."""

from pathlib import Path
from typing import Any

import cocotb

from tactile_depth.chip.common.td_parity_rom import ParityRom
from tactile_depth.chip.rom_files import write_words
from tb.common.tb_td_parity_ram import flipped_at_random
from tb.lockstep import play
from tb.stream import parameters
from tb.structures import ICARUS, VERILATOR, Structure

FILE = "rom.hex"


def built(width: int, depth: int, latency: int, parity: int, **runs: Any) -> Structure:
    def contents(folder: Path) -> None:
        words = flipped_at_random(width, depth)
        stored = words if parity else [word % (1 << width) for word in words]
        write_words(folder / FILE, stored, width + parity)

    return Structure({"Width": width, "Depth": depth, "Latency": latency, "Parity": parity}, roms=contents, **runs)


STRUCTURES = (
    built(54, 128, 2, 1, on=VERILATOR),
    built(10, 36, 1, 1, on=ICARUS, mutants=ICARUS),
    built(7, 33, 2, 1, mutants=ICARUS),
    built(10, 36, 1, 0),
    built(10, 36, 2, 0),
)
REFUSED = {"Latency_must_be_1_or_2": "Latency=3", "Parity_must_be_0_or_1": "Parity=2"}
PROTOCOL = {"holds": "32'(address) < Depth", "settled": {}, "counts": "settled"}
NO_PROOF = "registers behind a td_rom and no other state; its contents and addresses are proven of those that use it"


@cocotb.test
async def every_word(dut: Any) -> None:
    width, depth, latency, parity = parameters(dut, "Width", "Depth", "Latency", "Parity")
    words = [int(line, 16) for line in Path(FILE).read_text().split()]
    await play(dut, ParityRom(words, width, latency, bool(parity)), {"en": 1.0, "address": range(depth)})
