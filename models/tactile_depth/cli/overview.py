# SPDX-License-Identifier: Apache-2.0
"""Draws what a command found: a picture with its height, and the presses of a fit."""

from __future__ import annotations

import numpy as np
from PIL import Image

from tactile_depth.base.errors import InputError
from tactile_depth.calibrate.ball_press import BallPress
from tactile_depth.calibrate.evaluation import slopes_and_depths
from tactile_depth.calibrate.fitting import Fit
from tactile_depth.calibrate.judgement import doubtful_circles
from tactile_depth.calibrate.press_pictures import PressPictures
from tactile_depth.calibrate.presses import GridPresses
from tactile_depth.cli.drawing import AROUND_ZERO, BACKGROUND, DARK, FADED, INK, OUTSIDE, Panel, Scale, sheet
from tactile_depth.depth.result import Result

PANEL_WIDTH = 480  # pixels
TICK = 0.02  # of the width of a map: marks the row of the profile
PRESS_WIDTH, PRESSES_DRAWN = 300, 3
CIRCLE_WIDTH, IN_A_ROW, CHANGE_GAIN = 240, 6, 2  # of a contact sheet; grey levels drawn for one of change
GREY = 128
LINES = (INK, (31, 119, 180), (255, 127, 14), (44, 160, 44))  # of the ball and of the gradient models


def draw_overview(picture: np.ndarray, result: Result, caption: str) -> Image.Image:
    """Draw one result: the picture, its height, and the height along the row of the highest point.

    Parameters
    ----------
    picture : uint8 array (rows, columns, 3)
    result : Result
        Of a single picture.
    caption : str
    """
    rows, columns = result.codes.shape
    height = result.height_mm
    scale = Scale(min(float(height.min()), 0.0), max(float(height.max()), result.threshold_mm))
    row = int(height.argmax()) // columns
    at = (row + 0.5) / rows
    ticks = [(INK, np.array(((x, x + TICK), (at, at)))) for x in (-TICK, 1)]
    panels = (
        Panel("picture", _whole(picture, rows, columns)),
        scale.map("height", height, [(result.outside, OUTSIDE), (result.dark, DARK)], ticks),
        scale.profile("height along the marked row", [(FADED, np.zeros(columns)), (INK, height[row])]),
    )
    notes = [
        (OUTSIDE, f"steeper than calibrated: {int(result.outside.sum()):,} px"),
        (DARK, f"without light: {int(result.dark.sum()):,} px"),
    ]
    size_mm = (columns * result.pixel_pitch_mm * result.pixel_aspect, rows * result.pixel_pitch_mm)
    return sheet([panels], PANEL_WIDTH, size_mm, notes, caption)


def _whole(picture: np.ndarray, rows: int, columns: int) -> np.ndarray:
    """Crop a picture to the part that the grid shows: centred, of the grid's aspect ratio."""
    height, width = picture.shape[:2]
    across = min(width, round(height * columns / rows))
    down = min(height, round(width * rows / columns))
    y, x = (height - down) // 2, (width - across) // 2
    return picture[y : y + down, x : x + across]


def draw_presses(fit: Fit, presses: GridPresses) -> Image.Image:
    """Draw presses from the first to the last, by fits to the others: frame, slopes, depth, a row beside the ball."""
    pitch_mm, (rows, columns), best = presses.grid_pitch_mm, presses.grid, fit.sensor.model
    measured = [view for view in presses.views if view.press.name in fit.without]
    drawn = []
    for index in np.unique(np.linspace(0, len(measured) - 1, PRESSES_DRAWN).round().astype(int)):
        view = measured[index]
        press, sensor = view.press, fit.without[view.press.name]
        maps = {model: slopes_and_depths(sensor, presses, [view], model) for model in sensor.models}
        slopes, depth_mm = maps[best][0][0], maps[best][1][0] * pitch_mm
        row = min(max(round(press.y + 0.5), 0), rows - 1)
        lines = [press.depth[row] * pitch_mm]
        lines += [(depth[row] - press.edge_depth(depth)) * pitch_mm for _, (depth,) in maps.values()]
        circle = np.stack(press.edge) / [[columns], [rows]]
        steepest = float(np.abs(slopes).max()) or 1.0
        tilt, depths = Scale(-steepest, steepest, "", AROUND_ZERO), Scale(float(depth_mm.min()), float(depth_mm.max()))
        along = Scale(float(np.nanmin(lines)), float(np.nanmax(lines)))
        drawn.append(
            (
                Panel(press.name, view.frame, curves=[(BACKGROUND, circle)]),
                *(tilt.map(f"dz/d{'xy'[axis]}", slopes[..., axis], curves=[(INK, circle)]) for axis in (0, 1)),
                depths.map("depth", depth_mm, curves=[(BACKGROUND, circle)]),
                along.profile("row, over the circle", zip(LINES, lines, strict=False)),
            )
        )
    notes = [*zip(LINES, ("ball", *fit.sensor.models), strict=False)]
    size_mm = (columns * pitch_mm * presses.aspect, rows * pitch_mm)
    title = f"presses by fits to the others, {best}, Neumann, {columns} x {rows}"
    return sheet(drawn, PRESS_WIDTH, size_mm, notes, title)


def draw_circles(pictures: PressPictures, presses: GridPresses) -> Image.Image:
    """Draw the change of each press against the background, with its circle; presses without one were left out."""
    rows, columns = pictures.background.shape[:2]
    doubtful = set(doubtful_circles(presses))
    angle = np.linspace(0, 2 * np.pi, 90)
    panels = []
    for press in pictures.presses:
        if (pixels := change_of(pictures, press)) is None:
            continue
        curves = []
        if circle := presses.circles.get(press.name):
            x = (circle.x + 0.5 + circle.radius / presses.aspect * np.cos(angle)) / columns
            y = (circle.y + 0.5 + circle.radius * np.sin(angle)) / rows
            curves = [(OUTSIDE if press.name in doubtful else INK, np.stack((x, y)).clip(0, 1))]
        panels.append(Panel(press.name, pixels, curves=curves))
    if not panels:
        raise InputError(f"{presses.name}: no press can be read: give pictures of ball presses")
    lines = [panels[first : first + IN_A_ROW] for first in range(0, len(panels), IN_A_ROW)]
    size_mm = (columns * presses.pitch_mm * presses.aspect, rows * presses.pitch_mm)
    notes = [(INK, "circle"), (OUTSIDE, "beside the change of colour"), (BACKGROUND, "no circle: left out")]
    caption = f"{presses.name}: change against the background, times {CHANGE_GAIN}"
    return sheet(lines, CIRCLE_WIDTH, size_mm, notes, caption)


def change_of(pictures: PressPictures, press: BallPress) -> np.ndarray | None:
    """Return the change of a press against the background as a picture, or None if it cannot be read."""
    try:
        change = pictures.image(press).astype(np.int16) - pictures.background
    except InputError:  # a warning named it
        return None
    return (GREY + CHANGE_GAIN * change).clip(0, 255).astype(np.uint8)
