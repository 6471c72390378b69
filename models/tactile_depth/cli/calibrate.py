# SPDX-License-Identifier: Apache-2.0
"""`tactile-depth calibrate`: fits a calibration to ball presses, and measures it through a device if one is named."""

from __future__ import annotations

import argparse
import csv
import sys
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from tactile_depth.base import files
from tactile_depth.base.errors import Argument, InputError, InputWarning, counted, warn
from tactile_depth.calibrate.ball_press import BallPress
from tactile_depth.calibrate.fitting import DEFAULT_BITS, Fit, check_arguments, fit_presses, pixel_size
from tactile_depth.calibrate.press_folder import BACKGROUND, HEAD, TABLE, background_path, table_rows
from tactile_depth.calibrate.press_pictures import PressPictures, camera_pitch_mm, gather
from tactile_depth.calibrate.presses import SMALLEST_GRID, GridPresses, View, to_grid
from tactile_depth.chip.camera_configuration import FORMATS, PHASES, CameraChoice
from tactile_depth.chip.limits import MODELS
from tactile_depth.cli.circle_page import circle_page
from tactile_depth.cli.measure import DEVICE, address_of, grid_of, measure
from tactile_depth.cli.options import (
    add_build_arguments,
    add_light_and_zero_arguments,
    add_picture_arguments,
    build_choices,
    path_of,
    size,
)
from tactile_depth.cli.overview import draw_circles, draw_presses
from tactile_depth.depth.pipeline import Pipeline
from tactile_depth.pictures.frames import read_pictures
from tactile_depth.sensor.verdict import BAD
from tactile_depth.sensor.view import view_of

NAME = "calibrate"
HELP = "Fit a calibration to ball presses; load it into a device and measure it there, if one is named."
ALL = "all"
CIRCLE = ("x", "y", "radius")


