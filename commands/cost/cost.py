# SPDX-License-Identifier: Apache-2.0
"""Multipliers, memories, LUTs, power and latency of a configuration, on two devices."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache
from pathlib import Path

from commands.cost.devices import ECP5, XCZU7EV, Device
from commands.cost.luts import luts
from commands.cost.parts import parts
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.latency import first_depth_latency, last_pixel_to_first_depth, last_pixel_to_last_depth
from tactile_depth.chip.resources import Memory, Multiplier, Words

__all__ = ["ECP5", "KINDS", "XCZU7EV", "Cost", "cost"]

KINDS = ("frame stores", "delay lines", "tables", "row buffers")
CAMERAS = Path(__file__).with_name("cameras.json")
CLOCK_MHZ = 166.0  # of the power
MACRO_BITS = 1024  # a larger memory is a macro, a smaller one is flip-flops or gates
ACCESS_PJ, WORD_BITS = 5.3, 64
"""Energy of reading or writing a word of a macro of 512 words, see commands/hardware/memory_model.py."""
PRODUCT_UW, LUT_UW = 4.51, 2.04
"""Power of the logic for each bit of a product (bits of one operand times bits of the other) and for each LUT of the
XCZU7EV: least squares of relative errors to the logic at 45 nm of three configurations ("At 45 nm" in
docs/hardware.md), which they meet within 3 %."""


@dataclass(frozen=True)
class Cost:
    """Resources and latency of a configuration.

    Attributes
    ----------
    config : Configuration
    multipliers : list of Multiplier
    memories : list of Memory
    first_depth_cycles, last_pixel_cycles : int
        Cycles from the first and from the last pixel of a frame to its first depth.
    map_cycles : int
        Cycles from the last pixel of a frame to its last depth.
    """

    config: Configuration
    multipliers: list[Multiplier]
    memories: list[Memory]
    first_depth_cycles: int
    last_pixel_cycles: int
    map_cycles: int

    @cached_property
    def tiles(self) -> int:
        """Number of multipliers of 27 x 18 bits."""
        return self.multipliers_of(XCZU7EV)

    def multipliers_of(self, device: Device) -> int:
        """Return the number of multipliers of a device."""
        return sum(device.multipliers(multiplier.a, multiplier.b) for multiplier in self.multipliers)

    def blocks_of(self, device: Device) -> float:
        """Return the number of block memories of a device, in halves of a BRAM36, beside its UltraRAMs."""
        return sum(self._memories_of(device, "block"))

    def ultras_of(self, device: Device) -> float:
        """Return the number of UltraRAMs of a device."""
        return sum(self._memories_of(device, "ultra"))

    def _memories_of(self, device: Device, kind: str) -> list[float]:
        return [device.memories(each)[kind] for each in self.memories]

    def luts_of(self, device: Device) -> int:
        """Return the number of LUTs of a device, within the error that docs/hardware.md states."""
        return luts(self.config, device)

    @cached_property
    def power_mw(self) -> float:
        """Power at 45 nm and 166 MHz, without wires, clock tree and leakage of memories, in mW; see PRODUCT_UW."""
        product_bits = sum(each.a * each.b * self.work[each.core] for each in self.multipliers)
        return power_mw(product_bits, self.luts_of(XCZU7EV), self.accessed_bits)

    @cached_property
    def work(self) -> dict[str, float]:
        """Share of the clocks in which each core takes words."""
        return {part.core: part.work for part in parts(self.config) if isinstance(part, Words)}

    @cached_property
    def accessed_bits(self) -> float:
        """Bits that memories of more than a kilobit read and write per clock; of two banks of a table one is read.

        Tables and delay lines are read in every clock, other memories when their core takes words.
        """
        accessed = 0.0
        for memory in self.memories:
            always = memory.rom or memory.kind == "delay lines"
            each = memory.width * (1 if memory.rom else 0.5 if memory.banked else 2)
            accessed += (memory.bits > MACRO_BITS) * each * (1 if always else self.work[memory.core])
        return accessed

    @cached_property
    def memory_bits(self) -> int:
        return sum(memory.bits for memory in self.memories)

    def bits_of(self, kind: str) -> int:
        return sum(memory.bits for memory in self.memories if memory.kind == kind)

    def by_core(self) -> dict[str, tuple[int, int]]:
        """Return multipliers of 27 x 18 bits and memory bits of each core, in the order of the data."""
        counts: dict[str, tuple[int, int]] = {}
        for part in parts(self.config):
            tiles, bits = counts.get(part.core, (0, 0))
            if isinstance(part, Multiplier):
                counts[part.core] = tiles + XCZU7EV.multipliers(part.a, part.b), bits
            elif isinstance(part, Memory):
                counts[part.core] = tiles, bits + part.bits
        return counts


def power_mw(product_bits: float, luts: float, accessed_bits: float) -> float:
    """Return the power of products of so many bits in each clock, of LUTs and of memories, in mW."""
    logic_uw = PRODUCT_UW * product_bits + LUT_UW * luts
    return (logic_uw + ACCESS_PJ / WORD_BITS * CLOCK_MHZ * accessed_bits) / 1e3


@lru_cache(maxsize=4096)  # a search asks for the same ones again and again
def cost(config: Configuration) -> Cost:
    """Count the multipliers and memories in the RTL of a configuration."""
    found = parts(config)
    return Cost(
        config,
        [part for part in found if isinstance(part, Multiplier)],
        [part for part in found if isinstance(part, Memory)],
        first_depth_latency(config),
        last_pixel_to_first_depth(config),
        last_pixel_to_last_depth(config),
    )
