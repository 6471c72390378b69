# SPDX-License-Identifier: Apache-2.0
"""Frames of a camera, a video or pictures, read ahead by a thread; each that is lost is counted."""

from __future__ import annotations

import contextlib
import os
import queue
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import AbstractContextManager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from tactile_depth.base.errors import InputError, counted, install
from tactile_depth.base.npy import is_file
from tactile_depth.cli.failure import Failure
from tactile_depth.pictures.frames import PICTURE_SUFFIXES, read_pictures
from tactile_depth.pictures.pictures import rotated

QUEUED = 4  # frames that wait between the reader and the pipeline
DEAD_AFTER, DEAD_S = 30, 5.0  # failed reads in a row of a camera, and seconds without a frame
CLOSING_S = 1.0  # that a read may take when a source is closed; V4L2 waits up to 10 s for a camera that is gone
DEVICES = "/dev/"
CAMERAS = Path("/sys/class/video4linux")  # of Linux
HINTS = {
    "win32": "try 0, 1, 2, and --backend dshow or msmf; close other programs that use it",
    "darwin": "try 0, 1, 2; allow the terminal the camera in System Settings, Privacy & Security",
}
INSTALL = install("live")

Item = np.ndarray | InputError  # a frame, or why one could not be read


@dataclass(frozen=True)
class Frame:
    """A frame of a source.

    Attributes
    ----------
    index : int
        Its number in the source, from 0, dropped and unreadable ones included.
    image : uint8 array (rows, columns, 3), RGB
    captured_at : float or None
        When the camera delivered it, in seconds since the epoch, as `time.time` gives it; None for files.
    """

    index: int
    image: np.ndarray
    captured_at: float | None = None


class CameraChoice(NamedTuple):
    """Choices with which a camera is opened; those that are "" or None are left to the system.

    Attributes
    ----------
    backend : str
        Name of OpenCV's backend, such as `v4l2`, `dshow`, `msmf` or `avfoundation`.
    size : (rows, columns) or None
        Of its pictures.
    picture_format : str
        Four letters, such as `MJPG` or `YUYV`.
    """

    backend: str = ""
    size: tuple[int, int] | None = None
    picture_format: str = ""


AS_IT_IS = CameraChoice()


@dataclass
class Counts:
    """Numbers of frames by outcome; `read` is the sum of all others but `taken`, and of `unfinished`.

    Attributes
    ----------
    taken : int
        Came to the consumer, readable or not.
    captured : int
        Became the reference before anything was shown.
    shown : int
    dropped : int
        The camera was faster than the pipeline.
    failed : int
        Could not be read or processed.
    lost : int
        Got lost on the line to a device or from it.
    """

    taken: int = 0
    captured: int = 0
    shown: int = 0
    dropped: int = 0
    failed: int = 0
    lost: int = 0

    @property
    def read(self) -> int:
        """All frames but those that still wait when the source is closed."""
        return self.taken + self.dropped

    @property
    def unfinished(self) -> int:
        """Frames that were in work when the user ended it: at most one."""
        return self.taken - self.captured - self.shown - self.failed - self.lost

    def fail(self, reason: InputError) -> None:
        """Count a frame that could not be read or processed; say why for the first."""
        self.failed += 1
        if self.failed == 1:
            print(f"tactile-depth: a frame is left out; others are counted at the end: {reason}", file=sys.stderr)


