# SPDX-License-Identifier: Apache-2.0
"""Rows of `make extremes PRESET=sensor`: a real sensor's pipeline at its limits, as error in mm against drawn heights.

Each row is a stream through the RTL, and its worst picture by itself through `td.Pipeline`, which may refuse or warn.
"""

import warnings
from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from itertools import product
from pathlib import Path

import numpy as np

from commands.common import run_request, tabular
from commands.common.progress import progress_bar
from commands.common.results import save, written
from commands.run import sim
from commands.study import long_state
from commands.study.drawn_light import DrawnLight, exact
from commands.study.drawn_sensor import Height, flat
from tactile_depth.base import files
from tactile_depth.base.errors import InputError, InputWarning
from tactile_depth.chip.configuration import STORED, WIDTHS, WORDS, Configuration
from tactile_depth.chip.registers.register_map import REGISTERS
from tactile_depth.depth.pipeline import Pipeline
from tactile_depth.depth.twin import Twin
from tactile_depth.pictures.frames import camera_scale
from tactile_depth.sensor.presets import CHIP, THRESHOLD_MM
from tactile_depth.sensor.sensor import Sensor

RESULTS = ("extremes.json",)
CHOSEN = {WORDS[name]: f"{value:g}" for name, value in CHIP.words.items()}
GRID = {"ROWS": "48", "COLS": "64"}
RIGHT = 0.03  # of the true height: a map so near to the first of the stream is right again
STATUS_BITS = ("saturation", "dark")

Colours = tuple[float, float, float]
EVEN: Colours = (1.0, 1.0, 1.0)
OFF: Colours = (0.0, 0.0, 0.0)
DIM = 0.6  # exposure that leaves room for twice the light
FOLLOWING = 16  # frames after a change of the light
DRIFT = 1.01  # of the light from frame to frame


def untouched(drawn: DrawnLight) -> Height:
    return flat


@dataclass(frozen=True)
class Case:
    """Row of the table: a stream of one height in changing light.

    Attributes
    ----------
    height, reference : functions of the drawn sensor to a height; `height` None: the pictures show none
    lights : light of each frame over that of the reference
    exposure : light of all pictures
    tilt : change of the light of the frames from the middle to the sides
    paint : changes the reference, and the frames
    saturates : True if values must saturate, False if they must not, None if they may
    """

    name: str
    height: Callable[[DrawnLight], Height] | None
    lights: tuple[Colours, ...] = (EVEN,) * 3
    reference: Callable[[DrawnLight], Height] = untouched
    exposure: float = 1.0
    tilt: float = 0.0
    paint: Callable[[np.ndarray, np.ndarray], None] = lambda reference, frames: None
    saturates: bool | None = False


def ball(drawn: DrawnLight) -> Height:
    return drawn.body("ball", 0.06 * drawn.width_mm)


def ball_beside(drawn: DrawnLight) -> Height:
    return drawn.body("ball", 0.06 * drawn.width_mm, -drawn.width_mm / 4)


def too_deep(drawn: DrawnLight) -> Height:
    """Return a cone half as deep again as the depth range."""
    return drawn.body("cone", 1.5 * float(CHOSEN["DEPTH_RANGE"]))


