# SPDX-License-Identifier: Apache-2.0
"""`tactile-depth live`: depth of a camera, a video, pictures or a device as it comes, shown or recorded."""

from __future__ import annotations

import argparse
import gc
import sys
import time
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field
from typing import TextIO

import numpy as np
from PIL import Image

from tactile_depth.base.errors import InputError, InputWarning, counted
from tactile_depth.chip.link.depth_formats import FORMATS, NAMES, DepthFormat
from tactile_depth.cli.display import NUMBER, TIME, Display
from tactile_depth.cli.feed import CameraFeed, Feed, PackageFeed, SentFeed, Shot, capture_of_camera
from tactile_depth.cli.keys import pressed_keys
from tactile_depth.cli.measure import DEVICE, address_of
from tactile_depth.cli.options import (
    add_build_arguments,
    add_pipeline_arguments,
    choose_sensor,
    make_pipeline,
    named_sensor,
    path_of,
    read_reference,
    size,
)
from tactile_depth.cli.source import CameraChoice, Counts, Frame, Source
from tactile_depth.cli.viewer import LOOPBACK, PORT, load_rerun, page_of
from tactile_depth.depth.pipeline import Pipeline
from tactile_depth.device.addresses import SIM
from tactile_depth.device.device import Device
from tactile_depth.pictures.doubts import UnusablePicture
from tactile_depth.pictures.frames import GREY
from tactile_depth.pictures.picture_check import check_picture
from tactile_depth.pictures.reference_check import STEADY
from tactile_depth.sensor.built_in import read
from tactile_depth.sensor.sensor import Sensor
from tactile_depth.sensor.view import completed

