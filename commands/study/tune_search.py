# SPDX-License-Identifier: Apache-2.0
"""Search of `make tune`: the cheapest word lengths whose error is within a target, and the limits of the user."""

import math
import time
from bisect import bisect_left
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from statistics import fmean
from typing import Annotated, Any

from commands.common import published
from commands.common.variables import one, real
from commands.cost.cost import Cost, cost
from commands.cost.devices import Device
from commands.hardware.targets import DEFAULT_TARGET, TARGETS, Target
from tactile_depth.base.errors import Argument
from tactile_depth.chip.configuration import COEFFICIENT, DEFAULTS, GAIN, SOLVER_WIDTHS, STORED, WIDTHS, Configuration

DATA_BITS, COEFFICIENT_BITS, GAIN_BITS = (WIDTHS[name].accepted for name in (STORED, COEFFICIENT, GAIN))

AUTO = "auto"  # of TOLERANCE
DEFAULT_TOLERANCE = 0.1  # % of peak


@dataclass(frozen=True)
class Judgement:
    """One number for the errors of several frames, and the factor between the tolerance and that of tuning frames."""

    name: str
    of: Callable[[Sequence[float | None]], float]
    margin: float


def _rms(errors: Sequence[float | None]) -> float:
    return math.sqrt(fmean(error**2 for error in errors if error is not None))


# In 100 tunings on the bench (tolerances of 0.01 to 0.5, 20 splits each) the other frames then always met the
# tolerance; they missed it in 1 with 1.75, in 9 with 1.5, and in 22 with 1.
WORST_FRAME = Judgement("worst frame", lambda errors: max(error for error in errors if error is not None), 2.0)
# In 2,000 splits of 45 real presses, words of 14 to 20 bits, the RMS over the others is up to 1.53 times as large in
# 99 of 100.
ALL_FRAMES = Judgement("RMS over the frames", _rms, 1.5)


positive = real(1e-9, 1e9)
Limit = Annotated[float, positive]


def _tolerance(argument: Argument) -> float:
    return math.nan if argument.value == AUTO else positive(argument)


@dataclass(frozen=True)
class Limits:
    """Limits of the user; an infinite value is no limit, and a tolerance of nan follows from the calibration."""

    tolerance: Annotated[float, _tolerance] = DEFAULT_TOLERANCE
    latency_us: Annotated[Limit, "MAX_LATENCY_US"] = math.inf  # first pixel to first depth
    map_latency_us: Annotated[Limit, "MAX_MAP_LATENCY_US"] = math.inf  # last pixel to last depth
    clock_mhz: Limit = published.CLOCK_MHZ
    multipliers: Annotated[Limit, "MAX_DSP"] = math.inf
    luts: Annotated[Limit, "MAX_LUT"] = math.inf
    memory_kbit: Annotated[Limit, "MAX_MEMORY_KBIT"] = math.inf
    target: Annotated[Target, one(TARGETS)] = TARGETS[DEFAULT_TARGET]
    judgement: Judgement = WORST_FRAME

    @property
    def aim(self) -> float:
        """Target of the error of the frames for tuning."""
        return self.tolerance / self.judgement.margin

    @property
    def device(self) -> Device:
        """Device whose multipliers and LUTs count."""
        return self.target.device

    def weight(self, counted: Cost) -> float:
        """Return the cost of a configuration: its shares of multipliers, LUTs and memory bits of the device."""
        used = counted.multipliers_of(self.device), counted.luts_of(self.device), counted.memory_bits
        return sum(self.target.shares(*used))

    def broken(self, counted: Cost) -> list[str]:
        """Return the limits that a configuration exceeds, apart from the tolerance."""
        latency = counted.first_depth_cycles / self.clock_mhz
        checks = (
            ("MAX_LATENCY_US", latency, self.latency_us),
            ("MAX_MAP_LATENCY_US", counted.map_cycles / self.clock_mhz, self.map_latency_us),
            ("MAX_DSP", counted.multipliers_of(self.device), self.multipliers),
            ("MAX_LUT", counted.luts_of(self.device), self.luts),
            ("MAX_MEMORY_KBIT", counted.memory_bits / 1000, self.memory_kbit),
        )
        return [f"{name}={limit:g} (it takes {value:,.5g})" for name, value, limit in checks if value > limit]


@dataclass(frozen=True, order=True)
class Widths:
    """Point of the search."""

    solver: str
    data: int
    coefficient: int
    lanes: int = 1
    gain: int = GAIN_BITS[1]

    def __str__(self) -> str:
        lanes = f" LANES={self.lanes}" if self.lanes > 1 else ""
        own = [name for name, bits in self.words.items() if name in SOLVER_WIDTHS or bits != DEFAULTS[name]]
        words = " ".join(f"{WIDTHS[name].variable}={self.words[name]}" for name in own)
        return f"SOLVER={self.solver} {words}{lanes}"

    @property
    def words(self) -> dict[str, Any]:
        """Widths by field of Configuration."""
        return {STORED: self.data, COEFFICIENT: self.coefficient, GAIN: self.gain}