def grazing_edge(drawn: DrawnLight) -> Height:
    """Return a straight ridge that crosses the picture nearly along its rows, 0.2 mm high and 2 mm wide at half."""

    def height(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        return 0.1 * (1 + np.cos(np.pi * np.minimum(np.abs(y - 0.1 * x) / 2, 1)))

    return height


def bowl(drawn: DrawnLight) -> Height:
    """Return a contact 1 mm deep in the middle that reaches 0 in the corners: nothing is untouched."""
    corner = np.hypot(*drawn.grid) / 2 * drawn.pitch_mm
    return lambda x, y: 1 - (x**2 + y**2) / corner**2


def plate(drawn: DrawnLight) -> Height:
    """Return a flat plate, pressed 0.5 mm deep, that is larger than the picture."""
    return lambda x, y: flat(x, y) + 0.5


def checkerboard(drawn: DrawnLight) -> Height:
    """Return pixels up and down in turn, as steep as the steepest slope that the calibration was fitted to."""
    step = drawn.sensor.fitted_slope["cubic"] / np.sqrt(2) * drawn.pitch_mm
    return lambda x, y: step * (np.rint((x + y) / drawn.pitch_mm) % 2)


def _step(*light: float) -> tuple[Colours, ...]:
    red, green, blue = light * 3 if len(light) == 1 else light
    return (EVEN, EVEN, *((red, green, blue),) * FOLLOWING)


def _drift(to: float) -> tuple[Colours, ...]:
    rate = DRIFT if to > 1 else 1 / DRIFT
    count = int(np.log(to) / np.log(rate))
    return tuple((rate**n, rate**n, rate**n) for n in range(count))


def _chequered(reference: np.ndarray, frames: np.ndarray) -> None:
    frames[:] = 255 * (np.indices(frames.shape[1:3]).sum(axis=0)[..., None] % 2)


def _noise(reference: np.ndarray, frames: np.ndarray) -> None:
    frames[:] = np.random.default_rng(1).integers(0, 256, frames.shape)


def _dead(level: int, in_reference: bool) -> Callable[[np.ndarray, np.ndarray], None]:
    def paint(reference: np.ndarray, frames: np.ndarray) -> None:
        row, column = (length // 4 for length in reference.shape[:2])
        frames[:, row, column] = level
        if in_reference:
            reference[row, column] = level

    return paint


CASES = (
    Case("ball", ball),
    Case("no contact", untouched),
    Case("long grazing edge", grazing_edge),
    Case("contact over the whole gel", bowl),
    Case("the same, then 10 % more light", bowl, _step(1.1), saturates=None),
    Case("flat plate over the whole gel", plate),
    Case("checkerboard at the limit of slope", checkerboard),
    Case("checkerboard of black and white", None, paint=_chequered, saturates=True),
    Case("white noise", None, paint=_noise, saturates=True),
    Case("deeper than DEPTH_RANGE", too_deep, saturates=True),
    Case("light off for one frame", ball, (EVEN, EVEN, OFF, *(EVEN,) * FOLLOWING), saturates=None),
    Case("a black pixel in the picture", ball, paint=_dead(0, in_reference=False)),
    Case("a white pixel in the picture", ball, paint=_dead(255, in_reference=False), saturates=None),
    Case("the same black pixel in the reference too", ball, paint=_dead(0, in_reference=True)),
    Case("the same white pixel in the reference too", ball, paint=_dead(255, in_reference=True), saturates=None),
    Case("light x 0.8", ball, _step(0.8), saturates=None),
    Case("light x 1.25", ball, _step(1.25), saturates=None),
    Case("light x 1.125", ball, _step(1.125), exposure=DIM, saturates=None),
    Case("no contact, light x 1.6", untouched, _step(1.6), exposure=DIM, saturates=None),
    Case("light x 0.51", ball, _step(0.51), saturates=None),
    Case("light x 1.99", ball, _step(1.99), exposure=DIM, saturates=None),
    Case("light x 0.4", ball, _step(0.4), saturates=None),
    Case("light x 2.5", ball, _step(2.5), exposure=DIM, saturates=None),
    Case("light down to 0.51, 1 % a frame", ball, _drift(0.51)),
    Case("light up to 1.99, 1 % a frame", ball, _drift(1.99), exposure=DIM, saturates=None),
    Case("light up and down by 10 % in turn", ball, ((1.1,) * 3, (0.9,) * 3) * 4, saturates=None),
    Case("5 % more light at one side, 5 % less at the other", ball, tilt=0.05),
    Case("other white balance, red x 1.4, blue x 0.7", ball, _step(1.4, 1.0, 0.7), saturates=None),
    Case("overexposed, light x 2 with its reference", ball, exposure=2.0),
    Case("reference taken while touching", ball, reference=ball_beside),
    Case("no contact, reference taken while touching", untouched, reference=ball),
)


@dataclass(frozen=True)
class Errors:
    """Error of a map against the drawn height, mm; heights are above the mean of what is less deep than THRESHOLD_MM.

    Attributes
    ----------
    height : float
        Of the highest point, signed.
    untouched : float or None
        RMS where nothing touches; None where all touches.
    largest : float
        At any pixel.
    """

    height: float
    untouched: float | None
    largest: float


@dataclass(frozen=True)
class SensorRow:
    """Result of a case. Errors in mm; None where no height is drawn.

    Attributes
    ----------
    first, worst, last : Errors or None
        Of the first frame, of the frame with the largest error of the height, and of the last one.
    right_after : int or None
        Frames after the last change of the light until maps are as the first one again; None: never, or no change.
    alone : Errors or None
        Of the worst picture by itself, in the Python package; None: it is refused.
    python : str
        Refusal or warnings of the package, "" for none.
    chip_mm : float
        Largest RMS difference of a frame to double precision, clipped values included; dark frames left out.
    """

    case: str
    words: str
    frames: int
    first: Errors | None
    worst: Errors | None
    last: Errors | None
    right_after: int | None
    alone: Errors | None
    python: str
    chip_mm: float
    saturations: dict[str, int]
    status: tuple[str, ...]
    bit_exact: bool
    registers_agree: bool


def configurations(request: run_request.Request, sensor: DrawnLight) -> list[run_request.Request]:
    """Return the request, and that with the narrowest words that its grid and depth range take."""
    narrow = {**request.numbers, **{name: width.accepted[0] for name, width in WIDTHS.items()}}
    least, most = WIDTHS[STORED].accepted
    for bits in range(least, most + 1):
        each = replace(request, numbers=narrow | {STORED: bits})
        try:
            run_request.configure(each, on_grid(sensor, sensor.untouched.astype(np.uint8)))
        except InputError:
            continue
        return [request, each]
    return [request]


def draw(request: run_request.Request) -> DrawnLight:
    """Return the drawn sensor of a request. Raises InputError: the grid has not the aspect of the whole picture."""
    sensor = exact(run_request.load_sensor(request))
    sensor.zoom((request.rows, request.columns), f"ROWS={request.rows} and COLS={request.columns}")
    config = Configuration(rows=request.rows, columns=request.columns, solver=request.solver)
    return DrawnLight(sensor, (config.rows, config.columns), camera_scale(sensor, config))


def untouched_picture(drawn: DrawnLight, exposure: float = 1.0) -> np.ndarray:
    """Return a picture without contact, uint8 (rows, columns, 3)."""
    return drawn.pictures(drawn.untouched, [(exposure,) * 3], seed=1)[0]


def on_grid(drawn: DrawnLight, reference: np.ndarray) -> Sensor:
    """Return the drawn sensor on its grid, with a reference."""
    return drawn.sensor.scaled(drawn.scale, reference)


def measure(case: Case, request: run_request.Request, drawn: DrawnLight, rtl: bool = True) -> SensorRow:
    """Stream a case through model and RTL, and its worst picture through the Python package."""
    reference, frames, height_mm = _shown(case, drawn)
    sensor = on_grid(drawn, reference)
    config = run_request.configure(request, sensor)
    twin = Twin(sensor, config, reference[None])
    codes, light, clipped = twin.played(frames)
    bit_exact, differences, status = True, list[str](), 0
    if rtl:
        of_rtl, registers, differences = sim.stream(request, twin, frames, light, clipped)
        bit_exact, status = bool((of_rtl == codes).all()), registers["status"]
    assert light is not None
    is_set = (bool(clipped), twin.dark(frames).any())
    expected = tuple(bit for bit, is_one in zip(STATUS_BITS, is_set, strict=True) if is_one)
    shown = tuple(bit for bit in STATUS_BITS if status & REGISTERS["STATUS"].field(bit).mask) if rtl else expected
    depth_mm = codes[0] * config.depth_lsb_px * drawn.pitch_mm
    ideal_mm = twin.exact_px(frames, light[0]) * drawn.pitch_mm
    lit = np.any(case.lights, axis=-1)
    by_frame = [None if height_mm is None else errors_of(each, height_mm) for each in depth_mm]
    size = [0.0 if each is None else abs(each.height) for each in by_frame]
    worst = int(np.argmax(size))
    alone, python = _alone(drawn, request, reference, frames[worst], height_mm)
    return SensorRow(
        case=case.name,
        words="/".join(str(getattr(config, name)) for name in WIDTHS),
        frames=len(frames),
        first=by_frame[0],
        worst=by_frame[worst],
        last=by_frame[-1],
        right_after=right_after(case.lights, by_frame, height_mm),
        alone=alone,
        python=python,
        chip_mm=float(np.sqrt(((depth_mm - ideal_mm)[lit] ** 2).mean(axis=(1, 2))).max()),
        saturations=clipped,
        status=shown,
        bit_exact=bit_exact,
        registers_agree=not differences and shown == expected,
    )


def _shown(case: Case, drawn: DrawnLight) -> tuple[np.ndarray, np.ndarray, np.ndarray | None]:
    """Return the reference, the frames, and the true height in mm (rows, columns) of all of them."""
    height = flat if case.height is None else case.height(drawn)
    side = 1 + case.tilt * np.linspace(-1, 1, drawn.grid[1])[:, None]
    reference = drawn.pictures(drawn.levels(case.reference(drawn)), [(case.exposure,) * 3], seed=1)[0]
    lights = np.array(case.lights) * case.exposure
    frames = drawn.pictures(drawn.levels(height) * side, lights.tolist(), seed=2)
    case.paint(reference, frames)
    return reference, frames, None if case.height is None else drawn.heights(height)[:-1, :-1]


def errors_of(depth_mm: np.ndarray, height_mm: np.ndarray) -> Errors:
    """Return the errors of a depth map (rows, columns)."""
    free = depth_mm <= THRESHOLD_MM  # gel that is less deep counts as untouched
    above = depth_mm - (depth_mm[free].mean() if free.any() else 0.0)
    at_rest = above[height_mm == 0]
    return Errors(
        float(above.max() - height_mm.max()),
        float(np.sqrt((at_rest**2).mean())) if at_rest.size else None,
        float(np.abs(above - height_mm).max()),
    )


def right_after(lights: tuple[Colours, ...], by_frame: list[Errors | None], height_mm: np.ndarray | None) -> int | None:
    """Return the frames after the last change of the light until all maps are as the first one."""
    changes = [n for n in range(1, len(lights)) if lights[n] != lights[n - 1]]
    first = by_frame[0]
    if not changes or first is None or height_mm is None:
        return None
    near = RIGHT * float(height_mm.max())

    def is_right(each: Errors | None) -> bool:
        assert each is not None
        return abs(each.height - first.height) <= near and (each.untouched or 0) <= (first.untouched or 0) + near

    wrong = [n for n, each in enumerate(by_frame) if n >= changes[-1] and not is_right(each)]
    after = wrong[-1] + 1 if wrong else changes[-1]
    return None if after == len(by_frame) else after - changes[-1]


def _alone(
    drawn: DrawnLight,
    request: run_request.Request,
    reference: np.ndarray,
    frame: np.ndarray,
    height_mm: np.ndarray | None,
) -> tuple[Errors | None, str]:
    """Return the errors of a picture by itself, and the refusal or the warnings of the package."""
    try:
        with warnings.catch_warnings(action="ignore", category=InputWarning):
            pipeline = Pipeline(
                drawn.sensor, reference, grid=drawn.grid, depth_range_mm=request.deepest_mm, **request.numbers
            )
            result = pipeline(frame)
    except InputError as error:
        return None, f"refused: {error}"
    return None if height_mm is None else errors_of(result.depth_mm, height_mm), "; ".join(map(str, result.warnings))


def faults(case: Case, row: SensorRow) -> list[str]:
    """Return one line for each result that is not as it must be."""
    checks = (
        (not row.bit_exact, "RTL differs from the model"),
        (not row.registers_agree, "the registers of the hardware differ from the events at its pins"),
        (case.saturates not in (None, bool(row.saturations)), f"it must {'' if case.saturates else 'not '}saturate"),
    )
    return [f"{row.case}, {row.words}: {fault}" for broken, fault in checks if broken]


HEAD = (
    *("what comes in", "frames", "height, first frame", "worst", "last", "untouched gel, last", "largest, last"),
    *("right after", "worst one alone", "chip to double", "values clipped", "status bits", "Python package"),
)


def cells(row: SensorRow) -> tuple[str, ...]:
    """Return a row as text, below HEAD; errors in mm."""

    def height(each: Errors | None) -> str:
        return "-" if each is None else f"{each.height:+.3f}"

    last = row.last
    at_rest = "-" if last is None or last.untouched is None else f"{last.untouched:.3f}"
    return (
        *(row.case, f"{row.frames}", *map(height, (row.first, row.worst, last)), at_rest),
        *("-" if last is None else f"{last.largest:.3f}", "-" if row.right_after is None else f"{row.right_after}"),
        *(height(row.alone), f"{row.chip_mm:.4f}"),
        *(tabular.counts(row.saturations), ", ".join(row.status) or "-", row.python or "-"),
    )


def run(request: run_request.Request, out: Path, rtl: bool) -> int:
    """Run every row at the words of the request and at the narrowest ones, write the results, return the status."""
    files.check(out, RESULTS)
    drawn = draw(request)
    rows: list[SensorRow] = []
    broken: list[str] = []
    with progress_bar([*product(configurations(request, drawn), CASES)]) as bar:
        for each, case in bar:
            bar.set_description(case.name)
            rows.append(measure(case, each, drawn, rtl))
            broken += faults(case, rows[-1])
    sensor = on_grid(drawn, untouched_picture(drawn, DIM))
    config = run_request.configure(request, sensor)
    lights = long_state.light_states(drawn, sensor, config, DIM)
    clipped = max(sum(row.saturations.values()) // row.frames for row in rows)
    counts = long_state.counts(config, clipped, config.rows * config.columns)
    for words in dict.fromkeys(row.words for row in rows):
        print(f"words, coefficients and gains of {words} bits; errors in mm\n")
        print(tabular.Table(HEAD, [cells(row) for row in rows if row.words == words]), end="\n\n")
    print(tabular.shown(long_state.LightState, lights), end="\n\n")
    print(tabular.shown(long_state.LongCount, counts))
    document = {
        "sensor": [asdict(row) for row in rows],
        "light": [asdict(state) for state in lights],
        "counts": [asdict(count) for count in counts],
    }
    with written(out, RESULTS) as work:
        save(work / RESULTS[0], document)
        for fault in broken:
            print(fault)
    return 1 if broken else 0