NAME = "live"
HELP = "Show depth of a camera, a video, a folder of pictures or a device as it comes, or record it."
WORDS = NAMES[DepthFormat.WORDS]
CAPTURE = "capture"
CAPTURED = 8  # frames that a capture takes the mean of
PATIENCE_S = 0.1  # to wait for a frame; less with several sensors, of which none waits for another
PROGRESS_S = 0.2  # between two progress lines
PROGRESS_WIDTH = 78
REFERENCE, ZERO, QUIT = "r", "z", "q"
CAPTURES = {REFERENCE: "reference and the zero offset", ZERO: "zero offset"}
KEYS = f"keys: {REFERENCE} captures the {CAPTURES[REFERENCE]}, {ZERO} the {CAPTURES[ZERO]}, {QUIT} quits"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the subcommand."""
    parser.add_argument(
        "source",
        nargs="+",
        metavar="SOURCE",
        help="number or device of a camera, a video, a .npy of frames, a folder of pictures, or "
        f"{DEVICE}ADDRESS with the pipeline in hardware; several SOURCEs are several sensors, on one clock",
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
        action="append",
        metavar="BACKGROUND",
        help=f"the sensor without contact; {CAPTURE} (default): the first {CAPTURED} frames, so do not touch it; with "
        "several sensors one for each, in their order",
    )
    parser.add_argument(
        "--save", type=path_of, metavar="FILE.rrd", help="record what is shown; `rerun FILE.rrd` opens it"
    )
    parser.add_argument("--headless", action="store_true", help="open no viewer; needs --save")
    parser.add_argument("--web", action="store_true", help="show it in a browser of this computer, without a screen")
    parser.add_argument(
        "--web-address",
        metavar="IP[:PORT]",
        help=f"as --web, at this address (default {LOOPBACK}:{PORT}); 0.0.0.0 for every computer that can reach it",
    )
    parser.add_argument("--frames", type=int, metavar="N", help="stop after N frames of each sensor")
    camera = parser.add_argument_group("camera")
    camera.add_argument("--backend", default="", metavar="NAME", help="of OpenCV: v4l2, dshow, msmf, avfoundation, ..")
    camera.add_argument("--picture-size", type=size, metavar="WxH", help="size of its pictures")
    camera.add_argument(
        "--picture-format", type=four_letters, metavar="CODE", help="four letters, such as MJPG or YUYV"
    )
    add_pipeline_arguments(parser, several=True)
    add_build_arguments(parser)
    parser.set_defaults(run=run)


def four_letters(word: str) -> str:
    """Return the code of a picture format."""
    if len(word) != 4 or not word.isascii():
        raise argparse.ArgumentTypeError(f"{word}: accepted are four letters, such as MJPG")
    return word


@dataclass
class Watched:
    """A sensor that is watched.

    Attributes
    ----------
    name : str
        Its source.
    feed : Feed
    pipeline : Pipeline
    capture : str
        Key of the capture for which pictures are collected; "" for none.
    collected : list of arrays
        These pictures.
    state : str
        Contact of the last frame, in words.
    """

    name: str
    feed: Feed
    pipeline: Pipeline
    capture: str = ""
    collected: list[np.ndarray] = field(default_factory=list)
    state: str = ""


def run(options: argparse.Namespace, warned: Sequence[str]) -> None:
    """Show frames until the sources end, N are shown, q or Ctrl-C is pressed; then say how many, and which were lost.

    Raises
    ------
    InputError, Failure
    """
    page = page_of(options.web_address or LOOPBACK) if options.web or options.web_address else None
    if options.headless and page is not None:
        raise InputError("--headless opens no viewer, and --web serves one: omit one of them")
    if options.headless and options.save is None:
        raise InputError("--headless shows nothing: give --save FILE.rrd to record, or omit --headless")
    if options.frames is not None and options.frames < 1:
        raise InputError(f"--frames {options.frames}: accepted are 1 and more")
    address, names, each = device_of(options), options.source, options_of_each(options)
    with ExitStack() as stack:
        stack.callback(gc.freeze)  # Python's end would search all objects of the libraries: 1.2 s on a busy computer
        # A wrong input is told before the viewer opens.
        choice = CameraChoice(options.backend, options.picture_size, options.picture_format or "")
        pictures = names if address is None else [options.pictures] if options.pictures else []
        sources = [stack.enter_context(Source(name, choice, options.rotate)) for name in pictures]
        references = [None if one.reference == CAPTURE else read_reference(one.reference, one.rotate) for one in each]
        for one in each:
            if one.calibration is not None:
                require_calibration(one)
        load_rerun()  # its absence is told before anything is captured
        is_timed = len(sources) > 1 and any(source.is_camera for source in sources)
        display = stack.enter_context(
            Display(options.save, not options.headless, page, names, TIME if is_timed else NUMBER)
        )
        if page is not None:
            print(f"open {page.url}", flush=True)
        key = stack.enter_context(pressed_keys())
        counts, began = [source.counts for source in sources], time.monotonic()
        try:
            patience_s = PATIENCE_S / (len(sources) ** 2 or 1)
            if sources:
                given = zip(each, sources, references, strict=True)
                sensors = [of_pictures(address, *one, stack, patience_s) for one in given]
            else:
                sensors = [own_camera(str(address), each[0], references[0], stack)]
            counts = [sensor.feed.counts for sensor in sensors]
            if key is not None:
                print(KEYS)
            began = time.monotonic()
            has_ended = show(sensors, display, key, options.frames)
            for sensor in sensors:
                sensor.feed.end()
        finally:
            if is_terminal(sys.stderr):
                print(file=sys.stderr)  # the progress line ends
            for name, count in zip(names, counts, strict=False):
                if count.shown:
                    which = f"{name}: " if len(names) > 1 else ""
                    print(f"{which}{summary(count, time.monotonic() - began)}", flush=True)
        if options.save is not None:
            print(f"results: {options.save}", flush=True)
        if page is not None and has_ended:
            print("no more frames; the page stays until Ctrl-C", flush=True)
            while display.is_open() and (key is None or key() != QUIT):
                time.sleep(PATIENCE_S)


def require_calibration(options: argparse.Namespace) -> None:
    """Raise InputError if the calibration cannot be read; its warnings come when it is used."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", InputWarning)
        read(options.calibration, options.camera_size)


