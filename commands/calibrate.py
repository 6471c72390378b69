# SPDX-License-Identifier: Apache-2.0
"""`make calibrate`: from a no-contact frame and ball presses of known diameter to a calibration file.

The folder holds background.png, the presses as PNGs, and presses.csv: `frame` (a path in the folder), `diameter_mm` (or
`ball_diameter_mm`) of the ball, and, where they are known, the contact's circle `centre_x_px`, `centre_y_px`,
`contact_radius_px`, and `ball_radius_px`, all in camera pixels. Circles that are not given are found in the picture;
with CIRCLES=found all are: half a pixel in a radius of 26 is 4 % of the cap's height. A circle that is found lies about
a pixel within the contact's edge, where the gel is still on the ball.

Frames are seen as the hardware sees them: brought to the grid, rounded to 8 bits, flat-fielded by interpolated gains
(models/flat_field.py). The slope of a pixel is that of the ball where it touches, 0 elsewhere. A press that the square
crop cuts is fitted; of the whole ones every second is held out, and what is printed is of those alone. HELD_OUT=each
holds out every whole press in turn, each measured by a fit to all others: twice as many, for twenty times the fits.

How the slopes are weighted was settled on the fitted presses alone, each left out in turn. `quadratic`: all pixels
within 0.9 of the contact's radius count the same, the surroundings not at all: a pixel of the reference's colour reads
0 whatever the coefficients, and just outside the circle the gel is not flat, so that labels of 0 there cost up to half
of every height. At the circle itself the gel has left the ball. Besides slopes the heights of the caps are fitted, of
the presses that are whole: the relative error of one counts as the slopes of `CAP_PIXELS` pixels do. The presses are
then moved to where the fit sees the ball's top (about a grid pixel), and the fit is repeated, twice. `lut`: what lies
beyond twice the radius counts in all as much as the contacts, or a gel at rest would not read flat; bins seldom seen
lean on a polynomial of third degree in the colour. Slopes steeper than those of the balls are unknown to both.
"""

from __future__ import annotations

import csv
import math
import os
import sys
from collections import defaultdict
from dataclasses import dataclass, replace
from itertools import combinations_with_replacement
from pathlib import Path

import numpy as np
from scipy.ndimage import map_coordinates
from scipy.optimize import least_squares
from skimage.feature import canny
from skimage.filters import gaussian
from skimage.measure import CircleModel, ransac
from skimage.transform import hough_circle
from tqdm import tqdm

from commands import draw, variables
from commands import simulator as simulation
from models import reference
from models.calibration import BITS_PER_CHANNEL, MODELS, Calibration
from models.configuration import DEVIATION, Configuration
from models.divergence import divergence
from models.errors import InputError
from models.flat_field import FLAT_CODE, captured_gains, deviations, flat_codes
from models.frames import read_picture, resampling
from models.gradient_lookup import gradient_codes, gradient_lookup
from models.quadratic_gradient import polynomial_words, quadratic_gradient
from models.reference import quadratic_terms
from models.tactile_depth import solve

LARGEST_GRID, SMALLEST_GRID = 128, 16
FEWEST_FITTED, FEWEST_HELD_OUT = 6, 2
LARGEST_TABLE = 1 << 20  # bytes of presses.csv
PITCHES_AGREE = 0.02  # share by which PITCH and the balls' radii in pixels may differ
FITTED_SHARE = 0.9  # of the contact's radius
RECENTRED = 2  # times
CAP_PIXELS = 300
FURTHEST_SHIFT = 0.25  # of the contact's radius
NOTHING_TOUCHES = 2.0  # radii from the centre
BITS = 5
PRIOR_PIXELS = 1.0  # that the polynomial counts as, in each bin
PRIOR_DEGREE = 3
STEEPEST_PRIOR = 0.75
FRACTION_BITS = 10  # of a stored slope of the table: a float16 holds it, and the file is small
TOP_PX = 2  # radius of the top of a cap, in grid pixels
PRESSES_DRAWN = 3
SMALLEST_CIRCLE_PX = 8
FAINTEST_CIRCLE = 0.1  # deviation from the reference, along the circle
SHORTEST_ARC = 0.3  # of the circle, seen
GET = (
    "give PRESSES=<folder with background.png, PNGs of ball presses and presses.csv>; real ones are in the public "
    "repository rpl-cmu/gelslam, src/gelslam/resources/example_calibration: put frame and diameter_mm of its "
    "catalog.csv into presses.csv, and set PITCH=0.0634"
)
UNKNOWN_PITCH = "PITCH is needed: mm per camera pixel (presses.csv has no ball_radius_px)"


@dataclass(frozen=True)
class Circle:
    """The edge of a contact in camera pixels, x along the columns, y down the rows."""

    x: float
    y: float
    radius: float


