# SPDX-License-Identifier: Apache-2.0
"""Multipliers and memories of a configuration, counted in the parameters of the RTL.

Memories are those in td_ram.sv and td_rom.sv. Registers are not counted, nor are delays of up to LONGEST_SHIFT,
which are registers. A test elaborates the RTL and compares the counts.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

from commands.cost.devices import BLOCK, BY_SIZE, DISTRIBUTED, DISTRIBUTED_BITS
from tactile_depth.chip.common import td_node_map
from tactile_depth.chip.depth.zero_capture import LARGEST_LOG2
from tactile_depth.chip.limits import (
    COLOUR_COEFFICIENT,
    CORRECTION_WIDTH,
    CUBIC,
    DEVIATION,
    GUARD_BITS,
    LIGHT_GAIN,
    POLYNOMIAL,
    RATIO,
)
from tactile_depth.chip.poisson.transform import wide_corner_turn
from tactile_depth.chip.poisson.transform.sdf_fft import stages
from tactile_depth.chip.poisson.transform.wide_dst_inverse import latency as wide_inverse_latency
from tactile_depth.chip.poisson.transform.wide_fft import constant_paths

LONGEST_SHIFT = 4  # delays up to this are registers, hdl/common/td_delay_line.sv
LOOP = 4  # clocks of wide_substitution.sv from a word to the product with it and back
PIXEL_MARKS = 1 + 4  # dark, and the position: they travel with a pixel through td_node_map
DEPTH_MARKS = 3  # the position: it travels with a depth


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
    core: str
    style: int = BY_SIZE
    rom: bool = False

    @property
    def bits(self) -> int:
        return self.width * self.words

    @property
    def banked(self) -> bool:
        """One of the two banks of a td_banked_table.sv."""
        return self.kind == "tables" and not self.rom and self.core != "zero_capture"


Parts = list[Multiplier | Memory]


def parts(p: Mapping[str, int]) -> Parts:
    """Return the multipliers and memories of hdl/tactile_depth.sv with the parameters of `top_parameters`."""
    size, slope, data = p["Columns"], p["GradientWidth"], p["DataWidth"]
    solver = _spectral if not p["Tridiagonal"] else _tridiagonal if p["Lanes"] == 1 else _wide
    reorder = [Memory("row buffers", width, 2 * size, "row_reorder") for width in (slope + 2, data)]
    return [
        *_colours(p),
        Memory("row buffers", slope, size, "divergence"),  # the row above
        *(reorder if p["Lanes"] == 1 else []),
        *solver(p),
        *_zero(p),
        *_contact(p),
    ]


def _contact(p: Mapping[str, int]) -> Parts:
    """Count the delay of contact_events.sv."""
    lanes = p["Lanes"]
    return [Memory("delay lines", lanes * p["DataWidth"] + DEPTH_MARKS, lanes.bit_length() + 5, "contact_events")]


def _colours(p: Mapping[str, int]) -> Parts:
    """Count the parts from pixels to slopes: flat_field.sv, light_gains.sv, and one of the gradient models."""
    found: Parts = []
    if p["FlatField"]:
        gain, log2, core = p["GainWidth"], p["BlockLog2"], "flat_field"
        # The difference of two nodes times its row weight, and a colour times its gain: one bit more than a gain has.
        found += [Multiplier(gain + 1, log2 + 2, core), Multiplier(gain + 1, 9, core)] * 3
        found += [Memory("tables", gain, (p["Rows"] >> log2) * (p["Columns"] >> log2), core, BLOCK)] * 6
        found.append(Memory("delay lines", 3 * 8 + PIXEL_MARKS, td_node_map.latency(1, log2), core))
    if p["LightGains"]:
        found += [Multiplier(RATIO.width + 1, LIGHT_GAIN.width + 1, "light_gains")] * 3
    if p["Polynomial"]:
        core, width, words = "polynomial_gradient", POLYNOMIAL.width, math.prod(CUBIC)
        found += [Multiplier(DEVIATION.width, COLOUR_COEFFICIENT.width, core)] * 6
        found += [Memory("tables", width, words // 6, core, DISTRIBUTED)] * 12
        if p["Corrections"]:
            found += [
                Memory("tables", 2 * CORRECTION_WIDTH, 1 << 3 * p["BitsPerChannel"], "gradient_lookup", BLOCK)
            ] * 2
        return found
    return [
        *found,
        *[Memory("tables", 2 * p["GradientWidth"], 1 << 3 * p["BitsPerChannel"], "gradient_lookup", BLOCK)] * 2,
    ]


def _zero(p: Mapping[str, int]) -> Parts:
    """Count the parts of zero_offset.sv and zero_capture.sv: row weights, two banks of nodes, sums, delayed depths."""
    if not p["ZeroOffset"]:
        return []
    log2, data, lanes = p["BlockLog2"], p["DataWidth"], p["Lanes"]
    side = td_node_map.side(lanes, log2)  # nodes that are written at once
    words = (p["Rows"] >> log2) * (p["Columns"] >> log2) // side
    return [
        *[Memory("tables", data, words, "zero_offset", BLOCK)] * (2 * side * td_node_map.tables(lanes, log2)),
        Memory("delay lines", lanes * data + DEPTH_MARKS, td_node_map.latency(lanes, log2), "zero_offset"),
        Memory("tables", side * (data + 2 * log2 + LARGEST_LOG2), words, "zero_capture", BLOCK),
        *[Multiplier(data + 1, log2 + 2, "zero_offset")] * side,
    ]


def _wide(p: Mapping[str, int]) -> Parts:
    """Count the parts of wide_solver.sv."""
    size, rows, data, width, coeff = (
        p["Columns"],
        p["Rows"],
        p["DataWidth"],
        p["DataWidth"] + GUARD_BITS,
        p["CoeffWidth"],
    )
    down, up, core = p["DownWords"], p["Lanes"], "wide_elimination"
    clocks, beats = size // down, size // up
    group = min(down, up // 2)  # words in a memory of wide_stack.sv
    wait = beats * 2 - LOOP
    product = Multiplier(width, coeff)
    return [
        *[Memory("row buffers", p["GradientWidth"] + 2, 2 * clocks, "wide_rows")] * down,
        *_wide_fft(p, down, False, "wide_dst_forward"),
        *[replace(product, core="wide_dst_forward")] * (2 * down),
        _wide_factors(coeff, down, clocks, "wide_dst_forward"),
        *[replace(product, core=core)] * (2 * down),
        Memory("row buffers", down * (coeff + width), clocks, core),
        *_table(down * coeff, p["DownTableWords"], p["DownSettledWidth"], clocks, core),
        Memory("tables", down * (p["LastShiftWidth"] + coeff), clocks, core, rom=True),
        *_mean(p, core),
        *[Memory("row buffers", group * data, beats, "wide_stack", DISTRIBUTED)] * (up // group),
        *[Memory("frame stores", group * data, (rows - 1) * beats, "wide_stack", p["StoreStyle"])] * (up // group),
        *[replace(product, core="wide_substitution")] * up,
        *([Memory("delay lines", width, wait, "wide_substitution")] * up if wait > LONGEST_SHIFT else []),
        *_table(up * coeff, p["UpTableWords"], p["UpSettledWidth"], beats, "wide_substitution"),
        *_wide_inverse(p, "wide_dst_inverse"),
    ]


def _wide_inverse(p: Mapping[str, int], core: str) -> Parts:
    """Count the parts of wide_dst_inverse.sv with its pairs of rows and its corner turn."""
    size, data, width, paths = p["Columns"], p["DataWidth"], p["DataWidth"] + GUARD_BITS, p["Lanes"] // 2
    beats = size // paths
    pairs = [Memory("delay lines", width, beats // 2, core)] * (2 * paths) if beats // 2 > LONGEST_SHIFT else []
    turned = beats // 2 * 2 if paths == 1 else 2 * beats  # words of a memory of the corner turn
    return [
        *pairs,
        *[Memory("row buffers", 2 * width, beats // 2, core)] * (2 * paths),
        *[Multiplier(width, p["CoeffWidth"], core)] * (4 * paths),
        _wide_factors(p["CoeffWidth"], paths, beats, core),
        *_wide_fft(p, paths, True, core),
        Memory("delay lines", 1, wide_inverse_latency(size, 2 * paths) - wide_corner_turn.latency(size, paths), core),
        *[Memory("row buffers", data, turned, core)] * (4 if paths == 1 else 2 * paths),
    ]


def _wide_fft(p: Mapping[str, int], paths: int, inverse: bool, core: str) -> Parts:
    """Count the parts of wide_fft.sv: a line for each path in each commutator, and no product for factors of 1."""
    if paths == 1:
        return _fft(p, inverse, core)
    size, width, coeff = p["Columns"], p["DataWidth"] + GUARD_BITS, p["CoeffWidth"]
    beats = size // paths
    delays = [1 << bit for bit in range(beats.bit_length() - 1)]
    lines = [Memory("delay lines", 2 * width, delay, core) for delay in delays if delay > LONGEST_SHIFT]
    found: Parts = [*lines * paths]
    for stage in stages(size, inverse):
        if not stage.delay:
            found += [Multiplier(width, coeff, core)] * (
                4 * (paths - constant_paths(size, paths, stage.block, inverse))
            )
            found.append(_wide_factors(coeff, paths, beats, core))
    return found


def _wide_factors(coeff: int, paths: int, beats: int, core: str) -> Memory:
    """Count the table of wide_twiddle.sv, which is a block memory where the factors of one path fill one."""
    style = BLOCK if 3 * coeff * beats > DISTRIBUTED_BITS else DISTRIBUTED
    return Memory("tables", 3 * coeff * paths, beats, core, style, rom=True)


def _spectral(p: Mapping[str, int]) -> Parts:
    size, data, width, coefficient = p["Columns"], p["DataWidth"], p["DataWidth"] + GUARD_BITS, p["CoeffWidth"]
    return [
        *_forward(p) * 2,
        *[Memory("frame stores", data, size * size, "transpose", p["StoreStyle"])] * 2,
        Multiplier(width, coefficient, "spectral_divide"),
        Memory("tables", p["DivideShiftWidth"] + coefficient, size * (size + 1) // 2, "spectral_divide", rom=True),
        *_inverse(p, width),
        *_inverse(p, data),
    ]


def _tridiagonal(p: Mapping[str, int]) -> Parts:
    size, rows, data, width = p["Columns"], p["Rows"], p["DataWidth"], p["DataWidth"] + GUARD_BITS
    packed, core = p["WordsPerRow"], "forward_elimination"
    return [
        *_forward(p),
        *_thomas(p, core),
        Memory("tables", p["LastShiftWidth"] + p["CoeffWidth"], size, core, rom=True),
        *_mean(p, core),
        Memory("frame stores", data * packed, rows * -(-size // packed), "frame_stack", p["StoreStyle"]),
        *_thomas(p, "back_substitution"),
        *_inverse(p, width),
    ]


def _mean(p: Mapping[str, int], core: str) -> Parts:
    """Count the multipliers of column_mean.sv, which only Neumann has."""
    if not p["Neumann"]:
        return []
    width, row_number = p["DataWidth"] + GUARD_BITS, (p["Rows"] - 1).bit_length() + 2  # 1 to rows, signed
    return [Multiplier(width, row_number, core), Multiplier(width, p["CoeffWidth"], core)]


def _thomas(p: Mapping[str, int], core: str) -> Parts:
    """Count the parts of an elimination or substitution; of the table of the last row only the elimination has one."""
    width, coefficient = p["DataWidth"] + GUARD_BITS, p["CoeffWidth"]
    return [
        Multiplier(width, coefficient, core),
        Memory("row buffers", width, p["Columns"], core),
        *_table(coefficient, p["TableWords"], p["SettledWidth"], p["Columns"], core),
    ]


def _table(width: int, words: int, settled_width: int, clocks: int, core: str) -> Parts:
    """Count the two ROMs of thomas_table.sv without that of the last row."""
    index = (words - 1).bit_length() + settled_width
    return [Memory("tables", width, words, core, rom=True), Memory("tables", index, clocks, core, rom=True)]


def _forward(p: Mapping[str, int]) -> Parts:
    """Count the parts of dst_forward.sv, which forms only the real part of the product with the phase."""
    phase = Multiplier(p["DataWidth"] + GUARD_BITS, p["CoeffWidth"], "dst_forward")
    return [
        *_fft(p, False, "dst_forward"),
        *[phase] * 2,
        Memory("tables", 3 * p["CoeffWidth"], p["Columns"], "dst_forward", rom=True),
    ]


def _inverse(p: Mapping[str, int], in_width: int) -> Parts:
    """Count the parts of hdl/poisson/transform/dst_inverse.sv with its mode_pairs."""
    size, core = p["Columns"], "dst_inverse"
    return [
        *[Multiplier(in_width, p["CoeffWidth"], core)] * 4,
        Memory("delay lines", in_width, size // 2 + 1, core),
        Memory("row buffers", in_width, size, core, DISTRIBUTED),
        Memory("tables", 3 * p["CoeffWidth"], size, core, rom=True),
        *_fft(p, True, core),
    ]


def _fft(p: Mapping[str, int], inverse: bool, core: str) -> Parts:
    """Count the parts of hdl/poisson/transform/sdf_fft.sv: complex words in its delays, {-Im, Im, Re} in its tables."""
    found: Parts = []
    for stage in stages(p["Columns"], inverse):
        if stage.delay > LONGEST_SHIFT:
            found.append(Memory("delay lines", 2 * (p["DataWidth"] + GUARD_BITS + 1), stage.delay, core))
        elif not stage.delay:
            found += [Multiplier(p["DataWidth"] + GUARD_BITS, p["CoeffWidth"], core)] * 4
            found.append(Memory("tables", 3 * p["CoeffWidth"], stage.block, core, rom=True))
    return found