def options_of_each(options: argparse.Namespace) -> list[argparse.Namespace]:
    """Return the options of each sensor; raise InputError if there are more or fewer references or calibrations."""
    count = len(options.source)
    references, calibrations = options.reference or [CAPTURE] * count, options.calibration or [None]
    if len(calibrations) == 1:
        calibrations *= count
    for name, values in (("--reference", references), ("--calibration", calibrations)):
        if len(values) != count:
            problem = f"{name} is given {counted(len(values), 'time')} for {counted(count, 'SOURCE')}"
            raise InputError(f"{problem}: give it once for each, in their order")
    each = zip(options.source, references, calibrations, strict=True)
    return [
        argparse.Namespace(**{**vars(options), "source": source, "reference": reference, "calibration": calibration})
        for source, reference, calibration in each
    ]


def is_terminal(stream: TextIO | None) -> bool:
    """Return True for a stream to a terminal; a stream that is closed at the start is None."""
    return stream is not None and stream.isatty()


def shape_of(shape: Sequence[int], pitch_mm: float) -> str:
    """Return columns, rows and size of pixels in words."""
    rows, columns = shape
    return f"{columns} x {rows} pixels of {pitch_mm:.4f} mm"


def device_of(options: argparse.Namespace) -> str | None:
    """Return the address of the device, None for another source; raise InputError if options do not fit it."""
    devices = [source for source in options.source if source.startswith(DEVICE)]
    if devices and len(options.source) > 1:
        raise InputError(f"{devices[0]} with other sources: a device is watched alone: start the command for each")
    if not devices:
        if options.pictures is not None:
            raise InputError(f"--pictures {options.pictures} goes with a device: give it as SOURCE, or device:ADDRESS")
        if options.depth_format is not None:
            name = f"--depth-format {options.depth_format}"
            raise InputError(f"{name} goes with a device: omit it, or give device:ADDRESS as SOURCE")
        return None
    (source,) = devices
    address = address_of(source)
    if options.pictures is None and address.partition(":")[0] == SIM:
        raise InputError(f"{source} has no camera: give --pictures with a folder, a video or a camera")
    if options.pictures is None and options.calibration is None:
        raise InputError(
            f"{source} sends no camera pictures, by whose light a calibration could be chosen: give "
            "--calibration NAME_OR_FILE"
        )
    if options.pictures is None and options.rotate:
        raise InputError(f"--rotate {options.rotate}: {source} takes its own camera's pictures as they are: omit it")
    return address


def of_pictures(
    address: str | None,
    options: argparse.Namespace,
    source: Source,
    reference: np.ndarray | None,
    stack: ExitStack,
    patience_s: float,
) -> Watched:
    """Return depth of the pictures of a source, by a device if there is an address.

    Raises
    ------
    InputError, DeviceError
    """
    frames = source.frames(patience_s)
    if reference is None:
        reference = first_frames(frames, source)
    pipeline = make_pipeline(options, choose_sensor(options, reference), reference)
    if address is None:
        return Watched(source.name, PackageFeed(frames, pipeline, source.counts), pipeline)
    device = stack.enter_context(Device(address, pipeline, depth_format=options.depth_format or WORDS))
    device.load()
    return Watched(source.name, SentFeed(frames, device, source.counts), pipeline)


def own_camera(address: str, options: argparse.Namespace, reference: np.ndarray | None, stack: ExitStack) -> Watched:
    """Return depth of a device's own camera. Without a reference the device captures it.

    Raises
    ------
    InputError, DeviceError
    """
    sensor = named_sensor(options)
    is_given = reference is not None
    if not is_given:  # the picture that stands for a reference shows what the calibration's pictures show
        if options.crop is not None and sensor.view is None:
            sensor = completed(sensor, options.crop)
        options = argparse.Namespace(**{**vars(options), "crop": None})
    with warnings.catch_warnings():
        if not is_given:
            warnings.simplefilter("ignore", InputWarning)  # of the picture that stands for a reference for a moment
        pipeline = make_pipeline(options, sensor, reference if is_given else stand_in(sensor))
    device = stack.enter_context(Device(address, pipeline, depth_format=options.depth_format or WORDS))
    device.load()
    if not is_given:
        print(f"do not touch the sensor: its next {CAPTURED} frames become the reference", flush=True)
        capture_of_camera(device, reference=True)
    return Watched(address, CameraFeed(device), pipeline)


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
    print(f"{source.name}: " if source.is_camera else "", end="")
    print(f"do not touch the sensor: its first {CAPTURED} frames become the reference", flush=True)
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
        f"{source.name}: {counted(len(images), 'frame')}, the reference takes {CAPTURED}: give --reference BACKGROUND, "
        "a picture of the sensor without contact"
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


