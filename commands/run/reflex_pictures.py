# SPDX-License-Identifier: Apache-2.0
"""The pictures of `make reflex`: every trial beside the published figures, and one trial as it runs."""

from __future__ import annotations

import functools
import io
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from PIL import Image
from tqdm import tqdm

matplotlib.use("Agg")
from matplotlib import pyplot as plt

COLOURS = {"near": "#08306b", "host": "#e6550d"}
MARKERS = {"near": "o", "host": "s"}

LEAD_MS, TAIL_MS = 1.0, 1.0  # of the video, before the contact and after the command
STEP_MS = 0.1
PICTURE_MS = 100  # each stands so long
CONTRAST = 3  # a press as deep as the threshold is pale


def plot(path: Path, document: dict[str, Any]) -> None:
    """Contact to command and contact to motion of every trial, and the published mean, deviation and range."""
    rows: list[tuple[str, str, dict[str, Any] | None]] = []
    for solver, found in document["near"].items():
        rows.append((f"near the sensor,\n{solver}", "near", found))
    rows += [("near the sensor,\npublished", "near", None), ("host", "host", document["host"])]
    rows.append(("host,\npublished", "host", None))
    figure, axes = plt.subplots(1, 2, figsize=(12, 4.2), layout="constrained", sharex=True, sharey=True)
    jitter = np.random.default_rng(0)
    for axis, key in zip(axes, ("command", "motion"), strict=True):
        for place, (_, kind, found) in enumerate(rows):
            if found is None:
                published = document["published"][kind]
                mean, spread = published[key]
                low, high = published["range"]
                count = f"n = {published['trials']}"
                if key == "motion":
                    axis.plot([low, high], [place, place], color="black", linewidth=0.8, linestyle=":")
            else:
                values = [trial[f"{key}_ms"] for trial in found["trials"]]
                at = place + jitter.uniform(-0.28, 0.28, len(values))
                axis.scatter(values, at, s=9, alpha=0.45, color=COLOURS[kind], marker=MARKERS[kind], linewidths=0)
                mean, spread = found[key]["mean"], found[key]["sd"]
                count = f"n = {len(values)}"
            axis.errorbar(mean, place, xerr=spread, color="black", marker="D", markersize=4, capsize=5)
            side = "center" if kind == "host" else "left"  # there is no room left of the sensor's
            axis.annotate(
                f"{mean:.1f} ± {spread:.1f}   {count}", (mean, place - 0.36), fontsize=8, va="bottom", ha=side
            )
        axis.set(xlabel="ms", title=f"contact to {key}")
        axis.grid(axis="x", alpha=0.3)
    axes[0].set_yticks(range(len(rows)), [name for name, _, _ in rows])
    axes[0].set_ylim(len(rows) - 0.4, -0.7)
    axes[0].set_xlim(left=0)
    figure.savefig(path, dpi=110)
    plt.close(figure)


@dataclass(frozen=True)
class Film:
    """A trial as the video shows it. Times in ms after the contact.

    Attributes
    ----------
    frames : uint8 array (frames, rows, columns, 3)
    depth_mm : float array (frames, rows, columns), in the order in which it leaves
    begin_ms : float array (frames,)
        When the first pixel of each comes.
    read_out_ms, first_depth_ms : float
        From a frame's first pixel to its last, and to its first depth.
    depth_out_ms : float
        A frame's depth leaves in so long.
    command_ms, threshold_mm : float
    bottom_first : bool
        Depth leaves from the last row up.
    """

    frames: np.ndarray
    depth_mm: np.ndarray
    begin_ms: np.ndarray
    read_out_ms: float
    first_depth_ms: float
    depth_out_ms: float
    command_ms: float
    threshold_mm: float
    bottom_first: bool
    title: str


def _came(begin: float, duration: float, now: float, count: int) -> int:
    """Return the number of `count` evenly spaced events that have happened."""
    return int(np.clip((now - begin) / duration, 0, 1) * count)


def _rows_shown(film: Film, now: float) -> tuple[np.ndarray, np.ndarray]:
    """The frame as far as it has been read, over the one before, and the depth as far as it has left, upright."""
    rows = film.frames.shape[1]
    frame, depth = film.frames[0].copy(), np.zeros(film.depth_mm.shape[1:])
    for index, begin in enumerate(film.begin_ms):
        read = _came(begin, film.read_out_ms, now, rows)
        frame[:read] = film.frames[index, :read]
        left = _came(begin + film.first_depth_ms, film.depth_out_ms, now, rows)
        depth[:left] = film.depth_mm[index, :left]
    rest = np.median(film.frames[0], axis=(0, 1))
    frame = np.clip(rest + CONTRAST * (frame - rest), 0, 255).astype(np.uint8)
    return frame, depth[::-1] if film.bottom_first else depth


