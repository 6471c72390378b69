# SPDX-License-Identifier: Apache-2.0
"""`make sim`: streams frames through the RTL, checks every code, prints a table, draws.

Takes the variables of docs/make-sim.md as KEY=VALUE arguments. Exit status: docs/exit-status.md.
"""

from __future__ import annotations

import json
import os
import shutil
import sys
import threading
from dataclasses import replace
from pathlib import Path

import numpy as np
from tqdm import tqdm

from commands.common import repository, results, variables
from commands.common import simulator as simulation
from commands.common.run_request import CONTACT_THRESHOLD, Request, configure, load_sensor, parse
from commands.run import bench
from commands.run.compare import compare, warnings
from commands.run.draw import draw_depth
from commands.run.flags import flags
from commands.run.sim_table import check_registers, coefficient_words, measure, table
from tactile_depth import latency, reference
from tactile_depth.accuracy import errors
from tactile_depth.calibration.auto_zero import exact_zero
from tactile_depth.calibration.floor_capture import LARGEST_LOG2, captured_floor
from tactile_depth.common.round_saturate import Monitor
from tactile_depth.configuration import Configuration
from tactile_depth.errors import InputError
from tactile_depth.frames import Frames, load_frames
from tactile_depth.scenes import SCENES
from tactile_depth.sensor import Sensor
from tactile_depth.tactile_depth import tactile_depth

RESULTS = ("depth.npy", "depth.png", "report.json")
DUMPS = (".vcd", ".fst")


def untouched(request: Request, frames: Frames) -> np.ndarray | None:
    """Frames of `FLOOR`, a power of two of them, uint8 (n, rows, columns, 3); None without it.

    Raises
    ------
    InputError
    """
    if request.floor is None:
        return None
    reference = request.reference if request.floor in SCENES else None
    rest = load_frames(request.floor, frames.pixels.shape[1:3], reference, request.seed)
    if rest.pixel_scale != frames.pixel_scale:
        raise InputError(f"FLOOR={request.floor}: not of the size of {frames.name}: give frames of the same camera")
    return rest.pixels[: 1 << min(LARGEST_LOG2, len(rest.pixels).bit_length() - 1)]


def floor_of(rest: np.ndarray | None, calibration: Sensor, config: Configuration) -> np.ndarray | None:
    """Return the zero offset that a capture of these frames measures, codes (node rows, node columns)."""
    if rest is None:
        return None
    return captured_floor(tactile_depth(rest, calibration, replace(config, auto_zero=False)), config)


def exact_depth(frames: np.ndarray, rest: np.ndarray | None, calibration: Sensor, config: Configuration) -> np.ndarray:
    """Depth in double precision, grid pixels, rows from the top."""
    depth = reference.depth_of(frames, calibration, config)
    if rest is None:
        return depth
    down = -1 if config.solver == "tridiagonal" else 1  # blocks are counted as depth leaves
    at_rest = reference.depth_of(rest, calibration, config)[..., ::down, :]
    return exact_zero(depth[..., ::down, :], at_rest, config)[..., ::down, :]


