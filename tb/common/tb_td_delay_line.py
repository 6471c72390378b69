# SPDX-License-Identifier: Apache-2.0
"""td_delay_line against its model, with pauses, before and after a reset in mid-stream."""

import random
from typing import Any

import cocotb

from formal.entries import WORD_FREE, Proof
from tactile_depth.chip.common.td_delay_line import delay_line
from tb.stream import drive, parameters, parametrize
from tb.structures import ICARUS, VERILATOR, of_parameters

built = of_parameters("Width Delay Style Parity")
STRUCTURES = (
    built(54, 65, 3, 1, on=VERILATOR),
    built(1, 1, 3, 0, on=ICARUS),
    built(9, 2, 3, 0, on=ICARUS),
    built(8, 4, 3, 1, on=ICARUS, mutants=ICARUS),
    built(8, 5, 3, 0, on=ICARUS, mutants=ICARUS),
    built(8, 6, 1, 0, on=ICARUS, mutants=ICARUS),
    built(8, 5, 1, 1, on=ICARUS, mutants=ICARUS),
    built(8, 6, 4, 1, on=ICARUS, mutants=ICARUS),
    built(70, 8, 0, 1),
    built(12, 33, 3, 0),
    built(70, 128, 3, 1),
)
REFUSED = {"Delay_must_be_at_least_1": "Delay=0"}
PROOFS = tuple(
    Proof(why, {"Delay": delay, "Style": style, "Parity": parity})
    for delay, style, parity, why in (
        (1, 3, 0, "the smallest"),
        (4, 3, 0, f"the longest of registers; {WORD_FREE}"),
        (5, 3, 0, f"the shortest in memory; {WORD_FREE}"),
        (8, 3, 0, f"in memory, the pointer runs over at a power of two; {WORD_FREE}"),
        (6, 1, 0, f"in a block memory with a register behind it; {WORD_FREE}"),
        (6, 1, 1, f"in a block memory with a register before it too; {WORD_FREE}"),
        (6, 4, 1, "registers with a parity bit; words are not looked into"),
    )
)


@cocotb.test
@parametrize(pause=[0.0, 0.3], before=[0, 7])
async def shift(dut: Any, pause: float, before: Any) -> None:
    width, delay = parameters(dut, "Width", "Delay")
    chance = random.Random(cocotb.RANDOM_SEED)
    lost = [{"rst": 0, "in": chance.getrandbits(width)} for _ in range(before)] + [{"rst": 1, "in": 0}]
    kept = [{"rst": 0, "in": chance.getrandbits(width)} for _ in range(5 * delay + 20)]
    pins = await drive(dut, [*lost, *kept], ["out", "flipped"], pause)
    words = [int(word) for word in pins["in"][len(lost) :]]
    got = [int(word) for word in pins["out"][len(lost) + delay :]]
    assert got == delay_line(words, delay)[delay:]
    assert not any(int(flag) for flag in pins["flipped"][len(lost) + delay + 2 :])
