# SPDX-License-Identifier: Apache-2.0
"""td_rom against tactile_depth.chip.common.td_rom: every word, twice over in random order, with pauses."""

import random
from pathlib import Path
from typing import Any

import cocotb

from tactile_depth.chip.common.td_rom import LATENCY, rom
from tb.stream import drive, parameters, parametrize


@cocotb.test()
@parametrize(pause=[0.0, 0.3])
async def every_word(dut: Any, pause: float) -> None:
    (depth,) = parameters(dut, "Depth")
    words = [int(line, 16) for line in Path("rom.hex").read_text().split()]
    places = random.Random(cocotb.RANDOM_SEED).sample(range(depth), depth)
    stimuli = [{"address": place} for place in (*range(depth), *places, *[0] * LATENCY)]
    pins = await drive(dut, stimuli, ["data"], pause)
    addresses = [int(address) for address in pins["address"]]
    assert [int(word) for word in pins["data"][LATENCY:]] == rom(words, addresses)[:-LATENCY]