@dataclass(frozen=True)
class Row:
    """A line of presses.csv that can be used."""

    name: str
    diameter_mm: float
    circle: Circle | None
    ball_radius: float | None


@dataclass(frozen=True)
class Press:
    """A ball press. Lengths in pixels of the grid it is on, x along the columns, y down the rows."""

    name: str
    x: float
    y: float
    contact_radius: float
    ball_radius: float

    @property
    def cap_height(self) -> float:
        """Height of the ball's cap above its contact circle."""
        return self.ball_radius - math.sqrt(self.ball_radius**2 - self.contact_radius**2)

    @property
    def largest_slope(self) -> float:
        return self.contact_radius / math.sqrt(self.ball_radius**2 - self.contact_radius**2)

    def margin(self, size: int) -> float:
        """Distance from the contact circle to the nearest edge of a square grid; negative where it is cut."""
        return min(self.x, self.y, size - 1 - self.x, size - 1 - self.y) - self.contact_radius

    def on_grid(self, camera: tuple[int, int], size: int) -> Press:
        """The press as it lies on a square grid, from the camera's pixels."""
        plan = resampling(camera, (size, size))
        top, left = plan.origin
        return Press(
            self.name,
            (self.x - left + 0.5) / plan.scale - 0.5,
            (self.y - top + 0.5) / plan.scale - 0.5,
            self.contact_radius / plan.scale,
            self.ball_radius / plan.scale,
        )

    def distance(self, size: int) -> np.ndarray:
        """Of each pixel from the centre, in contact radii: float64 (size, size)."""
        rows, columns = np.indices((size, size))
        return np.hypot(columns - self.x, rows - self.y) / self.contact_radius

    def slopes(self, size: int) -> np.ndarray:
        """Slopes of depth, float64 (size, size, 2), 0 outside the contact."""
        rows, columns = np.indices((size, size), dtype=np.float64)
        offset = np.stack((columns - self.x, rows - self.y), axis=-1)
        squared = (offset**2).sum(axis=-1)
        touches = squared < self.contact_radius**2
        drop = np.sqrt(np.where(touches, self.ball_radius**2 - squared, 1))
        return np.where(touches[..., None], -offset / drop[..., None], 0)

    def circle(self) -> tuple[np.ndarray, np.ndarray]:
        """Points of the contact circle in a depth map: columns, rows.

        Depth lies half a pixel up and left of the slopes (models/divergence.py): a point of the frame is found half a
        pixel on.
        """
        angle = np.linspace(0, 2 * np.pi, 360, endpoint=False)
        return (
            self.x + 0.5 + self.contact_radius * np.cos(angle),
            self.y + 0.5 + self.contact_radius * np.sin(angle),
        )

    def recovered(self, depth: np.ndarray) -> float:
        """Cap height in a depth map (rows, cols) in grid pixels, over the true one.

        Mean depth within `TOP_PX` of the centre minus mean depth on the contact circle.
        """
        rows, columns = np.indices(depth.shape)
        top = depth[np.hypot(columns - self.x - 0.5, rows - self.y - 0.5) <= TOP_PX].mean()
        x, y = self.circle()
        return float((top - map_coordinates(depth, [y, x], order=1, mode="nearest").mean()) / self.cap_height)


@dataclass(frozen=True)
class View:
    """What the hardware's flat-fielding makes of a press, and the press on the grid."""

    press: Press
    frame: np.ndarray  # uint8 (size, size, 3)
    codes: np.ndarray  # uint8 (size, size, 3)
    deviations: np.ndarray  # int64 (size, size, 3), DEVIATION


@dataclass(frozen=True)
class Presses:
    """A folder of presses, read.

    Attributes
    ----------
    fitted, held_out : views on the grid
    pitch_mm : float
        Of the camera.
    scale : float
        Camera pixels per grid pixel.
    notes : one line for each thing that was left out
    agreement : circles found in the pictures minus those of the table, camera pixels, float64 (n, 3): x, y, radius
    """

    fitted: tuple[View, ...]
    held_out: tuple[View, ...]
    size: int
    pitch_mm: float
    scale: float
    notes: tuple[str, ...]
    agreement: np.ndarray

    @property
    def grid_pitch_mm(self) -> float:
        return self.pitch_mm * self.scale


# Reading.


def data_folder() -> Path:
    """The folder of real presses: `gelslam/` in `TACTILE_DATA`, or in ../shared/data beside the repository.

    Raises
    ------
    InputError
        It holds no presses.csv.
    """
    beside = simulation.ROOT.parent / "shared" / "data"
    folder = Path(os.environ.get("TACTILE_DATA") or beside) / "gelslam"
    if not (folder / "presses.csv").is_file():
        raise InputError(f"no presses: {folder} holds no presses.csv: {GET}")
    return folder


