# SPDX-License-Identifier: Apache-2.0
"""`make tune`: the cheapest configuration whose error on frames of the user is within a tolerance.

Two thirds of the frames, drawn by SEED, tune the choice by the bit-accurate model; the others prove it in RTL. Cost is
the fraction of the multipliers plus that of the LUTs plus that of the memory bits that a configuration takes of TARGET;
of two with the same cost the faster is chosen. The tridiagonal solver gets the fewest lanes with which the last depth
comes within MAX_MAP_LATENCY_US of the last pixel. TOLERANCE=auto is a tenth of the error of the calibration. Takes the
variables of docs/commands.md as KEY=VALUE arguments. Exit status: 0 found and proven, 1 not, 2 bad input.
"""

import json
import math
import os
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from tqdm import tqdm

from commands.common import repository, run_request
from commands.common import simulator as simulation
from commands.common.progress import duration, progress_bar
from commands.common.results import save
from commands.common.variables import Several
from commands.common.zero_offset import untouched
from commands.cost.cost import Cost
from commands.run import sim
from commands.study.accuracy import SMALLEST_PEAK_PX, errors
from commands.study.tune_search import ALL_FRAMES, AUTO, COEFFICIENT_BITS, DATA_BITS, Judgement, Limits, Search, Widths
from tactile_depth.base import files
from tactile_depth.base.errors import InputError
from tactile_depth.chip.configuration import COEFFICIENT, DEFAULTS, NUMBERS, STORED, WIDTHS, WORDS, Configuration
from tactile_depth.chip.latency import last_pixel_to_last_depth
from tactile_depth.chip.limits import COLUMNS, most_lanes
from tactile_depth.depth.twin import Twin
from tactile_depth.pictures.frames import Frames, load_frames, on_grid
from tactile_depth.sensor.scenes import AS_EVER
from tactile_depth.sensor.sensor import Sensor
from tactile_depth.sensor.view import shown

AUTO_SHARE = 0.1  # fraction that TOLERANCE=auto adds to the error of the calibration
NOT_OF_SIM = (*(width.variable for width in WIDTHS.values()), "REPEAT", "GAPS", "STALLS", "WAVES", "CONFIG")
OF_SIM = tuple(name for name in run_request.ACCEPTED if name not in NOT_OF_SIM)
DEFAULT_OUT = repository.ROOT / "build" / "tune"
RESULTS = ("config.json", "report.json")
DEFAULT_FRAMES = "bench"
DEFAULT = DEFAULTS[STORED], DEFAULTS[COEFFICIENT]
*_, DEEPEST = WORDS.values()
CHOOSE = 0  # number of lanes of a request without LANES

PROOF = 1 / 3  # fraction of the frames
NOISY_COPIES = 6  # copies of a single frame
NOISE_LEVELS = 1.0  # standard deviation of their noise, grey levels


def tolerance_of(calibration: Sensor, model: str) -> float:
    """Return the tolerance of TOLERANCE=auto, in % of the peak: with it the error of the calibration grows by a tenth.

    Both are independent, so their squares add. Raises InputError: the calibration has no error.
    """
    error = calibration.height_errors.get(model or calibration.model)
    if error is None:
        raise InputError(
            f"TOLERANCE={AUTO}: the error of {calibration.name} was not measured",
            remedy="give a number, in % of the peak, or a calibration of `make calibrate`",
        )
    return 100 * math.sqrt((1 + AUTO_SHARE) ** 2 - 1) * error.relative


