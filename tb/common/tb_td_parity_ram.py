# SPDX-License-Identifier: Apache-2.0
"""td_parity_ram against its model in every clock; some words of its file have a flipped bit."""

import random
from pathlib import Path
from typing import Any

import cocotb
from cocotb_tools.runner import as_sv_literal

from formal.entries import WORD_FREE, Proof
from tactile_depth.chip.common.td_parity_ram import ParityRam, checked
from tactile_depth.chip.rom_files import write_words
from tb.lockstep import WORD, Pins, play
from tb.stream import parameters
from tb.structures import ICARUS, VERILATOR, Structure

FILE = "words.hex"


def flipped_at_random(width: int, depth: int) -> list[int]:
    """Return words with their parity, every third of which has a flipped bit."""
    chance = random.Random(depth)
    words = [checked(chance.getrandbits(width), width) for _ in range(depth)]
    return [word ^ (n % 3 == 0) << chance.randrange(width + 1) for n, word in enumerate(words)]


def built(width: int, depth: int, style: int, latency: int, parity: int, **runs: Any) -> Structure:
    def contents(folder: Path) -> None:
        words = flipped_at_random(width, depth)
        stored = words if parity else [word % (1 << width) for word in words]
        write_words(folder / FILE, stored, width + parity)

    parameters = {"Width": width, "Depth": depth, "Style": style, "File": as_sv_literal(FILE), "Latency": latency}
    return Structure(parameters | {"Parity": parity}, roms=contents, **runs)


STRUCTURES = (
    built(24, 36, 1, 2, 1, on=VERILATOR),
    built(5, 6, 0, 1, 1, on=ICARUS, mutants=ICARUS),
    built(4, 7, 0, 2, 1, mutants=ICARUS),
    built(7, 6, 1, 1, 0),
    built(3, 9, 1, 2, 0),
)
REFUSED = {"Latency_must_be_1_or_2": "Latency=3", "Parity_must_be_0_or_1": "Parity=2"}
PROOFS = tuple(Proof(WORD_FREE, {"Latency": latency}) for latency in (1, 2))


def legal(_: ParityRam, pins: Pins) -> None:
    """Read no word in the clock that writes it."""
    pins["read_en"] &= not (pins["write_en"] and pins["write_address"] == pins["read_address"])


@cocotb.test
async def reads_and_writes(dut: Any) -> None:
    width, depth, latency, parity = parameters(dut, "Width", "Depth", "Latency", "Parity")
    words = [int(line, 16) for line in Path(FILE).read_text().split()]
    choices: dict[str, Any] = dict.fromkeys(("en", "write_en", "read_en"), 1.0)
    choices |= dict.fromkeys(("write_address", "read_address"), range(depth))
    await play(dut, ParityRam(words, width, latency, bool(parity)), choices | {"write_data": WORD}, legal)
