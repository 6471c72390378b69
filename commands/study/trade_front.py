# SPDX-License-Identifier: Apache-2.0
"""The front of `make trade`: which configurations no other one beats, the knee, and the picture.

A configuration is beaten if another one is no worse in every axis, as printed, and better in one. Its silicon is the
largest of the shares of multipliers, LUTs and block memory that it takes of an LFE5U-85F: it fits up to 100 %.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from commands.common.published import CLOCK_MHZ
from commands.common.tabular import Table
from commands.hardware.targets import TARGETS
from commands.study import study
from commands.study.study import built
from tactile_depth.chip.configuration import COEFFICIENT, DEFAULTS, GAIN, NUMBERS, SOLVER_WIDTHS, STORED


@dataclass(frozen=True)
class Point(study.with_numbers(NUMBERS)):  # type: ignore[misc]
    """Configuration of a real sensor's pipeline behind a camera."""

    gradient: str
    pixel_format: str
    light_gains: int  # 1 or 0


DEFAULT = Point("tridiagonal", "neumann", 96, 128, 1, *DEFAULTS.values(), "cubic", "rgb888", 1)
"""Configuration of td.Pipeline for a sensor of 4:3."""


@dataclass(frozen=True)
class Row(Point):
    """A configuration and what was measured: means over the presses in the middle, and over those at the sides."""

    problem: str
    presses: int
    height_um: float
    sides_height_um: float | None  # None: the grid is square and does not show the sides
    cap_percent: float
    untouched_um: float
    centroid_um: float
    area_percent: float
    saturations: int
    first_depth_cycles: int
    map_cycles: int
    contact_cycles: float
    multipliers: int
    multipliers_18: int
    luts: int
    memory_bits: int
    power_mw: float
    command: str
    models: str


ERRORS = {  # and their resolution
    **dict.fromkeys(("height_um", "sides_height_um", "untouched_um"), 0.1),
    **{"centroid_um": 1.0, "area_percent": 0.1},
}
COSTS = (
    *("first_depth_cycles", "map_cycles", "contact_cycles"),
    *("multipliers", "multipliers_18", "luts", "memory_bits", "power_mw"),
)
OPTIONS = (
    *("solver", "boundary", "gradient", "light_gains", "pixel_format", "rows", "columns", "lanes"),
    *NUMBERS,
)
NEAR = 1.1  # depth error of the knee over the smallest: what it adds is a tenth


def axes(rows: Sequence[Row]) -> np.ndarray:
    """Return errors as they are printed, and costs, float64 (rows, axes); infinite where the sides are not seen."""
    values = np.array([[getattr(row, name) for name in (*ERRORS, *COSTS)] for row in rows], float)
    errors = np.rint(values[:, : len(ERRORS)] / list(ERRORS.values()))
    return np.nan_to_num(np.concatenate((errors, values[:, len(ERRORS) :]), axis=1), nan=np.inf)


def beaten_by(rows: Sequence[Row]) -> list[int | None]:
    """Return for each row the number of one that beats it; None on the front."""
    values = axes(rows)
    found: list[int | None] = []
    for value in values:
        beats = (values <= value).all(axis=1) & (values < value).any(axis=1)
        found.append(int(beats.argmax()) if beats.any() else None)
    return found


def silicon(row: Row) -> float:
    """Return the largest of the shares of an LFE5U-85F that a configuration takes, in %."""
    return 100 * max(TARGETS["ecp5"].shares(row.multipliers_18, row.luts, row.memory_bits))


def depth_error(row: Row) -> float:
    """Return the RMS of the depth error in the contact and on untouched gel, of presses in the middle, in um."""
    return math.hypot(row.height_um, row.untouched_um) / math.sqrt(2)


def whole_picture(rows: Sequence[Row]) -> list[Row]:
    """Return the rows of grids that cover the picture, with the boundary that a contact may cross, of one camera."""
    same = DEFAULT.boundary, DEFAULT.pixel_format
    return [row for row in rows if row.sides_height_um and (row.boundary, row.pixel_format) == same]


def knee(rows: Sequence[Row]) -> Row:
    """Return the configuration with the least silicon whose depth error is within NEAR of the smallest."""
    among = whole_picture(rows)
    smallest = min(map(depth_error, among))
    near = [row for row in among if depth_error(row) <= NEAR * smallest]
    return min(near, key=lambda row: (silicon(row), depth_error(row)))


def described(row: Row) -> str:
    """Return a configuration in a few words."""
    lanes = f", {row.lanes} values a clock" if row.lanes > 1 else ""
    words = f"{'/'.join(str(getattr(row, name)) for name in SOLVER_WIDTHS)} bits"
    return f"{row.columns} x {row.rows}, {row.solver}, {row.gradient}, {words}{lanes}, {row.pixel_format}"