class Source(AbstractContextManager["Source"]):
    """Frames in the order of their arrival, for one consumer.

    A camera does not wait: when the queue is full the oldest frame is dropped. Files wait: none is dropped.

    Parameters
    ----------
    name : str
        Number or device of a camera, a video file, a picture, a `.npy` of frames, or a folder of pictures.
    choice : CameraChoice
        For a camera.
    rotate : int
        Degrees, counter-clockwise, by which frames are rotated.

    Attributes
    ----------
    counts : Counts
        `taken`, `dropped` and the unreadable among `failed` are counted here, the others by the consumer.

    Failure
        OpenCV is missing, or the camera cannot be opened.
    """

    def __init__(self, name: str, choice: CameraChoice = AS_IT_IS, rotate: int = 0) -> None:
        self.name, self.counts, self._rotate = name, Counts(), rotate
        self.is_camera = name.isdecimal() or name.startswith(DEVICES)
        items = _camera(name, choice) if self.is_camera else _files(name)
        self._queue: queue.Queue[Frame | InputError | Failure | None] = queue.Queue(QUEUED)
        self._stopped = threading.Event()
        self._thread = threading.Thread(target=self._read, args=(items,), daemon=True)
        self._thread.start()

    def __exit__(self, *raised: object) -> None:
        self._stopped.set()
        self._thread.join(CLOSING_S)

    def frames(self, patience_s: float = 0.1) -> Iterator[Frame | None]:
        """Give the frames to the end; None when none has arrived for a while.

        Raises
        ------
        Failure
            The camera gives no frames any more.
        """
        while True:
            try:
                item = self._queue.get(timeout=patience_s)
            except queue.Empty:
                yield None
                continue
            if item is None:
                return
            if isinstance(item, Failure):
                raise item
            self.counts.taken += 1
            if isinstance(item, InputError):
                self.counts.fail(item)
            else:
                yield item

    def _read(self, items: Iterator[Item]) -> None:
        end: Failure | None = None
        try:
            for index, item in enumerate(items):
                now = time.time() if self.is_camera else None
                self._put(item if isinstance(item, InputError) else Frame(index, rotated(item, self._rotate), now))
                if self._stopped.is_set():
                    return
        except Failure as error:
            end = error
        self._put(end)

    def _put(self, item: Frame | InputError | Failure | None) -> None:
        while not self._stopped.is_set():
            try:
                self._queue.put(item, timeout=0.01 if self.is_camera else 0.1)
                return
            except queue.Full:
                if self.is_camera:
                    with contextlib.suppress(queue.Empty):  # the consumer was quicker
                        self._queue.get_nowait()  # the oldest
                        self.counts.dropped += 1


def load_opencv() -> Any:
    """Return the module cv2.

    Raises
    ------
    Failure
        It is not installed.
    """
    os.environ.setdefault("OPENCV_FFMPEG_LOGLEVEL", "-8")  # quiet: what fails is told here, in one line
    os.environ.setdefault("OPENCV_LOG_LEVEL", "SILENT")
    try:
        import cv2
    except ImportError as error:
        raise Failure(f"cameras and videos are read by OpenCV, which is not installed: {INSTALL}") from error
    return cv2


def _files(name: str) -> Iterator[Item]:
    """Open a file or a folder at once, and give its frames later."""
    path = Path(name)
    is_video = is_file(path) and path.suffix.lower() not in (".npy", *PICTURE_SUFFIXES)
    if not is_video and not path.exists():
        raise InputError(
            f"{name}: no such source: give the number of a camera, a video, a .npy of frames or a folder of pictures"
        )
    return _video(name) if is_video else _images(iter(read_pictures(path)[1]))


def _images(images: Iterator[np.ndarray]) -> Iterator[Item]:
    while True:
        try:
            yield next(images)
        except StopIteration:
            return
        except InputError as error:
            yield error


def _video(name: str) -> Iterator[Item]:
    cv2 = load_opencv()
    video = cv2.VideoCapture(name)
    if not video.isOpened():
        raise InputError(
            f"{name}: not a readable video: give one that OpenCV reads, as an MP4, or a folder of pictures"
        )
    return _video_frames(cv2, video, name)


def _video_frames(cv2: Any, video: Any, name: str) -> Iterator[Item]:
    claimed = round(video.get(cv2.CAP_PROP_FRAME_COUNT))
    count = 0
    try:
        while True:
            is_read, image = video.read()
            if not is_read:
                break
            count += 1
            yield cv2.cvtColor(image, cv2.COLOR_BGR2RGB)
    finally:
        video.release()
    for _ in range(claimed - count):
        yield InputError(f"{name}: it claims {counted(claimed, 'frame')}, {count} could be read: give an intact video")