CIRCLE = ("centre_x_px", "centre_y_px", "contact_radius_px")
DIAMETERS = ("diameter_mm", "ball_diameter_mm")
KNOWN = ("frame", *DIAMETERS, *CIRCLE, "ball_radius_px")


def read_presses(folder: Path) -> tuple[list[Row], list[str]]:
    """The presses of presses.csv by name, and a line for each thing in it that is of no use.

    Raises
    ------
    InputError
        The table is not one.
    """
    path = folder / "presses.csv"
    rows: dict[str, Row] = {}
    notes = []
    try:
        with path.open("rb") as file:
            content = file.read(LARGEST_TABLE + 1)
        if len(content) > LARGEST_TABLE:
            raise ValueError(f"it is longer than {LARGEST_TABLE:,} bytes")
        lines = list(csv.reader(content.decode("utf-8-sig").splitlines()))
    except (OSError, ValueError, csv.Error) as error:
        reason = (error.strerror if isinstance(error, OSError) else None) or " ".join(str(error).split())
        raise InputError(f"{path}: not a readable table ({reason}): {GET}") from error
    head, lines = [name.strip() for name in lines[0]] if lines else [], lines[1:]
    diameter = next((name for name in DIAMETERS if name in head), "")
    if "frame" not in head or not diameter or len(set(head)) < len(head):
        raise InputError(
            f"{path}: columns {', '.join(head) or 'none'}: needed are frame and diameter_mm, each column once; "
            f"accepted are {', '.join(KNOWN)}"
        )
    if unknown := [name for name in head if name not in KNOWN]:
        notes.append(note(f"{path}: unknown columns {', '.join(unknown)}: not used; accepted are {', '.join(KNOWN)}"))
    for number, cells in enumerate(lines, 2):
        if not any(cells):
            continue
        try:
            if len(cells) != len(head):
                raise ValueError(f"{len(cells)} cells under {len(head)} columns")
            row = _row({name: cell.strip() for name, cell in zip(head, cells, strict=True)}, diameter)
            if row.name in rows:
                raise ValueError(f"{row.name} a second time")
        except ValueError as error:
            notes.append(note(f"{path}: line {number} left out: {error}"))
            continue
        rows[row.name] = row
    return sorted(rows.values(), key=lambda row: row.name), notes


def note(text: str) -> str:
    """One line, whatever was in the file."""
    return str(InputError(text))


def _row(cells: dict[str, str], diameter: str) -> Row:
    """Raises ValueError."""

    def number(column: str, low: float) -> float | None:
        text = cells.get(column, "")
        if not text:
            return None
        value = float(text)
        if not low < value < 1e6:
            raise ValueError(f"{column} is {text}")
        return value

    name = cells["frame"]
    if not name or Path(name).is_absolute() or ".." in Path(name).parts:
        raise ValueError(f"frame {name!r} is no path in the folder")
    mm = number(diameter, 0)
    if mm is None:
        raise ValueError(f"no {diameter}")
    x, y, radius = number(CIRCLE[0], -1e6), number(CIRCLE[1], -1e6), number(CIRCLE[2], 0)
    ball = number("ball_radius_px", 0)
    circle = None if x is None or y is None or radius is None else Circle(x, y, radius)
    if circle and ball and circle.radius >= ball:
        raise ValueError(f"the contact of {name} does not lie on its ball")
    return Row(name, mm, circle, ball)


def pitch_of(rows: list[Row], given: float | None) -> float:
    """Millimetres per camera pixel: as given, or as the balls' radii in pixels have it.

    Raises
    ------
    InputError
        Neither says it, or they disagree.
    """
    ratios = [row.diameter_mm / 2 / row.ball_radius for row in rows if row.ball_radius]
    if not ratios:
        if given is None:
            raise InputError(UNKNOWN_PITCH)
        return given
    from_balls = float(np.median(ratios))
    if given is None:
        return float(f"{from_balls:.3g}")  # no table has more digits
    if abs(from_balls / given - 1) > PITCHES_AGREE:
        raise InputError(f"PITCH={given:g}: ball_radius_px in presses.csv says {from_balls:.4g}: which is it?")
    return given


