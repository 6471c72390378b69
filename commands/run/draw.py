# SPDX-License-Identifier: Apache-2.0
"""Picture of `make sim`."""

from pathlib import Path

import numpy as np

from tactile_depth.cli.drawing import AROUND_ZERO, DARK, OUTSIDE, Panel, Scale, painted, sheet
from tactile_depth.pictures.frames import Frames

FRAMES_DRAWN = 6
PANEL_WIDTH = 240  # pixels
UM_PER_MM = 1000
DIFFERS = (255, 0, 0)


def draw_depth(
    path: Path,
    frames: Frames,
    depth: np.ndarray,
    reference: np.ndarray,
    pixel_pitch_mm: float,
    title: str,
    differing: np.ndarray,
    outside: np.ndarray,
    dark: np.ndarray,
) -> None:
    """Draw input, depth, reference and error side by side, one row for each of the first frames.

    Frames in which codes differ from the model come before others, and these codes are red. The input is painted over
    where it is dark and where slopes are outside the calibrated range.

    Parameters
    ----------
    depth, reference : float array (frames, rows, cols), mm
    differing, outside, dark : bool array (frames, rows, cols)
    """
    shown = sorted(np.argsort(~differing.any(axis=(1, 2)), kind="stable")[:FRAMES_DRAWN])
    drawn = []
    for index in shown:
        ours, double = depth[index], reference[index]
        error = (ours - double) * UM_PER_MM
        limit = max(float(np.abs(error).max()), 1e-9)
        depths = Scale(min(float(double.min()), 0.0), max(float(double.max()), 1e-9))
        flagged = [(outside[index], OUTSIDE), (dark[index], DARK)]
        drawn.append(
            (
                Panel(f"input: {frames.labels[index]}", painted(frames.pixels[index], flagged)),
                depths.map("depth (RTL)", ours, [(differing[index], DIFFERS)]),
                depths.map("reference, double precision", double),
                Scale(-limit, limit, "um", AROUND_ZERO).map("depth - reference", error),
            )
        )
    kinds = (
        (OUTSIDE, "slope outside the calibrated range", outside),
        (DARK, "dark, colour taken from the neighbour", dark),
        (DIFFERS, "differs from the model", differing),
    )
    if len(depth) > len(shown):
        which = "frames with differing codes and others" if differing.any() else "the first frames"
        title += f"; {which}: {len(shown)} of {len(depth)}"
    rows, columns = depth.shape[1:]
    notes = [(colour, what) for colour, what, mask in kinds if mask.any()]
    sheet(drawn, PANEL_WIDTH, (columns * pixel_pitch_mm, rows * pixel_pitch_mm), notes, title).save(path)
