# SPDX-License-Identifier: Apache-2.0
"""td_banked_table: RTL against the model; the model's banks."""

import random
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from cocotb_tools.runner import as_sv_literal

from formal.entries import WORD_FREE, Proof
from tactile_depth.chip.common.td_banked_table import BankedTable
from tactile_depth.chip.rom_files import write_words
from tb.structures import ICARUS, VERILATOR, Structure
from tests.rtl import test_rtl as test_rtl

DISTRIBUTED, BLOCK = range(2)


def built(width: int, depth: int, style: int, **runs: Any) -> Structure:
    def contents(folder: Path) -> None:
        chance = random.Random(depth)
        write_words(folder / "table.hex", [chance.getrandbits(width) for _ in range(depth)], width)

    parameters = {"Width": width, "Depth": depth, "Style": style, "File": as_sv_literal("table.hex")}
    return Structure(parameters, roms=contents, **runs)


STRUCTURES = (
    built(24, 36, BLOCK, on=VERILATOR),
    built(5, 6, DISTRIBUTED, on=ICARUS, mutants=True),
    built(42, 64, BLOCK),
)
PROOFS = (
    Proof(
        "a frame reads the bank named when it began; the free bank reads as it was written",
        WORD_FREE,
        depth=30,
    ),
)


def test_a_bank_is_written_while_the_other_is_in_use() -> None:
    table = BankedTable.of(np.array([1, 2, 3]))
    table.write(0, 9)
    assert table.begin_frame().tolist() == [1, 2, 3]
    table.wanted = 1
    with pytest.raises(ValueError, match="entry 1 is written while a change-over is due"):
        table.write(1, 8)
    assert table.begin_frame().tolist() == [9, 2, 3]
    assert table.free.tolist() == [1, 2, 3]
