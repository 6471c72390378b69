# SPDX-License-Identifier: Apache-2.0
"""Words, multipliers and memories of a core, as `parts` of its model states them for all its instances.

Memories are those in td_ram.sv and td_rom.sv. Registers are not counted, nor are delays of up to LONGEST_SHIFT,
which are registers. A test elaborates the RTL and compares the counts.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from tactile_depth.chip.fixed_point import Format

# Styles of td_ram.sv and td_rom.sv.
DISTRIBUTED, BLOCK, ULTRA, BY_SIZE = 0, 1, 2, 3
DISTRIBUTED_BITS = LATE_BITS = 4096  # of memories, and of those that may not be late: hdl/td_memory_pkg.sv
LONGEST_SHIFT = 4  # delays up to this are registers, hdl/common/td_delay_line.sv
DEPTH_MARKS = 3  # the position: it travels with a depth


class Sizes(Protocol):
    """Numbers of a configuration on which the transforms depend, whose models the configuration itself imports."""

    @property
    def solver(self) -> str: ...

    @property
    def columns(self) -> int: ...

    @property
    def down_words(self) -> int: ...

    @property
    def up_paths(self) -> int: ...

    @property
    def depth(self) -> Format: ...

    @property
    def coefficient(self) -> Format: ...

    @property
    def arithmetic_width(self) -> int: ...


@dataclass(frozen=True)
class Words:
    """An instance of a core, and the bits of the words that it takes in a clock.

    `work` is the share of the clocks in which it takes words, while frames follow each other without a pause.
    """

    bits: int
    core: str = ""
    work: float = 1.0


@dataclass(frozen=True)
class Multiplier:
    """A signed product of `a` by `b` bits, in a core of hdl/."""

    a: int
    b: int
    core: str = ""


@dataclass(frozen=True)
class Memory:
    """A memory of `words` words of `width` bits, in a core of hdl/; `style` as of td_ram.sv."""

    kind: str
    width: int
    words: int
    style: int = BY_SIZE
    rom: bool = False
    banked: bool = False  # one of the two banks of a td_banked_table.sv
    core: str = ""

    @property
    def bits(self) -> int:
        return self.width * self.words


def products(config: Sizes, number: int) -> list[Multiplier]:
    """Return products of a word of the arithmetic by a coefficient."""
    return [Multiplier(config.arithmetic_width, config.coefficient.width)] * number


Parts = list[Words | Multiplier | Memory]


def rom(width: int, words: int, style: int = BY_SIZE) -> Memory:
    return Memory("tables", width, words, style, rom=True)


def late_style(bits: int) -> int:
    """Return the style of a memory whose word is needed early, by its bits or by those of one of its tables."""
    return BLOCK if bits > LATE_BITS else DISTRIBUTED


def delay_line(width: int, delay: int) -> list[Memory]:
    """Return the memory of a td_delay_line.sv: none where it is registers; a block memory has a register behind it."""
    in_block = width * delay > DISTRIBUTED_BITS
    return [Memory("delay lines", width, delay - in_block)] if delay > LONGEST_SHIFT else []


def banks(width: int, words: int, style: int = BLOCK) -> list[Memory]:
    """Return both banks of a td_banked_table.sv."""
    return [Memory("tables", width, words, style, banked=True)] * 2
