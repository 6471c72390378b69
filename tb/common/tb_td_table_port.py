# SPDX-License-Identifier: Apache-2.0
"""td_table_port against its model, every cycle: accesses of every table, entries that change, resets."""

import random
from typing import Any

import cocotb
from cocotb.triggers import RisingEdge

from formal.entries import Proof
from tactile_depth.chip.common.td_table_port import WORD_BITS, TablePort
from tb import structs
from tb.stream import parameters, start_clock
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


CLOCKS = 6000


@cocotb.test()
async def accesses(dut: Any) -> None:
    """Drive every member of the bus at random; check what reaches the table, and the answer."""
    chance = random.Random(cocotb.RANDOM_SEED)
    select, index_width, width, words, entries, signed = parameters(
        dut, "Select", "IndexWidth", "Width", "Words", "Entries", "Signed"
    )
    model = TablePort(select, index_width, width, words, entries, bool(signed))
    dut.rst.value, dut.table_command.value, dut.free_word.value = 1, 0, 0
    start_clock(dut.clk)
    await RisingEdge(dut.clk)
    answers = 0
    for clock in range(CLOCKS):
        command = {
            "write": int(chance.random() < 0.3),
            "read": int(chance.random() < 0.3),
            "select": select if chance.random() < 0.6 else chance.randrange(4),
            "index": chance.getrandbits(24),
            "high": chance.getrandbits(WORD_BITS),
            "low": chance.getrandbits(WORD_BITS),
        }
        reset, free_word = int(clock == 0 or chance.random() < 0.05), chance.getrandbits(entries * words * width)
        dut.rst.value, dut.free_word.value = reset, free_word
        dut.table_command.value = structs.pack("table_command_t", command)
        await RisingEdge(dut.clk)
        if clock:
            model.write &= not reset
            got = {pin: int(getattr(dut, pin).value) for pin in ("write", "read", "index", "word")}
            assert got == {pin: getattr(model, pin) for pin in got}, f"clock {clock}: {got}"
            if (answer := model.answer()) is not None:
                assert structs.of(dut.table_answer, "table_answer_t") == answer, f"clock {clock}"
                answers += any(answer.values())
        model.clock(command, free_word, reset)
    assert answers > CLOCKS // 10, f"the test is void: {answers} answers"
