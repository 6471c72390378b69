# SPDX-License-Identifier: Apache-2.0
"""`make budget`: the error of depth in mm, and what it is made of, on drawn contacts and on real ball presses.

The depth of a picture is computed again and again, from the codes of a real sensor's pipeline to the true height; each
step switches one cause of error off, or puts the truth in its place. The differences of the steps are maps, and add up
to the map of the whole error. For the mean square of an area, less its mean (Neumann gives differences of depth alone):

    RMS of a part      root of <e_part, e_part>
    share of a part    <e_part, e> / <e, e>, e the whole error: shares add up to 1, and can be negative

Intervals are 95 % by bootstrap over the pictures. Drawn contacts: the bench (scenes.py) by the sensor of
drawn_sensor.py, calibrated with presses drawn by it, in light that drifted. Real presses: each by a calibration from
all others. Their pictures get drift and noise on top of what they hold, because neither is known: the parts are those
of what was added, and the rest lies in the calibration. A ball is known in its contact, and gel that nothing touches is
flat; how far the gel beside a contact is displaced is not known, and a part of its own.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from matplotlib.figure import Figure
from scipy.ndimage import distance_transform_edt

import tactile_depth as td
from commands.common import recorded, repository, variables
from commands.common.press_data import data_folder, pixels
from commands.common.progress import progress_bar
from commands.common.results import save, written
from commands.common.run_request import camera_choice
from commands.common.tabular import Table
from commands.common.variables import Place, Several, one, real
from commands.study.budget_steps import (
    BACK,
    BESIDE,
    FRONT,
    MEASURES,
    Camera,
    Exact,
    Seen,
    height_between,
    height_of_cap,
    parts_of,
    products,
)
from commands.study.drawn_sensor import PLACES, DrawnSensor, heights
from commands.study.study import VERSION
from tactile_depth.base.errors import InputError
from tactile_depth.calibrate.fitting import Fit, fit_presses
from tactile_depth.calibrate.press_pictures import PressPictures, camera_pitch_mm, gather
from tactile_depth.calibrate.presses import AT_REST, GridPresses, to_grid
from tactile_depth.chip.camera_configuration import CameraChoice
from tactile_depth.chip.configuration import COEFFICIENT, DEFAULTS, SOLVER_NUMBERS, STORED
from tactile_depth.chip.limits import BOUNDARIES
from tactile_depth.sensor.calibration_file import PIXEL_PITCHES_MM
from tactile_depth.sensor.scenes import BENCH

AREAS = {"contact": "contact", "untouched": "untouched gel"}  # of the table of shares, by measure
NUMBERS = tuple(number.variable for number in SOLVER_NUMBERS.values())
RESULTS = ("budget.json", "budget.png")
DEFAULT_OUT = repository.ROOT / "build" / "budget"
INTERRUPTED = "nothing was written"
CAMERA = "raw8"
PRESSES = 30  # of the drawn calibration
UNTOUCHED_MM = 2.0  # from displaced gel; of a press `AT_REST`
CAP_TOP, CAP_EDGE = 0.9, 0.1  # of the peak: the top of a drawn contact, above, and its edge, below
RESAMPLED, INTERVAL = 2000, (2.5, 97.5)


def _camera(values: Mapping[str, str]) -> CameraChoice:
    choice = camera_choice({"CAMERA": CAMERA, **values})
    assert choice is not None
    return choice


def _numbers(values: Mapping[str, str]) -> dict[str, Any]:
    given = {
        name: variables.number(values, each.variable, DEFAULTS[name], *each.accepted)
        for name, each in SOLVER_NUMBERS.items()
    }
    return DEFAULTS | given


@dataclass(frozen=True)
class BudgetRun:
    """Presses, real ones of a folder and drawn ones, and the pipeline; no variable gives the last three fields."""

    folder: Annotated[Place, "PRESSES"] | None = None
    pitch_mm: Annotated[float | None, real(*PIXEL_PITCHES_MM), "PITCH"] = None
    choice: Annotated[CameraChoice, Several(("CAMERA", "BAYER"), _camera)] = field(
        default_factory=lambda: CameraChoice(CAMERA)
    )
    neumann: Annotated[bool, one({name: name == "neumann" for name in BOUNDARIES}), "BOUNDARY"] = True
    numbers: Annotated[Mapping[str, Any], Several(NUMBERS, _numbers)] = field(default_factory=lambda: DEFAULTS)
    out: Place = DEFAULT_OUT
    drawn: DrawnSensor = field(default_factory=DrawnSensor)
    presses: int = PRESSES
    bodies: int = len(BENCH)

    def pipeline(self, sensor: td.Sensor, background: np.ndarray) -> td.Pipeline:
        """Return the pipeline of a sensor with a background on the grid."""
        return td.Pipeline(
            sensor,
            background,
            grid=(len(background), background.shape[1]),
            boundary=BOUNDARIES[not self.neumann],
            **self.numbers,
        )


# Sources.


def fitted(presses: GridPresses) -> Fit:
    return fit_presses(presses, ("cubic",), progress=lambda each: progress_bar(each, "fits"))


def drawn_contacts(request: BudgetRun) -> Iterator[tuple[str, dict[str, np.ndarray]]]:
    """Give place and products of each drawn contact."""
    drawn, chance = request.drawn, np.random.default_rng(1)
    pictures = drawn.presses(request.presses, chance)
    presses = to_grid(pictures, drawn.pitch_mm, choice=request.choice)
    fit = fitted(presses)
    camera = Camera.of(presses, request.choice)
    rest = camera.average(drawn.levels(np.zeros((*drawn.camera, 2))))
    pipeline = request.pipeline(fit.sensor, presses.background_on_grid)
    rests = (presses.background_on_grid, camera.rounded(presses.background), rest)
    exact = [Exact(pipeline, each) for each in rests]
    scale, pitch = presses.scale, presses.grid_pitch_mm
    for place, height in drawn.contacts(request.bodies, fit.sensor.fitted_slope["cubic"], chance):
        slopes = drawn.slopes(height)
        steady = drawn.levels(slopes)
        levels = steady * drawn.light(chance)
        true = heights(height, presses.grid, scale * drawn.pitch_mm, (-0.5, -0.5)) / pitch
        top, edge = true > CAP_TOP * true.max(), (true > 0) & (true < CAP_EDGE * true.max())
        seen = Seen(
            place,
            drawn.picture(levels, chance),
            levels,
            steady,
            camera.average(slopes),
            None,
            true,
            true > 0,
            distance_transform_edt(true <= 0) * pitch > UNTOUCHED_MM,
            height_between(top, edge),
        )
        yield place, products(seen, parts_of(seen, camera, exact, follow=False))


def real_presses(request: BudgetRun, pictures: PressPictures) -> Iterator[tuple[str, dict[str, np.ndarray]]]:
    """Give place and products of each whole press, by the calibration from all others."""
    presses = to_grid(pictures, camera_pitch_mm(pictures, request.pitch_mm), choice=request.choice)
    fit = fitted(presses)
    camera, chance = Camera.of(presses, request.choice), np.random.default_rng(1)
    rest = presses.background_on_grid, camera.rounded(presses.background), camera.average(presses.background)
    by_name = {press.name: press for press in pictures.presses}
    for view in presses.views:
        press = view.press
        if press.name not in fit.without:
            continue
        steady = pixels(by_name[press.name])
        levels = steady * request.drawn.light(chance)
        pipeline = request.pipeline(replace(fit.without[press.name], camera=fit.sensor.camera), rest[0])
        distance, height = press.distance, press.depth
        seen = Seen(
            PLACES[0] if press.is_central else PLACES[1],
            request.drawn.picture(levels, chance),
            levels,
            steady,
            press.slopes,
            ((distance < 1) | (distance > AT_REST))[..., None],
            np.nan_to_num(height),
            np.isfinite(height),
            press.untouched,
            height_of_cap(press),
        )
        exact = [Exact(pipeline, each) for each in rest]
        yield seen.place, products(seen, parts_of(seen, camera, exact, follow=True))


# Statistics.


def numbers_of(means: np.ndarray) -> dict[str, np.ndarray]:
    """Return RMS of parts and whole, and shares, of mean products (..., parts, parts)."""
    squares, whole = np.diagonal(means, axis1=-2, axis2=-1), means.sum(axis=(-2, -1))
    apart = squares.sum(axis=-1)
    return {
        "rms_um": 1000 * np.sqrt(squares),
        "share": means.sum(axis=-1) / whole[..., None],
        "whole_um": 1000 * np.sqrt(whole),
        "root_of_squares_um": 1000 * np.sqrt(apart),
        "root_of_squares_over_whole": np.sqrt(apart / whole),
    }


def correlated(means: np.ndarray) -> tuple[int, int, float]:
    """Return the two parts whose product adds most to the whole, up or down, and their correlation."""
    pairs = np.triu(means, 1)
    first, second = np.unravel_index(np.abs(pairs).argmax(), pairs.shape)
    return int(first), int(second), float(pairs[first, second] / np.sqrt(means[first, first] * means[second, second]))


def summary(each: np.ndarray) -> dict[str, Any]:
    """Return the numbers of products (pictures, parts, parts) and their intervals, as lists [value, low, high]."""
    count = len(each)
    weights = np.random.default_rng(1).multinomial(count, np.full(count, 1 / count), RESAMPLED) / count
    value, resampled = numbers_of(each.mean(axis=0)), numbers_of(np.tensordot(weights, each, 1))
    intervals = {
        name: np.stack((value[name], *np.percentile(resampled[name], INTERVAL, axis=0)), axis=-1).tolist()
        for name in value
    }
    return intervals | {"correlated": correlated(each.mean(axis=0))}


def source(
    name: str, parts: Sequence[str], pictures: Iterator[tuple[str, dict[str, np.ndarray]]], count: int
) -> dict[str, Any]:
    """Return the numbers of a source by place and measure."""
    found: dict[str, list[dict[str, np.ndarray]]] = {}
    for place, each in progress_bar(pictures, name, count):
        found.setdefault(place, []).append(each)
    places = {
        place: {"pictures": len(found[place])}
        | {measure: summary(np.array([each[measure] for each in found[place]])) for measure in MEASURES}
        for place in PLACES
        if place in found
    }
    return {"source": name, "parts": list(parts), "places": places}


# Results.


def setting(document: dict[str, Any]) -> str:
    """Return what was measured, in a sentence."""
    used = document["setting"]
    return (
        f"The pipeline of a real sensor, {used['boundary']}, {used[STORED]}-bit words and "
        f"{used[COEFFICIENT]}-bit coefficients, behind a camera that sends {used['camera']}, with noise of "
        f"{used['noise']:g} grey levels; light up to {100 * used['drift']:g} % off, and each colour up to "
        f"{100 * used['white']:g} % more. RMS errors, less the mean of the area, and "
        "95 % intervals by bootstrap over the pictures"
    )


OVER_WHOLE = "root of the sum of squares, over the whole"


def interval(three: Sequence[float], form: str = "{:.3g}", factor: float = 1) -> str:
    """Return a value and its interval as text."""
    value, low, high = (form.format(factor * each) for each in three)
    return f"{value} ({low} to {high})"


def whole_errors(document: dict[str, Any]) -> Table:
    """Return the table of the whole error of each source and place."""
    head = ("error, mm", "pictures", *MEASURES.values())
    rows = [
        (
            f"{each['source']}, {place}",
            str(found["pictures"]),
            *(interval(found[measure]["whole_um"], "{:.3f}", 1e-3) for measure in MEASURES),
        )
        for each in document["sources"]
        for place, found in each["places"].items()
    ]
    return Table(head, rows, "In short")


def tables(document: dict[str, Any]) -> list[Table]:
    """Return the whole error, then the parts of each source and measure."""
    made = [whole_errors(document)]
    for each in document["sources"]:
        for measure, title in MEASURES.items():
            columns = [
                ("part", *each["parts"], "sum: the whole error", OVER_WHOLE, "largest cross term, its correlation")
            ]
            for place, found in each["places"].items():
                of = found[measure]
                first, second, correlation = of["correlated"]
                um = [interval(three) for three in (*of["rms_um"], of["whole_um"], of["root_of_squares_um"])]
                shares = [interval(three, "{:z.1f}", 100) for three in of["share"]]
                over = interval(of["root_of_squares_over_whole"], "{:.2f}")
                columns.append((f"{place}, um RMS", *um, f"{each['parts'][first]}, {each['parts'][second]}"))
                columns.append(("share, %", *shares, "100", over, f"{correlation:.2f}"))
            head, *rows = zip(*columns, strict=True)
            made.append(Table(head, rows, f"{each['source']}, {title}"))
    return made


def shares(each: dict[str, Any]) -> Table:
    """Return a source's table: RMS of each part in um, and its share of the mean square."""
    columns = [(each["source"], *each["parts"], "whole error", OVER_WHOLE)]
    for name, area in AREAS.items():
        for place, found in each["places"].items():
            of = found[name]
            both = zip(of["rms_um"], of["share"], strict=True)
            parts = (f"{um:.2g} ({100 * share:z.0f} %)" for (um, *_), (share, *_) in both)
            over = interval(of["root_of_squares_over_whole"], "{:.2f}")
            columns.append((f"{area}, {place}", *parts, f"{of['whole_um'][0]:.1f}", over))
    head, *rows = zip(*columns, strict=True)
    return Table(head, rows)


