# SPDX-License-Identifier: Apache-2.0
"""`make calibrate`: `tactile-depth calibrate` with variables, and with a picture and a comparison of circles.

Real circles of presses.csv are often of whole pixels: half a pixel in a radius of 26 is 4 % of the height of a cap.
"""

import argparse
import os
from pathlib import Path
from typing import Annotated

from commands.common import repository
from commands.common.press_data import data_folder
from commands.common.run_request import camera_choice
from commands.common.variables import EQUAL, Name, Place, Several, one, real, whole
from tactile_depth.calibrate.fitting import DEFAULT_BITS
from tactile_depth.chip.camera_configuration import CameraChoice
from tactile_depth.chip.limits import MODELS
from tactile_depth.cli import calibrate
from tactile_depth.pictures.pictures import ROTATIONS
from tactile_depth.sensor.calibration_file import LONGEST_EXPOSURE_US, PIXEL_PITCHES_MM
from tactile_depth.sensor.sensor import TABLE_BITS


def main(
    presses: Place | None = None,
    model: Annotated[str, one((calibrate.ALL, *MODELS)), "GRADIENT"] = calibrate.ALL,
    pitch_mm: Annotated[float | None, real(*PIXEL_PITCHES_MM), "PITCH"] = None,
    bits: Annotated[int, whole(*TABLE_BITS)] = DEFAULT_BITS,
    find_circles: Annotated[bool, one({"table": False, "found": True}), "CIRCLES"] = False,
    exposure_us: Annotated[float | None, real(1e-3, LONGEST_EXPOSURE_US)] = None,
    rotate: Annotated[int, one({str(degrees): degrees for degrees in ROTATIONS})] = 0,
    keep_bad: Annotated[bool, one({"0": False, "1": True})] = False,
    crop: Name | None = None,
    camera: Annotated[CameraChoice | None, Several(("CAMERA", "BAYER"), camera_choice)] = None,
    out: Place | None = None,
) -> int:
    if out is not None:
        calibrate.require_npz(out)
    folder = presses or data_folder()
    parser = argparse.ArgumentParser()
    calibrate.add_arguments(parser)
    options = parser.parse_args(["PRESSES", "--compare-circles", "--picture"])
    options.presses, options.model, options.bits, options.find_circles = str(folder), model, bits, find_circles
    options.rotate, options.keep_bad = rotate, keep_bad
    options.pitch_mm, options.exposure_us, options.crop = pitch_mm and (pitch_mm,), exposure_us, crop
    if camera is not None:
        options.camera, options.bayer = camera.pixel_format, camera.phase
    default = repository.ROOT / "build" / "calibrate" / f"{folder.resolve().name}.npz"
    options.out = out or Path(os.path.relpath(default))
    calibrate.run(options, ())
    return EQUAL
