# SPDX-License-Identifier: Apache-2.0
"""Fits a calibration to ball presses: `fit`.

Pictures are processed as in the hardware: resampled to the grid, rounded to 8 bits, flat-fielded by interpolated gains.
The slope of a pixel is that of the ball where it touches, and 0 elsewhere. Every second press that lies completely on
the grid is held out of the fit. The error of the calibration is measured on the presses that are held out.

Model `quadratic`. Pixels within 0.9 of the contact's radius have the same weight; beyond 0.9 the gel has left the ball.
Pixels outside have no weight. A pixel of the background's colour reads 0 with any coefficients. Just outside the circle
the gel is not flat, and slopes of 0 there would reduce every height by up to a half. The heights of the caps are fitted
too: the relative error of one height has the weight of the slopes of `CAP_PIXELS` pixels. The presses are then moved to
the ball's top by the fitted slopes (about a grid pixel). The move and the fit are repeated `RECENTRED` times.

Model `lut`. All pixels beyond twice the contact's radius together have the weight of the contacts. Without them an
untouched gel would not read flat. Bins with few pixels are close to a polynomial of third degree in the colour.

Both weights were chosen by leaving out each fitted press in turn. Neither model knows slopes steeper than those of the
balls.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import combinations_with_replacement
from pathlib import Path
from warnings import warn

import numpy as np
from scipy.optimize import least_squares

from tactile_depth import reference
from tactile_depth.calibration_file import LONGEST_EXPOSURE_US, PIXEL_PITCHES_MM
from tactile_depth.configuration import DEVIATION, GRADIENT_LIMITS
from tactile_depth.errors import Argument, InputError, InputWarning
from tactile_depth.evaluation import Evaluation, Score, scores_of
from tactile_depth.gradient.flat_field import FLAT_CODE
from tactile_depth.poisson.divergence import divergence
from tactile_depth.presses import (
    FITTED_SHARE,
    NOTHING_TOUCHES,
    BallPress,
    GridPress,
    GridPresses,
    View,
    camera_pitch_mm,
    gather,
    to_grid,
)
from tactile_depth.reference import quadratic_terms
from tactile_depth.sensor import BITS_PER_CHANNEL, MODELS, Camera, Sensor, lighting

FEWEST_FITTED, FEWEST_HELD_OUT = 6, 2
RECENTRED = 2  # number of times that the presses are moved and the fit is repeated
CAP_PIXELS = 300  # weight of the relative error of a cap's height, in pixels
FURTHEST_SHIFT = 0.25  # largest move of a centre, as a fraction of the contact's radius
DEFAULT_BITS = 5
PRIOR_PIXELS = 1.0  # weight of the polynomial in each bin
PRIOR_DEGREE = 3
STEEPEST_PRIOR = 0.75
FRACTION_BITS = 10  # of a slope of the table: finer than the errors of the bins, and coarse enough for a small file

Depths = dict[str, np.ndarray]  # `_depth_features` of each press, by its name


@dataclass(frozen=True)
class Fit:
    """A fitted calibration and the presses that it was made from.

    Attributes
    ----------
    sensor : Sensor
    evaluation : Evaluation
        Scores on presses that were not in the fit.
    fitted, held_out : tuple of View
    centre_shift_px : float
        Median distance in camera pixels by which the fit moved the centres of the fitted presses.
    bins_fitted, pixels_in_them : float or None
        Fraction of the table's bins that fitted pixels fall into, and fraction of the pixels of the held-out contacts
        that fall into these bins; None without a table.
    """

    sensor: Sensor
    evaluation: Evaluation
    fitted: tuple[View, ...]
    held_out: tuple[View, ...]
    centre_shift_px: float
    bins_fitted: float | None = None
    pixels_in_them: float | None = None


def fit(
    presses: str | Path | Sequence[BallPress],
    background: np.ndarray | str | Path | None = None,
    *,
    pitch_mm: float | None = None,
    models: str | Sequence[str] = MODELS,
    bits: int = DEFAULT_BITS,
    find_circles: bool = False,
    name: str | None = None,
    exposure_us: float | None = None,
) -> Sensor:
    """Return a sensor, calibrated by presses of balls of known diameter.

    Give a dozen presses or more, spread over the gel, four or more of them completely in the picture's middle square.
    A warning names each press that is left out.

    Parameters
    ----------
    presses : path of a folder, or sequence of BallPress
        A folder holds pictures (PNG, JPEG) of one size, background.png, and presses.csv with columns `frame`,
        `diameter_mm` and optionally `centre_x_px`, `centre_y_px`, `contact_radius_px`, `ball_radius_px`.
    background : uint8 array (rows, columns, 3) or path, optional
        Picture of the sensor without contact; by default that of the folder.
    pitch_mm : float, optional
        Millimetres per camera pixel; by default computed from the balls' radii in pixels.
    models : str or sequence of str
        Gradient models to fit: `lut`, `quadratic`.
    bits : int
        Bits of each colour that index the table of `lut`, 1 to 6.
    find_circles : bool
        Use the circles found in the pictures even if others are given. This needs scikit-image, as does a press
        without a circle.
    name : str, optional
        Name of the sensor; by default that of the folder.
    exposure_us : float, optional
        Exposure time of the camera in microseconds.

    Returns
    -------
    Sensor
        `height_errors` is measured on presses that were held out of the fit; `Sensor.save` writes it.

    Raises
    ------
    InputError
    """
    wanted = check_arguments(models, bits, pitch_mm, exposure_us)
    pictures = gather(presses, background)
    on_grid = to_grid(pictures, camera_pitch_mm(pictures, pitch_mm), find_circles)
    for note in on_grid.notes:
        warn(InputWarning(note), stacklevel=2)
    return fit_presses(on_grid, wanted, bits, name or pictures.name, exposure_us).sensor


def check_arguments(
    models: str | Sequence[str], bits: int, pitch_mm: float | None, exposure_us: float | None
) -> tuple[str, ...]:
    """Return the models; raise InputError if an argument of `fit` is not accepted."""
    wanted = (models,) if isinstance(models, str) else tuple(models)
    if not wanted or not set(wanted) <= set(MODELS):
        raise InputError(Argument("models", ", ".join(map(str, wanted))), accepted=(*MODELS, "one or both"))
    low, high = BITS_PER_CHANNEL
    if not isinstance(bits, int) or not low <= bits <= high:
        raise InputError(Argument("bits", bits), accepted=f"a whole number from {low} to {high}")
    shortest, longest = PIXEL_PITCHES_MM
    if pitch_mm is not None and not shortest <= pitch_mm <= longest:
        accepted = (f"{shortest:g} to {longest:g}", "in mm per camera pixel")
        raise InputError(Argument("pitch_mm", pitch_mm), accepted=accepted)
    if exposure_us is not None and not 0 < exposure_us <= LONGEST_EXPOSURE_US:
        raise InputError(Argument("exposure_us", exposure_us), accepted="a time above 0, in microseconds")
    return tuple(model for model in MODELS if model in wanted)


def fit_presses(
    presses: GridPresses,
    models: Sequence[str] = MODELS,
    bits: int = DEFAULT_BITS,
    name: str = "fitted",
    exposure_us: float | None = None,
    *,
    each_in_turn: bool = False,
    progress: Callable[[list[View]], Iterable[View]] = list,
) -> Fit:
    """Fit a calibration to presses on the grid.

    Parameters
    ----------
    each_in_turn : bool
        Measure every complete press by a fit to all others, besides the fit that is returned. This measures twice as
        many presses and takes twenty times as many fits.
    progress : function
        Wraps the list of the presses that are held out in turn, for example to show progress.

    Raises
    ------
    InputError
        Too few presses.
    """
    fitted, held_out = held_out_presses(presses)
    depths: Depths = {}
    sensor, moved, is_filled = _fit_models(presses, fitted, models, bits, name, depths)
    if each_in_turn:
        evaluation = _each_in_turn(presses, models, bits, depths, progress)
    else:
        scores = {model: scores_of(sensor, presses, held_out, model) for model in models}
        evaluation = Evaluation(tuple(view.press.name for view in held_out), scores, presses.notes)
    rows, columns = presses.background.shape[:2]
    sensor = replace(
        sensor,
        model=evaluation.better_model,
        camera=Camera(rows, columns, presses.pixel_format, exposure_us=exposure_us),
        height_errors={model: evaluation.height_error(model) for model in models},
        lighting=lighting(presses.background),
    )
    shifts = [
        math.hypot(new.press.x - old.press.x, new.press.y - old.press.y) * presses.scale
        for new, old in zip(moved, fitted, strict=True)
    ]
    coverage = (None, None) if is_filled is None else _coverage(is_filled, held_out)
    return Fit(sensor, evaluation, fitted, held_out, float(np.median(shifts)), *coverage)


def held_out_presses(presses: GridPresses) -> tuple[tuple[View, ...], tuple[View, ...]]:
    """Return presses to fit and presses to hold out, every second one that lies completely on the grid.

    Raises
    ------
    InputError
        There are too few presses to fit or to hold out.
    """
    held_out = tuple(view for view in presses.views if view.is_whole)[1::2]
    held = {view.press.name for view in held_out}
    fitted = tuple(view for view in presses.views if view.press.name not in held)
    if len(fitted) < FEWEST_FITTED or len(held_out) < FEWEST_HELD_OUT:
        why = f"; {presses.notes[0]}" if presses.notes else ""
        raise InputError(
            f"{presses.name}: {len(fitted)} presses to fit and {len(held_out)} to hold out, wholly in the picture's "
            f"middle square: at least {FEWEST_FITTED} and {FEWEST_HELD_OUT} are needed{why}"
        )
    return fitted, held_out


def _each_in_turn(
    presses: GridPresses,
    models: Sequence[str],
    bits: int,
    depths: Depths,
    progress: Callable[[list[View]], Iterable[View]],
) -> Evaluation:
    """Measure every complete press by a fit to all others."""
    measured = [view for view in presses.views if view.is_whole]
    scores: dict[str, tuple[Score, ...]] = dict.fromkeys(models, ())
    for view in progress(measured):
        others = tuple(other for other in presses.views if other is not view)
        sensor, _, _ = _fit_models(presses, others, models, bits, "others", depths)
        for model in models:
            scores[model] += scores_of(sensor, presses, [view], model)
    return Evaluation(tuple(view.press.name for view in measured), scores, presses.notes)


def _fit_models(
    presses: GridPresses, views: tuple[View, ...], models: Sequence[str], bits: int, name: str, depths: Depths
) -> tuple[Sensor, tuple[View, ...], np.ndarray | None]:
    """Return a sensor fitted to views, the views with their presses moved, and the bins that pixels fell into.

    The table is fitted to the moved presses.
    """
    steepest = max(view.press.largest_slope for view in views)
    if steepest < GRADIENT_LIMITS[0]:
        raise InputError(
            f"{presses.name}: the steepest press has a slope of {steepest:.2g} at the edge of its contact: press balls "
            "deeper, or correct diameter_mm and pitch_mm"
        )
    coefficients, moved = fit_quadratic(views, presses.grid_pitch_mm, depths)
    gradient, is_filled = fit_table(moved, bits) if "lut" in models else (None, None)
    has_quadratic = "quadratic" in models
    sensor = Sensor(
        name,
        gradient,
        presses.pitch_mm,
        coefficients if has_quadratic else None,
        steepest if has_quadratic else 0.0,
        models[0],
        flat_field=True,
        fitted_slope=dict.fromkeys(models, steepest),
    )
    return sensor, moved, is_filled


# Quadratics.


def fit_quadratic(
    views: tuple[View, ...], pitch_mm: float, depths: Depths | None = None
) -> tuple[np.ndarray, tuple[View, ...]]:
    """Fit the quadratics by weighted least squares of slopes and heights.

    Parameters
    ----------
    pitch_mm : float
        Millimetres per grid pixel.
    depths : dict, optional
        Stores `_depth_features` by press, to reuse them in later fits.

    Returns
    -------
    float64 array (2, 3, 6), the coefficients, and the views with their presses moved to the ball's top
    """
    size, depths = len(views[0].frame), {} if depths is None else depths
    terms = quadratic_terms(size, size, pitch_mm)
    features = [
        (view.deviations[..., None] * DEVIATION.lsb * terms[..., None, :]).reshape(size, size, -1) for view in views
    ]
    for view, feature in zip(views, features, strict=True):
        if view.is_whole and view.press.name not in depths:
            depths[view.press.name] = _depth_features(feature)
    count = 2 * features[0].shape[-1]
    moved = views
    for again in range(RECENTRED + 1):
        squares, products = np.zeros((count, count)), np.zeros(count)
        for view, original, feature in zip(moved, views, features, strict=True):
            inside = view.press.distance(size) < FITTED_SHARE
            squares += np.kron(np.eye(2), feature[inside].T @ feature[inside])
            products += (feature[inside].T @ view.press.slopes(size)[inside]).T.ravel()
            if original.is_whole:
                cap = np.array([view.press.recovered(depth) for depth in depths[view.press.name]])
                squares += CAP_PIXELS * np.outer(cap, cap)
                products += CAP_PIXELS * cap
        solution = np.linalg.lstsq(squares, products, rcond=None)[0].reshape(2, -1).T
        if again < RECENTRED:
            moved = tuple(
                replace(view, press=recentred(original.press, feature @ solution))
                for view, original, feature in zip(moved, views, features, strict=True)
            )
    return solution.T.reshape(2, 3, terms.shape[-1]), moved


def _depth_features(feature: np.ndarray) -> np.ndarray:
    """Return the depth that each coefficient contributes, Neumann, in double precision.

    Depth is linear in the coefficients.

    Parameters
    ----------
    feature : float64 array (size, size, n)
        Slope that each coefficient of one axis contributes.

    Returns
    -------
    float32 array (2 n, size, size), grid pixels; dz/dx first, then dz/dy
    """
    size, count = len(feature), feature.shape[-1]
    depths = []
    for axis in (0, 1):
        slopes = np.zeros((count, size, size, 2))
        slopes[..., axis] = np.moveaxis(feature, -1, 0)
        depths.append(reference.solve(divergence(slopes, True), True).astype(np.float32))
    return np.concatenate(depths)


def recentred(press: GridPress, slopes: np.ndarray) -> GridPress:
    """Return the press, moved to the centre where its ball fits slopes (size, size, 2) best."""
    inside = press.distance(len(slopes)) < FITTED_SHARE
    rows, columns = np.nonzero(inside)
    measured = slopes[inside]

    def error(centre: np.ndarray) -> np.ndarray:
        x, y = columns - centre[0], rows - centre[1]
        drop = np.sqrt(np.maximum(press.ball_radius**2 - x**2 - y**2, 1))
        return np.concatenate((measured[:, 0] + x / drop, measured[:, 1] + y / drop))

    start = np.array((press.x, press.y))
    reach = FURTHEST_SHIFT * press.contact_radius
    x, y = least_squares(error, start, bounds=(start - reach, start + reach)).x
    return replace(press, x=float(x), y=float(y))


# Table.


def fit_table(views: tuple[View, ...], bits: int) -> tuple[np.ndarray, np.ndarray]:
    """Fit the table: each bin is the weighted mean of its pixels' slopes and of a polynomial in the colour.

    Returns
    -------
    float64 array (2**b, 2**b, 2**b, 2), slopes, multiples of 2**-FRACTION_BITS
    bool array (2**b, 2**b, 2**b), the bins that pixels fell into
    """
    size, bins = len(views[0].frame), 1 << bits
    terms = len(_colour_powers(np.zeros(3)))
    count = {region: np.zeros(bins**3) for region in ("contact", "flat")}
    squares = {region: np.zeros((terms, terms)) for region in count}
    slopes, products = np.zeros((bins**3, 2)), np.zeros((terms, 2))
    for view in views:
        index, truth, distance = _bins_of(view.codes, bits), view.press.slopes(size), view.press.distance(size)
        powers = _colour_powers(view.deviations * DEVIATION.lsb)
        inside = distance < FITTED_SHARE
        for region, where in (("contact", inside), ("flat", distance > NOTHING_TOUCHES)):
            count[region] += np.bincount(index[where], minlength=bins**3)
            squares[region] += powers[where].T @ powers[where]
        products += powers[inside].T @ truth[inside]  # elsewhere slopes are 0 and add nothing
        for axis in (0, 1):
            slopes[:, axis] += np.bincount(index[inside], truth[inside][:, axis], bins**3)
    level = count["contact"].sum() / max(count["flat"].sum(), 1)
    polynomial = np.linalg.lstsq(squares["contact"] + level * squares["flat"], products, rcond=None)[0]
    weight = count["contact"] + level * count["flat"]
    table = (slopes + PRIOR_PIXELS * _prior(polynomial, bins)) / (weight + PRIOR_PIXELS)[:, None]
    shape = (bins, bins, bins)
    is_filled = (count["contact"] + count["flat"] > 0).reshape(shape)
    return np.rint(table.reshape(*shape, 2) * 2**FRACTION_BITS) / 2**FRACTION_BITS, is_filled


def _prior(polynomial: np.ndarray, bins: int) -> np.ndarray:
    """Return the slopes of a polynomial (terms, 2) at the middle of each bin, (bins**3, 2), up to STEEPEST_PRIOR."""
    middle = (np.arange(bins) + 0.5) * (256 / bins) - 0.5
    colours = np.stack(np.meshgrid(middle, middle, middle, indexing="ij"), axis=-1) / FLAT_CODE - 1
    prior = _colour_powers(colours).reshape(bins**3, -1) @ polynomial
    steepness = np.linalg.norm(prior, axis=-1, keepdims=True)
    return prior * np.minimum(1, STEEPEST_PRIOR / np.maximum(steepness, 1e-9))


def _colour_powers(colours: np.ndarray) -> np.ndarray:
    """Return the products of up to `PRIOR_DEGREE` colours: (..., 3) to (..., terms)."""
    products = [
        np.prod(colours[..., list(which)], axis=-1)
        for degree in range(PRIOR_DEGREE + 1)
        for which in combinations_with_replacement(range(3), degree)
    ]
    return np.stack(products, axis=-1)


def _bins_of(codes: np.ndarray, bits: int) -> np.ndarray:
    """Return the index of each pixel's bin in the flattened table: uint8 (..., 3) to int64 (...)."""
    red, green, blue = np.moveaxis(codes >> (8 - bits), -1, 0)
    return np.ravel_multi_index((red, green, blue), (1 << bits,) * 3)


def _coverage(is_filled: np.ndarray, held_out: Sequence[View]) -> tuple[float, float]:
    """Return the fraction of filled bins, and the fraction of pixels of held-out contacts in filled bins."""
    bits = is_filled.shape[0].bit_length() - 1
    hits = [
        is_filled.ravel()[_bins_of(view.codes, bits)[view.press.distance(len(view.frame)) < 1]] for view in held_out
    ]
    return float(is_filled.mean()), float(np.concatenate(hits).mean())
