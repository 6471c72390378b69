# SPDX-License-Identifier: Apache-2.0
"""`tactile-depth depth`: height maps of pictures, as arrays, pictures, meshes and a report."""

from __future__ import annotations

import argparse
import contextlib
import json
from collections.abc import Iterator, Sequence
from datetime import datetime
from pathlib import Path
from typing import Any

import numpy as np
from PIL import ExifTags, Image
from PIL.PngImagePlugin import PngInfo

from tactile_depth.base.errors import InputError, counted
from tactile_depth.base.files import new_files
from tactile_depth.cli.options import add_pipeline_arguments, choose_sensor, make_pipeline, path_of, read_reference
from tactile_depth.cli.overview import draw_overview
from tactile_depth.cli.ply import write_ply
from tactile_depth.depth.pipeline import Pipeline
from tactile_depth.depth.result import Contact, Result, least_area_mm2
from tactile_depth.pictures.frames import PICTURE_SUFFIXES, read_pictures
from tactile_depth.pictures.grid_sampler import middle
from tactile_depth.pictures.pictures import rotated

NAME = "depth"
HELP = "Write the height maps of pictures: arrays, pictures, meshes and a report."
REPORT = "report.json"
HEIGHTS = "depth_mm.npy"
DEFAULT_OUT = "<name of the first picture or folder>-depth"
SUFFIXES = (*PICTURE_SUFFIXES, ".npy")
MICROMETRES = 1000  # of a millimetre
LARGEST_UM = 2**16 - 1
UNITS = {
    HEIGHTS: "height above the untouched surface in mm, float32; rows from the picture's top; with several pictures "
    "the first axis counts them",
    "depth_um.png": f"the same in micrometres, 16 bits, clipped at 0 and {LARGEST_UM}; viewers show it black, "
    "overview.png is for looking",
    "depth.ply": "the same as a mesh, mm",
    "captured_at": "time of capture, seconds since the epoch; null if the EXIF data of the picture lack it or its zone",
    "peak_height_mm": "largest height; of a contact the height of its peak",
    "contacts": "the contacts, that with most pixels first; contact is the record of all together",
    "warnings": "of a picture: why its heights are uncertain",
    "light_gains": "light of the reference over that of the picture, of red, green and blue; null without light gains",
    "peak_px, centroid_px": "row, column on the grid",
    "view": "shares of the width and height of the sensor's full picture that the grid is cut from; null: unknown",
    "peak_position_mm, centroid_mm": "row, column from the upper left corner of the grid; null without contact",
    "least_area_mm2": "least area above threshold_mm that is a contact",
    "area_threshold_mm": "depth above which a pixel is in the area: the one chosen, or half the contact's peak if that "
    "is less, at least threshold_mm",
    "area_mm2": "area above area_threshold_mm",
    "centroid": "weighted by what depth is above area_threshold_mm",
    "is_mostly_empty": "the area fills less than half of its bounding box: it is long, hollow, or of several contacts",
    "is_central": "the area lies wholly in the middle square, as high and wide as the grid's shorter side, where "
    "calibration_error was measured; null without contact",
    "volume_mm3": "sum of the depths in the area times the area of a pixel",
}
CONTACT = (
    *("peak_px", "peak_position_mm", "area_threshold_mm", "area_mm2", "volume_mm3"),
    *("centroid_px", "centroid_mm", "is_mostly_empty", "is_central"),
)
"""Entries of a contact in a report."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the subcommand."""
    parser.add_argument("pictures", nargs="+", metavar="PICTURE", help="PNG, JPEG, a .npy of frames, or a folder")
    parser.add_argument("--reference", required=True, metavar="BACKGROUND", help="the sensor without contact")
    parser.add_argument("--out", type=path_of, metavar="FOLDER", help=f"default: {DEFAULT_OUT}")
    add_pipeline_arguments(parser)
    parser.set_defaults(run=run)


