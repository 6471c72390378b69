# SPDX-License-Identifier: Apache-2.0
"""`make sim`: streams frames through the RTL, checks every code, prints a table, draws.

Takes the variables of docs/make-sim.md as KEY=VALUE arguments. Exit status: docs/exit-status.md.
"""

import math
import os
import shutil
import sys
from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Annotated, Any
from warnings import catch_warnings, simplefilter

import numpy as np

from commands.common import repository, run_request, variables
from commands.common import simulator as simulation
from commands.common.progress import following
from commands.common.results import save
from commands.common.run_request import WITH_CAMERA, Request, announce, chosen
from commands.common.zero_offset import untouched
from commands.hardware import synthesis
from commands.run import bench
from commands.run.compare import compare, doubts, warnings
from commands.run.draw import draw_depth
from commands.run.sim_table import check_registers, coefficient_words, latencies, table
from commands.study.accuracy import errors
from tactile_depth.base import files
from tactile_depth.base.errors import InputWarning
from tactile_depth.chip import latency
from tactile_depth.chip.camera_configuration import CameraChoice
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.gradient.flat_field import reference_gains, require_light
from tactile_depth.chip.registers.axil_registers import GAINS
from tactile_depth.depth.result import steeper
from tactile_depth.depth.twin import Twin
from tactile_depth.pictures.frames import Frames
from tactile_depth.sensor.sensor import Sensor

RESULTS = ("depth.npy", "depth.png", "report.json")
DUMPS = (".vcd", ".fst")


def simulate(request: Request, twin: Twin, frames: Frames, folder: Path, light: np.ndarray | None) -> bench.Played:
    """Run the bench in `folder` with a progress bar; `light` is that of `Twin.light_of_stream`."""
    config = twin.config
    total = len(frames.pixels) * request.repeat
    pixels = config.rows * config.columns
    if frames.camera is None or frames.words is None:
        entries = bench.frame_entries(frames.pixels)
        clocks = (total + 4) * pixels
    else:
        entries = bench.picture_entries(frames.words, frames.camera)
        clocks = 4 * pixels + request.repeat * bench.clocks_of(entries)
    # Twice the expected cycles with gaps and stalls, so that a pipeline that hangs ends with a failure.
    clocks = int(2 * clocks / (1 - request.gaps) / (1 - request.stalls))
    profiles = [
        bench.entry(side, bench.chance(no)) for side, no in (("sink", request.stalls), ("source", request.gaps))
    ]
    first = {} if light is None else dict(zip(GAINS, light[0, 0].tolist(), strict=True))
    bench.build(request.simulator, config, clocks, request.waves, frames.camera)
    with following("simulating", total, "frame", partial(bench.frames_left, folder, config)):
        return bench.play(
            request.simulator,
            config,
            twin.sensor,
            np.concatenate([profiles, entries]),
            folder,
            clocks=clocks,
            passes=request.repeat,
            total_frames=total,
            registers={"THRESHOLD": run_request.threshold_code(config), **first},
            seed=request.seed,
            waves=request.waves,
            zero=twin.zero,
            camera=frames.camera,
        )


def stream(
    request: Request, twin: Twin, frames: np.ndarray, light: np.ndarray | None, clipped: Mapping[str, int]
) -> tuple[np.ndarray, dict[str, int], list[str]]:
    """Send uint8 frames (frames, rows, columns, 3) through the RTL as often as the request says.

    Returns
    -------
    Codes (repeat, frames, rows, columns) in the order of the input, the registers, and a line for each counter of the
    hardware that differs from what was seen from outside
    """
    with files.temporary() as folder:
        played = simulate(request, twin, Frames(frames, 1.0, "", tuple(map(str, range(len(frames))))), folder, light)
    codes = twin.upright(played.codes.reshape(request.repeat, *frames.shape[:-1]))
    return codes, played.registers, check_registers(played, codes.shape[0] * len(frames), clipped, not request.stalls)