# Points of a solver that most searches measure: the widest, and a bisection of each width.
MEASURED = 1 + sum((high - low).bit_length() for low, high in (DATA_BITS, COEFFICIENT_BITS))


@dataclass
class Search:
    """Search of the cheapest point within the tolerance and the limits.

    As a width grows, the error falls (apart from little noise) and the cost grows. So for each data width only the
    narrowest coefficient that meets the tolerance can be the cheapest. That coefficient does not grow with the data
    width, and both are found by bisection. Every point that is returned has been measured.
    """

    build: Callable[[Widths], Configuration | None]  # None: cannot be built
    measure: Callable[[Configuration], float]  # error of the frames for tuning, % of peak
    limits: Limits
    target: float  # target of that error
    lanes: Mapping[str, int] = field(default_factory=dict)  # of a solver, by default one
    tried: dict[Widths, float] = field(default_factory=dict)

    def point(self, solver: str, data: int, coefficient: int) -> Widths:
        return Widths(solver, data, coefficient, self.lanes.get(solver, 1))

    def error(self, at: Widths) -> float:
        if at not in self.tried:
            config = self.build(at)
            self.tried[at] = math.inf if config is None else self.measure(config)
        return self.tried[at]

    def meets(self, at: Widths) -> bool:
        return self.error(at) <= self.target

    def cost(self, at: Widths) -> Cost | None:
        config = self.build(at)
        return None if config is None else cost(config)

    def allowed(self, at: Widths) -> bool:
        counted = self.cost(at)
        return counted is not None and not self.limits.broken(counted)

    def rank(self, at: Widths) -> tuple[float, int]:
        counted = self.cost(at)
        return (math.inf, 0) if counted is None else (self.limits.weight(counted), counted.first_depth_cycles)

    def seconds(self, solvers: list[str]) -> float:
        """Return about how long `cheapest` takes, by the time of the first point that it measures."""
        began = time.monotonic()
        self.error(self.point(solvers[0], DATA_BITS[1], COEFFICIENT_BITS[1]))
        return (time.monotonic() - began) * len(solvers) * MEASURED

    def cheapest(self, solvers: list[str]) -> Widths | None:
        candidates: list[Widths] = []
        for solver in solvers:
            widest = self.point(solver, DATA_BITS[1], COEFFICIENT_BITS[1])
            if not self.meets(widest):
                continue
            coefficient = COEFFICIENT_BITS[1]
            data = _least(DATA_BITS[0], DATA_BITS[1], lambda d: self.meets(replace(widest, data=d)))  # noqa: B023
            for width in range(data, DATA_BITS[1] + 1):
                least = self.point(solver, width, COEFFICIENT_BITS[0])
                if self.build(least) is not None and (
                    not self.allowed(least) or (candidates and self.rank(least) >= min(map(self.rank, candidates)))
                ):
                    break  # no coefficient meets the target, and wider words do not either
                row = replace(widest, data=width)
                coefficient = _least(
                    COEFFICIENT_BITS[0],
                    coefficient,
                    lambda c: self.meets(replace(row, coefficient=c)),  # noqa: B023
                )
                point = replace(row, coefficient=coefficient)
                if self.meets(point) and self.allowed(point):
                    candidates.append(point)
        return self.with_short_gains(min(candidates, key=self.rank)) if candidates else None

    def with_short_gains(self, at: Widths) -> Widths:
        """Return a point with the shortest gains of the flat field that meet the target."""
        config = self.build(at)
        if config is None or not config.flat_field:
            return at

        shorter = (replace(at, gain=width) for width in range(GAIN_BITS[0], at.gain))
        return next((point for point in shorter if self.build(point) is not None and self.meets(point)), at)

    def nearest(self, solvers: list[str]) -> Widths | None:
        """Return the point of the smallest error within the limits."""
        corners = []
        for solver in solvers:
            for coefficient in range(COEFFICIENT_BITS[0], COEFFICIENT_BITS[1] + 1):
                widths = (self.point(solver, data, coefficient) for data in range(DATA_BITS[1], DATA_BITS[0] - 1, -1))
                widest = next(filter(self.allowed, widths), None)
                corners += [] if widest is None else [widest]
        outer = [a for a in corners if not any(_wider(b, a) for b in corners)]
        return min(outer, key=self.error) if outer else None


def _wider(a: Widths, b: Widths) -> bool:
    """Return True if a is at least as wide as b in every word, and wider in one."""
    return a != b and a.solver == b.solver and a.data >= b.data and a.coefficient >= b.coefficient


def _least(low: int, high: int, holds: Callable[[int], bool]) -> int:
    """Return the least value in low..high from which on a condition holds, by bisection; it must hold at `high`."""
    return low + bisect_left(range(low, high), True, key=holds)