def split(frames: Frames, peaks: np.ndarray, seed: int) -> tuple[Frames, Frames, str]:
    """Return the frames for tuning, the frames for the proof, and a line that describes the split.

    Frames without contact are in neither.

    Raises InputError: no contact in any frame.
    """
    contacts = np.flatnonzero(peaks >= SMALLEST_PEAK_PX)
    if not len(contacts):
        raise InputError(
            f"FRAMES={frames.name}: no contact in any frame, and an error in % of peak says nothing: give some with one"
        )
    rng = np.random.default_rng(seed)
    left_out = f" ({len(peaks) - len(contacts)} without contact are left out)" if len(contacts) < len(peaks) else ""
    if len(contacts) == 1:
        alone, label = frames.pixels[contacts], frames.labels[contacts[0]]
        noise = rng.normal(scale=NOISE_LEVELS, size=(NOISY_COPIES - 1, *alone.shape[1:]))
        pixels = np.concatenate((alone, np.clip(np.rint(alone + noise), 0, 255).astype(np.uint8)))
        labels = (label, *(f"{label} + noise {i}" for i in range(1, NOISY_COPIES)))
        frames, contacts = replace(frames, pixels=pixels, labels=labels), np.arange(NOISY_COPIES)
        how = f"one frame{left_out}: tuned on it and copies with noise, proven on copies with other noise"
        order = contacts  # the frame itself is for tuning
    else:
        order = rng.permutation(contacts)
        how = ""
    count = max(1, round(len(order) * PROOF))
    tuning, proving = np.sort(order[:-count]), np.sort(order[-count:])
    how = how or f"tuned on {len(tuning)} frames, to be proven on {count} others{left_out}"

    def some(index: np.ndarray) -> Frames:
        return replace(frames, pixels=frames.pixels[index], labels=tuple(frames.labels[i] for i in index))

    return some(tuning), some(proving), how


def choices(values: Mapping[str, str]) -> tuple[run_request.Request, list[str]]:
    """Return the request of make sim, and the solvers to choose from. Raises InputError."""
    request = run_request.of_values(values, OF_SIM, "sensor", DEFAULT_FRAMES)
    solvers = [request.solver] if "SOLVER" in values else list(COLUMNS)
    if "LANES" in values:
        run_request.check_grid(replace(request, solver=solvers[-1]))
    else:
        request = replace(request, lanes=CHOOSE)
    return request, solvers


def lanes_within(
    build: Callable[[Widths], Configuration | None], request: run_request.Request, limits: Limits, solver: str
) -> int:
    """Return the lanes of LANES, or else the fewest with which the last depth comes within its limit.

    Where no number of lanes is enough, the most: the limit is then broken by the least.
    """
    if request.lanes != CHOOSE or solver != "tridiagonal":
        return request.lanes or 1
    most = most_lanes(request.columns, request.zero is not None)
    for lanes in (1 << log2 for log2 in range(most.bit_length())):
        config = build(Widths(solver, DATA_BITS[1], COEFFICIENT_BITS[1], lanes))
        if config is None or last_pixel_to_last_depth(config) <= limits.map_latency_us * limits.clock_mhz:
            break
    return lanes


def config_file(request: run_request.Request, at: Widths) -> dict[str, str | int | float]:
    """Return the variables of make sim that choose this configuration."""
    square, press = request.rows == request.columns, request.press
    rows, columns = request.camera_size or (0, 0)
    chosen = {
        "PRESET": request.preset,
        "SOLVER": at.solver,
        "BOUNDARY": request.boundary,
        "LANES": at.lanes if at.lanes > 1 else None,
        **({"N": request.columns} if square else {"ROWS": request.rows, "COLS": request.columns}),
        **{NUMBERS[name].variable: value for name, value in {**request.numbers, **at.words}.items()},
        "FRAMES": _absolute(request.frames),
        "SEED": request.seed,
        "REFERENCE": _absolute(request.reference),
        "ZERO": _absolute(request.zero),
        "LIGHT_GAINS": None if request.light_gains is None else int(request.light_gains),
        "PRESS": press.depth_mm,
        **({} if press == AS_EVER else {"AT": ",".join(f"{shift:g}" for shift in press.at_mm), "NOISE": press.noise}),
        DEEPEST: request.deepest_mm,
        "CALIBRATION": _absolute(request.calibration),
        "CAMERA_SIZE": f"{columns}x{rows}" if rows else None,
        "GRADIENT": request.gradient or None,
    }
    return {name: value for name, value in chosen.items() if value is not None}


def _absolute(source: str | None) -> str | None:
    """Return the path of a file or a folder from the root; the name of a scene or of a calibration as it is."""
    return str(Path(source).resolve()) if source and Path(source).exists() else source