def find_circle(image: np.ndarray, background: np.ndarray, largest_radius: float) -> Circle | None:
    """The contact's circle in a picture; None where none is seen.

    A Hough transform of the edges of the colour's deviation finds it roughly (the gel is drawn in around the contact,
    so its edge lies outside). The circle itself is the crest of the deviation, where the ball is steepest: one point
    along each ray, and a circle through them that leaves stray points out.

    Parameters
    ----------
    image, background : uint8 (rows, cols, 3)
    """
    reference = np.maximum(background.astype(np.float64), 1)
    magnitude = np.linalg.norm(gaussian((image - reference) / reference, 1.5, channel_axis=-1), axis=-1)
    radii = np.arange(SMALLEST_CIRCLE_PX, max(math.ceil(largest_radius), SMALLEST_CIRCLE_PX + 2))
    # Votes over the root of the radius: by votes alone large circles win, by their share small ones do.
    votes = hough_circle(canny(magnitude, sigma=1.5), radii, normalize=False, full_output=True)
    at = (votes.max(axis=(1, 2)) / np.sqrt(radii)).argmax()
    row, column = np.unravel_index(votes[at].argmax(), votes[at].shape)
    centre_x, centre_y, rough = column - radii[-1], row - radii[-1], float(radii[at])
    angle = np.linspace(0, 2 * np.pi, 180, endpoint=False)[:, None]
    along = np.arange(0.5 * rough, 1.05 * rough, 0.25)
    x, y = centre_x + np.cos(angle) * along, centre_y + np.sin(angle) * along
    seen = map_coordinates(magnitude, [y, x], order=1, cval=np.nan)
    rays = np.isfinite(seen).all(axis=1)
    if not rays.any():
        return None
    x, y, seen = x[rays], y[rays], seen[rays]
    crest = seen.argmax(axis=1)
    inner = (crest > 0) & (crest < len(along) - 1) & (seen.max(axis=1) > FAINTEST_CIRCLE)
    if inner.sum() < SHORTEST_ARC * len(angle):
        return None
    points = np.stack([grid[np.arange(len(crest)), crest][inner] for grid in (x, y)], axis=-1)
    model, on = ransac(points, CircleModel, min_samples=8, residual_threshold=2, max_trials=200, rng=1)
    if model is None or on.sum() < SHORTEST_ARC * len(angle):
        return None
    return Circle(float(model.center[0]), float(model.center[1]), float(model.radius))


def load_presses(folder: Path, pitch_mm: float | None = None, compare: bool = False, find: bool = False) -> Presses:
    """Read a folder; what cannot be used is left out with a line of `notes`.

    Parameters
    ----------
    pitch_mm : float, optional
        Of the camera, where the table does not say it.
    compare : bool
        Find circles also where the table gives them.
    find : bool
        And use those found.

    Raises
    ------
    InputError
        Too little is left.
    """
    if not folder.is_dir():
        raise InputError(f"{folder}: no such folder: {GET}")
    background = read_picture(folder / "background.png")
    camera = background.shape[:2]
    size = min(LARGEST_GRID, 1 << (min(camera).bit_length() - 1))
    if size < SMALLEST_GRID:
        raise InputError(f"{folder / 'background.png'}: {camera[0]} x {camera[1]}: too small for any grid")
    rows, notes = read_presses(folder)
    pitch = pitch_of(rows, pitch_mm)
    config = Configuration(columns=size)
    plan = resampling(camera, (size, size))

    def on_grid(image: np.ndarray) -> np.ndarray:
        return np.clip(np.rint(plan.average(image)), 0, 255).astype(np.uint8)

    gains = captured_gains(on_grid(background)[None], config)
    kept: list[Press] = []
    frames, agreement = [], []
    for row in rows:
        try:
            image = read_picture(folder / row.name)
            if image.shape != background.shape:
                raise InputError(
                    f"{folder / row.name}: {image.shape[0]} x {image.shape[1]}, but background.png is "
                    f"{camera[0]} x {camera[1]}"
                )
            ball = row.diameter_mm / 2 / pitch
            found = None
            if compare or find or row.circle is None:
                found = find_circle(image, background, min(0.8 * ball, min(camera) / 2))
            circle = found if find else row.circle or found
            if circle is None:
                raise InputError(f"{folder / row.name}: shows no circle")
            if circle.radius >= ball:
                raise InputError(
                    f"{folder / row.name}: a contact of {circle.radius:.0f} pixels on a ball of {ball:.0f}"
                )
            press = Press(row.name, circle.x, circle.y, circle.radius, ball).on_grid(camera, size)
            if not (press.distance(size) < FITTED_SHARE).any():
                raise InputError(f"{folder / row.name}: the press is outside the frame's middle square")
        except InputError as error:
            notes.append(note(f"{error}: left out"))
            continue
        if row.circle and found:
            agreement.append(
                (found.x - row.circle.x, found.y - row.circle.y, found.radius - row.circle.radius),
            )
        kept.append(press)
        frames.append(on_grid(image))
    stack = np.array(frames, np.uint8).reshape(-1, size, size, 3)
    codes, colours = flat_codes(stack, gains, config), deviations(stack, gains, config)
    views = [View(*parts) for parts in zip(kept, stack, codes, colours, strict=True)]
    test = [view for view in views if view.press.margin(size) >= 0][1::2]
    held = {view.press.name for view in test}
    fitted = [view for view in views if view.press.name not in held]
    if len(fitted) < FEWEST_FITTED or len(test) < FEWEST_HELD_OUT:
        why = f"; {notes[0]}" if notes else ""
        raise InputError(
            f"{folder}: {len(fitted)} presses to fit and {len(test)} wholly in the frame to hold out: at least "
            f"{FEWEST_FITTED} and {FEWEST_HELD_OUT} are needed{why}"
        )
    return Presses(
        tuple(fitted), tuple(test), size, pitch, plan.scale, tuple(notes), np.array(agreement).reshape(-1, 3)
    )


