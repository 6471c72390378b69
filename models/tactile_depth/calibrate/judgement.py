# SPDX-License-Identifier: Apache-2.0
"""Judges a fit: its errors on presses that were not fitted, and what the presses themselves show of a likely cause.

No errors of a fit show a diameter or a pitch that is wrong for all presses, or what the gel does where nothing was
pressed: the rest agrees with itself. So the presses are judged beside their errors.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np
from scipy.ndimage import median_filter

from tactile_depth.base.errors import InputError
from tactile_depth.calibrate.evaluation import Evaluation, scores_of
from tactile_depth.calibrate.presses import FITTED_SHARE, NOTHING_TOUCHES, GridPresses, View
from tactile_depth.chip.limits import COEFFICIENTS, DEVIATION
from tactile_depth.depth.reference import pixel_terms
from tactile_depth.pictures.identify import identify
from tactile_depth.pictures.reference_check import dents
from tactile_depth.sensor.sensor import Sensor, equal_areas
from tactile_depth.sensor.verdict import BAD, GOOD, GRADES, USABLE, Verdict
from tactile_depth.sensor.view import shown

# Least distance of a press from the picture's middle towards each of its sides, as a share of the way. Presses all over
# the gel, 10 or more: 0.31 to 0.9; presses on one side alone: -0.3 to 0.0.
BAD_REACH, GOOD_REACH = 0.1, 0.25
# Largest ratio of the diameter that the presses of a ball show, by the colours of other balls, to that given. Real
# balls that contradict each other by 8 %: 1.11; one of two diameters wrong by 30 %: 1.19 to 1.41.
DIAMETERS_AGREE, FEWEST_OF_A_BALL = 1.15, 4
LARGE_CONTACT = 0.85  # median of contact over ball radius: real presses of a Mini 0.51, drawn ones 0.3 to 0.7
# Ratio of all diameters to those given at which slopes are linear in the colours. Drawn linear gels: 1.0, with 0.03 to
# 0.04 of the slopes left; real gels: over 1.8, with 0.15 left. Colours of a lit gel never grow faster than slopes, as
# they seem to with diameters that are too large: 30 %: 0.77. With diameters 30 % too small: 1.32 to 1.42, with 0.03
# left. Drawn gels whose colours are 1 / (1 + 0.1 slope) of linear: 1.16; with 0.2, as if diameters were wrong: 1.45.
LINEAR_AT, FAR_FROM_LINEAR, LEFT_OF_LINEAR = (0.88, 1.14), 1.25, 0.06
FACTORS = np.exp(np.linspace(-0.6, 0.6, 49))  # of a diameter
RIDGE = 1e-3  # added to the diagonal of equations scaled to 1: colours that hardly vary get small coefficients
# Change of colour in a circle over that in the circle of its size that holds most: 0.70 to 1 for right circles, below
# 0.55 for others on untouched gel. Ring of most change, in radii: right circles of a Mini and drawn ones 0.75 to 1.05,
# of a DIGIT 0.65 to 0.75; 0.25 to 0.55 for circles shifted by half a radius or more, 1.45 for circles of 0.65 times the
# right size. So its share of that of the larger rings, the upper quartile, or of 1: 0.75 to
# 1.1 | 0.26 to 0.68, which circles of 1.4 times the right size have.
FULL_CIRCLE, RING, ALIKE = 0.62, (0.4, 1.25), 0.72
MOST_DOUBTFUL = 0.2  # share of the presses whose circles may be doubtful, or that may be left out
# A dark spot has less than that share of the light around it, in a square so wide in a picture of 320 columns. Share of
# the picture: real gels without markers 0.000; drawn markers 0.06 to 0.08.
DARK_SPOT, SPOT_PX, COLUMNS, MOST_SPOTS = 0.8, 31, 320, 0.02
# Presses that leave an area alone, of which the median is that of untouched gel. `dents` of the background beyond its
# limit, of 8 real or drawn presses and more, also beside each other: -0.003 at most; with another press as background
# 0.09 and more. Share of the areas that must be known, so that their noise is: 0.69 and more; of 5 presses, with 0.51,
# the excess is 0.009.
FEWEST_UNTOUCHED, KNOWN_AREAS = 4, 0.6
NAMED = 4  # presses in a reason
NOT_CHECKED = (
    "pitch and diameters not checked: heights are as wrong as they are, and neither ball_radius_px nor the view of a "
    "known sensor says more"
)
PITCH_AGREES = 0.1  # largest relative difference to the pitch of a built-in calibration of the same kind of sensor
SAME_PICTURE = 0.02  # RMS of log(picture / picture), colour by colour. Drawn specimens: 0.046 and more


def judge(presses: GridPresses, evaluation: Evaluation) -> Verdict:
    """Return the verdict on the best model of a fit to presses on the grid."""
    model = evaluation.best_model
    numbers = evaluation.faults(model)
    grades = [GOOD if not numbers else BAD if evaluation.severity(model) > 1 else USABLE]
    causes = []
    circles, spread, known = _circles(presses), _spread(presses), known_sensor(presses)
    background = (GOOD, "") if spread[0] == BAD else _background(presses)
    diameters = (GOOD, "") if circles[0] == BAD else _diameters(presses)  # which need right circles
    against_known = (GOOD, "") if known is None else _against(known, presses)
    for grade, cause in (circles, against_known, diameters, background, _markers(presses), spread):
        if cause:
            grades.append(grade)
            causes.append(cause)
    worst = max(grades, key=GRADES.index)
    if worst == BAD and not causes:
        causes = ["no likely cause found: look at the circles, and whether the camera adjusts itself"]
    unchecked = [] if presses.ball_pitches or known else [NOT_CHECKED]
    return Verdict(worst, (*numbers, *causes, *unchecked))


def _joined(names: Sequence[str]) -> str:
    return ", ".join(names[:NAMED]) + (f" and {len(names) - NAMED} more" if len(names) > NAMED else "")


# A built-in calibration.


def known_sensor(presses: GridPresses) -> Sensor | None:
    """Return the built-in calibration with the lighting of the background, at its size; None without one.

    What the pictures show must be known, or the same as there.
    """
    background = presses.background
    try:
        known = identify(background, crop=presses.view)
    except InputError:
        return None
    if presses.view is None:
        assert known.untouched is not None
        differs = np.log(np.maximum(equal_areas(background), 1) / np.maximum(known.untouched, 1))
        if (differs - differs.mean(axis=(0, 1))).std() > SAME_PICTURE:
            return None
    known, share = shown(known, presses.view)
    rows, columns = background.shape[:2]
    return known.scaled(1 / known.zoom((rows, columns), share=share))


def _against(known: Sensor, presses: GridPresses) -> tuple[str, str]:
    """Return whether the pitch, or the heights of the balls, are far from those of the same kind of sensor."""
    pitch_mm = known.pixel_pitch_mm
    if abs(presses.pitch_mm / pitch_mm - 1) > PITCH_AGREES:
        return BAD, (
            f"likely cause: a wrong pitch or crop: {presses.pitch_mm:.3g} mm per pixel, but {pitch_mm:.3g} by a "
            "built-in calibration for the same lighting and view"
        )
    views = [view for view in presses.views if view.is_whole and view.press.is_central]
    if not views:
        return GOOD, ""
    caps = float(np.median([score.cap_height for score in scores_of(known, presses, views, known.model)]))
    if max(caps, 1 / caps) < DIAMETERS_AGREE:
        return GOOD, ""
    return BAD, (
        f"likely cause: wrong diameters: a built-in calibration for the same lighting reads caps of {caps:.2f} times "
        "the height of these balls"
    )


# Diameters.


def _diameters(presses: GridPresses) -> tuple[str, str]:
    """Return whether the balls contradict each other, or all diameters what a gel can do."""
    pitches = presses.ball_pitches
    if pitches and max(pitches.values()) > DIAMETERS_AGREE * min(pitches.values()):
        balls = ", ".join(f"{ball:g} mm {pitch:.3g} mm per pixel" for ball, pitch in pitches.items())
        return BAD, f"likely cause: a wrong diameter or ball_radius_px: the pitch is by balls of {balls}"
    by_ball: dict[float, list[View]] = {}
    for view in presses.views:
        by_ball.setdefault(view.diameter_mm, []).append(view)
    samples = {ball: _Samples(views, presses.grid_pitch_mm) for ball, views in by_ball.items()}
    shown = {}
    for ball, own in samples.items():
        others = [each for other, each in samples.items() if other != ball]
        if len(by_ball[ball]) >= FEWEST_OF_A_BALL and len(presses.views) - len(by_ball[ball]) >= FEWEST_OF_A_BALL:
            shown[ball] = own.factor(others)
    if len(shown) > 1:
        mean = math.exp(np.mean([math.log(factor) for factor in shown.values()]))
        apart = {ball: factor / mean for ball, factor in shown.items()}
        if max(max(ratio, 1 / ratio) for ratio in apart.values()) > DIAMETERS_AGREE:
            balls = ", ".join(f"{ball:g} mm as {ball * ratio:.2g} mm" for ball, ratio in apart.items())
            return BAD, f"likely cause: a wrong diameter: by the colours of the other balls, {balls}"
    size = float(np.median([view.press.contact_radius / view.press.ball_radius for view in presses.views]))
    if size > LARGE_CONTACT:
        return USABLE, (
            "likely cause: diameters too small, a pitch too large, or presses too deep: contacts have "
            f"{size:.2f} of the radius of their balls, where slopes have no bound"
        )
    factor, left = _linear_at(list(samples.values()))
    low, high = LINEAR_AT
    if factor < low or (high < factor < FACTORS[-1] and left < LEFT_OF_LINEAR):
        wrong = "too large, or a pitch too small" if factor < low else "too small, or a pitch too large"
        return BAD if factor < low or factor > FAR_FROM_LINEAR else USABLE, (
            f"likely cause: diameters {wrong}: colours are those of balls of {factor:.2f} times the diameters given"
        )
    return GOOD, ""


class _Samples:
    """Pixels in the contacts of some presses: features of a response linear in the colours, and the balls' slopes."""

    def __init__(self, views: Sequence[View], pitch_mm: float) -> None:
        features, offsets, radii = [], [], []
        for view in views:
            press, inside = view.press, view.press.distance < FITTED_SHARE
            colours = view.deviations[inside] * DEVIATION.lsb
            terms = pixel_terms(*press.grid, pitch_mm)[inside][:, : COEFFICIENTS[-1]]
            features.append((colours[:, :, None] * terms[:, None, :]).reshape(len(colours), -1))
            rows, columns = np.nonzero(inside)
            offsets.append(np.stack(((press.x - columns) * press.aspect, press.y - rows), axis=-1))
            radii.append(np.full(len(colours), press.ball_radius))
        self.features, self.offsets, self.radii = (np.concatenate(parts) for parts in (features, offsets, radii))

    def slopes(self, factor: float = 1.0) -> np.ndarray:
        """Return slopes (n, 2) of balls of `factor` times the diameter; NaN where such a ball is not that wide."""
        drop = (factor * self.radii) ** 2 - (self.offsets**2).sum(axis=-1)
        return self.offsets / np.sqrt(np.where(drop > 0, drop, np.nan))[:, None]

    def factor(self, others: Sequence[_Samples]) -> float:
        """Return the factor of the diameter at which the slopes agree best with the response of other balls."""
        slopes = np.concatenate([other.slopes() for other in others])
        features = np.concatenate([other.features for other in others])
        by_others = self.features @ least_squares(features.T @ features, features.T @ slopes)
        known = np.hypot(*by_others.T) < np.quantile(np.hypot(*slopes.T), 0.98)
        return _best(lambda factor: float(((by_others - self.slopes(factor))[known] ** 2).mean()))[0]


