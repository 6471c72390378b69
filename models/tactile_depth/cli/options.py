# SPDX-License-Identifier: Apache-2.0
"""Options that the subcommands share, and the pipeline that they describe."""

from __future__ import annotations

import argparse
import re
from pathlib import Path
from typing import Any, get_args

import numpy as np

from tactile_depth.base.errors import InputError
from tactile_depth.chip.configuration import CHOICES, DEFAULTS, NUMBERS
from tactile_depth.chip.limits import BOUNDARIES, MODELS, Solver
from tactile_depth.depth.pipeline import ARITHMETICS, Pipeline
from tactile_depth.pictures.frames import read_stack
from tactile_depth.pictures.identify import identify
from tactile_depth.pictures.pictures import ROTATIONS, rotated
from tactile_depth.sensor.built_in import load, read
from tactile_depth.sensor.calibration_file import BUILT_IN
from tactile_depth.sensor.presets import AREA_THRESHOLD_MM, SENSOR, THRESHOLD_MM
from tactile_depth.sensor.sensor import Sensor
from tactile_depth.sensor.view import CONVENTIONS


def size(text: str) -> tuple[int, int]:
    """Read columns x rows, as 320x240; return (rows, columns)."""
    match = re.fullmatch(r"(\d{1,5})x(\d{1,5})", text)
    if not match:
        raise argparse.ArgumentTypeError(f"{text!r} is no size: accepted is columns x rows, as 320x240")
    return int(match[2]), int(match[1])


def path_of(text: str) -> Path:
    """Read a path to write to; an empty one, as of a variable that is not set, is none."""
    if not text:
        raise argparse.ArgumentTypeError("is empty: give a path")
    return Path(text)


def add_pipeline_arguments(parser: argparse.ArgumentParser, several: bool = False) -> None:
    """Add what `make_pipeline` reads, but for the reference; with `several`, a list of calibrations is read."""
    parser.add_argument(
        "--calibration",
        action="append" if several else "store",
        metavar="NAME_OR_FILE",
        help=f"{', '.join(BUILT_IN)}, or an .npz; by default the built-in one whose lighting the reference has",
    )
    parser.add_argument(
        "--camera-size", type=size, metavar="WxH", help="pictures that a calibration of format 1 was made from"
    )
    add_picture_arguments(parser, "by default what those of the calibration show")
    parser.add_argument("--grid", type=size, metavar="WxH", help="of the depth map, 128x96 by default for 4:3")
    parser.add_argument(
        "--arithmetic",
        choices=ARITHMETICS,
        default=ARITHMETICS[0],
        help="chip: every bit as in hardware (default); float: double precision",
    )
    parser.add_argument(
        "--threshold-mm",
        type=float,
        default=THRESHOLD_MM,
        metavar="MM",
        help=f"depth above which a pixel touches (default {THRESHOLD_MM})",
    )
    parser.add_argument(
        "--area-threshold-mm",
        type=float,
        default=AREA_THRESHOLD_MM,
        metavar="MM",
        help=f"depth above which a pixel is in the area of a contact (default {AREA_THRESHOLD_MM}), "
        "or half the contact's peak if less",
    )
    parser.add_argument(
        "--model", choices=MODELS, default="", help="gradient model; by default the best of the calibration"
    )
    add_light_and_zero_arguments(parser)


def add_picture_arguments(parser: argparse.ArgumentParser, otherwise: str) -> None:
    """Add the options that say what the pictures show, and how they lie."""
    conventions = ", ".join(CONVENTIONS)
    what = f"what the pictures show of the sensor's full picture: {conventions}, a share as 0.8, or WIDTH,HEIGHT"
    parser.add_argument("--crop", metavar="CROP", help=f"{what}; {otherwise}")
    parser.add_argument(
        "--rotate",
        type=int,
        default=0,
        choices=ROTATIONS,
        help="degrees, counter-clockwise, to rotate pictures by first",
    )


def add_light_and_zero_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options that leave out the zero offset and the light gains."""
    parser.add_argument(
        "--no-zero-offset", action="store_true", help="keep what depth reads without contact, do not subtract it"
    )
    parser.add_argument(
        "--no-light-gains", action="store_true", help="take the light of the pictures to be that of the reference"
    )


def add_build_arguments(parser: argparse.ArgumentParser) -> None:
    """Add choices that a device is built with, which the pipeline of its host must share."""
    build = parser.add_argument_group("build of a device that has others than the defaults")
    build.add_argument("--solver", choices=get_args(Solver), default=SENSOR.solver, help=f"default {SENSOR.solver}")
    build.add_argument("--boundary", choices=BOUNDARIES, default=SENSOR.boundary, help=f"default {SENSOR.boundary}")
    for name, number in NUMBERS.items():
        usual, unit = DEFAULTS[name], number.meaning.split()[0].upper()
        help_text = f"{number.meaning} (default {usual})"
        build.add_argument(number.option.split()[0], type=int, default=usual, metavar=unit, help=help_text)
    build.add_argument("--depth-range-mm", type=float, metavar="MM", help="depth that the formats are sized for")


def build_choices(options: argparse.Namespace) -> dict[str, Any]:
    """Return the arguments of `Pipeline` that `add_build_arguments` and `add_light_and_zero_arguments` give."""
    return {
        **{each.argument: vars(options)[each.argument] for each in CHOICES.values() if each.argument in options},
        "zero_offset": not options.no_zero_offset,
        "light_gains": False if options.no_light_gains else None,
    }


def read_reference(path: str, rotate: int) -> np.ndarray:
    """Read and rotate pictures without contact, uint8 (frames, rows, columns, 3); raise InputError if that fails."""
    return rotated(read_stack(path, f"--reference {path}"), rotate)


def choose_sensor(options: argparse.Namespace, reference: np.ndarray) -> Sensor:
    """Return the calibration that is named, else the built-in one that a reference looks like, and say so."""
    sensor = named_sensor(options) if options.calibration is not None else _identified(options, reference)
    if options.crop is None and sensor.view is not None and min(sensor.view) < 1:
        width, height = sensor.view
        shown = f"{width:.3g} of the width and {height:.3g} of the height of the sensor's full picture"
        print(f"view: pictures are taken to show {shown}; --crop says otherwise")
    return sensor


def _identified(options: argparse.Namespace, reference: np.ndarray) -> Sensor:
    if options.camera_size is not None:
        raise InputError("--camera-size without --calibration: it goes with a calibration file of version 0.1")
    sensor = identify(reference[0], crop=options.crop)
    print(f"calibration: {sensor.name}: the reference looks like it; --calibration names another")
    return sensor


def named_sensor(options: argparse.Namespace) -> Sensor:
    """Return the calibration that is named, and say so; --crop completes one whose view is unknown."""
    reader = load if options.crop is None else read
    sensor = reader(options.calibration, options.camera_size)
    print(f"calibration: {sensor.name}")
    return sensor


def make_pipeline(options: argparse.Namespace, sensor: Sensor, reference: np.ndarray | None) -> Pipeline:
    """Return the pipeline that the options describe."""
    return Pipeline(
        sensor,
        reference,
        crop=options.crop,
        grid=options.grid,
        model=options.model,
        **build_choices(options),
        arithmetic=options.arithmetic,
        threshold_mm=options.threshold_mm,
        area_threshold_mm=options.area_threshold_mm,
    )
