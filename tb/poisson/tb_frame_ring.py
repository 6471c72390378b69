# SPDX-License-Identifier: Apache-2.0
"""frame_ring against its model in every clock: frames, and some that are cut short; any frame is read at any time."""

import random
from typing import Any

import cocotb

from formal.entries import Proof
from tactile_depth.chip.poisson.frame_ring import FrameRing
from tb.lockstep import WORD, Pins, play
from tb.stream import parameters
from tb.structures import ICARUS, VERILATOR, of_parameters

NAMES = "Width Words Held LastFirst Late Parity"
built = of_parameters(NAMES)
STRUCTURES = (
    built(13, 12, 40, 1, 0, 1, on=VERILATOR),
    built(5, 6, 16, 0, 24, 1, on=ICARUS, mutants=ICARUS),
    built(4, 8, 20, 1, 0, 0, mutants=ICARUS),
    built(4, 5, 11, 1, 20, 1, mutants=ICARUS),
)
PROOFS = (
    Proof("the latest frame, from its last word back", {"LastFirst": 1, "Late": 0}),
    Proof("a frame behind the latest one, from its first word on", {"LastFirst": 0, "Late": 8}),
)


@cocotb.test
async def frames(dut: Any) -> None:
    width, words, held, last_first, late, parity = parameters(dut, *NAMES.split())
    chance = random.Random(cocotb.RANDOM_SEED)

    def legal(ring: FrameRing, pins: Pins) -> None:
        """Begin few frames early, read what is known, and no word in the clock that writes it."""
        if chance.random() < 0.98:
            pins["in_frame_start"] = ring.word in (None, 0, words)
        pins["out_frame_start"] &= ring.chosen is not None
        pins["out_next"] &= ring.read is not None and not (pins["en"] and pins["in_valid"] and ring.write == ring.read)

    ring = FrameRing(width, words, held, last_first=bool(last_first), late=late, parity=bool(parity))
    choices: dict[str, Any] = dict.fromkeys(("en", "in_valid", "out_en", "out_next"), 1.0)
    choices |= {"in_frame_start": 0.1, "out_frame_start": 0.2, "in_data": WORD}
    await play(dut, ring, choices, legal)
