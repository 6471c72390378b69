# SPDX-License-Identifier: Apache-2.0
"""black_level against its model in every clock."""

from typing import Any

import cocotb

from formal.entries import FULL_WIDTH, Proof
from tactile_depth.chip.camera.black_level import BlackLevel
from tb.lockstep import WORD, Pins, play
from tb.stream import parameters
from tb.structures import BOTH, ICARUS, Mutants, of_parameters

built = of_parameters("Bits Channels")
STRUCTURES = (
    built(10, 1, on=BOTH, mutants=ICARUS),
    built(8, 3, on=ICARUS, mutants=ICARUS),
    built(12, 1),
    built(10, 3),
    built(8, 1),
)
PROTOCOL = {
    "begun": {"begins": "en & in_valid"},
    "holds": "rst | ~in_valid | begun | in_frame_start",
    "counts": "live & ~reset",
    "out_samples out_colour out_row_start out_frame_start out_gains": "counts & out_valid",
}
MUTANTS = Mutants(repeats=2)
PROOFS = tuple(Proof(FULL_WIDTH, {"Bits": bits, "Channels": channels}) for bits, channels in ((10, 1), (8, 3)))


def legal(core: BlackLevel, pins: Pins) -> None:
    """Begin with the start of a frame."""
    pins["in_frame_start"] |= core.settings is None


@cocotb.test()
async def pixels(dut: Any) -> None:
    pins = dict.fromkeys(("en", "in_valid", "in_abort", "in_row_start", "in_frame_start"), 1.0)
    words = dict.fromkeys(("level", "gains", "in_samples", "in_colour"), WORD)
    bits, channels = parameters(dut, "Bits", "Channels")
    await play(dut, BlackLevel(bits, channels), {**pins, **words}, legal)
