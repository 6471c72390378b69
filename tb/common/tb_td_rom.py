# SPDX-License-Identifier: Apache-2.0
"""td_rom against tactile_depth.chip.common.td_rom: every word, twice over in random order, with pauses."""

import random
from pathlib import Path
from typing import Any

import cocotb

from tactile_depth.chip.common.td_rom import LATENCY, rom
from tactile_depth.chip.rom_files import write_words
from tb.stream import drive, parameters, parametrize
from tb.structures import ICARUS, VERILATOR, Structure


def built(width: int, depth: Any, style: int, **runs: Any) -> Structure:
    chance = random.Random(depth)
    words = [chance.getrandbits(width) for _ in range(depth)]
    return Structure(
        {"Width": width, "Depth": depth, "Style": style},
        roms=lambda folder: write_words(folder / "rom.hex", words, width),
        **runs,
    )


STRUCTURES = (
    built(54, 128, 3, on=VERILATOR),
    built(10, 36, 3, on=ICARUS, mutants=ICARUS),
    built(72, 33, 3),
    built(54, 128, 0),
    built(10, 36, 1),
)
REFUSED = {"Depth_must_be_at_least_2": "Depth=1"}
PROTOCOL = {"holds": "32'(address) < Depth", "settled": {}, "counts": "settled"}
NO_PROOF = "one read register and no other state; its contents and addresses are proven of those that use it"


@cocotb.test
@parametrize(pause=[0.0, 0.3])
async def every_word(dut: Any, pause: float) -> None:
    (depth,) = parameters(dut, "Depth")
    words = [int(line, 16) for line in Path("rom.hex").read_text().split()]
    places = random.Random(cocotb.RANDOM_SEED).sample(range(depth), depth)
    stimuli = [{"address": place} for place in (*range(depth), *places, *[0] * LATENCY)]
    pins = await drive(dut, stimuli, ["data"], pause)
    addresses = [int(address) for address in pins["address"]]
    assert [int(word) for word in pins["data"][LATENCY:]] == rom(words, addresses)[:-LATENCY]
