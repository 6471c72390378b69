# SPDX-License-Identifier: Apache-2.0
"""`tactile-depth live`: depth of a camera, a video, pictures or a device as it comes, shown or recorded."""

from __future__ import annotations

import argparse
import itertools
import sys
import time
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack
from pathlib import Path

import numpy as np
from PIL import Image

from tactile_depth.base.errors import InputError, InputWarning
from tactile_depth.chip.link.depth_formats import FORMATS, NAMES, DepthFormat
from tactile_depth.cli.display import Display, load_rerun
from tactile_depth.cli.feed import CameraFeed, Feed, PackageFeed, SentFeed, Shot, capture_of_camera
from tactile_depth.cli.keys import pressed_keys
from tactile_depth.cli.measure import DEVICE, address_of
from tactile_depth.cli.options import (
    add_build_arguments,
    add_pipeline_arguments,
    choose_sensor,
    make_pipeline,
    named_sensor,
    read_reference,
)
from tactile_depth.cli.source import Counts, Frame, Source
from tactile_depth.depth.pipeline import Pipeline
from tactile_depth.device.addresses import SIM
from tactile_depth.device.device import Device
from tactile_depth.pictures.doubts import UnusablePicture
from tactile_depth.pictures.frames import GREY
from tactile_depth.pictures.picture_check import check_picture
from tactile_depth.pictures.reference_check import STEADY
from tactile_depth.sensor.sensor import Sensor
from tactile_depth.sensor.view import completed

