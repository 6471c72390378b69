# SPDX-License-Identifier: Apache-2.0
"""Frames and keys of `tactile-depth live`: a camera that is fast, slow or gone, and the terminal."""

import contextlib
import os
import pty
import re
import select
import sys
import termios
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from tactile_depth.base.errors import InputError
from tactile_depth.cli import source as sources
from tactile_depth.cli.failure import Failure
from tactile_depth.cli.keys import pressed_keys
from tactile_depth.cli.source import CameraChoice, Source
from tests import press_video

ROOT = Path(__file__).parent.parent


def test_the_page_on_opencv_prints_what_it_says(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("cv2", reason="OpenCV is missing: make live-test")
    text = (ROOT / "docs" / "opencv.md").read_text()
    loop, camera = re.findall(r"^```python\n(.*?)^```", text, re.MULTILINE | re.DOTALL)
    printed = re.findall(r"^    (\d+: height .*)", text, re.MULTILINE)
    (tmp_path / "demo").mkdir()
    press_video.write_sensor(tmp_path / "demo")
    press_video.write_video(tmp_path / "demo" / "press.avi", press_video.press_frames(), 60)
    monkeypatch.chdir(tmp_path)
    names: dict[str, Any] = {}
    exec(loop, names)
    assert capsys.readouterr().out.splitlines() == printed[:2]
    untouched = [np.array(Image.open("demo/background.png"))] * 8
    press_video.write_video(tmp_path / "demo" / "camera.avi", [*untouched, *press_video.press_frames()], 60)
    exec(
        camera.replace("gelsight-mini", "demo/sensor.npz").replace("pictures(0)", 'pictures("demo/camera.avi")'), names
    )
    heights = capsys.readouterr().out.split()
    assert len(heights) == 60 - 8
    with pytest.raises(OSError, match="OpenCV cannot open it"):
        next(names["pictures"]("none.avi"))


# A camera.


@pytest.fixture
def camera(monkeypatch: pytest.MonkeyPatch) -> Any:
    """Make camera 0 return these items, each as fast as it is read."""

    def connect(items: Any) -> Any:
        monkeypatch.setattr(sources, "_camera", lambda name, choice: iter(items))
        return Source("0")

    return connect


def numbered(count: int) -> list[Any]:
    return [np.full((2, 2, 3), index, np.uint8) for index in range(count)]


def test_a_camera_that_is_too_fast_loses_its_oldest_frames_and_they_are_counted(camera: Any) -> None:
    with camera(numbered(50)) as source:
        source._thread.join()
        taken = [frame for frame in source.frames() if frame is not None]
    assert [frame.index for frame in taken] == list(range(50 - len(taken), 50))
    assert [int(frame.image[0, 0, 0]) for frame in taken] == [frame.index for frame in taken]
    assert 0 < len(taken) <= sources.QUEUED
    assert source.counts.dropped == 50 - len(taken)
    assert source.counts.read == 50


def test_frames_are_rotated(tmp_path: Path) -> None:
    pictures = np.random.default_rng(1).integers(0, 256, (2, 4, 3, 3), np.uint8)
    np.save(tmp_path / "portrait.npy", pictures)
    with Source(str(tmp_path / "portrait.npy"), rotate=90) as source:
        images = [frame.image for frame in source.frames() if frame is not None]
    np.testing.assert_array_equal(images, [np.rot90(picture) for picture in pictures])


def test_a_silent_source_gives_none_meanwhile(camera: Any) -> None:
    released = threading.Event()

    def items() -> Iterator[Any]:
        released.wait(10)
        yield from numbered(1)

    with camera(items()) as source:
        frames = source.frames(patience_s=0.01)
        assert next(frames) is None
        released.set()
        assert next(frame for frame in frames if frame is not None).index == 0


class Camera:
    """Substitute for cv2 and its camera, which reads one frame and then fails."""

    COLOR_BGR2RGB = None

    def __init__(self, good: int = 1) -> None:
        self.good, self.reads, self.released = good, 0, False

    def VideoCapture(self, name: str) -> Any:
        self.name = name
        return self

    def isOpened(self) -> Any:
        return self.good > 0

    def read(self) -> Any:
        self.reads += 1
        return (self.reads <= self.good), np.array([[[1, 2, 3]]], np.uint8)

    def cvtColor(self, image: np.ndarray, _: Any) -> Any:
        return image[..., ::-1]

    def release(self) -> None:
        self.released = True


def test_a_camera_that_is_unplugged_ends_it(monkeypatch: pytest.MonkeyPatch) -> None:
    device = Camera()
    monkeypatch.setattr(sources, "load_opencv", lambda: device)
    monkeypatch.setattr(sources, "QUEUED", 100)
    with Source("3") as source, pytest.raises(Failure, match="camera 3 gives no frames any more"):
        assert [frame.image.tolist() for frame in source.frames()] == [[[[3, 2, 1]]]]  # type: ignore[union-attr]
    assert device.name == 3  # type: ignore[comparison-overlap]
    assert device.released
    assert source.counts.failed == sources.DEAD_AFTER


def test_frames_of_a_camera_have_the_time_of_their_capture_and_those_of_files_none(camera: Any, tmp_path: Path) -> None:
    before = time.time()
    with camera(numbered(2)) as source:
        taken = [frame.captured_at for frame in source.frames() if frame is not None]
    assert before <= taken[0] <= taken[1] <= time.time()
    np.save(tmp_path / "frames.npy", np.stack(numbered(1)))
    with Source(str(tmp_path / "frames.npy")) as source:
        assert [frame.captured_at for frame in source.frames() if frame is not None] == [None]


class Choosy(Camera):
    """Camera that takes a size and a format, and has 480 x 640 pixels in MJPG whatever is asked."""

    CAP_PROP_FRAME_HEIGHT, CAP_PROP_FRAME_WIDTH, CAP_PROP_FOURCC = "rows", "columns", "format"

    class VideoWriter:
        @staticmethod
        def fourcc(*letters: str) -> int:
            return int.from_bytes("".join(letters).encode(), "little")

    class videoio_registry:
        @staticmethod
        def getCameraBackends() -> list[int]:
            return [200, 700]

        @staticmethod
        def getBackendName(number: int) -> str:
            return {200: "V4L2", 700: "DSHOW"}[number]

    def VideoCapture(self, name: Any, *backend: int) -> Any:
        self.opened = (name, *backend)
        return self

    def set(self, what: str, value: float) -> None:
        pass

    def get(self, what: str) -> float:
        return {"rows": 480, "columns": 640, "format": float(self.VideoWriter.fourcc(*"MJPG"))}[what]


def test_backend_size_and_format_of_a_camera_are_chosen(monkeypatch: pytest.MonkeyPatch) -> None:
    device = Choosy()
    monkeypatch.setattr(sources, "load_opencv", lambda: device)
    with Source("/dev/video3", CameraChoice("v4l2", (480, 640), "MJPG")):
        assert device.opened == (3, 200)


@pytest.mark.parametrize(
    ("choice", "message"),
    [
        (CameraChoice("msmf"), "--backend msmf is none of this OpenCV: accepted are dshow, v4l2"),
        (CameraChoice(size=(240, 320)), "--picture-size 320x240: camera 0 sends 640x480"),
        (CameraChoice(picture_format="YUYV"), "--picture-format YUYV: camera 0 sends MJPG"),
    ],
)
def test_what_a_camera_does_not_take_is_named(
    monkeypatch: pytest.MonkeyPatch, choice: CameraChoice, message: str
) -> None:
    monkeypatch.setattr(sources, "load_opencv", Choosy)
    with pytest.raises(InputError, match=message):
        Source("0", choice)


def test_a_camera_that_stays_silent_ends_it(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let a read fail after longer than `DEAD_S`, as V4L2 does with a camera that is gone."""
    monkeypatch.setattr(sources, "load_opencv", lambda: Camera())
    monkeypatch.setattr(sources, "DEAD_S", 0.0)
    with Source("3") as source, pytest.raises(Failure, match="camera 3 gives no frames any more"):
        list(source.frames())


@pytest.mark.parametrize(("system", "hint"), [("win32", "--backend dshow or msmf"), ("darwin", "System Settings")])
def test_a_camera_that_is_missing_has_a_hint_for_each_system(
    monkeypatch: pytest.MonkeyPatch, system: str, hint: str
) -> None:
    monkeypatch.setattr(sources, "load_opencv", lambda: Camera(good=0))
    monkeypatch.setattr(sys, "platform", system)
    with pytest.raises(Failure, match=f"camera 9 cannot be opened: .*{hint}"):
        Source("9")


def test_cameras_of_linux_are_listed_by_name(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    for number, index in ((0, 0), (1, 1), (10, 0)):
        (tmp_path / f"video{number}").mkdir()
        (tmp_path / f"video{number}" / "index").write_text(f"{index}\n")
        (tmp_path / f"video{number}" / "name").write_text("GelSight Mini\n" if number < 2 else "Webcam\n")
    monkeypatch.setattr(sources, "CAMERAS", tmp_path)
    monkeypatch.setattr(sources, "load_opencv", lambda: Camera(good=0))
    monkeypatch.setattr(sys, "platform", "linux")
    with pytest.raises(Failure, match=r"this computer has 0 \(GelSight Mini\), 10 \(Webcam\);"):
        Source("2")


def test_a_camera_that_is_not_there_is_a_failure(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sources, "load_opencv", lambda: Camera(good=0))
    with pytest.raises(Failure, match="camera /dev/video9 cannot be opened"):
        Source("/dev/video9")


# Keys.


def test_the_terminal_is_as_before(monkeypatch: pytest.MonkeyPatch) -> None:
    """Read single keys inside the block; afterwards lines and echo are restored, also after an error."""
    ours, theirs = pty.openpty()
    with os.fdopen(theirs, "r") as stdin:
        monkeypatch.setattr(sys, "stdin", stdin)
        before = termios.tcgetattr(stdin)
        with contextlib.suppress(KeyboardInterrupt), pressed_keys() as key:
            assert key() == ""  # type: ignore[misc]
            os.write(ours, b"rz")
            assert select.select([stdin], [], [], 5)[0]
            assert [key(), key(), key()] == ["r", "z", ""]  # type: ignore[misc]
            assert not termios.tcgetattr(stdin)[3] & (termios.ICANON | termios.ECHO)
            raise KeyboardInterrupt
        assert termios.tcgetattr(stdin) == before
    os.close(ours)


def test_without_a_terminal_there_are_no_keys(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    (tmp_path / "empty").touch()
    with (tmp_path / "empty").open() as stdin:
        monkeypatch.setattr(sys, "stdin", stdin)
        with pressed_keys() as key:
            assert key is None
