# SPDX-License-Identifier: Apache-2.0
"""Picture of `make reflex`: every trial beside the published figures."""

from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

COLOURS = {"near": "#08306b", "host": "#e6550d"}
MARKERS = {"near": "o", "host": "s"}


def plot(path: Path, document: dict[str, Any]) -> None:
    """Draw contact to command and to motion of every trial, and the published mean, deviation and range."""
    rows: list[tuple[str, str, dict[str, Any] | None]] = []
    for solver, result in document["near"].items():
        rows.append((f"near the sensor,\n{solver}", "near", result))
    rows += [("near the sensor,\npublished", "near", None), ("host", "host", document["host"])]
    rows.append(("host,\npublished", "host", None))
    figure = Figure(figsize=(12, 4.2), layout="constrained")
    axes = figure.subplots(1, 2, sharex=True, sharey=True)
    jitter = np.random.default_rng(0)
    for axis, key in zip(axes, ("command", "motion"), strict=True):
        for place, (_, kind, result) in enumerate(rows):
            if result is None:
                published = document["published"][kind]
                mean, spread = published[key]
                low, high = published["range"]
                count = f"n = {published['trials']}"
                if key == "motion":
                    axis.plot([low, high], [place, place], color="black", linewidth=0.8, linestyle=":")
            else:
                values = [trial[f"{key}_ms"] for trial in result["trials"]]
                at = place + jitter.uniform(-0.28, 0.28, len(values))
                axis.scatter(values, at, s=9, alpha=0.45, color=COLOURS[kind], marker=MARKERS[kind], linewidths=0)
                mean, spread = result[key]["mean"], result[key]["sd"]
                count = f"n = {len(values)}"
            axis.errorbar(mean, place, xerr=spread, color="black", marker="D", markersize=4, capsize=5)
            side = "center" if kind == "host" else "left"  # there is no room left of the sensor's points
            axis.annotate(
                f"{mean:.1f} ± {spread:.1f}   {count}", (mean, place - 0.36), fontsize=8, va="bottom", ha=side
            )
        axis.set(xlabel="ms", title=f"contact to {key}")
        axis.grid(axis="x", alpha=0.3)
    axes[0].set_yticks(range(len(rows)), [name for name, _, _ in rows])
    axes[0].set_ylim(len(rows) - 0.4, -0.7)
    axes[0].set_xlim(left=0)
    figure.savefig(path, dpi=110)
