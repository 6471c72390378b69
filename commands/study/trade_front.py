# SPDX-License-Identifier: Apache-2.0
"""The front of `make trade`: which configurations no other one beats, the knee, and the picture.

A configuration is beaten if another one is no worse in every axis, as printed, and better in one. Its silicon is the
sum of the shares of multipliers, LUTs and block memory that it takes of an LFE5U-85F.
"""

from __future__ import annotations

import csv
from collections.abc import Sequence
from pathlib import Path

import matplotlib
import numpy as np

from commands.common.markdown import table
from commands.common.published import CLOCK_MHZ
from commands.hardware.targets import TARGETS
from commands.study.rows import Row
from tactile_depth import files

matplotlib.use("Agg")
from matplotlib import pyplot as plt

ERRORS = {"height_um": 0.1, "sides_height_um": 0.1, "centroid_um": 1.0, "area_percent": 0.1}  # and their resolution
COSTS = (
    *("first_depth_cycles", "map_cycles", "contact_cycles"),
    *("multipliers", "multipliers_18", "luts", "memory_bits", "power_mw"),
)
OPTIONS = (
    *("solver", "boundary", "gradient", "light_gains", "pixel_format", "rows", "columns", "lanes"),
    *("data_width", "coefficient_width", "gain_width"),
)
NEAR = 1.1  # error of the knee over the smallest: what it adds is a tenth


def built(rows: Sequence[Row]) -> list[Row]:
    """Return the rows of configurations that can be built."""
    return [row for row in rows if not row["problem"]]


def axes(rows: Sequence[Row]) -> np.ndarray:
    """Return errors as they are printed, and costs, float64 (rows, axes); infinite where the sides are not seen."""
    errors = [[np.rint(float(row[name] or "inf") / step) for name, step in ERRORS.items()] for row in rows]
    costs = [[float(row[name]) for name in COSTS] for row in rows]
    return np.concatenate((np.array(errors), np.array(costs)), axis=1)


def beaten_by(rows: Sequence[Row]) -> list[int | None]:
    """Return for each row the number of one that beats it; None on the front."""
    values = axes(rows)
    found: list[int | None] = []
    for value in values:
        beats = (values <= value).all(axis=1) & (values < value).any(axis=1)
        found.append(int(beats.argmax()) if beats.any() else None)
    return found


def silicon(row: Row) -> float:
    """Return the shares of an LFE5U-85F that a configuration takes, in %, added up."""
    return 100 * TARGETS["ecp5"].share(*(float(row[name]) for name in ("multipliers_18", "luts", "memory_bits")))


def whole_picture(rows: Sequence[Row]) -> list[Row]:
    """Return the rows of grids that cover the picture."""
    return [row for row in rows if row["sides_height_um"]]


def knee(rows: Sequence[Row]) -> Row:
    """Return the configuration with the least silicon whose height error is within NEAR of the smallest."""
    among = whole_picture(rows)
    smallest = min(float(row["height_um"]) for row in among)
    return min((row for row in among if float(row["height_um"]) <= NEAR * smallest), key=silicon)


def described(row: Row) -> str:
    """Return a configuration in a few words."""
    lanes = f", {row['lanes']} values a clock" if row["lanes"] != "1" else ""
    words = f"{row['data_width']}/{row['coefficient_width']} bits"
    return (
        f"{row['columns']} x {row['rows']}, {row['solver']}, {row['gradient']}, {words}{lanes}, {row['pixel_format']}"
    )


def figures(row: Row) -> tuple[str, ...]:
    """Return the cells of a configuration in the table of chosen ones."""
    sides = f" / {float(row['sides_height_um']):.1f}" if row["sides_height_um"] else ""
    return (
        f"{float(row['height_um']):.1f}{sides}",
        f"{float(row['centroid_um']):.0f}",
        f"{float(row['area_percent']):.1f}",
        *(f"{float(row[name]) / CLOCK_MHZ:.1f}" for name in ("first_depth_cycles", "contact_cycles", "map_cycles")),
        row["multipliers_18"],
        f"{int(row['luts']):,}",
        f"{int(row['memory_bits']) / 1000:,.0f}",
        f"{float(row['power_mw']):.0f}",
        f"{silicon(row):.0f} %",
    )


HEAD = (
    *("configuration", "height error, um, middle / sides", "centroid, um", "area, %"),
    *("first depth, us", "contact", "map", "18 x 18", "LUT4", "kbit", "mW at 45 nm", "silicon"),
)


