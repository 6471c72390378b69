# SPDX-License-Identifier: Apache-2.0
"""`tactile-depth live`: depth of a camera, a video or pictures as they come, shown or recorded."""

from __future__ import annotations

import argparse
import itertools
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import numpy as np

from tactile_depth.checks.doubts import UnusablePicture
from tactile_depth.checks.picture_check import check_picture
from tactile_depth.checks.reference_check import STEADY
from tactile_depth.cli.display import Display, load_rerun
from tactile_depth.cli.keys import pressed_keys
from tactile_depth.cli.options import add_pipeline_arguments, choose_sensor, make_pipeline, read_reference
from tactile_depth.cli.source import Counts, Frame, Source
from tactile_depth.errors import InputError
from tactile_depth.pipeline import Pipeline
from tactile_depth.result import Result

NAME = "live"
HELP = "Show depth of a camera, a video or a folder of pictures as they come, or record it."
CAPTURE = "capture"
CAPTURED = 8  # frames that a capture takes the mean of
PROGRESS_S = 0.2  # between two progress lines
PROGRESS_WIDTH = 78
REFERENCE, ZERO, QUIT = "r", "z", "q"
CAPTURES = {REFERENCE: "reference and the zero offset", ZERO: "zero offset"}
KEYS = f"keys: {REFERENCE} captures the {CAPTURES[REFERENCE]}, {ZERO} the {CAPTURES[ZERO]}, {QUIT} quits"

Shot = tuple[Frame, Result]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the subcommand."""
    parser.add_argument(
        "source", metavar="SOURCE", help="number or device of a camera, a video, a .npy of frames, a folder of pictures"
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
    load_rerun()  # its absence is told before anything is captured
    reference = None if options.reference == CAPTURE else read_reference(options.reference)
    with Source(options.source) as source, pressed_keys() as key:
        began = time.monotonic()
        try:
            frames = source.frames()
            if reference is None:
                reference = first_frames(frames, source)
            pipeline = make_pipeline(options, choose_sensor(options, reference), reference)
            shots = processed(frames, pipeline, source.counts)
            first = next((shot for shot in shots if shot is not None), None)
            if first is None:
                raise InputError(f"{source.name}: no frame to show: give a source with more of them")
            print(f"grid: {pipeline.grid[1]} x {pipeline.grid[0]} pixels of {pipeline.pixel_pitch_mm:.4f} mm")
            with Display(options.save, not options.headless) as display:
                if key is not None:
                    print(KEYS)
                began = time.monotonic()
                show(itertools.chain([first], shots), pipeline, display, source.counts, key, options.frames)
        finally:
            if sys.stderr.isatty():
                print(file=sys.stderr)  # the progress line ends
            if source.counts.shown:
                print(summary(source.counts, time.monotonic() - began))
    if options.save is not None:
        print(f"results: {options.save}")


def first_frames(frames: Iterator[Frame | None], source: Source) -> np.ndarray:
    """Return the first frames of a source, uint8 (`CAPTURED`, rows, columns, 3), as a reference.

    Raises
    ------
    InputError
        There are fewer, or their sizes differ.
    """
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


def processed(frames: Iterator[Frame | None], pipeline: Pipeline, counts: Counts) -> Iterator[Shot | None]:
    """Give frames with their depth; None when none has arrived for a while.

    Raises
    ------
    InputError
        The first frame cannot be processed. Later ones are counted as failed, and so are frames that give no depth.
    """
    is_first, stream = True, pipeline.new_stream()
    for frame in frames:
        if frame is None:
            yield None
            continue
        try:
            result = pipeline(frame.image, stream, f"frame {frame.index}")
        except InputError as error:
            if is_first and not isinstance(error, UnusablePicture):
                raise
            counts.fail(error)
            continue
        is_first = False
        yield frame, result


def show(
    shots: Iterator[Shot | None],
    pipeline: Pipeline,
    display: Display,
    counts: Counts,
    key: Callable[[], str] | None,
    most: int | None,
) -> None:
    """Show frames until they end, `most` are shown or q is pressed; r and z capture from the frames that follow."""
    capture, collected = "", list[np.ndarray]()
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
        frame, result = shot
        display.show(frame.index, frame.image, result)
        counts.shown += 1
        if capture:
            collected.append(frame.image)
            if len(collected) == CAPTURED:
                take(capture, collected, pipeline)
                capture = ""
        now = time.monotonic()
        if sys.stderr.isatty() and now > told + PROGRESS_S:
            told = now
            print(f"\r{progress(counts, result, now - began)}", end="", file=sys.stderr, flush=True)
        if counts.shown == most:
            return


def take(capture: str, collected: Sequence[np.ndarray], pipeline: Pipeline) -> None:
    """Make frames without contact the reference, and after it the zero offset, or the zero offset alone."""
    try:
        images = np.stack(collected)
        if capture == REFERENCE:
            pipeline.capture_reference(images)
        if capture == ZERO or pipeline.config.zero_offset:
            pipeline.capture_zero(images)
    except (InputError, ValueError) as error:  # numpy: sizes differ
        print(f"tactile-depth: nothing captured: {error}", file=sys.stderr)
        return
    print(f"captured the {CAPTURES[capture]}")


def progress(counts: Counts, result: Result, seconds: float) -> str:
    """Return one line on the frame that is shown."""
    contact = result.contact
    touching = f"peak {contact.peak_mm:.2f} mm, area {contact.area_mm2:.1f} mm2" if contact.touching else "no contact"
    rate = counts.shown / max(seconds, 1e-9)
    return f"{counts.shown} frames, {rate:.1f} frames/s, {counts.dropped} dropped; {touching}".ljust(PROGRESS_WIDTH)


def summary(counts: Counts, seconds: float) -> str:
    """Return one line at the end: every frame that was read is in exactly one of the numbers after it."""
    parts = [f"read {counts.read}", f"shown {counts.shown}", f"dropped {counts.dropped}", f"failed {counts.failed}"]
    if counts.captured:
        parts.insert(1, f"captured {counts.captured}")
    if counts.unfinished:
        parts.append(f"unfinished {counts.unfinished}")
    return f"frames: {', '.join(parts)}; {counts.shown / max(seconds, 1e-9):.1f} frames/s"
