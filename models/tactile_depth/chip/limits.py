# SPDX-License-Identifier: Apache-2.0
"""Limits of a configuration, and the formats that none of its choices changes."""

from __future__ import annotations

from typing import Literal, get_args

from tactile_depth.chip.fixed_point import Format

Solver = Literal["tridiagonal", "spectral"]
Boundary = Literal["neumann", "dirichlet"]
Model = Literal["lut", "quadratic", "cubic"]

GUARD_BITS = 3  # bits of the arithmetic below a stored word: a DSP48E2 multiplies 27 bits at the cost of 24
DEPTH_HEADROOM = 9 / 8  # full scale of the depth code over the depth range: margin for depth errors
DEEPEST = 0.67  # largest depth over N pixels for slopes up to 1 (L1 norm of the linear map), as a fraction of N
COARSEST_LSB = 1 / 32  # of a mode's word, as a fraction of the deepest depth: coarser words lose the shape
SHALLOWEST_PX = 1 / 16

# A frame store as large as two UltraRAMs or more takes UltraRAM, which is cheaper.
ULTRA_WORDS, ULTRA_WIDTH = 4096, 72

COLUMNS = {"spectral": (16, 512), "tridiagonal": (16, 1024)}
ROWS = (8, 1024)
EXACT_LENGTHS = (8, 4096)  # rows and columns of a grid in double precision
MOST_LANES = 64
COLUMNS_PER_LANE = 2  # at least: the second row of a pair comes so many clocks after the first
ZERO_OFFSET_COLUMNS_PER_LANE = 4  # at least: the capture of the zero offset adds in three clocks, td_block_sum.sv
CHECK_COLUMNS, CHECK_BEATS = 32, 8  # at least, of the check of frames
MODELS: tuple[str, ...] = get_args(Model)
BOUNDARIES: tuple[Boundary, ...] = get_args(Boundary)
GRADIENT_LIMITS = (2.0**-6, 2.0**6)

# Flat-fielding. The reference is smooth, as the lighting is. A grid of 16 block means across the picture causes no
# visible error in the gradients of real presses; a grid of 8 does.
REFERENCE_NODES = 16
SMALLEST_BLOCK = 2
PIXEL_WIDTH = 8
DARKEST_LOG2 = 3  # a reference of 8 grey levels gives the full scale of a gain


def most_lanes(columns: int, zero_offset: bool = False) -> int:
    """Return the largest number of lanes of the tridiagonal solver."""
    return min(columns // (ZERO_OFFSET_COLUMNS_PER_LANE if zero_offset else COLUMNS_PER_LANE), MOST_LANES)


def can_check(columns: int, lanes: int) -> bool:
    """Return whether frames of a grid can check themselves; a row of many lanes leaves time for their sums."""
    beats = columns // max(1, lanes)
    return columns >= CHECK_COLUMNS and beats >= max(CHECK_BEATS, 3 + lanes.bit_length())


DEVIATION = Format(17, 15)
"""Format of a colour relative to the reference, I / ref - 1.

It is so fine that rounding does not tilt a gel of one colour, which has the same error in every pixel.
"""
RATIO = Format(17, 15)
"""Format of a colour relative to the reference, I / ref, unsigned, before the light gains."""
LIGHT_GAIN = Format(16, 15)
"""Format of the gain of a colour that follows the light, unsigned."""
POLYNOMIAL = Format(32, 28)
"""Format of a coefficient of the polynomial models along the raster, as wide as a register of the AXI4-Lite map; with a
larger `coefficient_limit` it has fewer fraction bits."""
FINE_BITS = (4, 128)
"""Fraction bits of the words of third degree beyond those of the others, and the largest side of a grid with so many:
3 more for each doubling of the side, because these words add up to its third power."""
CORRECTION_BITS, CORRECTION_WIDTH = 4, 8
"""Top bits of each colour that index the corrections of the model `cubic`, and bits of a correction."""
COLOUR_COEFFICIENT = Format(18, 14)
"""Format of the upper bits of a coefficient, which are multiplied, as wide as the narrow port of a DSP48E2."""
COEFFICIENT_LIMITS = (POLYNOMIAL.limit, 2.0**8)
COEFFICIENTS, CUBIC = (2, 3, 6), (2, 3, 10)
"""Coefficients of the models `quadratic` and `cubic`: slope, colour, term."""
SAMPLES = 16
"""Positions along a side of a grid: what is true of polynomials there is true of the whole grid."""


def is_grid_of_hardware(rows: int, columns: int, solver: str) -> bool:
    """Return True for a grid that the hardware can have with a solver."""
    fewest, most = COLUMNS.get(solver, (1, 0))
    return fewest <= columns <= most and columns.bit_count() == 1 and ROWS[0] <= rows <= ROWS[1]