def merged(sensors: Sequence[Watched]) -> Iterator[tuple[int, Shot | None]]:
    """Give the shots of all sensors, each with the number of its sensor, in turn; raise InputError if one has none."""
    waiting = {index: sensor.feed.shots() for index, sensor in enumerate(sensors)}
    while waiting:
        for index, shots in list(waiting.items()):
            try:
                yield index, next(shots)
            except StopIteration:
                del waiting[index]
                if not sensors[index].feed.counts.shown:
                    problem = f"{sensors[index].name}: no frame to show"
                    raise InputError(f"{problem}: give a source with more of them") from None


def show(sensors: Sequence[Watched], display: Display, key: Callable[[], str] | None, most: int | None) -> bool:
    """Show frames until they end; r and z capture from the frames that follow.

    Returns
    -------
    bool
        False if `most` of each sensor are shown, q is pressed, or the viewer was closed.
    """
    began, told = time.monotonic(), 0.0
    for index, shot in merged(sensors):
        pressed = key() if key is not None else ""
        if pressed == QUIT:
            return False
        if pressed in CAPTURES:
            for each in sensors:
                each.capture, each.collected = pressed, []
            print(f"\ncapturing the {CAPTURES[pressed]}: do not touch the sensor")
        sensor = sensors[index]
        if shot is None or (most is not None and sensor.feed.counts.shown >= most):
            continue
        if not sensor.feed.counts.shown:
            describe(sensor, shot, len(sensors) > 1)
        if display.show(*shot, index) is False:
            return False
        sensor.feed.counts.shown += 1
        if sensor.capture:
            if shot.image is not None:
                sensor.collected.append(shot.image)
            if not sensor.feed.takes_pictures or len(sensor.collected) == CAPTURED:
                take(sensor)
        now, sensor.state = time.monotonic(), state_of(shot)
        if is_terminal(sys.stderr) and now > told + PROGRESS_S:
            told = now
            print(f"\r{progress(sensors, now - began)}", end="", file=sys.stderr, flush=True)
        if most is not None and all(each.feed.counts.shown >= most for each in sensors):
            return False
    return True


def describe(sensor: Watched, shot: Shot, is_one_of_many: bool) -> None:
    """Print grid and depth map of a sensor."""
    which, pipeline, shape = f"{sensor.name}: " if is_one_of_many else "", sensor.pipeline, shot.depth.codes.shape
    print(f"{which}grid: {shape_of(pipeline.grid, pipeline.pixel_pitch_mm)}", flush=True)
    if shape != pipeline.grid:
        print(f"{which}depth: {shape_of(shape, shot.depth.pixel_pitch_mm)}")


def take(sensor: Watched) -> None:
    """Make pictures without contact the reference, and after it the zero offset, or the zero offset alone."""
    capture, sensor.capture = sensor.capture, ""
    try:
        sensor.feed.capture(sensor.collected, capture == REFERENCE)
    except InputError as error:
        print(f"tactile-depth: nothing captured: {error}", file=sys.stderr)
        return
    print(f"captured the {CAPTURES[capture]}")


def state_of(shot: Shot) -> str:
    """Return the contact of a frame in words."""
    contact = shot.depth.contact
    if not contact.touching:
        return "no contact"
    return f"peak height {contact.peak_height_mm:.2f} mm, area {contact.area_mm2:.1f} mm2"


def progress(sensors: Sequence[Watched], seconds: float) -> str:
    """Return one line on the frames that are shown."""
    shown = sum(sensor.feed.counts.shown for sensor in sensors)
    dropped = sum(sensor.feed.counts.dropped for sensor in sensors)
    states = "; ".join(sensor.state for sensor in sensors)
    return f"{counted(shown, 'frame')}, {shown / max(seconds, 1e-9):.1f} frames/s, {dropped} dropped; {states}".ljust(
        PROGRESS_WIDTH
    )


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