def simulate(
    request: Request,
    config: Configuration,
    frames: Frames,
    calibration: Sensor,
    folder: Path,
    floor: np.ndarray | None = None,
) -> bench.Played:
    """Run the bench in `folder`, with a bar that shows how far it is."""
    total = len(frames.pixels) * request.repeat
    pixels = config.rows * config.columns
    # Twice the clocks that gaps and stalls make likely: a pipeline that hangs ends with a failure.
    clocks = int(2 * (total + 4) * pixels / (1 - request.gaps) / (1 - request.stalls))
    profiles = [
        bench.entry(side, bench.chance(no)) for side, no in (("sink", request.stalls), ("source", request.gaps))
    ]
    finished = threading.Event()

    def watch() -> None:
        depth = folder / "depth.bin"
        with tqdm(total=total, unit="frame", desc="simulating", leave=False, disable=None) as bar:
            while not finished.wait(0.2):
                if depth.exists():
                    bar.update(min(depth.stat().st_size // (4 * pixels), total) - bar.n)

    bench.build(request.simulator, config, request.waves)
    watcher = threading.Thread(target=watch)
    watcher.start()
    try:
        return bench.play(
            request.simulator,
            config,
            calibration,
            np.concatenate([np.array(profiles, np.uint32), bench.frame_entries(frames.pixels)]),
            folder,
            clocks=clocks,
            passes=request.repeat,
            total_frames=total,
            registers={"THRESHOLD": round(CONTACT_THRESHOLD * min(config.rows, config.columns) / config.depth_lsb_px)},
            seed=request.seed,
            waves=request.waves,
            floor=floor,
        )
    finally:
        finished.set()
        watcher.join()


def run(request: Request, frames: Frames | None = None) -> int:
    """Play the frames on RTL and model, write the results, and return the exit status.

    `frames` replaces those that the request names.
    """
    simulation.check(request.simulator)
    calibration = load_sensor(request)
    # Refuse a grid before frames are read.
    Configuration(columns=request.columns, rows=request.rows, solver=request.solver)
    grid = (request.rows, request.columns)
    if frames is None:
        frames = load_frames(request.frames, grid, request.reference, request.seed, request.press)
    calibration = calibration.on_grid(frames)
    config = configure(request, calibration)
    flagged = flags(frames.pixels, calibration, config, request.reference)
    rest = untouched(request, frames)
    floor = floor_of(rest, calibration, config)
    out = request.out or default_folder(request, config)
    with results.workspace(out, RESULTS) as work:
        played = simulate(request, config, frames, calibration, work, floor)
        monitor = Monitor()
        codes = tactile_depth(frames.pixels, calibration, config, monitor, floor=floor)
        reference_px = exact_depth(frames.pixels, rest, calibration, config)
        seen = played.codes.reshape(request.repeat, *codes.shape)
        if config.solver == "tridiagonal":  # it puts the bottom row out first; results are in input order
            seen, codes = seen[..., ::-1, :], codes[..., ::-1, :]
        difference = compare(seen, codes)
        percent = errors(seen[0] * config.depth_lsb_px, reference_px)
        result = work / "result"
        result.mkdir()
        dumps = take_dumps(request, config, work, result)
        clips = {node: count * request.repeat for node, count in sorted(monitor.saturations.items())}
        report = {
            **describe(request, config, calibration, frames),
            **measure(played),
            **{key: values * request.repeat for key, values in percent.items()},
            "bit_exact": not difference.count,
            "differing_codes": difference.count,
            "saturations": clips,
            "registers": played.registers,
            "waves": dumps,
            **flagged.report(request.repeat),
        }
        differences = check_registers(played.registers, report, request.stalls)
        report["registers_agree"] = not differences
        report["warnings"] = [] if difference.count else warnings(config, report["rms_percent_of_peak"], clips)
        report["warnings"] += flagged.warnings()
        np.save(result / "depth.npy", seen.reshape(-1, *grid).astype(np.int32))
        (result / "report.json").write_text(json.dumps(report, indent=1) + "\n")
        pitch = calibration.pixel_pitch_mm
        draw_depth(
            result / "depth.png",
            frames,
            seen[0] * config.depth_lsb_px * pitch,
            reference_px * pitch,
            pitch,
            f"{request.solver}, {request.boundary}, {config.rows}x{config.columns}, {config.data_width}-bit words, "
            f"{calibration.name}",
            np.asarray(difference.differing.reshape(seen.shape).any(axis=0)),
            flagged,
        )
        results.replace(result, (*RESULTS, *dumps), out, earlier_dumps(out))

    print(table(report, frames.labels))
    for line in differences:
        print(line)
    print(difference.sentence())
    print(f"results: {os.path.relpath(out)}")
    for line in report["warnings"]:
        print(f"make sim: warning: {line}", file=sys.stderr)
    return variables.MISMATCH if difference.count or differences else variables.EQUAL


def default_folder(request: Request, config: Configuration) -> Path:
    """Folder of results when OUT is not given: one for each configuration."""
    widths = f"d{config.data_width}-c{config.coefficient_width}"
    colours = f"-{config.gradient_model}" if config.flat_field else ""
    colours += "-zero" if config.auto_zero else ""
    shape = f"{config.rows}x{config.columns}"
    name = f"{request.solver}-{request.boundary}-{shape}-{widths}{colours}-{request.simulator}"
    return repository.ROOT / "build" / "sim" / name


def describe(request: Request, config: Configuration, calibration: Sensor, frames: Frames) -> dict:
    """Fields of the report that are known before the simulation."""
    pixel_pitch_mm = calibration.pixel_pitch_mm
    assert config.depth_range_px is not None
    return {
        "grid": [config.rows, config.columns],
        "solver": request.solver,
        "boundary": request.boundary,
        "simulator": request.simulator,
        "data_width": config.data_width,
        "coeff_width": config.coefficient_width,
        "frames": len(frames.pixels) * request.repeat,
        "depth_lsb_mm": config.depth_lsb_px * pixel_pitch_mm,
        "pixel_pitch_mm": pixel_pitch_mm,
        "depth_range_mm": config.depth_range_px * pixel_pitch_mm,
        "gradient_lsb": config.gradient_lsb,
        "coefficient_table_words": coefficient_words(config),
        "contact_threshold_mm": CONTACT_THRESHOLD * min(config.rows, config.columns) * pixel_pitch_mm,
        "calibration": calibration.name,
        "gradient_model": config.gradient_model,
        "flat_field": config.flat_field,
        "auto_zero": config.auto_zero,
        "source": frames.name,
        "expected_last_pixel_to_first_depth_cycles": latency.last_pixel_to_first_depth(config),
    }


def take_dumps(request: Request, config: Configuration, work: Path, result: Path) -> list[str]:
    """Move the waveforms that a simulation left to `result`; returns their names."""
    if not request.waves:
        return []
    built = bench.build(request.simulator, config, True)  # Icarus writes there, Verilator into `work`
    return [Path(shutil.move(dump, result / dump.name)).name for dump in (*work.glob("*.vcd"), *built.glob("*.fst"))]


def earlier_dumps(out: Path) -> list[str]:
    """Names of the waveforms that the report in `out` lists: this command wrote them, and new results replace them."""
    try:
        names = json.loads((out / "report.json").read_text())["waves"]
        return [name for name in names if name == Path(name).name and name.endswith(DUMPS)]
    except (OSError, ValueError, LookupError, TypeError, AttributeError):  # no report, or one of something else
        return []


def main() -> None:
    with variables.reported("sim"):
        sys.exit(run(parse(sys.argv[1:])))


if __name__ == "__main__":
    main()