def compared(counted: Cost, base: Cost | None, limits: Limits) -> str:
    """Return the cost of a configuration, and the saving against another."""

    costs, others = _costs(counted, limits), _costs(base, limits) if base else None

    def change(quantity: str) -> str:
        return f" ({100 * (costs[quantity] / others[quantity] - 1):+.0f} %)" if others else ""

    return (
        f"{costs['multipliers']} {limits.device.multiplier}{change('multipliers')}, "
        f"{costs['luts']:,} LUTs{change('luts')}, "
        f"{costs['memory_bits'] / 1000:,.0f} kbit of memory{change('memory_bits')}, "
        f"{costs['first_depth_us']:,.1f} us to the first depth{change('first_depth_us')}, "
        f"{costs['map_us']:,.1f} us from the last pixel to the last depth{change('map_us')}"
    )


def main(limits: Limits, chosen: Annotated[tuple[run_request.Request, list[str]], Several(OF_SIM, choices)]) -> int:
    """Tune, prove the choice in RTL, write it and return the exit status."""
    request, solvers = chosen
    simulation.check(request.simulator)
    out = request.out or DEFAULT_OUT
    files.check(out, RESULTS)
    calibration, share = shown(run_request.load_sensor(request), request.crop)
    automatic = math.isnan(limits.tolerance)
    if automatic:
        limits = replace(limits, tolerance=tolerance_of(calibration, request.gradient), judgement=ALL_FRAMES)

    def shaped(at: Widths) -> run_request.Request:
        return replace(request, numbers={**request.numbers, **at.words}, solver=at.solver, lanes=at.lanes)

    _check_grid(request, solvers)
    shape = (request.rows, request.columns)
    frames = load_frames(request.frames, shape, request.reference, request.seed, request.press, share=share)
    calibration = on_grid(calibration, frames)
    refusals: list[InputError] = []

    @cache
    def build(at: Widths) -> Configuration | None:
        try:
            return run_request.configure(shaped(at), calibration)
        except InputError as error:
            refusals.append(error)
            return None

    lanes = {solver: lanes_within(build, request, limits, solver) for solver in solvers}
    solvers = [s for s in solvers if build(Widths(s, DATA_BITS[1], COEFFICIENT_BITS[1], lanes[s])) is not None]
    if not solvers:
        raise refusals[-1]
    widest = build(Widths(solvers[0], DATA_BITS[1], COEFFICIENT_BITS[1], lanes[solvers[0]]))
    assert widest is not None
    exact = Twin(calibration, widest).exact_px(frames.pixels)
    tuning, proving, how = split(frames, np.abs(exact).max(axis=(1, 2)), request.seed)
    run_request.announce(request, widest)
    if automatic:
        grows = "with which the error of the calibration grows by 10 %"
        print(f"TOLERANCE={AUTO}: {limits.tolerance:.3g} % of peak, {grows}")
    print(how)
    with progress_bar(desc="tuning", unit=" configurations") as bar:
        measure = _measurement(request, tuning, calibration, widest, limits.judgement, bar)
        search = Search(build, measure, limits, limits.aim, lanes)
        bar.write(f"tuning takes about {duration(search.seconds(solvers))}, and the proof in RTL follows")
        best = search.cheapest(solvers)
        if best is None:
            print(_none(search, solvers))
            return 1

    default = next((at for solver in COLUMNS if build(at := Widths(solver, *DEFAULT)) is not None), None)
    counted, base = _print_choice(search, best, default, limits)
    proven = _proven(shaped(best), out / "proof", proving, limits)
    if proven is None:
        return 1
    report = {
        "tolerance_percent": limits.tolerance,
        "margin": limits.judgement.margin,
        "tuned_on": list(tuning.labels),
        "proven_on": list(proving.labels),
        "error_is": limits.judgement.name,
        "tuned_percent": search.tried[best],
        "proven_percent": proven,
        "chosen": _costs(counted, limits),
        "default": {"configuration": str(default), **_costs(base, limits)} if base else None,
        "tried": {str(at): error if math.isfinite(error) else None for at, error in sorted(search.tried.items())},
    }
    _write(out, {"config.json": config_file(request, best), "report.json": report})
    error = f"{limits.judgement.name} {proven:.4f} % of peak, within {limits.tolerance:.4g}"
    print(f"proven: {error}; make sim CONFIG={os.path.relpath(out / 'config.json')}")
    return 0