# Fitting.


Depths = dict[str, np.ndarray]


def depths_of(feature: np.ndarray) -> np.ndarray:
    """Depth, grid pixels, that each number of a fit makes of its colour: (2 n, size, size) of (size, size, n), dz/dx
    first, then dz/dy. Neumann, in double precision: depth is linear in the numbers."""
    size, count = len(feature), feature.shape[-1]
    depths = []
    for axis in (0, 1):
        slopes = np.zeros((count, size, size, 2))
        slopes[..., axis] = np.moveaxis(feature, -1, 0)
        depths.append(reference.solve(divergence(slopes, True), True).astype(np.float32))
    return np.concatenate(depths)


def fit_quadratic(
    views: tuple[View, ...], pitch_mm: float, known: Depths | None = None
) -> tuple[np.ndarray, tuple[View, ...]]:
    """The coefficients, float64 (2, 3, 6), and the views with their presses moved to where the fit sees them.

    `known` keeps what `depths_of` finds, by press, from one fit to the next.
    """
    size, known = len(views[0].frame), {} if known is None else known
    terms = quadratic_terms(size, size, pitch_mm)
    features = [
        (view.deviations[..., None] * DEVIATION.lsb * terms[..., None, :]).reshape(size, size, -1) for view in views
    ]
    for view, feature in zip(views, features, strict=True):
        if view.press.margin(size) >= 0 and view.press.name not in known:
            known[view.press.name] = depths_of(feature)
    numbers = 2 * features[0].shape[-1]
    moved = views
    for again in range(RECENTRED + 1):
        squares, products = np.zeros((numbers, numbers)), np.zeros(numbers)
        for view, original, feature in zip(moved, views, features, strict=True):
            inside = view.press.distance(size) < FITTED_SHARE
            squares += np.kron(np.eye(2), feature[inside].T @ feature[inside])
            products += (feature[inside].T @ view.press.slopes(size)[inside]).T.ravel()
            if original.press.margin(size) >= 0:
                cap = np.array([view.press.recovered(depth) for depth in known[view.press.name]])
                squares += CAP_PIXELS * np.outer(cap, cap)
                products += CAP_PIXELS * cap
        fitted = np.linalg.lstsq(squares, products, rcond=None)[0].reshape(2, -1).T
        if again < RECENTRED:
            moved = tuple(
                replace(view, press=recentred(original.press, feature @ fitted))
                for view, original, feature in zip(moved, views, features, strict=True)
            )
    return fitted.T.reshape(2, *(len(terms[0, 0]) // 2, len(terms[0, 0]))), moved


def recentred(press: Press, slopes: np.ndarray) -> Press:
    """The press where its ball fits slopes (size, size, 2) best."""
    size = len(slopes)
    inside = press.distance(size) < FITTED_SHARE
    rows, columns = np.nonzero(inside)
    seen = slopes[inside]

    def error(at: np.ndarray) -> np.ndarray:
        x, y = columns - at[0], rows - at[1]
        drop = np.sqrt(np.maximum(press.ball_radius**2 - x**2 - y**2, 1))
        return np.concatenate((seen[:, 0] + x / drop, seen[:, 1] + y / drop))

    start = np.array((press.x, press.y))
    reach = FURTHEST_SHIFT * press.contact_radius
    x, y = least_squares(error, start, bounds=(start - reach, start + reach)).x
    return replace(press, x=float(x), y=float(y))


def colour_powers(colours: np.ndarray) -> np.ndarray:
    """All products of up to `PRIOR_DEGREE` colours: (..., 3) to (..., terms)."""
    products = [
        np.prod(colours[..., list(which)], axis=-1)
        for degree in range(PRIOR_DEGREE + 1)
        for which in combinations_with_replacement(range(3), degree)
    ]
    return np.stack(products, axis=-1)


def bins_of(codes: np.ndarray, bits: int) -> np.ndarray:
    red, green, blue = np.moveaxis(codes >> (8 - bits), -1, 0)
    return np.ravel_multi_index((red, green, blue), (1 << bits,) * 3)


def fit_table(views: tuple[View, ...], bits: int) -> tuple[np.ndarray, np.ndarray]:
    """The table of slopes, float64 (2**b, 2**b, 2**b, 2), multiples of 2**-FRACTION_BITS; and which bins were seen."""
    size, bins = len(views[0].frame), 1 << bits
    parts = {"contact": lambda r: r < FITTED_SHARE, "rest": lambda r: r > NOTHING_TOUCHES}
    count = {part: np.zeros(bins**3) for part in parts}
    squares: dict[str, np.ndarray] = {}
    slopes, products = np.zeros((bins**3, 2)), 0
    for view in views:
        index, truth = bins_of(view.codes, bits), view.press.slopes(size)
        powers = colour_powers(view.deviations * DEVIATION.lsb)
        for part, belongs in parts.items():
            where = belongs(view.press.distance(size))
            count[part] += np.bincount(index[where], minlength=bins**3)
            squares[part] = squares.get(part, 0) + powers[where].T @ powers[where]
        inside = parts["contact"](view.press.distance(size))  # elsewhere slopes are 0 and add nothing
        products = products + powers[inside].T @ truth[inside]
        for axis in (0, 1):
            slopes[:, axis] += np.bincount(index[inside], truth[inside][:, axis], bins**3)
    level = count["contact"].sum() / max(count["rest"].sum(), 1)
    polynomial = np.linalg.lstsq(squares["contact"] + level * squares["rest"], products, rcond=None)[0]
    middle = (np.arange(bins) + 0.5) * (256 / bins) - 0.5
    colours = np.stack(np.meshgrid(middle, middle, middle, indexing="ij"), axis=-1) / FLAT_CODE - 1
    prior = colour_powers(colours).reshape(bins**3, -1) @ polynomial
    steepness = np.linalg.norm(prior, axis=-1, keepdims=True)
    prior *= np.minimum(1, STEEPEST_PRIOR / np.maximum(steepness, 1e-9))
    weight = count["contact"] + level * count["rest"]
    table = (slopes + PRIOR_PIXELS * prior) / (weight + PRIOR_PIXELS)[:, None]
    shape = (bins, bins, bins)
    seen = (count["contact"] + count["rest"] > 0).reshape(shape)
    return np.rint(table.reshape(*shape, 2) * 2**FRACTION_BITS) / 2**FRACTION_BITS, seen


# What it achieved.


@dataclass(frozen=True)
class Score:
    """A model on a press, through the bit-accurate pipeline."""

    r2: float  # of the slopes inside the contact
    cap: float  # height recovered over the true one
    rest: float  # RMS slope where nothing touches


def slope_codes(view: View, model: str, calibration: Calibration, config: Configuration, pitch: float) -> np.ndarray:
    """As the hardware finds them, int64 (size, size, 2)."""
    if model == "lut":
        return gradient_lookup(view.codes, gradient_codes(calibration, config), config.bits_per_channel)
    return quadratic_gradient(view.deviations, polynomial_words(calibration, config, pitch), config)


def depth_px(slopes: np.ndarray, config: Configuration) -> np.ndarray:
    """Depth of slope codes as the hardware finds it, in grid pixels."""
    return solve(divergence(slopes, config.neumann), config) * config.depth_lsb_px


def score(view: View, slopes: np.ndarray, config: Configuration) -> Score:
    found, press, size = slopes * config.gradient_lsb, view.press, config.rows
    truth, distance = press.slopes(size), press.distance(size)
    inside, outside = distance < 1, distance > NOTHING_TOUCHES
    error = ((found - truth)[inside] ** 2).sum()
    r2 = 1 - error / ((truth[inside] - truth[inside].mean(axis=0)) ** 2).sum()
    rest = math.sqrt((found[outside] ** 2).mean()) if outside.any() else math.nan
    return Score(float(r2), press.recovered(depth_px(slopes, config)), rest)


def pipeline(calibration: Calibration, size: int) -> Configuration:
    """The configuration that results are measured on."""
    return Configuration(
        columns=size,
        neumann=True,
        gradient_limit=calibration.gradient_limit,
        bits_per_channel=calibration.bits_per_channel if calibration.gradient is not None else BITS,
    )


def summary(scores: list[Score]) -> dict[str, float]:
    caps = [one.cap for one in scores]
    return {
        "r2": float(np.mean([one.r2 for one in scores])),
        "cap_mean": float(np.mean(caps)),
        "cap_spread": float(np.std(caps)),
        "rest": float(np.nanmean([one.rest for one in scores])),
    }


def table(measured: list[View], scores: dict[str, list[Score]], seen: np.ndarray | None) -> str:
    """Press by press, and all together."""
    head = "".join(f"{model:>24}" for model in scores)
    names = "".join(f"{'slope R2':>12}{'cap height':>12}" for _ in scores)
    lines = [f"{'held out':<20}{head}", f"{'':<20}{names}"]
    for index, view in enumerate(measured):
        cells = "".join(f"{rows[index].r2:>12.3f}{rows[index].cap:>12.3f}" for rows in scores.values())
        lines.append(f"{view.press.name[-19:]:<20}{cells}")
    for label, key in (
        ("mean", ""),
        ("spread", "cap_spread"),
        ("RMS slope at rest", "rest"),
    ):
        cells = ""
        for rows in scores.values():
            found = summary(rows)
            cells += f"{found['r2']:>12.3f}{found['cap_mean']:>12.3f}" if not key else f"{found[key]:>24.3f}"
        lines.append(f"{label:<20}{cells}")
    if seen is not None:
        bits = seen.shape[0].bit_length() - 1
        met = np.concatenate(
            [seen.ravel()[bins_of(view.codes, bits)[view.press.distance(len(view.frame)) < 1]] for view in measured]
        )
        lines.append(
            f"table of {bits} bits a colour: {100 * seen.mean():.1f} % of its bins were seen in the fit, and "
            f"{100 * met.mean():.1f} % of the pixels of the held-out contacts fall into those"
        )
    return "\n".join(lines)


# The command.


@dataclass(frozen=True)
class Request:
    presses: Path | None
    models: tuple[str, ...]
    pitch_mm: float | None
    bits: int
    find: bool
    each: bool
    out: Path | None


def parse(arguments: list[str]) -> Request:
    """KEY=VALUE arguments; an empty value means the default.

    Raises
    ------
    InputError
    """
    accepted = ("PRESSES", "GRADIENT", "PITCH", "BITS", "CIRCLES", "HELD_OUT", "OUT")
    given = defaultdict(str, variables.given(arguments, accepted))
    models = {"": MODELS, "both": MODELS, **{model: (model,) for model in MODELS}}
    if given["GRADIENT"] not in models:
        raise InputError(f"GRADIENT={given['GRADIENT']}: accepted are {', '.join(filter(None, models))}")

    if given["CIRCLES"] not in ("", "table", "found"):
        raise InputError(
            f"CIRCLES={given['CIRCLES']}: accepted are table (where it has them) and found (in the pictures)"
        )
    if given["HELD_OUT"] not in ("", "second", "each"):
        raise InputError(
            f"HELD_OUT={given['HELD_OUT']}: accepted are second and each: whole presses left out of the fit"
        )
    out = Path(given["OUT"]) if given["OUT"] else None
    if out is not None and out.suffix != ".npz":
        raise InputError(f"OUT={out}: give the name of an .npz file")
    return Request(
        Path(given["PRESSES"]) if given["PRESSES"] else None,
        models[given["GRADIENT"]],
        variables.number(given, "PITCH", None, 1e-6, 1e3, float),
        variables.number(given, "BITS", BITS, *BITS_PER_CHANNEL),
        given["CIRCLES"] == "found",
        given["HELD_OUT"] == "each",
        out,
    )


@dataclass(frozen=True)
class Fit:
    """What some presses make of the models asked for; `seen`: bins of the table; `moved`: the presses, recentred."""

    calibration: Calibration
    seen: np.ndarray | None
    moved: tuple[View, ...]


def fitted(presses: Presses, views: tuple[View, ...], request: Request, name: str, known: Depths) -> Fit:
    coefficients, moved = fit_quadratic(views, presses.grid_pitch_mm, known)
    gradient, seen = fit_table(moved, request.bits) if "lut" in request.models else (None, None)
    quadratic = "quadratic" in request.models
    calibration = Calibration(
        name,
        gradient,
        presses.pitch_mm,
        coefficients if quadratic else None,
        max(view.press.largest_slope for view in views) if quadratic else 0.0,
    )
    return Fit(calibration, seen, moved)


def scores_of_each(presses: Presses, request: Request, known: Depths) -> dict[str, list[Score]]:
    """Of every whole press, by a fit to all others."""
    every = presses.fitted + presses.held_out
    scores: dict[str, list[Score]] = {model: [] for model in request.models}
    whole = [view for view in every if view.press.margin(presses.size) >= 0]
    for one in tqdm(whole, "holding out", leave=False, disable=None):
        others = tuple(view for view in every if view is not one)
        calibration = fitted(presses, others, request, "others", known).calibration
        config = pipeline(calibration, presses.size)
        for model, rows in scores.items():
            rows.append(score(one, slope_codes(one, model, calibration, config, presses.grid_pitch_mm), config))
    return scores


def run(request: Request) -> int:
    folder = data_folder() if request.presses is None else request.presses
    presses = load_presses(folder, request.pitch_mm, compare=True, find=request.find)
    for note in presses.notes:
        print(f"make calibrate: {note}", file=sys.stderr)
    out = request.out or simulation.ROOT / "build" / "calibrate" / f"{folder.resolve().name}.npz"
    known: Depths = {}
    fit = fitted(presses, presses.fitted, request, out.stem, known)
    calibration, config, pitch = fit.calibration, pipeline(fit.calibration, presses.size), presses.grid_pitch_mm
    slopes = {
        model: [slope_codes(view, model, calibration, config, pitch) for view in presses.held_out]
        for model in request.models
    }
    if request.each:
        scores = scores_of_each(presses, request, known)
        measured = [view for view in presses.fitted + presses.held_out if view.press.margin(presses.size) >= 0]
    else:
        measured = list(presses.held_out)
        scores = {
            model: [score(view, codes, config) for view, codes in zip(measured, found, strict=True)]
            for model, found in slopes.items()
        }
    best = max(scores, key=lambda model: summary(scores[model])["r2"])
    moved = [
        math.hypot(new.press.x - old.press.x, new.press.y - old.press.y) * presses.scale
        for new, old in zip(fit.moved, presses.fitted, strict=True)
    ]
    print(
        f"{len(presses.fitted)} presses fitted, {len(presses.held_out)} held out"
        f"{f' (below: {len(measured)} in turn)' if request.each else ''}, {presses.pitch_mm:g} mm per pixel, "
        f"grid of {presses.size}; centres of the fitted moved by {np.median(moved):.1f} pixels (median)"
    )
    if len(presses.agreement):
        x, y, radius = np.median(presses.agreement, axis=0)
        spread = np.median(np.abs(presses.agreement - (x, y, radius)), axis=0)
        print(
            f"circles found in {len(presses.agreement)} pictures, against the table's: x {x:+.1f} ({spread[0]:.1f}), "
            f"y {y:+.1f} ({spread[1]:.1f}), radius {radius:+.1f} ({spread[2]:.1f}) pixels, median (and deviation)"
        )
    print(table(measured, scores, fit.seen))
    gradient = calibration.gradient
    arrays = {"gradient": gradient if gradient is None else gradient.astype(np.float16), "coefficients": None}
    if calibration.coefficients is not None:
        arrays |= {"coefficients": calibration.coefficients, "largest_slope": np.float64(calibration.largest_slope)}
    try:
        out.parent.mkdir(parents=True, exist_ok=True)
        np.savez_compressed(
            out,
            pixel_pitch_mm=presses.pitch_mm,
            model=best,
            held_out=[view.press.name for view in presses.held_out],
            **{key: value for key, value in arrays.items() if value is not None},
        )
        picture = draw_presses(out.with_suffix(".png"), presses, slopes, best, config)
    except OSError as error:
        raise InputError(f"OUT={out} cannot be written ({error.strerror})") from error
    print(f"the better model is {best}: the default in {os.path.relpath(out)} ({out.stat().st_size / 1024:.1f} KiB)")
    print(f"picture: {os.path.relpath(picture)}")
    return 0


def draw_presses(
    path: Path, presses: Presses, slopes: dict[str, list[np.ndarray]], best: str, config: Configuration
) -> Path:
    """Held-out presses from the first to the last: frame, slopes, depth, and a cut beside the ball."""
    pitch = presses.grid_pitch_mm
    shown = np.unique(np.linspace(0, len(presses.held_out) - 1, PRESSES_DRAWN).round().astype(int))
    drawn = []
    for index in shown:
        view = presses.held_out[index]
        press, depths = view.press, {model: depth_px(found[index], config) for model, found in slopes.items()}
        x, y = press.circle()
        row = min(max(round(press.y + 0.5), 0), presses.size - 1)
        across = np.arange(presses.size) - press.x - 0.5
        squared = across**2 + (row - press.y - 0.5) ** 2
        ball = np.sqrt(np.maximum(press.ball_radius**2 - squared, 0)) - (press.ball_radius - press.cap_height)
        cuts = {
            model: (depth[row] - map_coordinates(depth, [y, x], order=1, mode="nearest").mean()) * pitch
            for model, depth in depths.items()
        }
        drawn.append(
            draw.DrawnPress(
                name=press.name,
                frame=view.frame,
                slopes=slopes[best][index] * config.gradient_lsb,
                depth=depths[best] * pitch,
                circle=(x * pitch, y * pitch),
                across=across * pitch,
                ball=np.where(squared < press.contact_radius**2, ball * pitch, np.nan),
                cuts=cuts,
            )
        )
    draw.draw_presses(path, drawn, presses.size * pitch, f"held-out presses, {best}, Neumann, {presses.size}")
    return path


def main() -> None:
    with variables.reported("calibrate"):
        sys.exit(run(parse(sys.argv[1:])))


if __name__ == "__main__":
    main()