def sources(arguments: Sequence[str]) -> str:
    """Return the digest of models and command, for docs/figures.json."""
    variables.read(BudgetRun, arguments)
    files_of = [Path(__file__).parent / f"{name}.py" for name in ("budget", "budget_steps", "drawn_sensor")]
    return recorded.digest(files_of, VERSION)


def plot(path: Path, document: dict[str, Any]) -> None:
    """Draw the RMS of each part as bars, by source and measure."""
    colours = dict(zip(PLACES, ("#08519c", "#e6550d", "#969696"), strict=True))
    sources, measures = document["sources"], ("contact", "untouched")
    figure = Figure(figsize=(11, 0.7 + 3.6 * len(sources)), layout="constrained")
    axes = figure.subplots(len(sources), len(measures), squeeze=False)
    for row, each in zip(axes, sources, strict=True):
        names = [*each["parts"], "whole error"]
        for axis, measure in zip(row, measures, strict=True):
            for number, (place, found) in enumerate(each["places"].items()):
                rms = np.array([*found[measure]["rms_um"], found[measure]["whole_um"]])
                at = np.arange(len(names)) + (number - (len(each["places"]) - 1) / 2) * 0.26
                ends = np.abs(rms[:, 1:] - rms[:, :1]).T
                style: dict[str, Any] = {"color": colours[place], "label": place, "error_kw": {"lw": 0.8}}
                bars = axis.barh(at, rms[:, 0], 0.24, xerr=ends, **style)
                axis.bar_label(bars, [f"{value:.2g}" for value in rms[:, 0]], padding=3, fontsize=7)
            axis.set(title=f"{each['source']}: {MEASURES[measure]}", yticks=range(len(names)), yticklabels=names)
            axis.set(xlabel="um RMS", xlim=(0, 1.1 * axis.get_xlim()[1]))
            axis.invert_yaxis()
            axis.grid(axis="x", alpha=0.3)
            axis.set_axisbelow(True)
    handles, labels = axes[0, 0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=len(labels))
    figure.savefig(path, dpi=110)


