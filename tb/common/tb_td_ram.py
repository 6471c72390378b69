# SPDX-License-Identifier: Apache-2.0
"""td_ram against its model: every word read, with reads and writes of different addresses in the same cycle."""

import random
from pathlib import Path
from typing import Any

import cocotb
from cocotb_tools.runner import as_sv_literal

from commands.hardware.ecp5 import write_slices
from formal.entries import WORD_FREE, Proof
from tactile_depth.chip.common.td_ram import ram
from tactile_depth.chip.rom_files import write_words
from tb.settings import RUN
from tb.stream import drive, parameters
from tb.structures import ICARUS, VERILATOR, Structure

DISTRIBUTED, BLOCK, ULTRA = range(3)


def built(width: int, depth: int, style: int, file: str = "", **runs: Any) -> Structure:
    def contents(folder: Path) -> None:
        if file:
            chance = random.Random(depth)
            write_words(folder / file, [chance.getrandbits(width) for _ in range(depth)], width)
            write_slices(folder)

    parameters = {"Width": width, "Depth": depth, "Style": style}
    named = {"File": as_sv_literal(file)} if file else {}
    return Structure(parameters | named, device={"file": file}, roms=contents, **runs)


STRUCTURES = (
    built(24, 64, BLOCK, "contents.hex", on=VERILATOR),
    built(5, 16, DISTRIBUTED, on=ICARUS, mutants=ICARUS),
    built(9, 24, DISTRIBUTED, "contents.hex", on=ICARUS),
    built(70, 32, ULTRA, on=ICARUS),
)
REFUSED = {
    "Depth_must_be_at_least_2": "Depth=1",
    "an_ultra_memory_has_no_contents_at_power_up": 'Style=2 File="contents.hex"',
}
PROTOCOL = {
    "holds": "~(read_en & write_en & read_address == write_address)"
    " & (~read_en | 32'(read_address) < Depth) & (~write_en | 32'(write_address) < Depth)"
}
PROOFS = tuple(Proof(WORD_FREE, {"Style": style}) for style in (0, 1, 2))


@cocotb.test
async def reads_and_writes(dut: Any) -> None:
    width, depth = parameters(dut, "Width", "Depth")
    chance = random.Random(cocotb.RANDOM_SEED)
    file = RUN.device["file"]
    before = [int(line, 16) for line in Path(file).read_text().split()] if file else [None] * depth

    def clock(read_address: Any = None, write_address: Any = None) -> Any:
        return {
            "write_en": write_address is not None,
            "write_address": write_address or 0,
            "write_data": chance.getrandbits(width),
            "read_en": read_address is not None,
            "read_address": read_address or 0,
        }

    every = [clock(read_address=place) for place in range(depth)] if file else []
    every += [clock(write_address=place) for place in chance.sample(range(depth), depth)]
    mixed = max(2_000, depth)
    for _ in range(mixed):
        read, write = (place if chance.random() < 0.5 else None for place in chance.sample(range(depth), 2))
        every.append(clock(read, write))
    every += [clock(read_address=place) for place in range(depth)]
    outputs = await drive(dut, [*every, clock()], ["read_data"])

    pins = ("write_en", "write_address", "write_data", "read_en", "read_address")
    _, expected = ram(before, list(zip(*(map(int, outputs[pin]) for pin in pins), strict=True))[:-1])  # type: ignore[arg-type]
    compared = [(int(outputs["read_data"][n + 1]), word) for n, word in enumerate(expected) if word is not None]
    assert len(compared) > mixed
    for n, (got, word) in enumerate(compared):
        assert got == word, f"read {n}: {got:#x}, expected {word:#x}"