def run(options: argparse.Namespace, warned: Sequence[str]) -> None:
    """Write all files of all pictures, or none."""
    out: Path = options.out or default_out(options.pictures[0])
    reference = read_reference(options.reference, options.rotate)
    sensor = choose_sensor(options, reference)
    pipeline = make_pipeline(options, sensor, reference)
    if options.out is None:
        _keep_others(out, options.pictures[0])
    with new_files(out, REPORT, "files") as folder:
        frames, heights = [], []
        for label, image, captured_at in _pictures(options.pictures, options.rotate):
            result = pipeline(image, name=label, captured_at=captured_at)
            heights.append(result.height_mm.astype(np.float32))
            frames.append((label, middle(image, pipeline.reader.share), result))
        digits = len(str(len(frames) - 1))
        described = []
        for index, (label, image, result) in enumerate(frames):
            suffix = f"_{index:0{digits}d}" if len(frames) > 1 else ""
            names = _write_frame(folder, suffix, label, image, result)
            described.append({"picture": label, **_describe(result), "files": names})
        np.save(folder / HEIGHTS, heights if len(heights) > 1 else heights[0])
        files = [HEIGHTS, REPORT, *(name for frame in described for name in frame["files"])]
        report = {**_describe_pipeline(pipeline, options), "pictures": described, "warnings": list(warned)}
        text = json.dumps({**report, "units": UNITS, "files": files}, indent=1, allow_nan=False)
        (folder / REPORT).write_text(text + "\n")
    print(f"grid: {pipeline.grid[1]} x {pipeline.grid[0]} pixels of {pipeline.pixel_pitch_mm:.4f} mm")
    for label, _, result in frames:
        print(f"{label}: {summary(result)}")
    print(f"results: {out}; overview.png is for looking: viewers show depth_um.png, which is in micrometres, black")


def _keep_others(out: Path, first: str) -> None:
    """Raise InputError if a folder that no argument names holds results of another first picture or folder."""
    before = first
    with contextlib.suppress(OSError, ValueError, LookupError, TypeError):
        before = str(json.loads((out / REPORT).read_text())["pictures"][0]["picture"])
    sources = (before, before.rpartition(": ")[0])  # a picture, or one of a folder or an .npy
    if Path(first).resolve() not in (Path(source).resolve() for source in sources):
        raise InputError(f"{out} holds results of {before}: give another folder as --out, or delete it")


def default_out(first: str) -> Path:
    """Return the folder of the results of a first picture; the dots of a folder's name are no suffix."""
    path = Path(first).resolve()
    suffix = path.suffix.lower()
    return Path(f"{path.stem if path.is_file() and suffix in SUFFIXES else path.name}-depth")


def _pictures(sources: Sequence[str], rotate: int) -> Iterator[tuple[str, np.ndarray, float | None]]:
    """Give pictures with their names and, if it is known, when they were captured."""
    for source in sources:
        labels, images = read_pictures(source, f"PICTURE {source}")
        for label, image in zip(labels, images, strict=True):
            path = Path(source) / label if Path(source).is_dir() else Path(source)
            yield (source if len(labels) == 1 else f"{source}: {label}"), rotated(image, rotate), _captured_at(path)


def _captured_at(path: Path) -> float | None:
    """Return when a picture was captured, in seconds since the epoch; None if its EXIF data lack time or time zone."""
    if path.suffix.lower() not in PICTURE_SUFFIXES:
        return None
    with Image.open(path) as picture:
        exif = picture.getexif().get_ifd(ExifTags.IFD.Exif)
    tags = ExifTags.Base
    day, zone, part = map(exif.get, (tags.DateTimeOriginal, tags.OffsetTimeOriginal, tags.SubsecTimeOriginal))
    part = part if str(part).isdecimal() else 0
    with contextlib.suppress(ValueError):
        return datetime.strptime(f"{day} {zone}", "%Y:%m:%d %H:%M:%S %z").timestamp() + float(f"0.{part}")
    return None