def run(request: BudgetRun) -> None:
    """Measure, print, and write budget.json and budget.png. Raises InputError."""
    with written(request.out, RESULTS) as work:
        missing, folder = "", request.folder
        try:
            folder = folder or data_folder()
        except InputError as error:
            missing = str(error)
        pictures = None if folder is None else gather(folder)
        drawn = drawn_contacts(request)
        sources = [source("drawn contacts", (*FRONT, *BACK), drawn, len(PLACES) * request.bodies)]
        if pictures is not None:
            real = real_presses(request, pictures)
            sources.append(source("real presses", (*FRONT, BESIDE, *BACK), real, len(pictures.presses)))
        used = {
            "camera": request.choice.pixel_format,
            "boundary": BOUNDARIES[not request.neumann],
            **{name: request.numbers[name] for name in SOLVER_NUMBERS},
            "drift": request.drawn.drift,
            "white": request.drawn.white,
            "noise": request.drawn.noise,
        }
        document = {"setting": used, "without": missing, "sources": sources}
        print(f"{setting(document)}\n")
        print(*tables(document), sep="\n\n", end="\n\n")
        save(work / RESULTS[0], document)
        plot(work / RESULTS[1], document)
        if missing:
            print(f"no real presses were measured: {missing}")


def main(request: BudgetRun) -> None:
    run(request)
    document = json.loads((request.out / RESULTS[0]).read_text())
    if not document["without"]:
        recorded.record(recorded.rounded(document))
