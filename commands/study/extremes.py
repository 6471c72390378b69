# SPDX-License-Identifier: Apache-2.0
"""`make extremes`: limits of the input range, one row each, in RTL, model and double precision.

Each row has the error, saturations by node, the sticky bit of the hardware, and the number of codes that wrapped. Long
runs measure drift, and the transforms are measured like in IEEE 1180. Variables: N (64), SIM, OUT, SHORT=1 without the
long runs and the largest grid. Exit status: 0 when every row is as it must be, 1 when not, 2 on bad input.
PRESET=sensor: the rows of sensor_extremes.py. Variables: ROWS and COLS (48 x 64), those of words and
depth range, SIM, OUT, RTL=0 for no simulation.
"""

from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Annotated, Any

import numpy as np

from commands.common import repository, run_request, tabular, variables
from commands.common import simulator as simulation
from commands.common.progress import progress_bar
from commands.common.results import save, written
from commands.common.tabular import Column
from commands.common.variables import Flag, Several
from commands.run import sim
from commands.study import certify, sensor_extremes
from commands.study.accuracy import errors
from commands.study.node_bounds import node_bounds
from commands.study.transform_noise import BIAS, Compliance, compliance
from tactile_depth.base import files
from tactile_depth.chip.common.td_round_saturate import Monitor
from tactile_depth.chip.configuration import WORDS, Configuration
from tactile_depth.chip.limits import COLUMNS, ROWS
from tactile_depth.chip.registers.register_map import REGISTERS
from tactile_depth.depth import reference
from tactile_depth.depth.twin import Twin
from tactile_depth.sensor.built_in import load
from tactile_depth.sensor.scenes import REST, SENSOR_WIDTH_MM, Press, photograph, render

RESULTS = ("extremes.json",)
CALIBRATION = "synthetic"
LONG_MODEL, LONG_RTL = 10_000, 2_000  # frames of the runs for drift
SHORT_MODEL = 96
ACCEPTED = ("PRESET", "N", "SIM", "OUT")
SENSOR_ACCEPTED = ("PRESET", "ROWS", "COLS", *WORDS.values(), "SIM", "OUT")
BATCH = 96  # frames that the model runs at a time
REST_COLOUR = round(REST)

Draw = Callable[[Configuration], np.ndarray]  # frames for a configuration


@dataclass(frozen=True)
class Extreme:
    """Row of the table: frames, and options of the pipeline that differ from the default.

    Constant slopes do not saturate: with zero depth around the frame their depth stays within the range.
    """

    name: str
    draw: Draw
    variables: tuple[str, ...] = ()
    saturates: bool = False  # True if values must saturate, False if they must not
    repeat: int = 1


@dataclass(frozen=True)
class Row:
    """Result of one case. Errors against double precision, in % of the peak (None without one) and in codes."""

    extreme: Annotated[str, Column("what comes in")]
    solver: Annotated[str, Column("solver")]
    grid: Annotated[str, Column("grid")]
    data_width: Annotated[int, Column("bits")]
    coeff_width: int
    frames: Annotated[int, Column("frames", ",")]
    rms_percent: Annotated[float | None, Column("RMS, % of peak", ".5f")]
    max_percent: Annotated[float | None, Column("largest, %", ".5f")]
    rms_codes: Annotated[float, Column("RMS, codes", ",.1f")]
    max_codes: Annotated[float, Column("largest, codes", ",.0f")]
    saturations: Annotated[dict[str, int], Column("values clipped", tabular.counts)]
    flagged: Annotated[bool, Column("status bit set", lambda flag: "yes" if flag else "no")]  # the sticky bit
    wrapped: Annotated[int, Column("wrapped")]
    bit_exact: bool
    registers_agree: bool


def _colour(*rgb: int) -> Draw:
    return lambda config: np.full((1, config.rows, config.columns, 3), rgb, np.uint8)


