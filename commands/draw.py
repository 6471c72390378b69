# SPDX-License-Identifier: Apache-2.0
"""Pictures for people."""

from __future__ import annotations

from pathlib import Path

import matplotlib
import numpy as np

from models.frames import Frames

matplotlib.use("Agg")
from matplotlib import pyplot as plt

FRAMES_DRAWN = 6
UM_PER_MM = 1000


def draw_depth(
    path: Path, frames: Frames, depth: np.ndarray, reference: np.ndarray, pixel_pitch_mm: float, title: str
) -> None:
    """Input, depth, reference and error side by side, one row for each of the first frames.

    Parameters
    ----------
    depth, reference : float array (frames, rows, cols), mm
    """
    count = min(len(depth), FRAMES_DRAWN)
    rows, columns = depth.shape[1:]
    extent = (0, columns * pixel_pitch_mm, rows * pixel_pitch_mm, 0)
    figure, axes = plt.subplots(count, 4, figsize=(13, 3 * count + 0.6), squeeze=False, layout="constrained")
    figure.suptitle(title)
    for index, row in enumerate(axes):
        top = max(float(reference[index].max()), 1e-9)
        bottom = min(float(reference[index].min()), 0.0)
        error = (depth[index] - reference[index]) * UM_PER_MM
        limit = max(float(np.abs(error).max()), 1e-9)
        row[0].imshow(frames.pixels[index], extent=extent, interpolation="nearest")
        maps = (
            (depth[index], "cividis", bottom, top, "mm"),
            (reference[index], "cividis", bottom, top, "mm"),
            (error, "PuOr", -limit, limit, "um"),
        )
        for axis, (image, colours, low, high, unit) in zip(row[1:], maps, strict=True):
            shown = axis.imshow(image, cmap=colours, vmin=low, vmax=high, extent=extent, interpolation="nearest")
            figure.colorbar(shown, ax=axis, label=unit, shrink=0.85)
        row[0].set_ylabel(f"{frames.labels[index]}\nmm")
    for axis, name in zip(
        axes[0],
        ("input", "depth, from the RTL", "reference, double precision", "depth - reference"),
        strict=True,
    ):
        axis.set_title(name)
    if len(depth) > count:
        figure.supxlabel(f"the first {count} of {len(depth)} frames")
    figure.savefig(path, dpi=80)
    plt.close(figure)