def pitch(text: str) -> tuple[float, ...]:
    """Read the size of a pixel in mm, as 0.0634, or its height and width, as 0.0634,0.058."""
    try:
        numbers = tuple(float(number) for number in text.split(","))
    except ValueError:
        numbers = ()
    if len(numbers) not in (1, 2):
        accepted = "mm per camera pixel, as 0.0634, or its height and width, as 0.0634,0.058"
        raise argparse.ArgumentTypeError(f"{text!r} is no pitch: accepted are {accepted}")
    return numbers


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the subcommand."""
    parser.add_argument(
        "device", nargs="?", metavar="device:ADDRESS", help="device:/dev/ttyUSB0, device:sim, ..; by default none"
    )
    parser.add_argument("presses", metavar="PRESSES", help=f"a folder of pictures of ball presses, with {TABLE}")
    parser.add_argument(
        "--pitch-mm", type=pitch, metavar="MM", help="mm per camera pixel, or height,width; by default from the balls"
    )
    parser.add_argument(
        "--diameter-mm", type=float, metavar="MM", help=f"of the ball that made all presses of a folder without {TABLE}"
    )
    parser.add_argument(
        "--background", metavar="PICTURE", help=f"the sensor without contact; by default {BACKGROUND}.png in PRESSES"
    )
    parser.add_argument(
        "--grid", type=size, metavar="WxH", help="of the depth map; by default that of the device, or 128x96 for 4:3"
    )
    parser.add_argument(
        "--model",
        choices=(ALL, *MODELS),
        default=ALL,
        help=f"gradient model; {ALL} (default): fits all, and a device gets the best",
    )
    parser.add_argument(
        "--bits", type=int, default=DEFAULT_BITS, metavar="N", help=f"of each colour, for lut (default {DEFAULT_BITS})"
    )
    parser.add_argument(
        "--circles",
        type=Path,
        metavar="FILE.csv",
        help=f"in place of {TABLE}: the table that this command writes, corrected",
    )
    parser.add_argument("--keep-bad", action="store_true", help="write FILE.npz although the verdict of the fit is bad")
    parser.add_argument("--find-circles", action="store_true", help=f"find all circles, also those that {TABLE} gives")
    parser.add_argument(
        "--compare-circles",
        action="store_true",
        help=f"print how circles that are found differ from those of {TABLE}",
    )
    parser.add_argument(
        "--camera", metavar="FORMAT", help=f"convert the pictures to what a camera sends: {', '.join(FORMATS)}"
    )
    parser.add_argument(
        "--bayer", default=PHASES[0], metavar="PHASE", help=f"of its Bayer pattern: {', '.join(PHASES)} (default first)"
    )
    add_picture_arguments(parser, "it is kept in FILE.npz, and unknown by default")
    parser.add_argument("--exposure-us", type=float, metavar="US", help="exposure time of the camera, to be kept")
    parser.add_argument("--out", type=path_of, metavar="FILE.npz", help="default: <name of PRESSES>.npz")
    parser.add_argument("--picture", action="store_true", help="draw three of the presses beside FILE.npz, as FILE.png")
    add_light_and_zero_arguments(parser)
    add_build_arguments(parser)
    parser.set_defaults(run=run)


def run(options: argparse.Namespace, warned: Sequence[str]) -> None:
    """Fit, print the table, measure through the device if one is named, and write the calibration file.

    Raises
    ------
    InputError, DeviceError
    """
    if options.presses.startswith(DEVICE):
        raise InputError(
            f"{options.presses}: a device sends no camera pictures to its host, so its own camera cannot be used: give "
            f"a folder of presses behind it, whose pictures are sent, as `{NAME} {options.presses} PRESSES`"
        )
    address = None if options.device is None else address_of(options.device)
    if address is not None and (grid := grid_of(address)) is not None:  # told before the fit
        if options.grid not in (None, grid):
            remedy = ("omit it, or give ", Argument("grid", grid))
            raise InputError(Argument("grid", options.grid), ": the device has another grid", remedy=remedy)
        options.grid = grid
    out: Path = options.out or Path(f"{Path(options.presses).resolve().name}.npz")
    require_npz(out)
    drawn = (out.with_suffix(".png"),) if options.picture else ()
    picture, page, table = (out.with_name(f"{out.stem}-circles{suffix}") for suffix in (".png", ".html", ".csv"))
    circles = [picture, page] if options.circles else [picture, page, table]  # a table that is given is not replaced
    names = [path.name for path in (out, *drawn, *circles)]
    with files.workspace(out.parent, names, str(out)) as work:  # refused before the fit, which takes some seconds
        pictures = press_pictures(options)
        presses = on_grid(options, pictures)
        draw_circles(pictures, presses).save(work / picture.name)
        (work / page.name).write_text(circle_page(pictures, presses), encoding="utf-8")
        if table in circles:
            with (work / table.name).open("w", encoding="utf-8", newline="") as file:
                csv.writer(file).writerows([HEAD, *table_rows(pictures.presses, presses.circles)])
        try:
            fit = fitted(options, presses, out.stem)
        except InputError:  # the circles may show why
            files.replace(work, [path.name for path in circles], out.parent)
            print("circles:", ", ".join(map(str, circles)), flush=True)
            raise
        if address is not None:
            pipeline = Pipeline(fit.sensor, pictures.background, grid=presses.grid, **build_choices(options))
            measure(address, pipeline, presses, pictures)
        fit.sensor.save(work / out.name)
        for path in drawn:
            draw_presses(fit, presses).save(work / path.name)
        files.replace(work, names, out.parent)
    print("circles:", ", ".join(map(str, circles)))
    print("results:", ", ".join(map(str, (out, *drawn))))


def require_npz(out: Path) -> None:
    """Raise InputError if that is no name of a calibration file."""
    if out.suffix != ".npz":
        raise InputError(Argument("folder", out), ": give the name of an .npz file")


def press_pictures(options: argparse.Namespace) -> PressPictures:
    """Return the presses of a folder with a table, or of a folder of pictures of one ball."""
    folder, table = Path(options.presses), options.circles
    if options.diameter_mm is None:
        return gather(folder, options.background, options.rotate, table)
    if table is not None or (folder / TABLE).exists():
        has = table or folder / TABLE
        raise InputError(f"--diameter-mm {options.diameter_mm:g}: {has} has the diameters: omit one of them")
    background = Path(options.background or background_path(folder))
    names = [name for name in read_pictures(folder, f"PRESSES {folder}")[0] if folder / name != background]
    listed = [BallPress(folder / name, options.diameter_mm, name=name) for name in names]
    return gather(listed, background, options.rotate)


def on_grid(options: argparse.Namespace, pictures: PressPictures) -> GridPresses:
    """Return the presses on the grid, and warn of those that are left out."""
    pitch_mm = options.pitch_mm and (options.pitch_mm[0] if len(options.pitch_mm) == 1 else options.pitch_mm)
    check_arguments(chosen(options), options.bits, options.exposure_us)
    height, aspect = pixel_size(pitch_mm)
    if options.grid is not None and min(options.grid) < SMALLEST_GRID:
        raise InputError(Argument("grid", options.grid), accepted=f"{SMALLEST_GRID} columns and rows or more")
    presses = to_grid(
        pictures,
        camera_pitch_mm(pictures, height),
        options.find_circles,
        options.compare_circles,
        None if options.camera is None else CameraChoice(options.camera, options.bayer),
        aspect,
        options.grid,
    )
    for note in presses.notes:
        warn(InputWarning(note))
    return replace(presses, view=None if options.crop is None else view_of(options.crop))


def chosen(options: argparse.Namespace) -> tuple[str, ...]:
    """Return the gradient models to fit."""
    return MODELS if options.model == ALL else (options.model,)


def fitted(options: argparse.Namespace, presses: GridPresses, name: str) -> Fit:
    """Fit to the presses, and print the error on each whole press by a fit to the others."""
    rows, columns = presses.grid
    print(
        f"{counted(len(presses.views), 'press')}, grid of {columns} x {rows}",
        presses.field_of_view,
        sep="\n",
        flush=True,
    )
    if len(presses.agreement):
        middle = np.median(presses.agreement, axis=0)
        spread = np.median(np.abs(presses.agreement - middle), axis=0)
        off = (f"{name} {value:+.1f} ({by:.1f})" for name, value, by in zip(CIRCLE, middle, spread, strict=True))
        what = f"circles found in {counted(len(presses.agreement), 'picture')} minus those of {TABLE}"
        print(f"{what}: {', '.join(off)} pixels, median (and median deviation)")
    fit = fit_presses(presses, chosen(options), options.bits, name, options.exposure_us, _progress)
    evaluation = replace(fit.evaluation, notes=())  # they are warnings
    print("every whole press, by a fit to the others; cap height: recovered / true", evaluation, sep="\n")
    print(f"the best model is {fit.sensor.model}", f"verdict: {fit.verdict.lines}", sep="\n", flush=True)
    if fit.verdict.grade == BAD and not options.keep_bad:
        what = f"{name}.npz is not written, because the verdict of the fit is bad"
        raise InputError(what, remedy="mend the cause that is named, or give --keep-bad")
    return fit


def _progress(views: list[View]) -> Iterator[View]:
    """Give presses, and count them on a terminal."""
    for number, view in enumerate(views, 1):
        if sys.stderr.isatty():
            end = "\n" if number == len(views) else ""
            print(f"\rfit {number} of {len(views)} to all presses but one", end=end, file=sys.stderr, flush=True)
        yield view