def _channels(config: Configuration) -> np.ndarray:
    """Return frames with one channel at its lowest and at its highest value."""
    frames = np.full((6, config.rows, config.columns, 3), REST_COLOUR, np.uint8)
    for index in range(6):
        frames[index, ..., index // 2] = 255 * (index % 2)
    return frames


def _scene(name: str, press: Press | None = None) -> Draw:
    return lambda config: render(name, config.rows, config.columns, press=press or Press()).frames


def _single_pixel(config: Configuration) -> np.ndarray:
    """Return frames with one pixel of the steepest slope, in the middle and in two corners, and no other contact."""
    frames = np.full((3, config.rows, config.columns, 3), REST_COLOUR, np.uint8)
    for frame, at in zip(frames, ((config.rows // 2, config.columns // 2), (0, 0), (-1, -1)), strict=True):
        frame[at] = _steepest(config)[0, 0, 0]
    return frames


def _checkerboard(config: Configuration) -> np.ndarray:
    """Return a chequer board of the steepest slopes of both signs."""
    steep = _steepest(config)
    white = np.indices((config.rows, config.columns)).sum(axis=0)[..., None] % 2
    return np.where(white, steep[0], steep[1])[None].astype(np.uint8)


def _uniform(gx: float, gy: float) -> Draw:
    def draw(config: Configuration) -> np.ndarray:
        height = gx * np.arange(config.columns)[None, :] + gy * np.arange(config.rows)[:, None]
        return photograph(np.pad(height, ((0, 1), (0, 1)), "reflect", reflect_type="odd"))[None, :-1, :-1]

    return draw


def _steepest(config: Configuration) -> np.ndarray:
    """Return frames of one colour: that of the largest gx + gy, and that of the smallest."""
    total = load(CALIBRATION).table.sum(axis=-1)
    step = config.bin_levels
    bins = [np.unravel_index(at, total.shape) for at in (total.argmax(), total.argmin())]
    colours = np.array(bins, np.uint8) * step
    return np.broadcast_to(colours[:, None, None], (2, config.rows, config.columns, 3))


def _worst(config: Configuration) -> np.ndarray:
    return certify.worst_frames(node_bounds(config), load(CALIBRATION), config)[0]


def _noise(config: Configuration) -> np.ndarray:
    return np.random.default_rng(1).integers(0, 256, (4, config.rows, config.columns, 3), np.uint8)


def _too_deep(config: Configuration) -> np.ndarray:
    """Return a cone with the steepest slopes up to the edge of the frame, nearly twice as deep as the default range."""
    size = min(config.rows, config.columns)
    y, x = np.indices((config.rows, config.columns)) + 0.5
    distance = np.hypot(y - config.rows / 2, x - config.columns / 2)
    return photograph(0.9 * np.maximum(size / 2 - 1 - distance, 0))[None]


EXTREMES = (
    Extreme("all black", _colour(0, 0, 0)),
    Extreme("all white", _colour(255, 255, 255)),
    Extreme("saturated channels", _channels),
    Extreme("no contact", _scene("flat")),
    Extreme("single pixel", _single_pixel),
    Extreme("checkerboard", _checkerboard),
    Extreme("uniform slope", _uniform(0.5, 0.25)),
    Extreme("steepest slope everywhere", _steepest),
    Extreme("worst cases of the certificate", _worst, saturates=True),
    Extreme("... with DEPTH_RANGE=worst", _worst, ("DEPTH_RANGE=worst",)),
    Extreme("white noise", _noise),
    Extreme("contact cut by the edge", _scene("ball", Press(at_mm=(SENSOR_WIDTH_MM / 2, 0.0)))),
    Extreme("contact cut by the corner", _scene("ball", Press(at_mm=(SENSOR_WIDTH_MM / 2, -SENSOR_WIDTH_MM / 2)))),
    Extreme("press deeper than the format", _too_deep, saturates=True),
    Extreme("12 bits", _scene("contacts"), ("DATA_WIDTH=12",)),
    Extreme("32 bits", _scene("contacts"), ("DATA_WIDTH=32", "COEFF_WIDTH=24")),
)


def smallest(solver: str) -> Extreme:
    grid = {"spectral": ("N=16",), "tridiagonal": (f"ROWS={ROWS[0]}", f"COLS={COLUMNS[solver][0]}")}[solver]
    return Extreme("smallest grid", _scene("contacts"), grid)


def largest(solver: str) -> Extreme:
    return Extreme("largest grid", _scene("ball"), (f"N={COLUMNS[solver][1]}",))


def drift(frames: int) -> Extreme:
    """Stream the eight contacts repeatedly, back to back; every pass must give the codes of the first."""
    return Extreme(f"{frames:,} frames back to back", _scene("contacts"), repeat=frames // 8)


def measure(extreme: Extreme, solver: str, size: int, simulator: str) -> Row:
    """Stream the frames through RTL and model, and measure both against double precision."""
    words = [*([] if any(v.startswith(("N=", "ROWS=")) for v in extreme.variables) else [f"N={size}"])]
    words += [f"SOLVER={solver}", f"SIM={simulator}", f"REPEAT={extreme.repeat}", *extreme.variables]
    request = run_request.parse(words)
    calibration = load(CALIBRATION)
    config = run_request.configure(request, calibration)
    frames = np.ascontiguousarray(extreme.draw(config))
    twin = Twin(calibration, config)
    model, light, clipped = twin.played(frames, request.repeat)
    codes, registers, differences = sim.stream(request, twin, frames, light, clipped)
    exact = reference.depth(frames, calibration, config.neumann)
    want = exact / config.depth_lsb_px
    error = codes[0] - want
    percent = errors(codes[0] * config.depth_lsb_px, exact)
    full_scale = 2.0 ** (config.depth.width - 1)
    grid = f"{config.rows}x{config.columns}"
    return Row(
        *(extreme.name, solver, grid, config.depth.width, config.coefficient.width, extreme.repeat * len(frames)),
        _largest(percent["rms_percent_of_peak"]),
        _largest(percent["max_percent_of_peak"]),
        float(np.sqrt((error**2).mean(axis=(1, 2))).max()),
        float(np.abs(error).max()),
        clipped,
        bool(registers["status"] & REGISTERS["STATUS"].field("saturation").mask),
        int(np.count_nonzero((np.abs(want) > full_scale / 2) & (codes * np.sign(want) < 0))),
        bool((codes == model).all()),
        not differences,
    )


def _largest(values: list[float | None]) -> float | None:
    return max((value for value in values if value is not None), default=None)


def faults(extreme: Extreme, row: Row) -> list[str]:
    """Return one line for each result that is out of bounds."""
    flag = "the status bit is set without a saturation" if row.flagged else "a saturation did not set the status bit"
    checks = (
        (not row.bit_exact, "RTL differs from the model, or a frame differs from its repetition"),
        (not row.registers_agree, "the counters of the hardware differ from the events at its pins"),
        (row.flagged != bool(row.saturations), flag),
        (row.wrapped, f"{row.wrapped} codes wrapped around"),
        (extreme.saturates != bool(row.saturations), f"it must {'' if extreme.saturates else 'not '}saturate"),
    )
    return [f"{row.extreme}, {row.solver}: {fault}" for broken, fault in checks if broken]


# Drift of the model: the error of a frame must not depend on the number of frames before it.

DRIFT = 0.05  # allowed relative difference of the mean errors of both halves of a run


def model_drift(solver: str, size: int, count: int, advance: Callable[[int], object] = lambda frames: None) -> Row:
    """Run contacts with new noise, frame after frame; return errors, wrapped codes and saturations as in other rows.

    Here `bit_exact` means that the mean errors of both halves agree within DRIFT.
    """
    config = Configuration(columns=size, solver=solver)
    calibration = load(CALIBRATION)
    twin, monitor = Twin(calibration, config), Monitor()
    squares, largest_error, percent, wrapped = [], 0.0, [], 0
    for start in range(0, count, BATCH):
        scenes = [
            render("contacts", size, seed=start + index + 1).frames for index in range(min(BATCH, count) // 8 + 1)
        ]
        frames = np.concatenate(scenes)[: min(BATCH, count - start)]
        codes = twin.codes(frames, monitor)
        exact = reference.depth(frames, calibration)
        error = codes - exact / config.depth_lsb_px
        squares.append(np.sqrt((error**2).mean(axis=(1, 2))))
        largest_error = max(largest_error, float(np.abs(error).max()))
        percent.append(errors(codes * config.depth_lsb_px, exact))
        wrapped += int(np.count_nonzero((np.abs(exact) > config.depth_limit_px / 2) & (codes * exact < 0)))
        advance(len(frames))
    rms = np.concatenate(squares)
    name, grid = f"{count:,} frames on the model", f"{size}x{size}"
    return Row(
        *(name, solver, grid, config.depth.width, config.coefficient.width, count),
        max(_largest(each["rms_percent_of_peak"]) or 0.0 for each in percent),
        max(_largest(each["max_percent_of_peak"]) or 0.0 for each in percent),
        float(rms.max()),
        largest_error,
        dict(monitor.saturations),
        bool(monitor.saturations),
        wrapped,
        bool(abs(rms[: count // 2].mean() / rms[count // 2 :].mean() - 1) < DRIFT),
        True,
    )


def as_document(rows: list[Row], measured: list[Compliance]) -> dict[str, list[dict[str, Any]]]:
    """Return the content of extremes.json."""
    return {"extremes": [asdict(row) for row in rows], "compliance": [asdict(row) for row in measured]}


def run(size: int, simulator: str, out: Path, short: bool) -> int:
    """Run every row, write the results and return the exit status."""
    simulation.check(simulator)
    for solver in COLUMNS:
        Configuration(columns=size, solver=solver)
    files.check(out, RESULTS)  # refuse bad input before minutes of work
    plan = [
        (extreme, solver)
        for solver in COLUMNS
        for extreme in (*EXTREMES, smallest(solver), *([] if short else [largest(solver), drift(LONG_RTL)]))
    ]
    rows: list[Row] = []
    broken: list[str] = []
    with progress_bar(plan) as bar:
        for extreme, solver in bar:
            bar.set_description(f"{extreme.name}, {solver}")
            rows.append(measure(extreme, solver, size, simulator))
            broken += faults(extreme, rows[-1])
    count = SHORT_MODEL if short else LONG_MODEL
    for solver in COLUMNS:
        with progress_bar(total=count, desc=f"model, {solver}", unit="frame") as bar:
            rows.append(model_drift(solver, size, count, bar.update))
        if not rows[-1].bit_exact:
            broken.append(f"{rows[-1].extreme}, {solver}: the error drifts")
    measured = compliance(Configuration(columns=size), 100 if short else 10_000)
    for row in measured:
        if not row.zero_in_zero_out:
            broken.append(f"{row.core}: zero in does not give zero out")
        if row.saturations:
            broken.append(f"{row.core}, {row.input}: {row.saturations} values clipped within the range")
        if row.mean_in_standard_errors > BIAS:
            broken.append(f"{row.core}, {row.input}: the mean error is {row.mean:.5f}, a bias")
    document = as_document(rows, measured)
    print(tabular.shown(Row, rows), end="\n\n")
    print(tabular.shown(Compliance, measured))
    with written(out, RESULTS) as work:
        save(work / RESULTS[0], document)
        for fault in broken:
            print(fault)
    return 1 if broken else 0


def of_sensor(
    request: Annotated[
        run_request.Request,
        run_request.chosen(SENSOR_ACCEPTED, frames="", **sensor_extremes.GRID, **sensor_extremes.CHOSEN),
    ],
    rtl: Flag = True,
) -> int:
    """Run the rows of a real sensor and return the exit status."""
    if rtl:
        simulation.check(request.simulator)
    return sensor_extremes.run(request, request.out or repository.ROOT / "build" / "extremes-sensor", rtl)


def of_scenes(
    request: Annotated[run_request.Request, run_request.chosen(ACCEPTED, N="64")], short: Flag = False
) -> int:
    return run(request.columns, request.simulator, request.out or repository.ROOT / "build" / "extremes", short)


def main(values: Annotated[dict[str, str], Several((*ACCEPTED, "SHORT", *SENSOR_ACCEPTED, "RTL"), dict)]) -> int:
    of_preset = of_sensor if values.get("PRESET") == "sensor" else of_scenes
    return variables.read(of_preset, [f"{name}={value}" for name, value in values.items()])