def figures(row: Row) -> tuple[str, ...]:
    """Return the cells of a configuration in the table of chosen ones."""
    sides = f" / {row.sides_height_um:.1f}" if row.sides_height_um else ""
    return (
        f"{row.height_um:.1f}{sides}",
        f"{row.untouched_um:.1f}",
        f"{row.centroid_um:.0f}",
        f"{row.area_percent:.1f}",
        *(f"{cycles / CLOCK_MHZ:.1f}" for cycles in (row.first_depth_cycles, row.contact_cycles, row.map_cycles)),
        str(row.multipliers_18),
        f"{row.luts:,}",
        f"{row.memory_bits / 1000:,.0f}",
        f"{row.power_mw:.0f}",
        f"{silicon(row):.0f} %",
    )


HEAD = (
    *("configuration", "height error, um, middle / sides", "untouched gel, um", "centroid, um", "area, %"),
    *("first depth, us", "contact", "map", "18 x 18", "LUT4", "kbit", "mW at 45 nm", "silicon"),
)


def _words(data: int, coefficient: int) -> Point:
    return DEFAULT.but(**{STORED: data, COEFFICIENT: coefficient, GAIN: 16})


SQUARE = DEFAULT.but(rows=128, columns=128)
LUT: dict[str, Any] = {"gradient": "lut", "light_gains": 0}
CHANGES = {
    "24-bit default": DEFAULT,
    **{f"{bits}-bit words": _words(bits, 18) for bits in (20, *range(18, 11, -1))},
    **{f"{bits}-bit coefficients": _words(24, bits) for bits in (14, 10)},
    **{
        f"{rows} x {columns}": DEFAULT.but(rows=rows, columns=columns)
        for rows, columns in ((192, 256), (48, 64), (24, 32))
    },
    "zero depth at the edge": DEFAULT.but(boundary="dirichlet"),
    "no light gains": DEFAULT.but(light_gains=0),
    "`quadratic`": DEFAULT.but(gradient="quadratic"),
    "`lut`": DEFAULT.but(**LUT),
    **{f"camera of `{sent}`": DEFAULT.but(pixel_format=sent) for sent in ("raw8", "yuyv", "rgb565")},
    **{f"{lanes} values per clock": DEFAULT.but(lanes=lanes) for lanes in (4, 16)},
    "middle square, 128 x 128": SQUARE,
    "the same, spectral": SQUARE.but(solver="spectral"),
    "published choices: the same, `lut`": SQUARE.but(solver="spectral", **LUT),
}
"""Changes of the default, one at a time."""


def changed(rows: Sequence[Row]) -> dict[str, Row]:
    """Return the rows of CHANGES by their names."""
    by_point = {study.point_of(Point, row): row for row in built(rows)}
    return {name: by_point[point] for name, point in CHANGES.items() if point in by_point}


@dataclass(frozen=True)
class Front:
    """The front of a study.

    Attributes
    ----------
    changes : list of tuple of str
        Cells of the knee and of the default with one thing changed at a time, below HEAD.
    options : list of tuple of str
        Cells of each value of each option, below OPTIONS_HEAD.
    count, unbuilt, on_front : int
        Configurations: all, those that cannot be built, those that no other one beats.
    knee : str
        Command that runs the knee.
    """

    changes: list[tuple[str, ...]]
    options: list[tuple[str, ...]]
    count: int
    unbuilt: int
    on_front: int
    knee: str

    @property
    def never(self) -> list[str]:
        """Options that are on the front with no configuration: candidates for removal."""
        return [name for name, _, on_front, _ in self.options if on_front == "0"]

    @property
    def sentence(self) -> str:
        beaten = self.count - self.unbuilt - self.on_front
        never = ", ".join(self.never) or "no option"
        return (
            f"{self.count} configurations, {self.unbuilt} of them cannot be built; {self.on_front} are on the front, "
            f"{beaten} are beaten by another in every axis; never on the front: {never}"
        )


OPTIONS_HEAD = ("option", "configurations", "on the front", "least depth error, um")


