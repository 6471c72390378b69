# SPDX-License-Identifier: Apache-2.0
"""Multipliers and memories of the devices that `make synth` knows, and what a product or an array takes of them."""

from __future__ import annotations

import math
from dataclasses import dataclass

from tactile_depth.chip.resources import BY_SIZE, DISTRIBUTED, DISTRIBUTED_BITS, ULTRA, Memory


@dataclass(frozen=True)
class Device:
    """A device, by its cells.

    Attributes
    ----------
    multiplier, block : str
        Names of its multiplier and its block memory.
    ports : (int, int)
        Bits of the operands of a multiplier.
    headroom : int
        Bits of a port that the lower part of a longer operand leaves free: 1 where all operands are signed.
    block_shapes : tuple of (int, int)
        Words and bits of a block memory.
    ultra_shape : (int, int), or None
        Words and bits of an UltraRAM.
    lut_inputs : int
    lut_rams : tuple of (int, int, int)
        Words, bits and LUTs of memories built of LUTs; an array takes those that are the fewest LUTs.
    distributed_bits : int
        Of the largest memory that is built of LUTs by its size: `DistributedBits` of td_memory_pkg.sv.
    halves : bool
        Half of a block memory can be used by itself.
    """

    name: str
    multiplier: str
    ports: tuple[int, int]
    headroom: int
    block: str
    block_shapes: tuple[tuple[int, int], ...]
    ultra_shape: tuple[int, int] | None
    lut_inputs: int
    lut_rams: tuple[tuple[int, int, int], ...]
    distributed_bits: int = DISTRIBUTED_BITS
    halves: bool = True

    def multipliers(self, a: int, b: int) -> int:
        """Return the multipliers of a product of `a` by `b` bits, with the operands on the ports that give fewer."""

        def parts(width: int, port: int) -> int:
            return 1 + max(0, -(-(width - port) // (port - self.headroom)))

        wide, narrow = self.ports
        return min(parts(a, wide) * parts(b, narrow), parts(b, wide) * parts(a, narrow))

    def memories(self, array: Memory) -> dict[str, float]:
        """Return the block memories and UltraRAMs of an array; both 0 where it is built of LUTs."""
        if array.style == ULTRA and self.ultra_shape:
            deep, wide = self.ultra_shape
            return {"ultra": math.ceil(array.words / deep) * math.ceil(array.width / wide), "block": 0.0}
        built = array.style != DISTRIBUTED and (array.style != BY_SIZE or array.bits > self.distributed_bits)
        return {"ultra": 0.0, "block": self.blocks(array.words, array.width, array.rom) if built else 0.0}

    def blocks(self, words: int, width: int, rom: bool = False) -> float:
        """Return the number of block memories of an array, by the plain rule; half of a BRAM36 where 18 Kb are enough.

        An ECP5's RAM is built of slices of one block in height (boards/ecp5/td_ram.sv).
        """
        shapes = self.block_shapes
        if self.halves and any(words <= deep and width <= wide / 2 for deep, wide in shapes if wide > 1):
            return 0.5
        if self == ECP5 and not rom and words > SLICED_WORDS:
            shapes = tuple(shape for shape in shapes if shape[0] >= words) or shapes
        return min(math.ceil(words / deep) * math.ceil(width / wide) for deep, wide in shapes)


SLICED_WORDS = 2048  # of an ECP5: a RAM of more words is built of slices

BRAM36 = ((512, 72), (1024, 36), (2048, 18), (4096, 9), (8192, 4), (16384, 2), (32768, 1))
LUT6_RAMS = ((32, 6, 4), (64, 3, 4), (128, 1, 4))
XCZU7EV = Device("XCZU7EV", "DSP48E2", (27, 18), 1, "BRAM36", BRAM36, (4096, 72), 6, LUT6_RAMS)
XC7A35T, XC7A100T, XC7Z020 = (
    Device(name, "DSP48E1", (25, 18), 1, "BRAM36", BRAM36, None, 6, LUT6_RAMS)
    for name in ("XC7A35T", "XC7A100T", "XC7Z020")
)
ECP5 = Device(
    "LFE5U-85F",
    "MULT18X18D",
    (18, 18),
    0,
    "DP16KD",
    ((512, 36), (1024, 18), (2048, 9), (4096, 4), (8192, 2), (16384, 1)),
    None,
    4,
    ((16, 4, 4),),
    distributed_bits=1024,
    halves=False,
)
