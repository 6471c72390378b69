# SPDX-License-Identifier: Apache-2.0
"""Counts multipliers, memory bits and latency of a configuration, from the parameters of the RTL.

Memories are those in ram.sv and rom.sv. Registers are not counted, nor are delays of up to LONGEST_SHIFT,
which are registers. A test elaborates the RTL and compares the counts.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from tactile_depth.configuration import Configuration
from tactile_depth.latency import GAIN_MAP, first_depth_latency, last_pixel_to_first_depth
from tactile_depth.tactile_depth import top_parameters
from tactile_depth.transform.sdf_fft import stages

KINDS = ("frame stores", "delay lines", "tables", "row buffers")
LONGEST_SHIFT = 4  # delays up to this are registers, hdl/common/delay_line.sv

# A DSP48E2 multiplies 27 by 18 bits, signed. The low parts of a wider operand are unsigned and hold one bit less.
PORTS = (27, 18)


@dataclass(frozen=True)
class Multiplier:
    """A signed product of `a` by `b` bits."""

    a: int
    b: int

    @property
    def tiles(self) -> int:
        """Number of multipliers of 27 x 18 bits, with the operand on the wide port that gives fewer."""

        def parts(width: int, port: int) -> int:
            return 1 + max(0, -(-(width - port) // (port - 1)))

        wide, narrow = PORTS
        return min(parts(self.a, wide) * parts(self.b, narrow), parts(self.b, wide) * parts(self.a, narrow))


@dataclass(frozen=True)
class Memory:
    """A memory of `words` words of `width` bits."""

    kind: str
    width: int
    words: int

    @property
    def bits(self) -> int:
        return self.width * self.words


@dataclass(frozen=True)
class Cost:
    """Resources and latency of a configuration.

    Attributes
    ----------
    multipliers : list of Multiplier
    memories : list of Memory
    first_depth_cycles, last_pixel_cycles : int
        Cycles from the first and from the last pixel of a frame to its first depth.
    """

    multipliers: list[Multiplier]
    memories: list[Memory]
    first_depth_cycles: int
    last_pixel_cycles: int

    @cached_property
    def tiles(self) -> int:
        """Number of multipliers of 27 x 18 bits."""
        return sum(multiplier.tiles for multiplier in self.multipliers)

    @cached_property
    def memory_bits(self) -> int:
        return sum(memory.bits for memory in self.memories)

    def bits_of(self, kind: str) -> int:
        return sum(memory.bits for memory in self.memories if memory.kind == kind)


def cost(config: Configuration) -> Cost:
    """Count the multipliers and memories in the RTL of a configuration."""
    multipliers, memories = _pipeline(top_parameters(config))
    return Cost(multipliers, memories, first_depth_latency(config), last_pixel_to_first_depth(config))


Parts = tuple[list[Multiplier], list[Memory]]


def _pipeline(p: dict[str, int]) -> Parts:
    """Count the parts of hdl/tactile_depth.sv."""
    size, slope, data = p["Size"], p["GradientWidth"], p["DataWidth"]
    divergence = slope + 2
    multipliers, tables = _colours(p)
    memories = [
        *tables,
        Memory("row buffers", slope, size),  # divergence: the row above
        Memory("row buffers", divergence, 2 * size),  # row_reorder, in and out
        Memory("row buffers", data, 2 * size),
    ]
    solver = _tridiagonal(p) if p["Tridiagonal"] else _spectral(p)
    return _joined((multipliers, memories), solver, _floor(p))


def _colours(p: dict[str, int]) -> Parts:
    """Count the parts from pixels to slopes: flat_field.sv, and gradient_lookup.sv or quadratic_gradient.sv."""
    multipliers, memories = [], []
    if p["FlatField"]:
        gain, log2 = p["GainWidth"], p["BlockLog2"]
        # A node times its row weight, and a colour times its gain. Both are unsigned, so each needs one more bit.
        multipliers += [Multiplier(gain + 1, log2 + 3), Multiplier(gain + 1, 9)] * 3
        memories += [Memory("tables", gain, (p["Rows"] >> log2) * (p["Size"] >> log2))] * 6
    if p["Quadratic"]:
        multipliers += [Multiplier(p["ColourWidth"], p["ColourCoeffWidth"])] * 6
        memories += [Memory("tables", p["PolynomialWidth"], 2 * p["PolynomialWords"])]  # for reads by the bus
        memories += [Memory("tables", p["PolynomialWidth"], 2 * p["PolynomialWords"] // 6)] * 6
    else:
        memories += [Memory("tables", 2 * p["GradientWidth"], 1 << 3 * p["BitsPerChannel"])] * 2
    return multipliers, memories


def _floor(p: dict[str, int]) -> Parts:
    """Count the parts of auto_zero.sv and floor_capture.sv: row weights, two banks of floors, sums, delayed depth."""
    if not p["AutoZero"]:
        return [], []
    log2, data = p["BlockLog2"], p["DataWidth"]
    nodes = (p["Rows"] >> log2) * (p["Size"] >> log2)
    memories = [Memory("tables", data, nodes)] * 2 + [Memory("tables", data + 2 * log2 + p["FloorLog2"], nodes)]
    return [Multiplier(data + 1, log2 + 3)], [*memories, Memory("delay lines", data, GAIN_MAP)]


def _spectral(p: dict[str, int]) -> Parts:
    size, data, width, coefficient = p["Size"], p["DataWidth"], p["Width"], p["CoeffWidth"]
    return _joined(
        _forward(p),
        ([], [Memory("frame stores", data, size * size)] * 2),
        _forward(p),
        (
            [Multiplier(width, coefficient)],
            [Memory("tables", p["DivideShiftWidth"] + coefficient, size * (size + 1) // 2)],
        ),
        _inverse(p, width),
        _inverse(p, data),
    )


def _tridiagonal(p: dict[str, int]) -> Parts:
    size, rows, data, width, coefficient = p["Size"], p["Rows"], p["DataWidth"], p["Width"], p["CoeffWidth"]
    words, packed = p["TableWords"], p["WordsPerRow"]
    one_way = (  # elimination or substitution
        [Multiplier(width, coefficient)],
        [
            Memory("row buffers", width, size),  # the running row
            Memory("tables", coefficient, words),
            Memory("tables", (words - 1).bit_length() + p["SettledWidth"], size),
            Memory("tables", p["LastShiftWidth"] + coefficient, size),
        ],
    )
    row_number = (rows - 1).bit_length() + 2  # 1 to rows, signed
    mean = [Multiplier(width, row_number), Multiplier(width, coefficient)] if p["Neumann"] else []
    return _joined(
        _forward(p),
        one_way,
        (mean, [Memory("frame stores", data * packed, rows * -(-size // packed))]),
        one_way,
        _inverse(p, width),
    )


def _forward(p: dict[str, int]) -> Parts:
    """Count the parts of hdl/transform/dst_forward.sv, which forms only the real part of the product with the phase."""
    phase = [Multiplier(p["Width"], p["CoeffWidth"])] * 2
    return _joined(_fft(p, inverse=False), (phase, [Memory("tables", 3 * p["CoeffWidth"], p["Size"])]))


def _inverse(p: dict[str, int], in_width: int) -> Parts:
    """Count the parts of hdl/transform/dst_inverse.sv with its mode_pairs."""
    size = p["Size"]
    memories = [
        Memory("delay lines", in_width, size // 2 + 1),
        Memory("row buffers", in_width, size),
        Memory("tables", 3 * p["CoeffWidth"], size),
    ]
    return _joined(([Multiplier(in_width, p["CoeffWidth"])] * 4, memories), _fft(p, inverse=True))


def _fft(p: dict[str, int], inverse: bool) -> Parts:
    """Count the parts of hdl/transform/sdf_fft.sv: complex words in its delays, {-Im, Im, Re} in its tables."""
    multipliers, memories = [], []
    for stage in stages(p["Size"], inverse):
        if stage.delay > LONGEST_SHIFT:
            memories.append(Memory("delay lines", 2 * (p["Width"] + 1), stage.delay))
        elif not stage.delay:
            multipliers += [Multiplier(p["Width"], p["CoeffWidth"])] * 4
            memories.append(Memory("tables", 3 * p["CoeffWidth"], stage.block))
    return multipliers, memories


def _joined(*parts: Parts) -> Parts:
    return [m for part in parts for m in part[0]], [m for part in parts for m in part[1]]