def least_squares(squares: np.ndarray, products: np.ndarray) -> np.ndarray:
    """Return the solution of squares (n, n) and products (n,) or (n, m), whose units are powers of a millimetre."""
    scale = 1 / np.sqrt(squares.diagonal())
    scaled = squares * np.outer(scale, scale) + RIDGE * np.eye(len(scale))
    return (np.linalg.solve(scaled, (products.T * scale).T).T * scale).T


def _best(error: Callable[[float], float]) -> tuple[float, float]:
    """Return the factor of the smallest error, and that error."""
    errors = np.array([error(factor) for factor in FACTORS])
    if np.isnan(errors).all():
        return 1.0, math.inf
    return float(FACTORS[np.nanargmin(errors)]), float(np.nanmin(errors))


def _linear_at(samples: Sequence[_Samples]) -> tuple[float, float]:
    """Return the factor of all diameters at which slopes are closest to linear in the colours, and what is left."""
    features = np.concatenate([each.features for each in samples])

    def error(factor: float) -> float:
        slopes = np.concatenate([each.slopes(factor) for each in samples])
        if np.isnan(slopes).any():
            return math.nan
        fitted = features @ least_squares(features.T @ features, features.T @ slopes)
        return math.sqrt(((fitted - slopes) ** 2).sum() / (slopes**2).sum())

    return _best(error)


