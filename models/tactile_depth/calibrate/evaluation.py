# SPDX-License-Identifier: Apache-2.0
"""Measures a calibration on ball presses of known diameter, through the bit-accurate models."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from tactile_depth.base.by_value import ByValue
from tactile_depth.base.errors import Argument, InputError, InputWarning, counted, require_flag, warn
from tactile_depth.calibrate.ball_press import BallPress
from tactile_depth.calibrate.press_pictures import BACKGROUND, PITCHES_AGREE, gather
from tactile_depth.calibrate.presses import NOTHING_TOUCHES, GridPresses, View, to_grid
from tactile_depth.chip.poisson.cores import fastest
from tactile_depth.depth.twin import Twin
from tactile_depth.pictures.grid_sampler import middle
from tactile_depth.pictures.pictures import Picture
from tactile_depth.pictures.reference_check import check_reference
from tactile_depth.sensor.sensor import HeightError, Sensor
from tactile_depth.sensor.view import Crop, shown

GOOD_SHARE = 0.5  # of the largest usable error
BALLS_AGREE = 0.03  # largest relative difference between the heights of balls
# Largest errors of a usable model, on presses that were not fitted; a good one has half of them or less. Measured: the
# better polynomial of 16 to 45 real presses, and drawn ones | half of the circles shifted by half a radius or more.
CAP_BIAS = 0.12  # mean error of caps: up to 0.03 | 0.12 to 0.8
CAP_RMS = 0.16  # RMS error of caps: 0.00 to 0.12 | 0.20 to 0.76
SIDES_APART = 0.2  # mean caps in the middle less those at the sides: up to 0.08 | 0.15 to 0.6; a gel with markers: 0.8
SHAPE_RMS = 0.16  # height RMS in the contact, over the height of the cap: 0.01 to 0.08 | 0.18 to 0.41
FLAT_RMS = 0.16  # RMS depth of untouched gel, over the height of the cap: 0.00 to 0.06 | 0.02 to 0.18


@dataclass(frozen=True)
class Score:
    """Score of a gradient model on one press.

    Attributes
    ----------
    height_rms_mm : float
        Standard deviation of depth from the ball in the contact.
    cap_height : float
        Recovered over true height of the ball's cap.
    rest_slope, rest_mm : float
        RMS slope where nothing touches, and RMS of the depth, less its mean; NaN where the contact fills the grid.
    cap_mm : float
        True height of the cap.
    """

    height_rms_mm: float
    cap_height: float
    rest_slope: float
    rest_mm: float
    cap_mm: float


@dataclass(frozen=True, eq=False)
class Evaluation(ByValue):
    """Scores of a calibration press by press; `str` returns a table of them, the `notes` and the `summary`.

    Attributes
    ----------
    presses : tuple of str
        Names of the presses.
    diameters_mm : tuple of float
        Of the balls.
    central : tuple of bool
        The contact lies wholly in the picture's middle square.
    scores : mapping of str to tuple of Score
        Scores of the presses, by gradient model.
    notes : tuple of str
        One line for each press that was left out.
    """

    presses: tuple[str, ...]
    diameters_mm: tuple[float, ...]
    central: tuple[bool, ...]
    scores: Mapping[str, tuple[Score, ...]]
    notes: tuple[str, ...] = ()

    def __repr__(self) -> str:
        left_out = f", {len(self.notes)} left out" if self.notes else ""
        return f"Evaluation({counted(len(self.presses), 'press')}{left_out}: {', '.join(self.scores)})"

    def values(self, model: str, name: str) -> np.ndarray:
        """Return one number of the scores of each press, float64 (presses,)."""
        return np.array([getattr(score, name) for score in self.scores[model]])

    def height_error(self, model: str) -> HeightError:
        """Return mean and standard deviation of recovered over true height in the middle square, else of all."""
        central = np.array(self.central)
        ratios = self.values(model, "cap_height")[central if central.any() else ~central]
        return HeightError(float(ratios.mean()), float(ratios.std()), len(ratios))

    @property
    def best_model(self) -> str:
        """The model whose worst error is the smallest share of what is accepted."""
        return min(self.scores, key=self.severity)

    def severity(self, model: str) -> float:
        """Return the largest error of a model over the largest that is usable: up to `GOOD_SHARE` it is good."""
        return max(error / limit for error, limit, _ in self._errors(model))

    def faults(self, model: str) -> list[str]:
        """Return a line for each error of a model that is larger than that of a good one, the worst first."""
        errors = sorted(self._errors(model), key=lambda each: each[0] / each[1], reverse=True)
        return [
            f"{text} (good up to {GOOD_SHARE * limit:.2g}, usable up to {limit:g})"
            for error, limit, text in errors
            if error > GOOD_SHARE * limit
        ]

    def _errors(self, model: str) -> list[tuple[float, float, str]]:
        """Return errors of a model, each with the largest that is usable and a text."""
        caps, height = self.values(model, "cap_height"), self.values(model, "cap_mm").mean()
        rms, flat = self.values(model, "height_rms_mm").mean(), self.values(model, "rest_mm")
        mean, spread, shape = float(caps.mean()), float(np.sqrt(((caps - 1) ** 2).mean())), float(rms / height)
        errors = [
            (abs(mean - 1), CAP_BIAS, f"caps read {mean:.2f} of their height"),
            (spread, CAP_RMS, f"RMS error of caps {spread:.2f} of their height"),
            (shape, SHAPE_RMS, f"height RMS in the contact {shape:.2f} of the caps' height"),
        ]
        if not np.isnan(flat).all():
            rest = float(np.nanmean(flat) / height)
            errors.append((rest, FLAT_RMS, f"untouched gel reads {rest:.2f} of the caps' height RMS"))
        central = np.array(self.central)
        if 0 < central.sum() < len(central):
            middle, sides = float(caps[central].mean()), float(caps[~central].mean())
            apart = f"caps read {middle:.2f} in the middle and {sides:.2f} at the sides"
            errors.append((abs(middle - sides), SIDES_APART, apart))
        return errors

    @property
    def summary(self) -> str:
        """The mean errors in the middle square and beside it, and what the balls say of the scale."""
        lines = []
        for model in self.scores:
            rms, cap, *rest = (
                self.values(model, name) for name in ("height_rms_mm", "cap_height", "rest_slope", "rest_mm")
            )
            for where, among in (("in the middle", np.array(self.central)), ("at the sides", ~np.array(self.central))):
                if among.any():
                    flat = among & ~np.isnan(rest[0] + rest[1])
                    slope, depth = (each[flat].mean() for each in rest) if flat.any() else (math.nan, math.nan)
                    lines.append(
                        f"{model}, {counted(among.sum(), 'press')} {where}: height RMS in the contact "
                        f"{1000 * rms[among].mean():.1f} um; caps {cap[among].mean():.3f} of their height, RMS error "
                        f"{np.sqrt(((cap[among] - 1) ** 2).mean()):.3f}; RMS where nothing touches: slope {slope:.3f}, "
                        f"depth {1000 * depth:.1f} um"
                    )
            lines += self._of_balls(model)
        return "\n".join(lines)

    def _of_balls(self, model: str) -> list[str]:
        """Return the ratio of each ball, if there are several, and whether they contradict each other."""
        caps, diameters = self.values(model, "cap_height"), np.array(self.diameters_mm)
        ratios = {ball: float(caps[diameters == ball].mean()) for ball in sorted(set(self.diameters_mm))}
        if len(ratios) < 2:
            return []
        apart = max(ratios.values()) / min(ratios.values()) - 1
        doubt = f"; the scale is not known better than these {100 * apart:.0f} %" if apart > BALLS_AGREE else ""
        return [f"{model}, caps by ball: {', '.join(f'{b:g} mm {r:.3f}' for b, r in ratios.items())}{doubt}"]

    def __str__(self) -> str:
        label = f"{'press':<22}"
        lines = [
            " " * len(label) + "".join(f"{model:>24}" for model in self.scores),
            label + f"{'RMS, um':>12}{'cap height':>12}" * len(self.scores),
        ]
        for index, (name, is_central) in enumerate(zip(self.presses, self.central, strict=True)):
            rows = [scores[index] for scores in self.scores.values()]
            cells = "".join(f"{1000 * row.height_rms_mm:>12.1f}{row.cap_height:>12.3f}" for row in rows)
            lines.append(f"{name[-21:]:<22}{cells}{'' if is_central else '  at the side'}")
        return "\n".join([*lines, *self.notes, self.summary])


def evaluation_of(
    presses: GridPresses, views: Sequence[View], scores: Mapping[str, tuple[Score, ...]], notes: tuple[str, ...] = ()
) -> Evaluation:
    """Return the evaluation of presses whose scores are known."""
    names = tuple(view.press.name for view in views)
    central = tuple(view.press.is_central for view in views)
    return Evaluation(names, tuple(view.diameter_mm for view in views), central, scores, presses.notes + notes)


def evaluate(
    sensor: Sensor,
    presses: str | Path | Sequence[BallPress],
    background: Picture | None = None,
    *,
    find_circles: bool = False,
    crop: Crop | None = None,
) -> Evaluation:
    """Measure each gradient model of a calibration on presses of balls.

    Depth is computed as by the hardware with zero slope at the edge, on the grid that covers the pictures. A press that
    the edge of the picture cuts is left out, with a warning.

    Parameters
    ----------
    sensor : Sensor
        See `load` and `fit`.
    presses, background, find_circles
        See `fit`. The pixel pitch is that of the sensor.
    crop : str, float or (width, height), optional
        What the pictures show of the sensor's full picture, as for a Pipeline.

    Returns
    -------
    Evaluation

    Raises
    ------
    InputError
        The pictures do not fit the sensor's camera, or no complete press is left.
    """
    require_flag(Argument("find_circles", find_circles))
    pictures = gather(presses, background)
    rows, columns = pictures.background.shape[:2]
    sensor, share = shown(sensor, crop)
    pitch = sensor.pixel_pitch_mm / sensor.zoom((rows, columns), BACKGROUND, share)
    by_balls = float(np.median(pictures.pitches)) if pictures.pitches else pitch
    if abs(by_balls / pitch - 1) > PITCHES_AGREE:
        raise InputError(
            f"{sensor.name} has {pitch:.4g} mm/pixel, which contradicts {pictures.name}, whose ball radii give "
            f"{by_balls:.4g}: give presses of that sensor, or correct ball_radius_px"
        )
    sensor.require_reference(True)
    check_reference(sensor, middle(pictures.background[None], share), share=share)
    on_grid = to_grid(pictures, pitch, find_circles, aspect=sensor.pixel_aspect, share=share)
    measured = [view for view in on_grid.views if view.is_whole]
    cut = [view.press.name for view in on_grid.views if not view.is_whole]
    notes = tuple(f"{name}: the edge of the picture cuts the contact: left out" for name in cut)
    if not measured:
        first = (*on_grid.notes, *notes)[:1]
        problem = f": none of {len(pictures.presses)} can be used{''.join(f': {note}' for note in first)}"
        raise InputError(Argument("presses"), problem)
    for note in on_grid.notes:
        warn(InputWarning(note))
    if cut:
        count = f"{len(cut)} of {len(pictures.presses)} presses left out: the edge of the picture cuts the contact"
        warn(InputWarning(f"{count}: {', '.join(cut)}", remedy="press nearer to the middle"))
    scores = {model: scores_of(sensor, on_grid, measured, model) for model in sensor.models}
    return evaluation_of(on_grid, measured, scores, notes)


def scores_of(sensor: Sensor, presses: GridPresses, views: Sequence[View], model: str) -> tuple[Score, ...]:
    """Return the scores of a gradient model on presses."""
    slopes, depths = slopes_and_depths(sensor, presses, views, model)
    pitch_mm = presses.grid_pitch_mm
    maps = zip(views, slopes, depths, strict=True)
    return tuple(_score(view, slope, depth, pitch_mm) for view, slope, depth in maps)


def slopes_and_depths(
    sensor: Sensor, presses: GridPresses, views: Iterable[View], model: str
) -> tuple[np.ndarray, np.ndarray]:
    """Return slopes and depths of presses as the hardware computes them, with zero slope at the edge.

    Returns
    -------
    float64 arrays (presses, rows, columns, 2), pixels per pixel, and (presses, rows, columns), grid pixels
    """
    on_grid = replace(sensor, pixel_pitch_mm=presses.grid_pitch_mm, reference=presses.background_on_grid)
    rows, columns = presses.grid
    config = on_grid.configuration(model, columns=columns, rows=rows, solver="tridiagonal", neumann=True)
    twin = Twin(on_grid, config, cores=fastest())
    codes, depth, _ = twin.chip(np.stack([view.frame for view in views]))
    return codes * config.gradient_lsb, twin.upright(depth) * config.depth_lsb_px


def _score(view: View, slopes: np.ndarray, depth: np.ndarray, pitch_mm: float) -> Score:
    outside = view.press.distance > NOTHING_TOUCHES
    slope = math.sqrt((slopes[outside] ** 2).mean()) if outside.any() else math.nan
    far = view.press.untouched
    rest_mm = float(depth[far].std()) * pitch_mm if far.any() else math.nan
    cap_mm = view.press.cap_height * pitch_mm
    return Score(view.press.height_rms(depth) * pitch_mm, view.press.recovered(depth), slope, rest_mm, cap_mm)