def run(request: Request, frames: Frames | None = None) -> int:
    """Play the frames on RTL and model, write the results, and return the exit status.

    `frames` replaces those that the request names.
    """
    simulation.check(request.simulator)
    with variables.warned() as of_pictures:
        frames, calibration, config = synthesis.design(request, frames)
        twin = Twin(calibration, config, untouched(request, frames))
    codes, light, clips = twin.played(frames.pixels, request.repeat)
    light_once = None if light is None else light[0]
    if config.flat_field:
        require_light(reference_gains(calibration, config), config, f"REFERENCE={request.reference}")
    dark = twin.dark(frames.pixels)
    slopes = twin.exact_slopes(frames.pixels, light_once) / (calibration.pixel_aspect, 1)
    outside = steeper(slopes, calibration.fitted_slope.get(config.gradient_model, math.inf), dark)
    out = request.out or default_folder(request, config)
    with files.workspace(out, RESULTS) as work:
        played = simulate(request, twin, frames, work, light)
        reference_px = twin.exact_px(frames.pixels, light_once)
        rtl_codes = twin.upright(played.codes.reshape(request.repeat, *codes.shape[-3:]))
        difference = compare(rtl_codes, codes)
        percent = errors(rtl_codes[0] * config.depth_lsb_px, reference_px)
        result = work / "result"
        result.mkdir()
        dumps = take_dumps(request, config, frames, work, result)
        report = {
            **describe(request, config, calibration, frames),
            **latencies(played),
            **{key: values * request.repeat for key, values in percent.items()},
            **camera_report(request, config, frames, rtl_codes[0]),
            "bit_exact": not difference.count,
            "differing_codes": difference.count,
            "saturations": clips,
            "registers": played.registers,
            "waves": dumps,
            "dark_pixels": dark.sum(axis=(1, 2)).tolist() * request.repeat,
            "slopes_outside_calibration": outside.sum(axis=(1, 2)).tolist() * request.repeat,
        }
        differences = check_registers(played, report["frames"], clips, not request.stalls and frames.camera is None)
        report["registers_agree"] = not differences
        found = [] if difference.count else warnings(config, report["rms_percent_of_peak"], clips)
        found += doubts(dark, outside)
        report["warnings"] = [*of_pictures, *found]
        np.save(result / "depth.npy", rtl_codes.reshape(-1, config.rows, config.columns).astype(np.int32))
        save(result / "report.json", report)
        pitch = calibration.pixel_pitch_mm
        draw_depth(
            result / "depth.png",
            frames,
            rtl_codes[0] * config.depth_lsb_px * pitch,
            reference_px * pitch,
            pitch,
            f"{request.solver}, {request.boundary}, {config.rows}x{config.columns}, {config.depth.width}-bit words, "
            f"{calibration.name}",
            np.asarray(difference.differing.reshape(rtl_codes.shape).any(axis=0)),
            outside,
            dark,
        )
        earlier = [name for name in files.listed(out / "report.json", "waves") if name.endswith(DUMPS)]
        files.replace(result, (*RESULTS, *dumps), out, earlier)

    announce(request, config)
    print(table(report, frames.labels))
    for line in differences:
        print(line)
    print(difference.sentence())
    print(f"results: {os.path.relpath(out)}")
    for line in found:
        print(f"make sim: warning: {line}", file=sys.stderr)
    return variables.MISMATCH if difference.count or differences else variables.EQUAL


def default_folder(request: Request, config: Configuration) -> Path:
    """Return the default folder of results, one for each configuration."""
    widths = run_request.words_of(config, config.flat_field)
    colours = run_request.model_of(config)
    colours += "-zero" if config.zero_offset else ""
    colours += "-light" if config.light_gains else ""
    shape = f"{config.rows}x{config.columns}"
    camera = "" if request.camera is None else f"-{request.camera.pixel_format}"
    lanes = f"-{config.lanes}lanes" if config.lanes > 1 else ""
    name = f"{request.solver}{lanes}-{request.boundary}-{shape}-{widths}{colours}{camera}-{request.simulator}"
    return repository.ROOT / "build" / "sim" / name


def describe(request: Request, config: Configuration, calibration: Sensor, frames: Frames) -> dict:
    """Return the fields of the report that are known before the simulation."""
    pixel_pitch_mm = calibration.pixel_pitch_mm
    return {
        **run_request.described(config),
        "simulator": request.simulator,
        "frames": len(frames.pixels) * request.repeat,
        "depth_lsb_mm": config.depth_lsb_px * pixel_pitch_mm,
        "pixel_pitch_mm": pixel_pitch_mm,
        "depth_range_mm": config.deepest_px * pixel_pitch_mm,
        "gradient_lsb": config.gradient_lsb,
        "coefficient_table_words": coefficient_words(config),
        "contact_threshold_mm": run_request.CONTACT_THRESHOLD * min(config.rows, config.columns) * pixel_pitch_mm,
        "calibration": calibration.name,
        "source": frames.name,
        "expected_last_pixel_to_first_depth_cycles": latency.last_pixel_to_first_depth(config)
        if frames.camera is None
        else latency.last_word_to_first_depth(frames.camera, config),
    }


def camera_report(request: Request, config: Configuration, frames: Frames, codes: np.ndarray) -> dict[str, Any]:
    """Return the fields of the report about the camera, and the depth error against RGB of the grid.

    RGB of the grid is the average of the same window of the same pictures; its depth is in double precision.
    `codes` are (frames, rows, columns), rows from the top.
    """
    camera = frames.camera
    if camera is None:
        return {}
    plain = replace(request, camera=CameraChoice("rgb888", window=camera.crop))
    with catch_warnings():
        simplefilter("ignore", InputWarning)  # those of the same pictures have been shown
        as_rgb, sensor, _ = synthesis.design(plain)
        twin = Twin(sensor, config, untouched(plain, as_rgb))
    light = twin.light_of_stream(as_rgb.pixels)
    reference_px = twin.exact_px(as_rgb.pixels, None if light is None else light[0])
    percent = errors(codes * config.depth_lsb_px, reference_px)
    lost = {f"camera_{key}": values * request.repeat for key, values in percent.items()}
    return {**run_request.described_camera(camera), **lost}


def take_dumps(request: Request, config: Configuration, frames: Frames, work: Path, result: Path) -> list[str]:
    """Move the waveforms that a simulation left to `result`; return their names."""
    if not request.waves:
        return []
    built = bench.build(request.simulator, config, 0, True, frames.camera)  # Icarus writes there, Verilator into `work`
    return [Path(shutil.move(dump, result / dump.name)).name for dump in (*work.glob("*.vcd"), *built.glob("*.fst"))]


def main(request: Annotated[Request, chosen(WITH_CAMERA)]) -> int:
    return run(request)
