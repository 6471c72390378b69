# SPDX-License-Identifier: Apache-2.0
"""td_table_port against its model in every clock."""

from typing import Any

import cocotb

from formal.entries import Proof
from tactile_depth.chip.common.td_table_port import TablePort
from tb import table_bus
from tb.lockstep import WORD, play
from tb.stream import parameters
from tb.structures import ICARUS, VERILATOR, Structure


def built(select: int, index: int, width: int, words: int, signed: int, entries: int = 1, **runs: Any) -> Structure:
    numbers = {"Select": select, "IndexWidth": index, "Width": width, "Words": words, "Signed": signed}
    return Structure({**numbers, "Entries": entries}, **runs)


STRUCTURES = (
    built(3, 8, 24, 1, 1, on=VERILATOR),
    built(0, 3, 2, 2, 1, on=ICARUS, mutants=ICARUS),
    built(2, 5, 3, 1, 0, on=ICARUS, mutants=ICARUS),
    built(1, 6, 32, 1, 1),
    built(2, 10, 24, 1, 0),
    built(0, 12, 21, 2, 1),
    built(2, 4, 5, 1, 1, entries=3, on=ICARUS, mutants=ICARUS),
    built(3, 6, 24, 1, 0, entries=4, on=VERILATOR),
)
REFUSED = {"an_entry_is_1_or_2_words_of_at_most_32_bits": "Width=33, Words=3"}
PROOFS = tuple(
    Proof(
        "words are only copied and extended; of one word, and of two; one entry, two and three side by side",
        {"Signed": signed, "Words": words, "Entries": entries},
    )
    for signed, words, entries in ((1, 2, 1), (0, 1, 3), (1, 2, 2))
)


@cocotb.test
async def accesses(dut: Any) -> None:
    select, *sizes = parameters(dut, "Select", "IndexWidth", "Width", "Words", "Entries", "Signed")
    choices = {**table_bus.choices(select), "free_word": WORD}
    await play(dut, TablePort(select, *sizes), choices, lambda model, pins: table_bus.pack(pins))