def _proven(request: run_request.Request, out: Path, proving: Frames, limits: Limits) -> float | None:
    """Return the error of the RTL on frames that it was not tuned on; None, and print why, if the proof fails."""
    print(f"proof in RTL, on {len(proving.pixels)} frames that it was not tuned on:")
    status = sim.run(replace(request, out=out), proving)
    report = json.loads((out / "report.json").read_text())
    error = limits.judgement.of(report["rms_percent_of_peak"])
    if status:
        print("the proof failed: see above")
    elif error > limits.tolerance:
        misses = f"it misses TOLERANCE={limits.tolerance:g} on frames that it was not tuned on ({error:.4f} % of peak)"
        print(f"{misses}: give more frames or a smaller tolerance")
    else:
        return error
    return None


def _write(out: Path, documents: dict[str, Any]) -> None:
    """Write the results, both or neither."""
    with files.workspace(out) as work:
        for name, content in documents.items():
            save(work / name, content)
        files.replace(work, documents, out)


def _print_choice(search: Search, best: Widths, default: Widths | None, limits: Limits) -> tuple[Cost, Cost | None]:
    """Print what was chosen and what it costs; return its cost and that of the default widths."""
    counted = search.cost(best)
    assert counted is not None
    base = search.cost(default) if default else None
    print(f"cheapest of {len(search.tried)} tried: {best}")
    left = f"leaves a margin of {limits.judgement.margin:g} to {limits.tolerance:.4g}"
    print(f"{limits.judgement.name} of those tuned on: {search.tried[best]:.4f} % of peak, which {left}")
    print(f"it takes {compared(counted, base, limits)}{f'; in brackets against {default}' if base else ''}")
    return counted, base


def _costs(counted: Cost, limits: Limits) -> dict[str, Any]:
    return {
        "device": limits.device.name,
        "multipliers": counted.multipliers_of(limits.device),
        "luts": counted.luts_of(limits.device),
        "memory_bits": counted.memory_bits,
        "first_depth_cycles": counted.first_depth_cycles,
        "first_depth_us": counted.first_depth_cycles / limits.clock_mhz,
        "map_cycles": counted.map_cycles,
        "map_us": counted.map_cycles / limits.clock_mhz,
        "share_of_device": limits.weight(counted),
    }


def _check_grid(request: run_request.Request, solvers: list[str]) -> None:
    """Refuse a grid that no solver takes before frames are read."""
    refused = []
    for solver in solvers:
        try:
            shape: dict[str, Any] = {"columns": request.columns, "rows": request.rows, "lanes": request.lanes or 1}
            words = Widths(solver, DATA_BITS[1], DEFAULT[1]).words
            Configuration(**shape, solver=solver, **{**request.numbers, **words})
            return
        except InputError as error:
            refused.append(error)
    raise refused[0]


def _measurement(
    request: run_request.Request,
    tuning: Frames,
    calibration: Sensor,
    any_of_them: Configuration,
    judgement: Judgement,
    bar: tqdm,
) -> Callable[[Configuration], float]:
    no_contact = untouched(request, tuning)
    exact = Twin(calibration, any_of_them, no_contact).exact_px(tuning.pixels)  # no width changes a light gain

    def measure(config: Configuration) -> float:
        rms = errors(Twin(calibration, config, no_contact).depth_px(tuning.pixels), exact)["rms_percent_of_peak"]
        bar.update()
        return judgement.of(rms)

    return measure


def _none(search: Search, solvers: list[str]) -> str:
    limits = search.limits
    near = search.nearest(solvers)
    if near is not None:
        judged, margin = limits.judgement, f"a margin of {limits.judgement.margin:g}"
        wanted = f"where {search.target:.4g} would leave {margin} to TOLERANCE={limits.tolerance:.4g}"
        error = f"{judged.name} {search.error(near):.4g} % of peak of those tuned on"
        return f"no configuration is good enough within the limits; the nearest is {near}: {error}, {wanted}"
    counts = {
        at: counted
        for solver in solvers
        for data in range(DATA_BITS[0], DATA_BITS[1] + 1)
        if (counted := search.cost(at := search.point(solver, data, COEFFICIENT_BITS[0]))) is not None
    }
    near = min(counts, key=lambda at: (len(limits.broken(counts[at])), search.rank(at)))
    return (
        f"no configuration is within the limits; the nearest is {near}: beyond {', '.join(limits.broken(counts[near]))}"
    )
