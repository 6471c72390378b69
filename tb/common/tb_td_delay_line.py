# SPDX-License-Identifier: Apache-2.0
"""td_delay_line against its model, with pauses, before and after a reset in mid-stream."""

import random
from typing import Any

import cocotb

from tactile_depth.chip.common.td_delay_line import delay_line
from tb.stream import drive, parameters, parametrize


@cocotb.test()
@parametrize(pause=[0.0, 0.3], before=[0, 7])
async def shift(dut: Any, pause: float, before: Any) -> None:
    width, delay = parameters(dut, "Width", "Delay")
    chance = random.Random(cocotb.RANDOM_SEED)
    lost = [{"rst": 0, "in": chance.getrandbits(width)} for _ in range(before)] + [{"rst": 1, "in": 0}]
    kept = [{"rst": 0, "in": chance.getrandbits(width)} for _ in range(5 * delay + 20)]
    pins = await drive(dut, [*lost, *kept], ["out"], pause)
    words = [int(word) for word in pins["in"][len(lost) :]]
    got = [int(word) for word in pins["out"][len(lost) + delay :]]
    assert got == delay_line(words, delay)[delay:]
