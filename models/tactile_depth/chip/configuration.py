# SPDX-License-Identifier: Apache-2.0
"""The configuration of a pipeline, the only source of its numbers.

Every fixed-point format, HDL parameter and expected latency is derived here from a few choices. Formats follow from two
bounds: no slope exceeds `gradient_limit`, no depth exceeds `depth_range_px`. Every step between them is linear, so the
largest value of a node is an L1 norm, computed by the bit-accurate model on unit vectors of floats (bounds.py).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Annotated, Any

import numpy as np

from tactile_depth.base.declared import declared
from tactile_depth.base.errors import Argument, InputError, former_names, one_of, power_of_two, within
from tactile_depth.chip.bounds import Bounds, bounds, difference_bounds
from tactile_depth.chip.choices import Choice, Number, Width
from tactile_depth.chip.fixed_point import Format
from tactile_depth.chip.limits import (
    BOUNDARIES,
    CHECK_BEATS,
    CHECK_COLUMNS,
    COARSEST_LSB,
    COEFFICIENT_LIMITS,
    COLOUR_COEFFICIENT,
    COLUMNS,
    DARKEST_LOG2,
    DEEPEST,
    DEPTH_HEADROOM,
    EXACT_LENGTHS,
    GRADIENT_LIMITS,
    GUARD_BITS,
    MODELS,
    PIXEL_WIDTH,
    POLYNOMIAL,
    REFERENCE_NODES,
    ROWS,
    SAMPLES,
    SHALLOWEST_PX,
    SMALLEST_BLOCK,
    ULTRA_WIDTH,
    ULTRA_WORDS,
    Boundary,
    can_check,
    most_lanes,
)
from tactile_depth.chip.poisson.transform.fft import twiddle_stages
from tactile_depth.chip.poisson.transform.transform import Transform
from tactile_depth.chip.poisson.transform.twiddle import coefficient_gain
from tactile_depth.chip.resources import BLOCK, ULTRA


@former_names(auto_zero="zero_offset")
@dataclass(frozen=True)
class Configuration:
    """The choices that define a pipeline, and the numbers that follow; InputError if it cannot be built.

    Attributes
    ----------
    columns, rows : int
        The grid; columns are a power of two. Without rows as many; only the tridiagonal solver accepts another number.
    solver : str
        `spectral` or `tridiagonal`, which alone has more than one lane.
    neumann : bool
        Zero slope at the frame's edge instead of zero depth.
    lanes : int
        Depth values per clock, a power of two.
    data_width, coefficient_width, gain_width : int
        Bits of a stored word, of a coefficient, and of a gain of the flat field.
    depth_range_px : float
        Largest depth that formats are sized for, in grid pixels; None: a quarter of the grid.
    gradient_limit, coefficient_limit : float
        Largest slope; a bound that no coefficient of a polynomial reaches, larger for faint colours; powers of two.
    bits_per_channel : int
        Bits of each colour that index the gradient table.
    gradient_model : str
        `lut`, a table of colours; `quadratic` or `cubic`, polynomials of the position, which need `flat_field`.
    flat_field, zero_offset, light_gains : bool
        Colours are relative to a reference frame; the depth read without contact is subtracted; a gain for each colour
        follows the light, which needs polynomials.
    parity, self_check : bool
        Each word of the memories has a parity bit, by which the device sees a flipped bit; the depth of each frame is
        put into the equation, by which it sees an error of the solver.
    """

    columns: Annotated[int, Choice(variable="N", option="--grid {}x..")] = 128
    rows: Annotated[int, Choice(option="--grid ..x{}")] = 0
    solver: Annotated[str, Choice()] = "spectral"
    neumann: Annotated[bool, Choice(argument="boundary")] = False
    lanes: Annotated[int, Choice(option="lanes={}")] = 1  # no option of the command has it
    data_width: Annotated[int, Width(meaning="bits of a stored word", accepted=(12, 32), letter="d")] = 24
    coefficient_width: Annotated[
        int, Width(meaning="bits of a coefficient", accepted=(10, 24), letter="c", variable="COEFF_WIDTH")
    ] = 18
    gain_width: Annotated[
        int, Width(meaning="bits of a gain of the flat field", accepted=(16, 24), letter="g", colours=True)
    ] = 24
    depth_range_px: Annotated[float | None, Choice(argument="depth_range_mm", variable="DEPTH_RANGE")] = None
    gradient_limit: float = 1.0
    coefficient_limit: float = POLYNOMIAL.limit
    bits_per_channel: int = 4
    gradient_model: Annotated[str, Choice(variable="GRADIENT", option="--model {}")] = "lut"
    flat_field: bool = False
    zero_offset: bool = False
    light_gains: Annotated[bool, Choice(option="--no-light-gains")] = False
    parity: Annotated[bool, Choice(option="parity={}")] = False  # no option of the command has it, nor the next
    self_check: Annotated[bool, Choice(option="self_check={}")] = False

    def __post_init__(self) -> None:
        model, solver = Argument("gradient_model", self.gradient_model), Argument("solver", self.solver)
        columns, data_width = Argument("columns", self.columns), Argument("data_width", self.data_width)
        one_of(model, MODELS)
        if self.polynomials and not self.flat_field:
            raise InputError(model, " without a reference: it takes colours relative to one", remedy="give one")
        if self.light_gains and not self.polynomials:
            raise InputError(
                *(Argument("light_gains", True), " with ", model, ": they act on colours relative to a reference, "),
                "which a table has as 8 bits",
                remedy=("set ", Argument("gradient_model", "cubic"), " or ", Argument("light_gains", False)),
            )
        one_of(solver, COLUMNS)
        if not self.rows:
            object.__setattr__(self, "rows", self.columns)
        self._check_grid()
        if self.solver == "spectral" and self.rows != self.columns:
            raise InputError(
                *(solver, " with ", Argument("rows", self.rows), " and ", columns, ": it takes square grids"),
                remedy=("set both the same, or ", Argument("solver", "tridiagonal")),
            )
        self._check_lanes()
        if self.self_check and not can_check(self.columns, self.lanes):
            raise InputError(
                *(Argument("self_check", True), " with ", columns, ", ", Argument("lanes", self.lanes)),
                f": it takes {CHECK_COLUMNS} columns or more, and {CHECK_BEATS} clocks for a row of depth",
                remedy=("set ", Argument("self_check", False)),
            )
        for name, number in NUMBERS.items():
            within(Argument(name, getattr(self, name)), *number.accepted)
        self._check_sums()
        if self.depth_range_px is None:
            object.__setattr__(self, "depth_range_px", min(self.rows, self.columns) / 4)
        if not SHALLOWEST_PX <= self.deepest_px < math.inf:
            raise InputError(
                f"a depth range of {self.deepest_px:g} pixels: accepted are {SHALLOWEST_PX:g} pixels and more"
            )
        lowest, highest = GRADIENT_LIMITS
        if not lowest <= self.gradient_limit <= highest or math.log2(self.gradient_limit) % 1:
            raise InputError(
                f"the largest slope of the calibration is near {self.gradient_limit:g}: accepted are "
                f"{lowest:g} to {highest:g} pixels per pixel: correct its unit"
            )
        self._check_formats(columns, data_width)

    def _check_grid(self) -> None:
        columns = Argument("columns", self.columns)
        within(columns, *COLUMNS[self.solver])
        power_of_two(columns)
        within(Argument("rows", self.rows), *ROWS)

    def _check_formats(self, columns: Argument, data_width: Argument) -> None:
        """Refuse a pipeline whose words are too short."""
        lowest, highest = COEFFICIENT_LIMITS
        if not lowest <= self.coefficient_limit <= highest or math.log2(self.coefficient_limit) % 1:
            raise InputError(
                f"the coefficients of the calibration are near {self.coefficient_limit:g}: accepted are up to "
                f"{highest:g}: colours that change so little with the slope do not show it: use more light"
            )
        deepest = min(self.deepest_px, DEEPEST * min(self.rows, self.columns) * self.gradient_limit)
        modes = self.column_inverse if self.solver == "spectral" else self.elimination_store
        step = modes.lsb * self.depth_limit_px
        if step > COARSEST_LSB * deepest:
            enough = self.data_width + math.ceil(math.log2(step / (COARSEST_LSB * deepest)))
            wider = (Argument("data_width", enough), " or ") if enough <= WIDTHS[STORED].accepted[1] else ()
            raise InputError(
                *(data_width, " cannot hold the formats of ", columns),
                f" and a depth range of {self.deepest_px:g} pixels (the step of a mode would be {step:.3g} pixels, "
                f"the largest depth is {deepest:.3g})",
                remedy=("try ", *wider, "a smaller depth range"),
            )
        for node, (bound, form) in self.bounds_within_range().items():
            if bound > form.limit - form.lsb:
                raise InputError(
                    *(f"{node} of ", columns, ", ", data_width),
                    f" holds up to {form.limit:g} and a depth within the range of {self.deepest_px:g} pixels can "
                    f"ask for {bound:.4g}",
                    remedy="a fault in the derivation of formats, please report it",
                )

    def _check_lanes(self) -> None:
        most = most_lanes(self.columns, self.zero_offset)
        lanes = Argument("lanes", self.lanes)
        if self.solver != "tridiagonal" and self.lanes != 1:
            raise InputError(
                *(lanes, " with ", Argument("solver", self.solver), ": it puts out one depth value per clock"),
                remedy=("set ", Argument("lanes", 1), ", or ", Argument("solver", "tridiagonal")),
            )
        if not 1 <= self.lanes <= most:
            zero = (" and ", Argument("zero_offset", True)) if self.zero_offset else ()
            raise InputError(lanes, " with ", Argument("columns", self.columns), *zero, accepted=range(1, most + 1))
        power_of_two(lanes)

    def _check_sums(self) -> None:
        """Refuse gains that a capture cannot sum blocks in."""
        least = PIXEL_WIDTH + 2 * self.reference_block_log2
        if self.flat_field and self.gain_width < least:
            block = 1 << self.reference_block_log2
            raise InputError(
                *(Argument("gain_width", self.gain_width), " with ", Argument("columns", self.columns)),
                f": a capture of the reference sums blocks of {block} x {block} pixels in words of that width",
                remedy=("set ", Argument("gain_width", least), " or more"),
            )

    @property
    def samples(self) -> tuple[np.ndarray, np.ndarray]:
        """Rows and columns, from corner to corner of the grid, float64 (`SAMPLES`, `SAMPLES`) each."""
        sides = (np.linspace(0, length - 1, SAMPLES) for length in (self.rows, self.columns))
        row, column = np.meshgrid(*sides, indexing="ij")
        return row, column

    @property
    def bin_levels(self) -> int:
        """Grey levels of a colour that one entry of the gradient table holds for."""
        return 256 >> self.bits_per_channel

    @property
    def coefficient(self) -> Format:
        """Format of a coefficient of the solver, up to 1."""
        return Format(self.coefficient_width, self.coefficient_width - 1)

    @property
    def gain(self) -> Format:
        """Format of a gain of the flat field, 1 / reference, unsigned."""
        return Format(self.gain_width, self.gain_width + DARKEST_LOG2)

    @property
    def boundary(self) -> Boundary:
        """Name of the condition at the edge."""
        return BOUNDARIES[not self.neumann]

    @property
    def arithmetic_width(self) -> int:
        """Bits inside the transforms and the divide."""
        return self.data_width + GUARD_BITS

    @property
    def deepest_px(self) -> float:
        """Largest depth that formats are sized for, in grid pixels."""
        assert self.depth_range_px is not None  # it is filled in
        return self.depth_range_px

    @property
    def depth_limit_px(self) -> float:
        """Full scale of the depth code, in grid pixels."""
        return DEPTH_HEADROOM * self.deepest_px

    @property
    def depth_limit_log2(self) -> int:
        """Full scale of the depth code, in units of `unit_px`, as a power of two."""
        return math.ceil(math.log2(self.depth_limit_px)) if self.solver == "tridiagonal" else 0

    @property
    def unit_px(self) -> float:
        """Unit of length, in grid pixels, up to the forward modes: that of the depth where no divide changes units."""
        return self.depth_limit_px / 2.0**self.depth_limit_log2 if self.solver == "tridiagonal" else 1.0

    @property
    def reference_block_log2(self) -> int:
        """Base-2 logarithm of the rows and columns of a block of pixels that share a gain."""
        block = min(max(self.columns // REFERENCE_NODES, SMALLEST_BLOCK), self.rows)
        return block.bit_length() - 1

    @property
    def reference_nodes(self) -> tuple[int, int]:
        """Rows and columns of the grid of gains; an incomplete last row of blocks has no gains of its own."""
        return self.rows >> self.reference_block_log2, self.columns >> self.reference_block_log2

    @property
    def down_words(self) -> int:
        """Modes per clock on the way down, the root of `lanes`: more cost more, fewer delay the whole map."""
        return 1 << (self.lanes.bit_length() - 1) // 2

    @property
    def up_paths(self) -> int:
        """Modes per clock of each of two rows on the way up; with one lane they come in half of the clocks."""
        return max(1, self.lanes // 2)

    @property
    def store_style(self) -> int:
        """Style of a memory of a frame store, BLOCK or ULTRA."""
        wide = -(-self.up_paths * self.data_width // ULTRA_WIDTH)
        bits = self.rows * self.columns * self.data_width // (2 * wide)
        return ULTRA if bits >= ULTRA_WORDS * ULTRA_WIDTH else BLOCK

    @property
    def words_per_row(self) -> int:
        """Words in a row of the frame store: those of a clock, or as many as an UltraRAM takes; spectral: one."""
        packed = ULTRA_WIDTH // self.data_width if self.store_style == ULTRA and self.solver == "tridiagonal" else 1
        return self.up_paths if self.up_paths > 1 else packed

    # Formats, in the order of the stream. Slopes, divergence and forward modes have the unit `unit_px`; all values
    # after the solve along the columns have the unit `depth_limit_px`.

    @cached_property
    def row_forward(self) -> Format:
        return Format.holding(self._bounds.row_forward * self.gradient_limit / self.unit_px, self.arithmetic_width)

    @property
    def polynomials(self) -> bool:
        """True for a gradient model of polynomials of the position."""
        return self.gradient_model != "lut"

    @property
    def has_table(self) -> bool:
        """True if colours index a table, of slopes or of corrections."""
        return self.gradient_model != "quadratic"

    @property
    def gradient(self) -> Format:
        """Format of a slope, with the fraction bits of the row transform, so that no bits are dropped between them."""
        fraction = self.row_forward.fraction
        largest = self.gradient_limit / self.gradient_lsb
        return Format(math.ceil(math.log2(largest)) + 1, fraction)

    @property
    def gradient_lsb(self) -> float:
        """Slope of code 1. For the tridiagonal solver it compensates the gain of the coefficients."""
        gain = self.transform_gain if self.solver == "tridiagonal" else 1.0
        return self.row_forward.lsb * self.unit_px * gain

    @property
    def polynomial(self) -> Format:
        """Format of a coefficient along the raster, in units of `coefficient_unit`."""
        return Format(POLYNOMIAL.width, POLYNOMIAL.fraction - self._coefficient_log2)

    @property
    def colour_coefficient(self) -> Format:
        """Format of the upper bits of a coefficient, in units of `coefficient_unit`."""
        return Format(COLOUR_COEFFICIENT.width, COLOUR_COEFFICIENT.fraction - self._coefficient_log2)

    @property
    def coefficient_unit(self) -> float:
        """Slope of a coefficient of 1."""
        return self.gradient_lsb * 2.0**self.gradient.fraction

    @property
    def _coefficient_log2(self) -> int:
        return round(math.log2(self.coefficient_limit / POLYNOMIAL.limit))

    @property
    def divergence(self) -> Format:
        return Format(self.gradient.width + 2, self.gradient.fraction)

    @cached_property
    def row_modes(self) -> Format:
        """Format of the first frame store."""
        return Format.holding(self._bounds.row_modes * self.gradient_limit, self.data_width)

    @cached_property
    def column_forward(self) -> Format:
        return Format.holding(self._bounds.column_forward * self.gradient_limit, self.arithmetic_width)

    @cached_property
    def column_inverse(self) -> Format:
        return Format.holding(self._bounds.column_inverse / DEPTH_HEADROOM, self.arithmetic_width)

    @cached_property
    def depth_modes(self) -> Format:
        """Format of the second frame store."""
        return Format.holding(self._bounds.depth_modes / DEPTH_HEADROOM, self.data_width)

    @cached_property
    def elimination(self) -> Format:
        """Format of the running rows of the tridiagonal solver, and of the modes at its input."""
        return Format.holding(max(self._elimination_bounds.values()), self.arithmetic_width)

    @property
    def elimination_store(self) -> Format:
        """Format of the frame store of the tridiagonal solver."""
        return Format(self.data_width, self.elimination.fraction - GUARD_BITS)

    @property
    def moment_drop(self) -> int:
        """Fraction bits that rows * mean drops before the division by rows (Neumann)."""
        return (self.rows - 1).bit_length()

    @cached_property
    def row_inverse(self) -> Format:
        return Format.holding(self._row_inverse_bound / DEPTH_HEADROOM, self.arithmetic_width)

    @property
    def depth(self) -> Format:
        return Format(self.data_width, self.data_width - 1)

    @property
    def depth_lsb_px(self) -> float:
        """Depth of code 1, in grid pixels."""
        return self.depth.lsb * self.depth_limit_px

    def solver_parameters(self) -> dict[str, int]:
        """Return the HDL parameters that both solvers share."""
        return {
            "Columns": self.columns,
            "Width": self.arithmetic_width,
            "CoeffWidth": self.coefficient_width,
            "InWidth": self.divergence.width,
            "DataWidth": self.data_width,
        }

    def transform(self, before: Format, inside: Format, behind: Format) -> Transform:
        """Return the formats of a transform of a solver, from those of the words before, inside and behind it."""
        return Transform(
            before.fraction - inside.fraction,
            self.arithmetic_width,
            self.coefficient_width,
            inside.fraction - behind.fraction,
            behind.width,
            alternate=not self.neumann,
        )

    # Gain.

    @property
    def transform_gain(self) -> float:
        """Gain of the coefficients over all forward and inverse transforms, slightly below 1."""
        transforms = 4 if self.solver == "spectral" else 2
        return coefficient_gain(self.coefficient_width) ** (transforms * (twiddle_stages(self.columns) + 1))

    # Bounds.

    @property
    def _bounds(self) -> Bounds:
        return bounds(self.columns, self.neumann)

    @property
    def _row_inverse_bound(self) -> float:
        """Bound of the inverse row transform, which takes two rows at a time in the tridiagonal solver."""
        return self._bounds.row_pair if self.solver == "tridiagonal" else self._bounds.row_inverse

    @property
    def _elimination_bounds(self) -> dict[str, float]:
        """Bounds of the nodes with format `elimination`, where z is at most the largest depth mode.

        |d| = |z[i] + c z[i+1]| and |e| = |z[i] - c c' z[i+2]| are at most twice it, as is a sum of modes of two rows.
        """
        by_slopes, by_depths = difference_bounds(self.rows, self.columns, self.neumann)
        slope = self.gradient_limit / self.depth_limit_px
        difference = float(np.minimum(by_slopes * slope, by_depths / DEPTH_HEADROOM).max())
        depth = self._bounds.depth_modes / DEPTH_HEADROOM
        return {
            "elimination.difference": difference,
            "elimination.state": 2 * depth,
            "substitution": depth,
        }

    def bounds_within_range(self) -> dict[str, tuple[float, Format]]:
        """Return the largest magnitude at each group of nodes for inputs within gradient limit and depth range."""
        steep, deep = self.gradient_limit / self.unit_px, 1 / DEPTH_HEADROOM
        found = {
            "row_forward": (self._bounds.row_forward * steep, self.row_forward),
            "row_inverse": (self._row_inverse_bound * deep, self.row_inverse),
            "row_inverse.output": (deep, self.depth),
        }
        if self.solver == "tridiagonal":
            running = {node: (bound, self.elimination) for node, bound in self._elimination_bounds.items()}
            stored = (self._elimination_bounds["elimination.state"], self.elimination_store)
            return found | running | {"elimination.store": stored}
        return found | {
            "row_forward.phase.re": (self._bounds.row_modes * steep, self.row_modes),
            "column_forward": (self._bounds.column_forward * steep, self.column_forward),
            "spectral_divide": (self._bounds.column_inverse * deep, self.column_inverse),
            "column_inverse.output": (self._bounds.depth_modes * deep, self.depth_modes),
        }


COLOURS: dict[str, Any] = {"flat_field": True, "gradient_model": "cubic", "light_gains": True}  # of a real sensor
CHOICES = {name: choice.of(name) for name, choice in declared(Configuration, Choice).items()}  # that users name
NUMBERS = {name: number for name, number in CHOICES.items() if isinstance(number, Number)}  # with a range
SOLVER_NUMBERS = {name: number for name, number in NUMBERS.items() if not number.colours}
DEFAULTS: dict[str, int] = {name: getattr(Configuration, name) for name in NUMBERS}
WIDTHS = {name: number for name, number in NUMBERS.items() if isinstance(number, Width)}
SOLVER_WIDTHS = {name: width for name, width in WIDTHS.items() if not width.colours}
STORED, COEFFICIENT, GAIN = "data_width", "coefficient_width", "gain_width"
WORDS = {CHOICES[name].argument: CHOICES[name].variable for name in (*NUMBERS, "depth_range_px")}
"""Variables of the numbers and of the depth range, by argument of `td.Pipeline`."""


class ExactConfiguration(Configuration):
    """Choices for double precision, which takes any grid and has no formats."""

    def _check_grid(self) -> None:
        for length in (Argument("rows", self.rows), Argument("columns", self.columns)):
            within(length, *EXACT_LENGTHS)

    def _check_formats(self, columns: Argument, data_width: Argument) -> None:
        """Accept all: there are none."""