NAME = "live"
HELP = "Show depth of a camera, a video, a folder of pictures or a device as it comes, or record it."
WORDS = NAMES[DepthFormat.WORDS]
CAPTURE = "capture"
CAPTURED = 8  # frames that a capture takes the mean of
PROGRESS_S = 0.2  # between two progress lines
PROGRESS_WIDTH = 78
REFERENCE, ZERO, QUIT = "r", "z", "q"
CAPTURES = {REFERENCE: "reference and the zero offset", ZERO: "zero offset"}
KEYS = f"keys: {REFERENCE} captures the {CAPTURES[REFERENCE]}, {ZERO} the {CAPTURES[ZERO]}, {QUIT} quits"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the subcommand."""
    parser.add_argument(
        "source",
        metavar="SOURCE",
        help="number or device of a camera, a video, a .npy of frames, a folder of pictures, or "
        f"{DEVICE}ADDRESS with the pipeline in hardware",
    )
    parser.add_argument(
        "--pictures",
        metavar="SOURCE",
        help=f"with {DEVICE}..: pictures to be sent to it, a SOURCE as above; by default its own camera takes them",
    )
    parser.add_argument(
        "--depth-format",
        choices=tuple(FORMATS),
        help=f"with {DEVICE}..: {WORDS} (default), whole depth codes; 16-bit, codes rounded to 16 bits; averaged, the "
        "mean of 2x2 codes in 16 bits, of which a line carries six times as many frames",
    )
    parser.add_argument(
        "--reference",
        default=CAPTURE,
        metavar="BACKGROUND",
        help=f"the sensor without contact; {CAPTURE} (default): the first {CAPTURED} frames, so do not touch it",
    )
    parser.add_argument("--save", type=Path, metavar="FILE.rrd", help="record what is shown; `rerun FILE.rrd` opens it")
    parser.add_argument("--headless", action="store_true", help="open no viewer; needs --save")
    parser.add_argument("--frames", type=int, metavar="N", help="stop after N frames")
    add_pipeline_arguments(parser)
    add_build_arguments(parser)
    parser.set_defaults(run=run)


def run(options: argparse.Namespace, warned: Sequence[str]) -> None:
    """Show frames until the source ends, N are shown, q or Ctrl-C is pressed; then say how many, and which were lost.

    Raises
    ------
    InputError, Failure
    """
    if options.headless and options.save is None:
        raise InputError("--headless shows nothing: give --save FILE.rrd to record, or omit --headless")
    if options.frames is not None and options.frames < 1:
        raise InputError(f"--frames {options.frames}: accepted are 1 and more")
    address = device_of(options)
    load_rerun()  # its absence is told before anything is captured
    reference = None if options.reference == CAPTURE else read_reference(options.reference)
    with ExitStack() as stack:
        source = None
        if address is None or options.pictures is not None:
            source = stack.enter_context(Source(options.pictures or options.source))
        key = stack.enter_context(pressed_keys())
        counts = Counts() if source is None else source.counts
        began = time.monotonic()
        try:
            if source is None:
                feed, pipeline = own_camera(str(address), options, reference, stack)
            else:
                feed, pipeline = of_pictures(address, options, source, reference, stack)
            counts, shots = feed.counts, feed.shots()
            first = next((shot for shot in shots if shot is not None), None)
            if first is None:
                raise InputError(
                    f"{options.pictures or options.source}: no frame to show: give a source with more of them"
                )
            print(f"grid: {shape_of(pipeline.grid, pipeline.pixel_pitch_mm)}")
            if first.depth.codes.shape != pipeline.grid:
                print(f"depth: {shape_of(first.depth.codes.shape, first.depth.pixel_pitch_mm)}")
            with Display(options.save, not options.headless) as display:
                if key is not None:
                    print(KEYS)
                began = time.monotonic()
                show(itertools.chain([first], shots), feed, display, key, options.frames)
            feed.end()
        finally:
            if sys.stderr.isatty():
                print(file=sys.stderr)  # the progress line ends
            if counts.shown:
                print(summary(counts, time.monotonic() - began))
    if options.save is not None:
        print(f"results: {options.save}")


def shape_of(shape: Sequence[int], pitch_mm: float) -> str:
    """Return columns, rows and size of pixels in words."""
    rows, columns = shape
    return f"{columns} x {rows} pixels of {pitch_mm:.4f} mm"


def device_of(options: argparse.Namespace) -> str | None:
    """Return the address of the device, None for another source; raise InputError if options do not fit it."""
    if not options.source.startswith(DEVICE):
        if options.pictures is not None:
            raise InputError(f"--pictures {options.pictures} goes with a device: give it as SOURCE, or device:ADDRESS")
        if options.depth_format is not None:
            name = f"--depth-format {options.depth_format}"
            raise InputError(f"{name} goes with a device: omit it, or give device:ADDRESS as SOURCE")
        return None
    address = address_of(options.source)
    if options.pictures is None and address.partition(":")[0] == SIM:
        raise InputError(f"{options.source} has no camera: give --pictures with a folder, a video or a camera")
    if options.pictures is None and options.calibration is None:
        raise InputError(
            f"{options.source} sends no camera pictures, by whose light a calibration could be chosen: give "
            "--calibration NAME_OR_FILE"
        )
    return address


def of_pictures(
    address: str | None, options: argparse.Namespace, source: Source, reference: np.ndarray | None, stack: ExitStack
) -> tuple[Feed, Pipeline]:
    """Return depth of the pictures of a source, by a device if there is an address, and the pipeline.

    Raises
    ------
    InputError, DeviceError
    """
    frames = source.frames()
    if reference is None:
        reference = first_frames(frames, source)
    pipeline = make_pipeline(options, choose_sensor(options, reference), reference)
    if address is None:
        return PackageFeed(frames, pipeline, source.counts), pipeline
    device = stack.enter_context(Device(address, pipeline, depth_format=options.depth_format or WORDS))
    device.load()
    return SentFeed(frames, device, source.counts), pipeline


def own_camera(
    address: str, options: argparse.Namespace, reference: np.ndarray | None, stack: ExitStack
) -> tuple[Feed, Pipeline]:
    """Return depth of a device's own camera, and the pipeline. Without a reference the device captures it.

    Raises
    ------
    InputError, DeviceError
    """
    sensor = named_sensor(options)
    is_given = reference is not None
    if not is_given and options.crop is not None and sensor.view is None:
        sensor = completed(sensor, options.crop)
    with warnings.catch_warnings():
        if not is_given:
            warnings.simplefilter("ignore", InputWarning)  # of the picture that stands for a reference for a moment
        if not is_given:
            options.crop = None  # the picture that stands for a reference shows what the calibration's pictures show
        pipeline = make_pipeline(options, sensor, reference if is_given else stand_in(sensor))
    device = stack.enter_context(Device(address, pipeline, depth_format=options.depth_format or WORDS))
    device.load()
    if not is_given:
        print(f"do not touch the sensor: its next {CAPTURED} frames become the reference", flush=True)
        capture_of_camera(device, reference=True)
    return CameraFeed(device), pipeline


def stand_in(sensor: Sensor) -> np.ndarray | None:
    """Return a picture with the lighting of a sensor, until its device has captured a reference.

    Returns
    -------
    uint8 array (rows, columns, 3), or None for the synthetic sensor, which takes colours as sent
    """
    if sensor.camera is None:
        return None
    size = (sensor.camera.columns, sensor.camera.rows)
    light = np.ones((2, 2, 3)) if sensor.lighting is None else sensor.lighting
    colours = [np.array(Image.fromarray(np.float32(GREY * light[..., colour])).resize(size)) for colour in range(3)]
    return np.stack(colours, axis=-1).clip(1, 255).astype(np.uint8)


def first_frames(frames: Iterator[Frame | None], source: Source) -> np.ndarray:
    """Return the first frames of a source, uint8 (`CAPTURED`, rows, columns, 3), as a reference."""
    print(f"do not touch the sensor: its first {CAPTURED} frames become the reference")
    images: list[np.ndarray] = []
    for frame in frames:
        if frame is None:
            continue
        if not _is_settled(frame, images, source):
            continue
        source.counts.captured += 1
        images.append(frame.image)
        if frame.image.shape != images[0].shape:
            raise InputError(f"{source.name}: frame {frame.index} has another size: give pictures of one size")
        if len(images) == CAPTURED:
            return np.stack(images)
    raise InputError(
        f"{source.name}: {len(images)} frames, the reference takes {CAPTURED}: give --reference BACKGROUND, a picture "
        "of the sensor without contact"
    )


def _is_settled(frame: Frame, images: list[np.ndarray], source: Source) -> bool:
    """Return False for a frame that gives no reference; begin anew when the exposure has changed. Both are counted."""
    try:
        check_picture(frame.image, None, f"frame {frame.index}")
    except UnusablePicture as error:
        source.counts.fail(error)
        return False
    if images and abs(frame.image.mean() / images[0].mean() - 1) > STEADY:
        for _ in images:
            source.counts.fail(InputError(f"{source.name}: the exposure has not settled"))
        source.counts.captured -= len(images)
        images.clear()
    return True


def show(
    shots: Iterator[Shot | None],
    feed: Feed,
    display: Display,
    key: Callable[[], str] | None,
    most: int | None,
) -> None:
    """Show frames until they end, `most` are shown or q is pressed; r and z capture from the frames that follow."""
    capture, collected, counts = "", list[np.ndarray](), feed.counts
    began, told = time.monotonic(), 0.0
    for shot in shots:
        pressed = key() if key is not None else ""
        if pressed == QUIT:
            return
        if pressed in CAPTURES:
            capture, collected = pressed, []
            print(f"\ncapturing the {CAPTURES[pressed]}: do not touch the sensor")
        if shot is None:
            continue
        display.show(*shot)
        counts.shown += 1
        if capture:
            if shot.image is not None:
                collected.append(shot.image)
            if not feed.takes_pictures or len(collected) == CAPTURED:
                take(capture, collected, feed)
                capture = ""
        now = time.monotonic()
        if sys.stderr.isatty() and now > told + PROGRESS_S:
            told = now
            print(f"\r{progress(counts, shot, now - began)}", end="", file=sys.stderr, flush=True)
        if counts.shown == most:
            return


def take(capture: str, collected: Sequence[np.ndarray], feed: Feed) -> None:
    """Make frames without contact the reference, and after it the zero offset, or the zero offset alone."""
    try:
        feed.capture(collected, capture == REFERENCE)
    except InputError as error:
        print(f"tactile-depth: nothing captured: {error}", file=sys.stderr)
        return
    print(f"captured the {CAPTURES[capture]}")


def progress(counts: Counts, shot: Shot, seconds: float) -> str:
    """Return one line on the frame that is shown."""
    contact = shot.depth.contact
    touching = f"peak {contact.peak_mm:.2f} mm, area {contact.area_mm2:.1f} mm2" if contact.touching else "no contact"
    rate = counts.shown / max(seconds, 1e-9)
    return f"{counts.shown} frames, {rate:.1f} frames/s, {counts.dropped} dropped; {touching}".ljust(PROGRESS_WIDTH)


def summary(counts: Counts, seconds: float) -> str:
    """Return one line at the end: every frame that was read is in exactly one of the numbers after it."""
    parts = [f"read {counts.read}", f"shown {counts.shown}", f"dropped {counts.dropped}", f"failed {counts.failed}"]
    if counts.captured:
        parts.insert(1, f"captured {counts.captured}")
    if counts.lost:
        parts.append(f"lost {counts.lost}")
    if counts.unfinished:
        parts.append(f"unfinished {counts.unfinished}")
    return f"frames: {', '.join(parts)}; {counts.shown / max(seconds, 1e-9):.1f} frames/s"
