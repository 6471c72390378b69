# SPDX-License-Identifier: Apache-2.0
"""Measures a calibration on ball presses of known diameter, through the bit-accurate models."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from tactile_depth.errors import Argument, InputError
from tactile_depth.poisson.divergence import divergence
from tactile_depth.presses import (
    BACKGROUND,
    NOTHING_TOUCHES,
    PITCHES_AGREE,
    BallPress,
    GridPresses,
    View,
    gather,
    to_grid,
)
from tactile_depth.sensor import HeightError, Sensor
from tactile_depth.tactile_depth import light_of, slope_codes, slope_tables, solve


@dataclass(frozen=True)
class Score:
    """Score of a gradient model on one press.

    Attributes
    ----------
    slope_r2 : float
        Coefficient of determination of the slopes inside the contact.
    cap_height : float
        Recovered over true height of the ball's cap.
    rest_slope : float
        RMS slope where nothing touches; NaN where the contact fills the grid.
    """

    slope_r2: float
    cap_height: float
    rest_slope: float


@dataclass(frozen=True)
class Evaluation:
    """Scores of a calibration press by press; `str` returns them as a table.

    Attributes
    ----------
    presses : tuple of str
        Names of the presses.
    scores : mapping of str to tuple of Score
        Scores of the presses, by gradient model.
    notes : tuple of str
        One line for each press that was left out.
    """

    presses: tuple[str, ...]
    scores: Mapping[str, tuple[Score, ...]]
    notes: tuple[str, ...] = ()

    def slope_r2(self, model: str) -> float:
        """Return the mean of `slope_r2` over the presses."""
        return float(np.mean([score.slope_r2 for score in self.scores[model]]))

    def height_error(self, model: str) -> HeightError:
        """Return mean and standard deviation of the recovered over the true height."""
        ratios = [score.cap_height for score in self.scores[model]]
        return HeightError(float(np.mean(ratios)), float(np.std(ratios)), len(ratios))

    def rest_slope(self, model: str) -> float:
        """Return the mean of `rest_slope` over the presses that leave part of the grid untouched; NaN without any."""
        slopes = [score.rest_slope for score in self.scores[model] if not math.isnan(score.rest_slope)]
        return float(np.mean(slopes)) if slopes else math.nan

    @property
    def better_model(self) -> str:
        """The model with the larger `slope_r2`."""
        return max(self.scores, key=self.slope_r2)

    def __str__(self) -> str:
        label = f"{'press':<22}"
        lines = [
            " " * len(label) + "".join(f"{model:>24}" for model in self.scores),
            label + f"{'slope R2':>12}{'cap height':>12}" * len(self.scores),
        ]
        for index, name in enumerate(self.presses):
            rows = [scores[index] for scores in self.scores.values()]
            cells = "".join(f"{row.slope_r2:>12.3f}{row.cap_height:>12.3f}" for row in rows)
            lines.append(f"{name[-21:]:<22}{cells}")
        errors = {model: self.height_error(model) for model in self.scores}
        means = "".join(f"{self.slope_r2(model):>12.3f}{errors[model].mean:>12.3f}" for model in self.scores)
        spreads = "".join(f"{error.spread:>24.3f}" for error in errors.values())
        at_rest = "".join(f"{self.rest_slope(model):>24.3f}" for model in self.scores)
        lines += [f"{'mean':<22}{means}", f"{'spread':<22}{spreads}", f"{'RMS slope at rest':<22}{at_rest}"]
        return "\n".join(lines)


def evaluate(
    sensor: Sensor,
    presses: str | Path | Sequence[BallPress],
    background: np.ndarray | str | Path | None = None,
    *,
    find_circles: bool = False,
) -> Evaluation:
    """Measure each gradient model of a calibration on presses of balls.

    Depth is computed as by the hardware with zero slope at the edge, on the largest square grid within the pictures.
    A press that the square cuts is left out.

    Parameters
    ----------
    sensor : Sensor
        See `load` and `fit`.
    presses, background, find_circles
        See `fit`. The pixel pitch is that of the sensor.

    Returns
    -------
    Evaluation

    Raises
    ------
    InputError
        The pictures do not fit the sensor's camera, or no complete press is left.
    """
    pictures = gather(presses, background)
    rows, columns = pictures.background.shape[:2]
    pitch = sensor.pixel_pitch_mm / sensor.zoom((rows, columns), BACKGROUND)
    by_balls = float(np.median(pictures.pitches)) if pictures.pitches else pitch
    if abs(by_balls / pitch - 1) > PITCHES_AGREE:
        raise InputError(
            f"{sensor.name} has {pitch:.4g} mm/pixel, which contradicts {pictures.name}, whose ball radii give "
            f"{by_balls:.4g}: give presses of that sensor, or correct ball_radius_px"
        )
    sensor.require_reference(True)
    sensor.check_lighting(pictures.background)
    on_grid = to_grid(pictures, pitch, find_circles)
    measured = [view for view in on_grid.views if view.is_whole]
    cut = [f"{view.press.name}: the picture's middle square cuts the contact: left out" for view in on_grid.views]
    notes = on_grid.notes + tuple(note for note, view in zip(cut, on_grid.views, strict=True) if not view.is_whole)
    if not measured:
        problem = f": none of {len(pictures.presses)} can be used{f': {notes[0]}' if notes else ''}"
        raise InputError(Argument("presses"), problem)
    scores = {model: scores_of(sensor, on_grid, measured, model) for model in sensor.models}
    return Evaluation(tuple(view.press.name for view in measured), scores, notes)


def scores_of(sensor: Sensor, presses: GridPresses, views: Sequence[View], model: str) -> tuple[Score, ...]:
    """Return the scores of a gradient model on presses."""
    slopes, depths = slopes_and_depths(sensor, presses, views, model)
    return tuple(_score(view, *maps) for view, *maps in zip(views, slopes, depths, strict=True))


def slopes_and_depths(
    sensor: Sensor, presses: GridPresses, views: Iterable[View], model: str
) -> tuple[np.ndarray, np.ndarray]:
    """Return slopes and depths of presses as the hardware computes them, with zero slope at the edge.

    Returns
    -------
    float64 arrays (presses, size, size, 2), pixels per pixel, and (presses, size, size), grid pixels
    """
    on_grid = replace(sensor, pixel_pitch_mm=presses.grid_pitch_mm, reference=presses.background_on_grid)
    config = on_grid.configuration(model, columns=presses.size, neumann=True)
    frames, tables = np.stack([view.frame for view in views]), slope_tables(on_grid, config)
    codes = slope_codes(frames, on_grid, config, tables=tables, light=light_of(frames, tables, config))
    return codes * config.gradient_lsb, solve(divergence(codes, config.neumann), config) * config.depth_lsb_px


def _score(view: View, slopes: np.ndarray, depth: np.ndarray) -> Score:
    press, size = view.press, len(depth)
    truth, distance = press.slopes(size), press.distance(size)
    inside, outside = distance < 1, distance > NOTHING_TOUCHES
    error = ((slopes - truth)[inside] ** 2).sum()
    r2 = 1 - error / ((truth[inside] - truth[inside].mean(axis=0)) ** 2).sum()
    rest = math.sqrt((slopes[outside] ** 2).mean()) if outside.any() else math.nan
    return Score(float(r2), press.recovered(depth), rest)