def _comparator(film: Film) -> tuple[np.ndarray, np.ndarray]:
    """The deepest value that has left of the frame that is leaving, row by row, for a line of steps: times and mm."""
    at: list[float] = []
    deepest: list[float] = []
    rows = film.depth_mm.shape[1]
    for index, begin in enumerate(film.begin_ms):
        at += list(begin + film.first_depth_ms + film.depth_out_ms * np.arange(rows + 1) / rows)
        deepest += [0.0, *np.maximum.accumulate(film.depth_mm[index].max(axis=1))]
    return np.array(at), np.array(deepest)


def video(path: Path, film: Film) -> None:
    """An animated GIF: frame, depth map and comparator on one time axis."""
    top = 1.15 * max(float(film.depth_mm.max()), film.threshold_mm)
    end = film.command_ms + TAIL_MS
    figure = plt.figure(figsize=(8.4, 5.4), layout="constrained")
    grid = figure.add_gridspec(2, 2, height_ratios=(3, 2))
    left, right, below = figure.add_subplot(grid[0, 0]), figure.add_subplot(grid[0, 1]), figure.add_subplot(grid[1, :])
    figure.suptitle(film.title, fontsize=11)
    frame, depth = _rows_shown(film, -LEAD_MS)
    shown_frame = left.imshow(frame, interpolation="nearest")
    shown_depth = right.imshow(depth, cmap="cividis", vmin=0, vmax=top, interpolation="nearest")
    figure.colorbar(shown_depth, ax=right, label="mm", shrink=0.9)
    left.set_title(f"frame, as it is read out (contrast x {CONTRAST})", fontsize=10)
    right.set_title("depth, as it leaves", fontsize=10)
    for axis in (left, right):
        axis.set_axis_off()
    at, deepest = _comparator(film)
    for index, begin in enumerate(film.begin_ms):
        label = "read-out" if index == 0 else None
        below.axvspan(begin, begin + film.read_out_ms, ymin=0.94, color="0.75" if index % 2 else "0.55", label=label)
    (line,) = below.plot(
        [], [], color="#08306b", drawstyle="steps-post", label="deepest so far in the frame that leaves"
    )
    below.axhline(film.threshold_mm, color="#e6550d", linestyle="--", label="threshold")
    below.axvline(0, color="black", linestyle=":", linewidth=1)
    below.annotate(" pin touches", (0, 0.82 * top), fontsize=8)
    now_line = below.axvline(-LEAD_MS, color="black", linewidth=1)
    rises = below.axvline(film.command_ms, color="#08306b", linewidth=2, visible=False)
    mark = below.annotate("", (film.command_ms, 0.87 * top), fontsize=9, ha="right", weight="bold")
    below.set(xlim=(-LEAD_MS, end), ylim=(-0.03 * top, top), xlabel="ms after the contact", ylabel="mm")
    below.legend(fontsize=8, loc="lower left", bbox_to_anchor=(0.1, 0.2))
    pictures = []
    figure.canvas.draw()
    figure.set_layout_engine("none")  # it stays as it is
    for now in tqdm(np.arange(-LEAD_MS, end, STEP_MS), desc="video", leave=False, disable=None):
        frame, depth = _rows_shown(film, now)
        shown_frame.set_data(frame)
        shown_depth.set_data(depth)
        out = at <= now
        line.set_data([*at[out], now], [*deepest[out], *deepest[out][-1:]] if out.any() else [0.0])
        now_line.set_xdata([now, now])
        if now >= film.command_ms:
            rises.set_visible(True)
            mark.set_text(f"contact rises, {film.command_ms:.2f} ms ")
        buffer = io.BytesIO()
        figure.savefig(buffer, format="png", dpi=80)
        pictures.append(Image.open(buffer).convert("P", palette=Image.Palette.ADAPTIVE, colors=96))
    plt.close(figure)
    save = functools.partial(pictures[0].save, path, format="GIF", save_all=True, append_images=pictures[1:], loop=0)
    save(duration=[PICTURE_MS] * (len(pictures) - 1) + [20 * PICTURE_MS])