# Circles, markers and positions.


def _circles(presses: GridPresses) -> tuple[str, str]:
    """Return whether many circles lie beside the change of colour, or many presses are left out."""
    doubtful = doubtful_circles(presses)
    if len(doubtful) > MOST_DOUBTFUL * len(presses.views):
        return BAD, (
            f"likely cause: wrong circles: those of {len(doubtful)} of {len(presses.views)} presses do not lie around "
            f"the change of colour: {_joined(doubtful)}"
        )
    number = len(presses.left_out)
    if number > MOST_DOUBTFUL * (number + len(presses.views)):
        return USABLE, f"{number} of {number + len(presses.views)} presses are left out: {_joined(presses.left_out)}"
    return GOOD, ""


def doubtful_circles(presses: GridPresses) -> list[str]:
    """Return the names of presses whose circles do not hold the change of colour as those of the others do."""
    if not presses.views:
        return []
    shares, rings = np.transpose([_change_in(view) for view in presses.views])
    low, high = RING
    low = max(low, ALIKE * min(float(np.percentile(rings, 75)), 1.0))
    full = (shares >= FULL_CIRCLE) & (low <= rings) & (rings <= high)
    return [view.press.name for view, is_full in zip(presses.views, full, strict=True) if not is_full]


def _change_in(view: View) -> tuple[float, float]:
    """Return the change of colour in a circle over the most in any of its size, and its ring of most change."""
    from scipy.signal import fftconvolve  # it takes longer to import than all others

    change, press = np.linalg.norm(view.deviations, axis=-1), view.press
    reach = math.ceil(press.contact_radius)
    rows, columns = np.indices((2 * reach + 1,) * 2) - reach
    disc = np.hypot(rows, columns * press.aspect) < press.contact_radius
    most = fftconvolve(change, disc, mode="same").max()
    near = press.distance < 2
    ring = (press.distance * 10).astype(int)[near]  # a tenth of the radius wide
    mean = np.bincount(ring, change[near]) / np.maximum(np.bincount(ring), 1)
    return float(change[press.distance < 1].sum() / most), float(mean[2:].argmax() + 2.5) / 10


