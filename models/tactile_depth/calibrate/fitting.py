# SPDX-License-Identifier: Apache-2.0
"""Fits a calibration to ball presses: `fit`.

Pictures are processed as in the hardware: resampled to the grid that covers them, rounded to 8 bits, flat-fielded by
interpolated gains, with a light gain for each colour (except for `lut`). The slope of a pixel is that of the ball where
it touches. The calibration is fitted to all presses. Its error is measured on each press that lies completely in the
picture, by a fit to all others.

Models `quadratic` and `cubic`. Slopes, depths and heights of the caps are fitted together; all are linear in the
coefficients. Slopes of pixels within 0.9 of the contact's radius have weight 1; beyond 0.9 the gel has left the ball.
Depths within the contact circle, less their mean, have `DEPTH_WEIGHT`, because depth is what is wanted: it takes in the
slopes around it. The relative error of the height of a whole cap has `CAP_WEIGHT`. Depths far from the contact, less
their mean, are 0 with `FLAT_WEIGHT`: more of it makes untouched gel flatter, and contacts less right. Slopes outside
have no weight: a pixel of the background's colour reads 0 with any coefficients, and just outside the circle the gel is
not flat. `cubic` adds slopes that are polynomials of second and third degree in the colours, the same everywhere: they
become its table of corrections.

Model `lut`. All pixels beyond twice the contact's radius together have the weight of the contacts. Without them an
untouched gel would not read flat. Bins with few pixels are close to a polynomial of third degree in the colour.

The weights were chosen by leaving out each press in turn. No model knows slopes steeper than those of the balls.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from itertools import combinations_with_replacement
from pathlib import Path
from typing import Any

import numpy as np

from tactile_depth.base.errors import Argument, InputError, InputWarning, counted, require_flag, warn
from tactile_depth.calibrate.ball_press import BallPress
from tactile_depth.calibrate.evaluation import Evaluation, Score, evaluation_of, scores_of
from tactile_depth.calibrate.judgement import judge, least_squares
from tactile_depth.calibrate.press_pictures import camera_pitch_mm, gather
from tactile_depth.calibrate.presses import FITTED_SHARE, NOTHING_TOUCHES, GridPresses, View, to_grid
from tactile_depth.chip.gradient.flat_field import FLAT_CODE
from tactile_depth.chip.gradient.polynomial_gradient import correction_codes, correction_unit, correction_units
from tactile_depth.chip.limits import COEFFICIENTS, CORRECTION_BITS, CUBIC, DEVIATION, GRADIENT_LIMITS, MODELS
from tactile_depth.chip.poisson.divergence import divergence
from tactile_depth.depth import reference
from tactile_depth.depth.reference import pixel_terms
from tactile_depth.pictures.pictures import Picture
from tactile_depth.sensor.calibration_file import LONGEST_EXPOSURE_US, PIXEL_ASPECTS, PIXEL_PITCHES_MM
from tactile_depth.sensor.sensor import CORRECTIONS, TABLE_BITS, Camera, Sensor, equal_areas, lighting
from tactile_depth.sensor.verdict import BAD, Verdict
from tactile_depth.sensor.view import Crop, view_of

FEWEST, FEWEST_MEASURED = 8, 2  # presses; those that lie completely in the middle square
DRAWS, DRAWN_OUT = 12, 6  # choices of presses for each number of them, and presses that are measured in each
DEPTH_WEIGHT = 0.5  # of the squared error of a depth in grid pixels; that of a slope has weight 1
FLAT_WEIGHT = 0.01  # of the squared depth in grid pixels, far from the contact
CAP_WEIGHT = 1000  # of the squared relative error of the height of a cap
DEFAULT_BITS = 5
PRIOR_PIXELS = 1.0  # weight of the polynomial in each bin
PRIOR_DEGREES, CORRECTION_DEGREES = (0, 1, 2, 3), (2, 3)
STEEPEST_PRIOR = 0.75
FRACTION_BITS = 10  # of a slope of the table: finer than the errors of the bins, and coarse enough for a small file

Equations = tuple[np.ndarray, np.ndarray]  # squares (n, n) and products (n,) of least squares


@dataclass(frozen=True)
class Fit:
    """A fitted calibration.

    Attributes
    ----------
    sensor : Sensor
    evaluation : Evaluation
        Scores of each whole press by a fit to all others.
    without : mapping of str to Sensor
        The fit to all presses but one, by the name of the one.
    verdict : Verdict
        That of `sensor`.
    """

    sensor: Sensor
    evaluation: Evaluation
    without: dict[str, Sensor]
    verdict: Verdict


def fit(
    presses: str | Path | Sequence[BallPress],
    background: Picture | None = None,
    *,
    pitch_mm: float | tuple[float, float] | None = None,
    models: str | Sequence[str] = MODELS,
    bits: int = DEFAULT_BITS,
    find_circles: bool = False,
    name: str | None = None,
    exposure_us: float | None = None,
    rotate: int = 0,
    crop: Crop | None = None,
    quiet: bool = False,
) -> Sensor:
    """Return a sensor, calibrated by presses of balls of known diameter.

    Give two dozen presses or more, spread over the gel, four or more of them completely in the picture's middle square:
    heights are then right within about 6 % (docs/calibrate.md). A warning names each press that is left out.
    The error of the calibration is printed.

    Parameters
    ----------
    presses : path of a folder, or sequence of BallPress
        A folder holds pictures (PNG, JPEG) of one size, background.png, and presses.csv with columns `frame`,
        `diameter_mm` and optionally `centre_x_px`, `centre_y_px`, `contact_radius_px`, `ball_radius_px`.
    background : uint8 array (rows, columns, 3), PIL image or path, optional
        Picture of the sensor without contact; by default that of the folder.
    pitch_mm : float or (height, width), optional
        Millimetres per camera pixel; by default computed from the balls' radii in pixels. Two numbers, down the rows
        and along the columns, if pixels are not square; radii in pixels then count down the rows.
    models : str or sequence of str
        Gradient models to fit: `lut`, `quadratic`, `cubic`.
    bits : int
        Bits of each colour that index the table of `lut`, 1 to 6.
    find_circles : bool
        Use the circles found in the pictures even if others are given. This needs scikit-image, as does a press
        without a circle.
    name : str, optional
        Name of the sensor; by default that of the folder.
    exposure_us : float, optional
        Exposure time of the camera in microseconds.
    rotate : int
        Degrees, counter-clockwise, by which all pictures are rotated first: 0, 90, 180 or 270. Give circles as they lie
        after that.
    crop : str, float or (width, height), optional
        What the pictures show of the sensor's full picture, to be kept as `Sensor.view`: `none`, all of it; a share, as
        0.8; `gs_sdk` or `gsrobotics`, what that software leaves. By default it is unknown.
    quiet : bool
        Print nothing.

    Returns
    -------
    Sensor
        `height_errors` and `verdict` are measured on each press by a fit to the others; `Sensor.save` writes them. A
        bad verdict gives a warning.

    Raises
    ------
    InputError
    """
    require_flag(Argument("find_circles", find_circles))
    require_flag(Argument("quiet", quiet))
    wanted = check_arguments(models, bits, exposure_us)
    height, aspect = pixel_size(pitch_mm)
    pictures = gather(presses, background, rotate)
    view = None if crop is None else view_of(crop)
    on_grid = to_grid(pictures, camera_pitch_mm(pictures, height), find_circles, aspect=aspect)
    on_grid = replace(on_grid, view=view)
    for note in on_grid.notes:
        warn(InputWarning(note))
    fitted = fit_presses(on_grid, wanted, bits, name or pictures.name, exposure_us)
    if fitted.verdict.grade == BAD:
        warn(InputWarning(f"the verdict of the fit is {fitted.verdict}"))
    if not quiet:
        print(on_grid.field_of_view, fitted.evaluation.summary, f"verdict: {fitted.verdict.lines}", sep="\n")
    return fitted.sensor


def check_arguments(models: str | Sequence[str], bits: int, exposure_us: float | None) -> tuple[str, ...]:
    """Return the models; raise InputError if an argument of `fit` is not accepted."""
    wanted = (models,) if isinstance(models, str) else tuple(models)
    if not wanted or not set(wanted) <= set(MODELS):
        raise InputError(Argument("models", ", ".join(map(str, wanted))), accepted=(*MODELS, "one or more"))
    low, high = TABLE_BITS
    if not isinstance(bits, int) or not low <= bits <= high:
        raise InputError(Argument("bits", bits), accepted=f"a whole number from {low} to {high}")
    if exposure_us is not None and not 0 < exposure_us <= LONGEST_EXPOSURE_US:
        raise InputError(Argument("exposure_us", exposure_us), accepted="a time above 0, in microseconds")
    return tuple(model for model in MODELS if model in wanted)


def pixel_size(pitch_mm: float | tuple[float, float] | None) -> tuple[float | None, float]:
    """Return the height of a pixel in mm, and its width over its height; raise InputError if they are not accepted."""
    if pitch_mm is None:
        return None, 1.0
    given, (shortest, longest) = np.atleast_1d(np.asarray(pitch_mm)), PIXEL_PITCHES_MM
    is_pitch = given.shape in ((1,), (2,)) and given.dtype.kind in "iuf"
    if not is_pitch or not ((shortest <= given) & (given <= longest)).all():
        accepted = (f"{shortest:g} to {longest:g}", "in mm per camera pixel, or its height and width")
        raise InputError(Argument("pitch_mm", pitch_mm), accepted=accepted)
    aspect, (low, high) = float(given[-1] / given[0]), PIXEL_ASPECTS
    if not low <= aspect <= high:
        raise InputError(Argument("pitch_mm", pitch_mm), accepted=f"pixels {low:g} to {high:g} times as wide as high")
    return float(given[0]), aspect


def fit_presses(
    presses: GridPresses,
    models: Sequence[str] = MODELS,
    bits: int = DEFAULT_BITS,
    name: str = "fitted",
    exposure_us: float | None = None,
    progress: Callable[[list[View]], Iterable[View]] = list,
) -> Fit:
    """Fit a calibration to presses on the grid, and measure it by fits to all presses but one.

    Parameters
    ----------
    progress : function
        Wraps the list of the presses that are left out in turn, for example to show progress.
    """
    measured = [view for view in presses.views if view.is_whole]
    central = sum(view.press.is_central for view in measured)
    if len(presses.views) < FEWEST or central < FEWEST_MEASURED:
        why = f"; {presses.notes[0]}" if presses.notes else ""
        raise InputError(
            f"{presses.name}: {counted(len(presses.views), 'press')}, {central} of them wholly in the picture's middle "
            f"square: at least {FEWEST} and {FEWEST_MEASURED} are needed{why}"
        )
    parts = {view.press.name: _parts(view, presses.grid_pitch_mm, models, bits) for view in presses.views}
    sensor = _fit_models(presses, presses.views, name, parts)
    without: dict[str, Sensor] = {}
    scores: dict[str, tuple[Score, ...]] = dict.fromkeys(models, ())
    for view in progress(measured):
        others = tuple(other for other in presses.views if other is not view)
        without[view.press.name] = fitted = _fit_models(presses, others, "others", parts)
        for model in models:
            scores[model] += scores_of(fitted, presses, [view], model)
    evaluation = evaluation_of(presses, measured, scores)
    verdict = judge(presses, evaluation)
    rows, columns = presses.background.shape[:2]
    sensor = replace(
        sensor,
        model=evaluation.best_model,
        camera=Camera(rows, columns, presses.pixel_format, exposure_us=exposure_us),
        height_errors={model: evaluation.height_error(model) for model in models},
        lighting=lighting(presses.background),
        untouched=equal_areas(presses.background),
        verdict=verdict,
        view=presses.view,
    )
    return Fit(sensor, evaluation, without, verdict)


def fit_folds(presses: GridPresses, folds: Sequence[Collection[str]]) -> list[Sensor]:
    """Fit a calibration for each fold, the names of some presses, to all presses that are not in it.

    Their errors are not measured.
    """
    parts = {view.press.name: _parts(view, presses.grid_pitch_mm, MODELS, DEFAULT_BITS) for view in presses.views}
    rows, columns = presses.background.shape[:2]
    camera = Camera(rows, columns, presses.pixel_format)
    fitted = []
    for fold in folds:
        others = tuple(view for view in presses.views if view.press.name not in fold)
        sensor = _fit_models(presses, others, "others", parts)
        fitted.append(replace(sensor, camera=camera, lighting=lighting(presses.background)))
    return fitted


def errors_by_number(
    presses: GridPresses,
    numbers: Iterable[int],
    progress: Callable[[list[int]], Iterable[int]] = list,
) -> dict[int, tuple[float, float]]:
    """Measure `cubic` fitted to so many presses, drawn by chance, on presses in the middle square not among them.

    Returns
    -------
    dict
        By number of presses: RMS error of a cap's height over the true one, and height RMS in the contact in mm.
    """
    chance = np.random.default_rng(1)
    parts = {view.press.name: _parts(view, presses.grid_pitch_mm, ("cubic",), DEFAULT_BITS) for view in presses.views}
    central = [view for view in presses.views if view.press.is_central]
    errors = {}
    for number in progress(list(numbers)):
        scores: list[Score] = []
        for _ in range(DRAWS):
            left_out = [central[index] for index in chance.choice(len(central), DRAWN_OUT, replace=False)]
            others = [view for view in presses.views if view not in left_out]
            fitted = tuple(others[index] for index in chance.choice(len(others), number, replace=False))
            scores += scores_of(_fit_models(presses, fitted, "some", parts), presses, left_out, "cubic")
        off = np.array([score.cap_height - 1 for score in scores])
        errors[number] = float(np.sqrt((off**2).mean())), float(np.mean([score.height_rms_mm for score in scores]))
    return errors


def _parts(view: View, pitch_mm: float, models: Sequence[str], bits: int) -> dict[str, Any]:
    """Return what a press adds to the fit of each model."""
    return {model: _table_sums(view, bits) if model == "lut" else _equations(view, pitch_mm, model) for model in models}


def _fit_models(
    presses: GridPresses, views: tuple[View, ...], name: str, parts: Mapping[str, Mapping[str, Any]]
) -> Sensor:
    models = tuple(parts[views[0].press.name])
    by_model = {model: [parts[view.press.name][model] for view in views] for model in models}
    steepest = max(view.press.largest_slope for view in views)
    if steepest < GRADIENT_LIMITS[0]:
        raise InputError(
            f"{presses.name}: the steepest press has a slope of {steepest:.2g} at the edge of its contact: press balls "
            "deeper, or correct diameter_mm and pitch_mm"
        )
    cubic, corrections = _cubic(views, by_model["cubic"]) if "cubic" in models else (None, None)
    sensor = Sensor(
        name,
        filled(by_model["lut"]) if "lut" in models else None,
        presses.pitch_mm,
        solved(by_model["quadratic"]).reshape(COEFFICIENTS) if "quadratic" in models else None,
        0.0 if models == ("lut",) else steepest * max(1.0, presses.aspect),
        models[0],
        flat_field=True,
        fitted_slope=dict.fromkeys(models, steepest),
        cubic=cubic,
        corrections=corrections,
        pixel_aspect=presses.aspect,
    )
    if corrections is None:
        return sensor
    limit = sensor.gradient_limit  # the hardware holds corrections in 8 bits of half the largest slope
    return replace(sensor, corrections=correction_units(corrections, limit) * correction_unit(limit))


# Polynomials.


def solved(equations: Sequence[Equations]) -> np.ndarray:
    """Return the coefficients (2, n) of least squares, of dz/dx and dz/dy."""
    squares, products = (np.sum(parts, axis=0) for parts in zip(*equations, strict=True))
    return least_squares(squares, products).reshape(2, -1)


def _cubic(views: Sequence[View], equations: Sequence[Equations]) -> tuple[np.ndarray, np.ndarray]:
    """Return the cubics (2, 3, 10) and the corrections (16, 16, 16, 2) by colour.

    Colours that no contact has get no larger corrections than those that one has.
    """
    count = math.prod(CUBIC[1:])
    solution = solved(equations)
    entries = np.arange(CORRECTIONS[0]) / (CORRECTIONS[0] / 2) - 1  # deviations at their centres
    colours = np.stack(np.meshgrid(entries, entries, entries, indexing="ij"), axis=-1)
    corrections = _colour_powers(colours, CORRECTION_DEGREES) @ solution[:, count:].T
    seen = np.concatenate(
        [correction_codes(view.deviations[view.press.distance < 1]) >> 8 - CORRECTION_BITS for view in views]
    )
    limit = np.abs(corrections[tuple(seen.T)]).max(axis=0)
    return solution[:, :count].reshape(CUBIC), corrections.clip(-limit, limit)


def _equations(view: View, pitch_mm: float, model: str) -> Equations:
    """Return what a press adds to the normal equations of slopes, depths and the height of its cap."""
    is_cubic = model == "cubic"
    colours = view.deviations * DEVIATION.lsb
    terms = pixel_terms(*view.press.grid, pitch_mm)[..., : CUBIC[-1] if is_cubic else COEFFICIENTS[-1]]
    feature = (colours[..., None] * terms[..., None, :]).reshape(*view.press.grid, -1)
    if is_cubic:
        feature = np.concatenate((feature, _colour_powers(colours, CORRECTION_DEGREES)), axis=-1)
    inside = view.press.distance < FITTED_SHARE
    squares = np.kron(np.eye(2), feature[inside].T @ feature[inside])
    products = (feature[inside].T @ view.press.slopes[inside]).T.ravel()
    depths, ball = _depth_features(feature), view.press.depth
    touches, far = np.isfinite(ball), view.press.untouched
    within, height = (each - each.mean(axis=-1, keepdims=True) for each in (depths[:, touches], ball[touches]))
    squares += DEPTH_WEIGHT * within @ within.T
    products += DEPTH_WEIGHT * within @ height
    flat = depths[:, far]
    if flat.size:
        flat -= flat.mean(axis=-1, keepdims=True)
        squares += FLAT_WEIGHT * flat @ flat.T
    if view.is_whole:
        cap = np.array([view.press.recovered(depth) for depth in depths])
        squares += CAP_WEIGHT * np.outer(cap, cap)
        products += CAP_WEIGHT * cap
    return squares, products


def _depth_features(feature: np.ndarray) -> np.ndarray:
    """Return the depth that each coefficient contributes, Neumann, in double precision.

    Parameters
    ----------
    feature : float64 array (rows, columns, n)
        Slope that each coefficient of one axis contributes.

    Returns
    -------
    float64 array (2 n, rows, columns), grid pixels; dz/dx first, then dz/dy
    """
    depths = []
    for axis in (0, 1):
        slopes = np.zeros((feature.shape[-1], *feature.shape[:2], 2))
        slopes[..., axis] = np.moveaxis(feature, -1, 0)
        depths.append(reference.solve(divergence(slopes, True), True))
    return np.concatenate(depths)


# Table.


@dataclass(frozen=True)
class TableSums:
    """Sums over the pixels of a press; `contact` within it, `flat` where nothing touches.

    Attributes
    ----------
    count : float64 array (2, bins**3), contact and flat
    squares : float64 array (2, terms, terms)
    slopes : float64 array (bins**3, 2)
    products : float64 array (terms, 2)
    """

    count: np.ndarray
    squares: np.ndarray
    slopes: np.ndarray
    products: np.ndarray


def _table_sums(view: View, bits: int) -> TableSums:
    entries = 1 << 3 * bits
    index = np.ravel_multi_index(tuple(np.moveaxis(view.codes >> 8 - bits, -1, 0)), (1 << bits,) * 3)
    truth, distance = view.press.slopes, view.press.distance
    powers = _colour_powers(view.codes / FLAT_CODE - 1, PRIOR_DEGREES)
    inside = distance < FITTED_SHARE
    regions = (inside, distance > NOTHING_TOUCHES)
    return TableSums(
        np.stack([np.bincount(index[where], minlength=entries) for where in regions]).astype(np.float64),
        np.stack([powers[where].T @ powers[where] for where in regions]),
        np.stack([np.bincount(index[inside], truth[inside][:, axis], entries) for axis in (0, 1)], axis=-1),
        powers[inside].T @ truth[inside],  # elsewhere slopes are 0 and add nothing
    )


def filled(sums: Sequence[TableSums]) -> np.ndarray:
    """Return the table of presses: a bin is the weighted mean of its pixels' slopes and of a polynomial in the colour.

    Returns
    -------
    float64 array (2**b, 2**b, 2**b, 2), slopes, multiples of 2**-FRACTION_BITS
    """
    count, squares, slopes, products = (
        np.sum([getattr(one, field.name) for one in sums], axis=0) for field in fields(TableSums)
    )
    level = count[0].sum() / max(count[1].sum(), 1)
    polynomial = np.linalg.lstsq(squares[0] + level * squares[1], products, rcond=None)[0]
    bins = round(len(slopes) ** (1 / 3))
    table = (slopes + PRIOR_PIXELS * _prior(polynomial, bins)) / (count[0] + level * count[1] + PRIOR_PIXELS)[:, None]
    return np.rint(table.reshape(bins, bins, bins, 2) * 2**FRACTION_BITS) / 2**FRACTION_BITS


def _prior(polynomial: np.ndarray, bins: int) -> np.ndarray:
    """Return the slopes of a polynomial (terms, 2) at the middle of each bin, (bins**3, 2), up to STEEPEST_PRIOR."""
    middle = (np.arange(bins) + 0.5) * (256 / bins) - 0.5
    colours = np.stack(np.meshgrid(middle, middle, middle, indexing="ij"), axis=-1) / FLAT_CODE - 1
    prior = _colour_powers(colours, PRIOR_DEGREES).reshape(bins**3, -1) @ polynomial
    steepness = np.linalg.norm(prior, axis=-1, keepdims=True)
    return prior * np.minimum(1, STEEPEST_PRIOR / np.maximum(steepness, 1e-9))


def _colour_powers(colours: np.ndarray, degrees: Iterable[int]) -> np.ndarray:
    """Return the products of so many colours: (..., 3) to (..., terms)."""
    products = [
        np.prod(colours[..., list(which)], axis=-1)
        for degree in degrees
        for which in combinations_with_replacement(range(3), degree)
    ]
    return np.stack(products, axis=-1)
