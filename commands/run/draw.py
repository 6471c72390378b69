# SPDX-License-Identifier: Apache-2.0
"""Pictures of depth maps and of ball presses."""

from dataclasses import dataclass
from pathlib import Path

import matplotlib
import numpy as np

from commands.run.flags import Flags
from tactile_depth.pictures.frames import Frames

matplotlib.use("Agg")
from matplotlib import pyplot as plt
from matplotlib.colors import to_rgb

FRAMES_DRAWN = 6
UM_PER_MM = 1000
plt.rcParams["axes.titley"] = 1.0  # above each axes: to look for a free place takes a fifth of a picture's time


def draw_depth(
    path: Path,
    frames: Frames,
    depth: np.ndarray,
    reference: np.ndarray,
    pixel_pitch_mm: float,
    title: str,
    differing: np.ndarray,
    flagged: Flags,
) -> None:
    """Draw input, depth, reference and error side by side, one row for each of the first frames.

    Frames in which codes differ from the model come before others, and a red square marks each of these codes. The
    input is painted over where it is dark and where slopes are outside the calibrated range.

    Parameters
    ----------
    depth, reference : float array (frames, rows, cols), mm
    differing : bool array (frames, rows, cols)
    """
    shown = sorted(np.argsort(~differing.any(axis=(1, 2)), kind="stable")[:FRAMES_DRAWN])
    count = len(shown)
    rows, columns = depth.shape[1:]
    extent = (0, columns * pixel_pitch_mm, rows * pixel_pitch_mm, 0)
    # Positions are computed here, because the layout of matplotlib takes longer than everything else.
    height, widths = 2.65 * count + 1.1, (1, 1, 1, 0.06, 0.2, 1, 0.06)
    figure, axes = plt.subplots(
        count, len(widths), figsize=(12, height), squeeze=False, gridspec_kw={"width_ratios": widths}
    )
    figure.subplots_adjust(left=0.07, right=0.95, bottom=0.6 / height, top=1 - 0.75 / height, wspace=0.13, hspace=0.12)
    figure.suptitle(title, y=1 - 0.15 / height)
    look = {"extent": extent, "interpolation": "nearest"}
    for row, index in zip(axes, shown, strict=True):
        ours, double = depth[index], reference[index]
        top = max(float(double.max()), 1e-9)
        bottom = min(float(double.min()), 0.0)
        error = (ours - double) * UM_PER_MM
        limit = max(float(np.abs(error).max()), 1e-9)
        row[0].imshow(painted(frames.pixels[index], flagged, index), **look)
        row[1].imshow(ours, cmap="cividis", vmin=bottom, vmax=top, **look)
        scales = (
            ("mm", row[3], row[2].imshow(double, cmap="cividis", vmin=bottom, vmax=top, **look)),
            ("um", row[6], row[5].imshow(error, cmap="PuOr", vmin=-limit, vmax=limit, **look)),
        )
        for unit, place, image in scales:
            figure.colorbar(image, cax=place)
            place.set_title(unit, fontsize="medium", loc="left")
        down, across = (np.argwhere(differing[index]).T + 0.5) * pixel_pitch_mm
        row[1].plot(across, down, "s", color="red", markersize=4, fillstyle="none")
        row[0].set_ylabel(f"{frames.labels[index]}\nmm")
        row[4].set_axis_off()
        for axis in row[[1, 2, 5]]:
            axis.tick_params(labelleft=False)
    marked = "; red: differs" if differing.any() else ""
    for axis, name in zip(
        axes[0, [0, 1, 2, 5]],
        ("input", "depth (RTL)" + marked, "reference, double precision", "depth - reference"),
        strict=True,
    ):
        axis.set_title(name)
    for axis in axes[:-1, [0, 1, 2, 5]].ravel():
        axis.tick_params(labelbottom=False)
    notes = [f"{colour}: {what}" for colour, what, mask in _paints(flagged) if mask.any()]
    if len(depth) > count:
        which = "frames with differing codes and others" if differing.any() else "the first frames"
        notes.append(f"{which}: {count} of {len(depth)}")
    figure.supxlabel("; ".join(notes), y=0.1 / height, fontsize="medium")
    figure.savefig(path, dpi=80)
    plt.close(figure)


def _paints(flagged: Flags) -> list[tuple[str, str, np.ndarray]]:
    """Return colour, meaning and flagged pixels of each kind of flag."""
    return [
        ("orange", "slope outside the calibrated range", flagged.outside),
        ("magenta", "dark, colour taken from the neighbour", flagged.dark),
    ]


def painted(frame: np.ndarray, flagged: Flags, index: int) -> np.ndarray:
    """Return a frame, uint8 (rows, cols, 3), with its flagged pixels in the colours of their flags."""
    picture = frame.copy()
    for colour, _, mask in _paints(flagged):
        picture[mask[index]] = np.round(255 * np.array(to_rgb(colour)))
    return picture


@dataclass(frozen=True)
class DrawnPress:
    """A ball press as `draw_presses` shows it. Lengths in mm."""

    name: str
    frame: np.ndarray  # uint8 (size, size, 3)
    slopes: np.ndarray  # (size, size, 2)
    depth: np.ndarray  # (size, size)
    circle: tuple[np.ndarray, np.ndarray]  # columns, rows
    across: np.ndarray  # (size,), relative to the centre
    ball: np.ndarray  # (size,), height over the contact circle; NaN outside
    cuts: dict[str, np.ndarray]  # of the depth by each model, height over the contact circle


def draw_presses(path: Path, presses: list[DrawnPress], size_mm: tuple[float, float], title: str) -> None:
    """Draw frame, both slopes, depth and a cut through the contact, one row per press."""
    width_mm, height_mm = size_mm
    extent = (0, width_mm, height_mm, 0)
    figure, axes = plt.subplots(
        len(presses), 5, figsize=(17, 3 * len(presses) + 0.6), squeeze=False, layout="constrained"
    )
    figure.suptitle(title)
    for press, row in zip(presses, axes, strict=True):
        row[0].imshow(press.frame, extent=extent, interpolation="nearest")
        limit = float(np.abs(press.slopes).max()) or 1.0
        for axis, which in zip(row[1:3], (0, 1), strict=True):
            shown = axis.imshow(press.slopes[..., which], cmap="PuOr", vmin=-limit, vmax=limit, extent=extent)
            figure.colorbar(shown, ax=axis, shrink=0.85)
        shown = row[3].imshow(press.depth, cmap="cividis", extent=extent)
        figure.colorbar(shown, ax=row[3], label="mm", shrink=0.85)
        for axis in row[:4]:
            axis.plot(*press.circle, color="white" if axis in (row[0], row[3]) else "black", linewidth=0.7)
            axis.set(xlim=(0, width_mm), ylim=(height_mm, 0))
        for model, cut in press.cuts.items():
            row[4].plot(press.across, cut, label=model)
        row[4].plot(press.across, press.ball, "k--", label="ball")
        row[4].set_ylabel("mm over the contact circle")
        row[4].legend()
        row[0].set_ylabel(f"{press.name}\nmm")
    for axis, name in zip(axes[0], ("frame", "dz/dx", "dz/dy", "depth", "row through the centre"), strict=True):
        axis.set_title(name)
    figure.savefig(path, dpi=80)
    plt.close(figure)