def _background(presses: GridPresses) -> tuple[str, str]:
    """Return whether the background differs from the gel that the presses leave alone, as if something touched in it.

    Presses all over the gel leave each area alone, but for a few of them.
    """
    own, changes = np.maximum(equal_areas(presses.background_on_grid), 1), []
    for view in presses.views:
        alone = equal_areas((view.press.distance <= NOTHING_TOUCHES)[..., None])[..., 0] == 0
        if alone.any():
            change = np.log(np.maximum(equal_areas(view.frame), 1) / own)
            changes.append(np.where(alone[..., None], change - np.median(change[alone], axis=0), np.nan))
    stack, usual = np.array(changes).reshape(-1, *own.shape), np.zeros_like(own)
    known = (~np.isnan(stack[..., 0])).sum(axis=0) >= FEWEST_UNTOUCHED
    usual[known] = np.nanmedian(stack[:, known], axis=0)
    differs, is_touched = dents(own * np.exp(usual), own)
    if not is_touched or known.mean() < KNOWN_AREAS:
        return GOOD, ""
    return BAD, (
        f"likely cause: a touched background: it differs by {100 * differs:.0f} % from the median of the presses, in "
        "places that they leave alone: take it with the sensor untouched"
    )


def _markers(presses: GridPresses) -> tuple[str, str]:
    """Return whether the gel without contact has dark spots, which other contacts move even if the presses did not."""
    step = max(presses.background.shape[1] // COLUMNS, 1)
    light = presses.background[::step, ::step].mean(axis=-1)
    share = float((light < DARK_SPOT * median_filter(light, SPOT_PX * light.shape[1] // COLUMNS | 1)).mean())
    if share < MOST_SPOTS:
        return GOOD, ""
    return BAD, (
        f"likely cause: markers: dark spots cover {100 * share:.0f} % of the gel; they move with it, so its reference "
        "does not cancel them"
    )


def _spread(presses: GridPresses) -> tuple[str, str]:
    """Return whether presses leave a side of the picture out."""
    rows, columns = presses.grid
    at = np.array([(view.press.x, view.press.y) for view in presses.views])
    away = 2 * (at + 0.5) / (columns, rows) - 1  # from the middle, in shares of the way to the edge
    reach = np.concatenate(((-away).max(axis=0), away.max(axis=0)))
    bare = [side for side, far in zip(("left", "top", "right", "bottom"), reach, strict=True) if far < GOOD_REACH]
    if not bare:
        return GOOD, ""
    grade = BAD if reach.min() < BAD_REACH else USABLE
    return grade, (
        f"likely cause: presses on one side alone: none lies well to the {' or the '.join(bare)} of the "
        "middle, where slopes are guessed"
    )
