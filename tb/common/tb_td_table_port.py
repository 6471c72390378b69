# SPDX-License-Identifier: Apache-2.0
"""td_table_port against its model, every cycle: accesses of every table, entries that change, resets."""

import random
from typing import Any

import cocotb
from cocotb.triggers import RisingEdge

from tactile_depth.chip.common.td_table_port import WORD_BITS, TablePort
from tb import structs
from tb.stream import parameters, start_clock

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