def chosen(rows: Sequence[Row]) -> dict[str, Row]:
    """Return the configurations that the picture marks, by their names; the last is not of the whole picture."""
    among = built(rows)

    def one(**wanted: str) -> Row:
        return next(row for row in among if all(row[name] == value for name, value in wanted.items()))

    wide = {"data_width": "24", "coefficient_width": "18", "gradient": "cubic", "pixel_format": "rgb888"}
    wide |= {"boundary": "neumann", "gain_width": "24"}
    plain = {"light_gains": "1", "lanes": "1"}
    return {
        "knee": knee(among),
        "24-bit default": one(rows="96", columns="128", **wide, **plain),
        "published choices": one(rows="128", columns="128", solver="spectral", **{**wide, "gradient": "lut"}),
    }


def summary(rows: Sequence[Row]) -> str:
    """Return the table of chosen configurations, and what each option is good for."""
    among = built(rows)
    beaten = beaten_by(among)
    front = [row for row, other in zip(among, beaten, strict=True) if other is None]
    lines = [table(HEAD, [(f"{name}: {described(row)}", *figures(row)) for name, row in chosen(rows).items()]), ""]
    counted, never = [], []
    for option in OPTIONS:
        for value in sorted({row[option] for row in among}, key=lambda text: (len(text), text)):
            of = [row for row in among if row[option] == value]
            on = sum(row[option] == value for row in front)
            least = min(float(row["height_um"]) for row in of)
            counted.append((f"{option}={value}", str(len(of)), str(on), f"{least:.1f}"))
            if not on:
                never.append(f"{option}={value}")
    lines.append(table(("option", "configurations", "on the front", "least height error, um"), counted))
    problems = len(rows) - len(among)
    lines.append(
        f"\n{len(rows)} configurations, {problems} of them cannot be built; {len(front)} are on the front, "
        f"{len(among) - len(front)} are beaten (beaten.csv)"
    )
    lines.append(f"never on the front: {', '.join(never) if never else 'no option'}")
    knees = knee(among)
    lines.append(f"the knee: {knees['command']}")
    return "\n".join(lines)


def write_beaten(rows: Sequence[Row], folder: Path) -> None:
    """Write the configurations that another one beats, and which one, to beaten.csv."""
    among = built(rows)
    with files.workspace(folder, ("beaten.csv",)) as work:
        with (work / "beaten.csv").open("w", newline="") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(("beaten", "by"))
            for row, other in zip(among, beaten_by(among), strict=True):
                if other is not None:
                    writer.writerow((row["command"], among[other]["command"]))
        files.replace(work, ("beaten.csv",), folder)


def draw(rows: Sequence[Row], path: Path) -> None:
    """Draw the height error against silicon and against the latency of the whole map."""
    among = whole_picture(built(rows))
    marked = chosen(rows)
    figure, both = plt.subplots(1, 2, figsize=(11, 4.4), layout="constrained", sharey=True)
    measures = (
        ("silicon, % of an LFE5U-85F: multipliers + LUTs + memory", silicon),
        (f"last pixel to whole map, us at {CLOCK_MHZ:g} MHz", lambda row: float(row["map_cycles"]) / CLOCK_MHZ),
    )
    for axis, (label, measure) in zip(both, measures, strict=True):
        x, y = (np.array([take(row) for row in among]) for take in (measure, lambda row: float(row["height_um"])))
        axis.scatter(x, y, s=9, color="#9ab", alpha=0.5, linewidths=0)
        order = np.lexsort((y, x))
        axis.step(x[order], np.minimum.accumulate(y[order]), where="post", color="#08306b")
        axis.axhline(y.min(), color="black", linestyle=":", linewidth=1)
        looks = (("*", 200, "#e6550d"), ("o", 60, "#08306b"), ("D", 45, "black"))
        for (name, row), (marker, size, colour) in zip(marked.items(), looks, strict=True):
            at = measure(row), float(row["height_um"])
            axis.scatter(*at, marker=marker, s=size, color=colour, zorder=3)
            axis.annotate(name, at, (6, 8), textcoords="offset points", fontsize=9, color=colour, weight="bold")
        axis.set(xscale="log", yscale="log", xlabel=label, ylim=(0.9 * y.min(), 3 * y.min()))
        axis.set_yticks(ticks := [20, 25, 30, 40, 50], [str(tick) for tick in ticks])
        axis.minorticks_off()
        axis.grid(alpha=0.3)
    both[0].set_ylabel("height error in the contact, um")
    across = both[1].get_yaxis_transform()
    both[1].text(0.98, 0.985 * y.min(), "error of the calibration", fontsize=9, va="top", ha="right", transform=across)
    figure.savefig(path, dpi=110)
    plt.close(figure)