def summary(result: Result) -> str:
    """Return one line on a picture: height with its error, area, and what is doubtful."""
    contact = result.contact
    if contact.touching:
        peak, error = float(result.height_mm.max()), result.height_error
        spread = "" if error is None else f" +- {peak * error.relative:.2f}"
        parts = [f"peak height {peak:.2f}{spread} mm, contact area {contact.area_mm2:.1f} mm2"]
        if len(result.contacts) > 1:
            parts.append(f"{len(result.contacts)} contacts together")
        if result.warnings:
            parts.append("uncertain, as the warnings say")
        elif error is None:
            parts.append("error of the calibration not measured")
        elif not contact.is_central:
            parts.append(
                "the contact leaves the middle square, where the error was measured; outside it the error is larger"
            )
    else:
        parts = [f"no contact above {result.threshold_mm:.3g} mm"]
    for count, noun, what in (
        (int(result.outside.sum()), "pixel", "steeper than the calibration has seen"),
        (int(result.dark.sum()), "pixel", "without light"),
        (sum(result.saturations.values()), "value", "clipped"),
    ):
        if count:
            parts.append(f"{counted(count, noun)} {what}")
    return "; ".join(parts)


def _write_frame(folder: Path, suffix: str, label: str, image: np.ndarray, result: Result) -> list[str]:
    """Write the files of one picture; return their names."""
    picture, mesh, overview = (f"depth_um{suffix}.png", f"depth{suffix}.ply", f"overview{suffix}.png")
    micrometres = np.rint(result.height_mm * MICROMETRES).clip(0, LARGEST_UM).astype(np.uint16)
    unit = PngInfo()
    unit.add_text("Description", "height above the untouched surface in micrometres, which viewers show black")
    Image.fromarray(micrometres).save(folder / picture, pnginfo=unit)
    write_ply(folder / mesh, result.height_mm, result.pixel_pitch_mm, result.pixel_aspect)
    draw_overview(image, result, f"{label}: {summary(result)}").save(folder / overview)
    return [picture, mesh, overview]


def _describe_pipeline(pipeline: Pipeline, options: argparse.Namespace) -> dict[str, Any]:
    config, model = pipeline.config, pipeline.config.gradient_model
    error = None if pipeline.doubts else pipeline.sensor.height_errors.get(model)
    return {
        "calibration": pipeline.sensor.name,
        "calibration_named": options.calibration is not None,
        "gradient_model": model,
        "calibration_error": None
        if error is None
        else {
            "height_recovered_over_true": error.mean,
            "spread": error.spread,
            "presses": error.presses,
            "relative": error.relative,
        },
        "view": pipeline.sensor.view,
        "calibrated_slope": pipeline.sensor.fitted_slope.get(model),
        "reference": options.reference,
        "arithmetic": pipeline.arithmetic,
        "solver": config.solver,
        "boundary": config.boundary,
        "zero_offset": config.zero_offset,
        "light_gains": config.light_gains,
        "grid": {"rows": pipeline.grid[0], "columns": pipeline.grid[1]},
        "pixel_pitch_mm": pipeline.pixel_pitch_mm,
        "pixel_aspect": pipeline.sensor.pixel_aspect,
        "depth_lsb_mm": pipeline.depth_lsb_mm,
        "depth_range_mm": config.deepest_px * pipeline.pixel_pitch_mm,
        "threshold_mm": pipeline.threshold_mm,
        "area_threshold_mm": pipeline.area_threshold_mm,
        "least_area_mm2": least_area_mm2(pipeline.threshold_mm),
    }


def _describe(result: Result) -> dict[str, Any]:
    contact = result.contact
    described = {"touching": contact.touching, **_describe_contact(contact)}
    if not contact.touching:
        described |= {"area_threshold_mm": None, "is_central": None}
    return {
        "captured_at": result.captured_at,
        "peak_height_mm": float(result.height_mm.max()),
        "contact": described,
        "contacts": [{"peak_height_mm": each.peak_height_mm, **_describe_contact(each)} for each in result.contacts],
        "warnings": list(result.warnings),
        "light_gains": None if result.light_gains is None else result.light_gains.tolist(),
        "saturations": result.saturations,
        "dark_pixels": int(result.dark.sum()),
        "outside_pixels": int(result.outside.sum()),
    }


def _describe_contact(contact: Contact) -> dict[str, Any]:
    return {name: getattr(contact, name) for name in CONTACT}