def front_of(rows: Sequence[Row]) -> Front:
    """Return the front of measured rows."""
    among = built(rows)
    front = [row for row, other in zip(among, beaten_by(among), strict=True) if other is None]
    options: list[tuple[str, ...]] = []
    for option in OPTIONS:
        for value in sorted({getattr(row, option) for row in among}, key=lambda value: (len(str(value)), str(value))):
            of, on = ([row for row in rows if getattr(row, option) == value] for rows in (among, front))
            least = min(map(depth_error, of))
            options.append((f"{option}={value}", str(len(of)), str(len(on)), f"{least:.1f}"))
    best = knee(among)
    named = {f"knee: {described(best)}": best} | changed(rows)
    changes = [(name, *figures(row)) for name, row in named.items()]
    return Front(changes, options, len(rows), len(rows) - len(among), len(front), best.command)


def summary(front: Front) -> str:
    """Return the tables of a front, its counts, and the command of its knee."""
    tables = Table(HEAD, front.changes), Table(OPTIONS_HEAD, front.options)
    return "\n\n".join([*map(str, tables), f"{front.sentence} (beaten.csv)", f"the knee: {front.knee}"])


def write_beaten(rows: Sequence[Row], path: Path) -> None:
    """Write the configurations that another one beats, and which one."""
    among = built(rows)
    by = zip(among, beaten_by(among), strict=True)
    pairs = [(row.command, among[other].command) for row, other in by if other is not None]
    path.write_bytes(b"".join(map(study.line, [("beaten", "by"), *pairs])))


LABELS = {  # of the marked configurations; {} is the depth error
    "24-bit default": "default: 96 x 128, 24 bits, {:.1f} \u00b5m",
    "4 values per clock": "4 values\nper clock",
    "16 values per clock": "16 values\nper clock",
    "published choices: the same, `lut`": "published choices\nin this pipeline: {:.1f} \u00b5m",
}


def draw(rows: Sequence[Row], path: Path) -> None:
    """Draw the depth error against silicon and against the latency of the whole map."""
    among, found = whole_picture(built(rows)), changed(rows)
    best = knee(among)
    smallest = min(map(depth_error, among))
    figure = Figure(figsize=(11, 4.4), layout="constrained")
    both = figure.subplots(1, 2, sharey=True)
    default, *lanes, published = (found[name] for name in LABELS)
    default_label, *lanes_labels, published_label = LABELS.values()
    knee_label = f"knee: {best.rows} x {best.columns}, {getattr(best, STORED)} bits, {{:.1f}} \u00b5m"
    panels: tuple[tuple[str, Callable[[Row], float], list[tuple[Row, str]]], ...] = (
        ("fullest resource of an LFE5U-85F, %", silicon, [(best, knee_label)]),
        (
            f"delay from the last pixel to the whole map, \u00b5s at {CLOCK_MHZ:g} MHz",
            lambda row: row.map_cycles / CLOCK_MHZ,
            list(zip(lanes, lanes_labels, strict=True)),
        ),
    )
    for axis, (title, measure, own) in zip(both, panels, strict=True):
        x, y = (np.array([take(row) for row in among]) for take in (measure, depth_error))
        axis.scatter(x, y, s=9, color="#9ab", alpha=0.5, linewidths=0, label="a configuration")
        order = np.lexsort((y, x))
        least = np.minimum.accumulate(y[order])
        axis.step(x[order], least, where="post", color="#08306b", label="the best found for its cost")
        axis.axhline(smallest, color="black", linestyle=":", linewidth=1, label="error of the calibration")
        looks = [*((row, text, "#e6550d", "*", 200) for row, text in own), (default, default_label, "#08306b", "o", 60)]
        for row, text, colour, marker, size in [*looks, (published, published_label, "black", "D", 45)]:
            at = measure(row), depth_error(row)
            axis.scatter(*at, marker=marker, s=size, color=colour, zorder=3)
            side = "right" if at[0] > np.sqrt(x.min() * x.max()) else "left"
            offset = (-4 if side == "right" else 4, -16 if row is default else 9)
            style = {"fontsize": 9, "color": colour, "weight": "bold", "ha": side, "zorder": 4}
            style["bbox"] = {"facecolor": "white", "alpha": 0.7, "edgecolor": "none", "pad": 1}
            axis.annotate(text.format(at[1]), at, offset, textcoords="offset points", **style)
        axis.set(xscale="log", yscale="log", xlabel=title, ylim=(0.85 * smallest, 3.5 * smallest))
        axis.set_yticks(ticks := [20, 25, 30, 40, 50, 60, 70], [str(tick) for tick in ticks])
        axis.xaxis.set_major_formatter("{x:g}")
        axis.minorticks_off()
        axis.grid(alpha=0.3)
    both[0].set_xticks(shares := [20, 30, 50, 100, 200, 500], [str(share) for share in shares])
    both[0].set_ylabel("depth error on real presses, \u00b5m RMS")
    both[1].legend(fontsize=8, loc="upper right")
    figure.savefig(path, dpi=110)