def _camera(name: str, choice: CameraChoice) -> Iterator[Item]:
    cv2 = load_opencv()
    device = os.path.realpath(name) if name.startswith(DEVICES) else name  # /dev/v4l/by-id/.. is a link
    number = device.removeprefix(f"{DEVICES}video")
    backend = [_backend(cv2, choice.backend)] if choice.backend else []
    camera = cv2.VideoCapture(int(number) if number.isdecimal() else device, *backend)
    if not camera.isOpened():
        raise Failure(f"camera {name} cannot be opened: {_hint()}")
    if choice.picture_format:
        camera.set(cv2.CAP_PROP_FOURCC, cv2.VideoWriter.fourcc(*choice.picture_format))
    if choice.size is not None:
        camera.set(cv2.CAP_PROP_FRAME_HEIGHT, choice.size[0])
        camera.set(cv2.CAP_PROP_FRAME_WIDTH, choice.size[1])
    try:
        _require(cv2, camera, name, choice)
    except InputError:
        camera.release()
        raise
    return _camera_frames(cv2, camera, name)


def _backend(cv2: Any, name: str) -> int:
    """Return the number of a backend; raise InputError, which lists those of this OpenCV, if it is none of them."""
    registry = cv2.videoio_registry
    known = {registry.getBackendName(each).lower(): each for each in registry.getCameraBackends()}
    if name.lower() not in known:
        raise InputError(f"--backend {name} is none of this OpenCV", accepted=sorted(known))
    return known[name.lower()]


def _require(cv2: Any, camera: Any, name: str, choice: CameraChoice) -> None:
    """Raise InputError if a camera did not take the size or the format that was chosen."""
    lists = "; `v4l2-ctl --list-formats-ext` lists them" if sys.platform == "linux" else ""
    if choice.size is not None:
        rows, columns = (round(camera.get(each)) for each in (cv2.CAP_PROP_FRAME_HEIGHT, cv2.CAP_PROP_FRAME_WIDTH))
        if (rows, columns) != choice.size:
            asked = "{1}x{0}".format(*choice.size)
            raise InputError(
                f"--picture-size {asked}: camera {name} sends {columns}x{rows}: give a size that it has{lists}"
            )
    code = round(camera.get(cv2.CAP_PROP_FOURCC)) if choice.picture_format else 0
    if code > 0 and (taken := code.to_bytes(4, "little").decode("ascii", "replace")) != choice.picture_format:
        raise InputError(
            f"--picture-format {choice.picture_format}: camera {name} sends {taken}: give a format that it has{lists}"
        )


def _hint() -> str:
    """Return how to find a camera on this system."""
    if (hint := HINTS.get(sys.platform)) is not None:
        return hint
    names = []
    for folder in sorted(CAMERAS.glob("video*"), key=lambda each: (len(each.name), each.name)):
        with contextlib.suppress(OSError):
            if (folder / "index").read_text().strip() == "0":  # the others of a camera carry no pictures
                names.append(f"{folder.name.removeprefix('video')} ({(folder / 'name').read_text().strip()})")
    if not names:
        return "this computer has no camera: plug it in, and look for its number with `v4l2-ctl --list-devices`"
    return f"this computer has {', '.join(names)}; another program may use it, or you are not in the group video"


def _camera_frames(cv2: Any, camera: Any, name: str) -> Iterator[Item]:
    failed, last = 0, time.monotonic()
    try:
        while failed < DEAD_AFTER and time.monotonic() < last + DEAD_S:
            is_read, image = camera.read()
            if is_read:
                failed, last = 0, time.monotonic()
                yield cv2.cvtColor(image, cv2.COLOR_BGR2RGB)
            else:
                failed += 1
                yield InputError(f"camera {name}: a frame could not be read")
    finally:
        camera.release()
    raise Failure(f"camera {name} gives no frames any more: plug it in again")
