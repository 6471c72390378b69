# SPDX-License-Identifier: Apache-2.0
"""`tactile-depth live`: it shows the results of the pipeline, and each frame is shown or counted as lost.

Tests of the viewer and of videos need the extra [live]; `make live-test` runs all tests in an environment with it.
"""

import importlib.util
import re
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

import tactile_depth as td
from tactile_depth.base.errors import InputError
from tactile_depth.cli import live as command
from tactile_depth.cli.main import main
from tactile_depth.cli.source import Source
from tests.press_video import press_frames, write_inputs, write_video

FRAMES = 10
MISSING = [name for name in ("cv2", "rerun") if importlib.util.find_spec(name) is None]
needs_live = pytest.mark.skipif(bool(MISSING), reason=f"{', '.join(MISSING)} missing: make live-test installs them")


@pytest.fixture(scope="module")
def inputs(tmp_path_factory: pytest.TempPathFactory) -> Any:
    """Return drawn presses as a folder of pictures, background and calibration."""
    return write_inputs(tmp_path_factory.mktemp("inputs"), FRAMES)


@pytest.fixture
def live(inputs: Any, capsys: pytest.CaptureFixture[str]) -> Any:
    """Return a function that runs the command with the calibration of `inputs`, and returns what it prints."""

    def run(source: Any, *options: Any, status: int = 0) -> Any:
        calibrated = ["--calibration", f"{inputs}/sensor.npz", "--grid", "32x24"]
        assert main(["live", str(source), *map(str, options), *calibrated]) == status
        return capsys.readouterr()

    return run


@pytest.fixture
def background(inputs: Any) -> list[str]:
    return ["--reference", f"{inputs}/background.png"]


@pytest.fixture(scope="module")
def images() -> Any:
    return press_frames(FRAMES)


def pipeline_of(inputs: Any, reference: Any = "background.png") -> Any:
    reference = inputs / reference if isinstance(reference, str) else reference
    return td.Pipeline(td.load(inputs / "sensor.npz"), reference, grid=(24, 32))


class Screen:
    """Substitute of the display that keeps the frames shown."""

    last: Any

    def __init__(self, *_: Any) -> None:
        self.indices: list[Any] = []
        self.heights: list[Any] = []
        self.sensors: list[int] = []
        Screen.last = self

    def __enter__(self) -> Any:
        return self

    def __exit__(self, *_: Any) -> None:
        pass

    def show(self, index: int, picture: np.ndarray, result: Any, sensor: int = 0) -> None:
        self.sensors.append(sensor)
        self.indices.append(index)
        self.heights.append(result.height_mm)


@pytest.fixture
def screen(monkeypatch: pytest.MonkeyPatch) -> None:
    """Replace the display and the check that it is installed."""
    monkeypatch.setattr(command, "Display", Screen)
    monkeypatch.setattr(command, "load_rerun", lambda: None)


def counted(printed: Any) -> Any:
    """Return the numbers of the last line, by name."""
    (line,) = [line for line in printed.splitlines() if line.startswith("frames:")]
    counts = {name: int(count) for name, count in re.findall(r"(\w+) (\d+)[,;]", line)}
    lost_or_shown = sum(count for name, count in counts.items() if name != "read")
    assert counts["read"] == lost_or_shown
    return counts


# Frames shown.


def test_every_picture_of_a_folder_is_shown_as_the_pipeline_computes_it(
    inputs: Any, live: Any, background: Any, images: Any, screen: Any
) -> None:
    printed = live(inputs / "presses", *background).out
    expected = pipeline_of(inputs).stream(images)
    np.testing.assert_array_equal(Screen.last.heights, [result.height_mm for result in expected])
    assert Screen.last.indices == list(range(FRAMES))
    assert counted(printed) == {"read": FRAMES, "shown": FRAMES, "dropped": 0, "failed": 0}


@pytest.mark.parametrize("option", [[], ["--reference", "capture"]])
def test_the_first_frames_become_the_reference(
    tmp_path: Path, inputs: Any, live: Any, images: Any, screen: Any, option: Any
) -> None:
    no_contact = np.array(Image.open(inputs / "background.png"))
    np.save(tmp_path / "frames.npy", np.stack([no_contact] * 8 + [images[5]]))
    printed = live(tmp_path / "frames.npy", *option).out
    (first,) = pipeline_of(inputs).stream(images[5:6])
    np.testing.assert_array_equal(Screen.last.heights, [first.height_mm])
    assert printed.startswith("do not touch the sensor: its first 8 frames become the reference\n")
    assert counted(printed) == {"read": 9, "captured": 8, "shown": 1, "dropped": 0, "failed": 0}


def test_frames_before_the_exposure_settles_become_no_reference(
    tmp_path: Path, inputs: Any, live: Any, images: Any, screen: Any
) -> None:
    no_contact = np.array(Image.open(inputs / "background.png"))
    first = [no_contact // 32, no_contact // 4, no_contact // 2]
    np.save(tmp_path / "frames.npy", np.stack([*first, *[no_contact] * 8, images[5]]))
    printed = live(tmp_path / "frames.npy")
    (expected,) = pipeline_of(inputs).stream(images[5:6])
    np.testing.assert_array_equal(Screen.last.heights, [expected.height_mm])
    assert counted(printed.out) == {"read": 12, "captured": 8, "shown": 1, "dropped": 0, "failed": 3}
    assert "a frame is left out; others are counted at the end" in printed.err


def test_frames_that_give_no_depth_are_counted_as_failed(
    tmp_path: Path, inputs: Any, live: Any, background: Any, images: Any, screen: Any
) -> None:
    np.save(tmp_path / "frames.npy", np.stack([np.zeros_like(images[5]), images[5], np.zeros_like(images[5])]))
    printed = live(tmp_path / "frames.npy", *background)
    assert counted(printed.out) == {"read": 3, "shown": 1, "dropped": 0, "failed": 2}
    assert "frame 0: it is black" in printed.err


def test_the_calibration_is_found_by_the_captured_reference(
    tmp_path: Path, screen: Any, capsys: pytest.CaptureFixture[str]
) -> None:
    no_contact = np.kron(td.load("gelsight-mini").lighting * 90, np.ones((60, 80, 1))).clip(0, 255).astype(np.uint8)  # type: ignore[operator]
    np.save(tmp_path / "frames.npy", np.stack([no_contact] * 9))
    assert main(["live", f"{tmp_path}/frames.npy"]) == 0
    assert "calibration: gelsight-mini: the reference looks like it" in capsys.readouterr().out


def test_it_stops_after_so_many_frames(inputs: Any, live: Any, background: Any, screen: Any) -> None:
    printed = live(inputs / "presses", *background, "--frames", 3)
    assert Screen.last.indices == [0, 1, 2]
    assert counted(printed.out)["shown"] == 3


def test_several_sensors_are_shown_each_by_its_own_pipeline(
    tmp_path: Path, inputs: Any, background: Any, images: Any, screen: Any, capsys: Any
) -> None:
    """Show two folders of unequal length, the second with a reference of its own, which is captured."""
    no_contact = np.array(Image.open(inputs / "background.png"))
    np.save(tmp_path / "frames.npy", np.stack([no_contact] * 8 + [images[5]]))
    words = [f"{inputs}/presses", f"{tmp_path}/frames.npy", "--calibration", f"{inputs}/sensor.npz", "--grid", "32x24"]
    assert main(["live", *words, *background, "--reference", "capture"]) == 0
    heights = [result.height_mm for result in pipeline_of(inputs).stream(images)]
    shown = list(zip(Screen.last.indices, Screen.last.sensors, Screen.last.heights, strict=True))
    np.testing.assert_array_equal([height for _, sensor, height in shown if sensor == 0], heights)
    ((number, height),) = [(number, height) for number, sensor, height in shown if sensor == 1]
    (expected,) = pipeline_of(inputs).stream(images[5:6])
    assert number == 8
    np.testing.assert_array_equal(height, expected.height_mm)
    assert "frames.npy: frames: read 9, captured 8, shown 1, dropped 0, failed 0" in capsys.readouterr().out


# Keys.


def drifting(tmp_path: Path, inputs: Any, images: np.ndarray) -> tuple[Any, ...]:
    """Return frames without contact under weaker light, then one press, with the background of the old light."""
    no_contact = np.array(Image.open(inputs / "background.png"))
    y, x = np.mgrid[-1:1:240j, -1:1:320j]
    light = 0.9 + 0.05 * np.stack([x, y, x * y], axis=-1)
    drifted = [np.rint(image * light).astype(np.uint8) for image in (no_contact, images[5])]
    np.save(tmp_path / "frames.npy", np.stack([drifted[0]] * 8 + [drifted[1]]))
    return np.stack([drifted[0]] * 8), drifted[1]


@pytest.mark.parametrize("key", ["r", "z"])
def test_keys_capture_from_the_frames_that_follow(
    tmp_path: Path, inputs: Any, live: Any, background: Any, images: np.ndarray, screen: Any, press_keys: Any, key: str
) -> None:
    no_contact, press = drifting(tmp_path, inputs, images)
    press_keys(key)
    printed = live(tmp_path / "frames.npy", *background)
    expected = pipeline_of(inputs)
    stream = expected.new_stream()
    before = [expected(image, stream).height_mm for image in no_contact]
    np.testing.assert_array_equal(Screen.last.heights[:8], before)
    if key == "r":
        expected.capture_reference(no_contact)
    expected.capture_zero(no_contact)
    np.testing.assert_array_equal(Screen.last.heights[8], expected(press, stream).height_mm)
    assert "captured the" in printed.out


def test_q_quits(inputs: Any, live: Any, background: Any, screen: Any, press_keys: Any) -> None:
    press_keys("..q")
    printed = live(inputs / "presses", *background).out
    assert Screen.last.indices == [0, 1]
    assert counted(printed) == {"read": 3, "shown": 2, "dropped": 0, "failed": 0, "unfinished": 1}
    assert "keys: r captures the reference" in printed


def test_z_without_a_zero_offset_is_refused_and_nothing_ends(
    inputs: Any, live: Any, background: Any, screen: Any, press_keys: Any
) -> None:
    press_keys("z")
    printed = live(inputs / "presses", *background, "--no-zero-offset")
    assert "nothing captured: pictures: this pipeline has no zero offset" in printed.err
    assert len(Screen.last.indices) == FRAMES


# Frames that are lost.


def test_pictures_that_cannot_be_read_or_used_are_counted(
    tmp_path: Path, live: Any, background: Any, images: np.ndarray, screen: Any
) -> None:
    for index in range(4):
        Image.fromarray(images[index]).save(tmp_path / f"{index}.png")
    (tmp_path / "1.png").write_bytes(b"no picture")
    Image.new("RGB", (100, 240)).save(tmp_path / "2.png")
    printed = live(tmp_path, *background)
    assert Screen.last.indices == [0, 3]
    assert counted(printed.out) == {"read": 4, "shown": 2, "dropped": 0, "failed": 2}
    (line,) = printed.err.splitlines()
    assert line.startswith("tactile-depth: a frame is left out; others are counted at the end: ")
    assert "1.png: not a readable picture" in line


def test_a_source_of_the_wrong_size_is_told_at_the_start(
    tmp_path: Path, live: Any, background: Any, screen: Any
) -> None:
    Image.new("RGB", (100, 240)).save(tmp_path / "0.png")
    (line,) = live(tmp_path, *background, status=2).err.splitlines()
    assert "100 x 240 pixels (columns x rows), but" in line


def test_files_wait_for_a_slow_consumer(inputs: Any) -> None:
    with Source(f"{inputs}/presses") as source:
        taken = []
        for frame in source.frames():
            time.sleep(0.01)
            taken.append(frame)
    assert len(taken) == source.counts.read == FRAMES
    assert source.counts.dropped == 0


def test_an_interruption_still_says_where_the_frames_went(
    inputs: Any, live: Any, background: Any, screen: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupt(self: Any, index: Any, *_: Any) -> None:
        if index == 2:
            raise KeyboardInterrupt

    monkeypatch.setattr(Screen, "show", interrupt)
    printed = live(inputs / "presses", *background, status=130)
    assert counted(printed.out) == {"read": 3, "shown": 2, "dropped": 0, "failed": 0, "unfinished": 1}
    assert printed.err.splitlines()[-1] == "tactile-depth: interrupted"


# Bad input.


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["none.mp4"], "none.mp4: no such source"),
        (["presses", "--headless"], "--headless shows nothing: give --save FILE.rrd"),
        (["presses", "--frames", "0"], "--frames 0: accepted are 1 and more"),
        (["presses", "--web", "--headless", "--save", "run.rrd"], "--headless opens no viewer, and --web serves one"),
        (["presses", "--web-address", "robot"], "--web-address robot is no address: accepted is an IP address"),
        (["presses", "--web-address", "127.0.0.1:65535"], "accepted are ports from 1 to 65534"),
        (["presses", "presses", "--reference", "capture"], "--reference is given 1 time for 2 SOURCEs"),
        (["presses", "device:sim"], "device:sim with other sources: a device is watched alone"),
        (["presses", "none.mp4", "--web"], "none.mp4: no such source"),
        (["presses"], "reference looks like no sensor"),
        (["few"], "few: 1 frame, the reference takes 8: give --reference BACKGROUND"),
    ],
)
def test_bad_input_is_one_line(
    inputs: Any, screen: Any, monkeypatch: pytest.MonkeyPatch, capsys: Any, options: Any, message: Any
) -> None:
    monkeypatch.chdir(inputs)
    (inputs / "few").mkdir(exist_ok=True)
    Image.new("RGB", (320, 240), (128, 128, 128)).save(inputs / "few" / "0.png")
    assert main(["live", *options]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert message in line


@pytest.mark.parametrize(
    ("module", "source", "message"),
    [("rerun", "presses", "frames are shown by Rerun"), ("cv2", "0", "cameras and videos are read by OpenCV")],
)
def test_a_missing_library_is_one_line(
    inputs: Any, monkeypatch: pytest.MonkeyPatch, capsys: Any, module: Any, source: Any, message: Any
) -> None:
    monkeypatch.chdir(inputs)
    monkeypatch.setitem(sys.modules, module, None)
    if module == "cv2":
        monkeypatch.setattr(command, "load_rerun", lambda: None)
    assert main(["live", source]) == 3
    how = 'which is not installed: run pip install "tactile-depth[live]", in a clone ".[live]"'
    assert capsys.readouterr().err == f"tactile-depth: {message}, {how}\n"


# With OpenCV and Rerun.


@pytest.fixture(scope="module")
def video(inputs: Any) -> Any:
    path = inputs / "press.avi"
    write_video(path, press_frames(FRAMES), 25)
    return path


def decoded(video: Any) -> list[Any]:
    """Return the frames of a video as OpenCV reads it, in RGB."""
    with Source(str(video)) as source:
        return [frame.image for frame in source.frames() if frame is not None]


def read_back(path: Path) -> Any:
    """Return the content of an .rrd: entity and component to values by frame number, (None) for static ones."""
    from rerun.chunk import RrdReader  # type: ignore[import-not-found]

    values: dict[Any, Any] = {}
    for chunk in RrdReader(path).stream():
        batch = chunk.to_record_batch()
        columns = {field.name: batch.column(field.name) for field in batch.schema}
        times = columns["frame"].to_pylist() if "frame" in columns else [None] * len(batch)
        for name, column in columns.items():
            if ":" in name:
                values.setdefault(f"{chunk.entity_path}:{name}", {}).update(zip(times, column.to_pylist(), strict=True))
    return values


def component(values: Any, entity: Any, ending: Any) -> dict[Any, Any]:
    (key,) = [key for key in values if key.startswith(f"{entity}:") and key.endswith(ending)]
    return {frame: value for frame, value in values[key].items() if value is not None}


@needs_live
def test_a_recording_holds_every_frame_as_the_pipeline_computes_it(
    tmp_path: Path, inputs: Any, live: Any, background: Any, video: Any
) -> None:
    rrd = tmp_path / "run.rrd"
    printed = live(video, *background, "--headless", "--save", rrd)
    assert counted(printed.out) == {"read": 25, "shown": 25, "dropped": 0, "failed": 0}
    values, expected = read_back(rrd), pipeline_of(inputs)
    results = list(expected.stream(decoded(video)))
    heights = component(values, "/height", "buffer")
    assert sorted(heights) == list(range(25))
    for frame, result in enumerate(results):
        (buffer,) = heights[frame]
        logged = np.frombuffer(bytes(buffer), np.float32).reshape(24, 32)
        np.testing.assert_array_equal(logged, result.height_mm.astype(np.float32))
    vertices = component(values, "/surface", "vertex_positions")
    np.testing.assert_array_equal(np.array(vertices[7])[:, 2], results[7].height_mm.astype(np.float32).ravel())
    peaks = component(values, "/contact/peak_height_mm", "scalars")
    assert [peaks[frame] for frame in range(25)] == [[result.contact.peak_height_mm] for result in results]
    touching = component(values, "/contact/touching", "scalars")
    assert [touching[frame] for frame in range(25)] == [[float(result.contact.touching)] for result in results]
    assert sorted(component(values, "/camera", "blob")) == list(range(25))


@needs_live
def test_a_video_gives_the_frames_that_were_written_in_rgb(video: Any, images: np.ndarray) -> None:
    """Read a video of a lossless codec, so that exchanged channels are seen."""
    read = decoded(video)
    assert len(read) == 25
    for index, image in enumerate(read):
        np.testing.assert_array_equal(image, images[index % FRAMES])


@needs_live
def test_a_video_that_is_cut_is_counted(tmp_path: Path, inputs: Any, video: Any) -> None:
    """Cut the end of an AVI, which holds its index: its header counts frames that cannot be read."""
    import cv2

    path = tmp_path / "whole.avi"
    writer = cv2.VideoWriter(str(path), cv2.VideoWriter_fourcc(*"MJPG"), 30, (320, 240))
    for image in press_frames(3):
        for _ in range(10):
            writer.write(image)
    writer.release()
    data = path.read_bytes()
    (tmp_path / "cut.avi").write_bytes(data[: len(data) // 2])
    with Source(str(tmp_path / "cut.avi")) as source:
        shown = sum(frame is not None for frame in source.frames())
    assert 0 < shown < 30
    assert source.counts.read == shown + source.counts.failed == 30


@needs_live
def test_what_is_no_video_is_refused(tmp_path: Path) -> None:
    (tmp_path / "text.mp4").write_text("text")
    with pytest.raises(InputError, match=r"text.mp4: not a readable video"):
        Source(str(tmp_path / "text.mp4"))


@needs_live
def test_ctrl_c_closes_the_recording(tmp_path: Path, inputs: Any, background: Any, video: Any) -> None:
    rrd = tmp_path / "run.rrd"
    long = tmp_path / "long.avi"
    write_video(long, press_frames(FRAMES), 3000)
    options = [*background, "--calibration", f"{inputs}/sensor.npz"]
    process = subprocess.Popen(
        [sys.executable, "-m", "tactile_depth.cli", "live", long, *options, "--headless", "--save", rrd],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    deadline = time.monotonic() + 60
    while not (rrd.exists() and rrd.stat().st_size > 500_000):
        assert time.monotonic() < deadline
        assert process.poll() is None
        time.sleep(0.1)
    process.send_signal(signal.SIGINT)
    printed, errors = process.communicate(timeout=60)
    assert process.returncode == 130
    assert errors.splitlines()[-1] == "tactile-depth: interrupted"
    shown = counted(printed)["shown"]
    logged = len(component(read_back(rrd), "/height", "buffer"))
    assert logged in (shown, shown + 1)  # it may be logged, not yet counted


@needs_live
def test_a_recording_that_cannot_be_written_is_named(tmp_path: Path, live: Any, background: Any, video: Any) -> None:
    (tmp_path / "file").touch()
    printed = live(video, *background, "--headless", "--save", tmp_path / "file" / "run.rrd", status=2)
    assert "run.rrd cannot be written" in printed.err


@needs_live
def test_a_recording_replaces_a_recording_and_no_other_file(
    tmp_path: Path, live: Any, background: Any, video: Any
) -> None:
    rrd = tmp_path / "run.rrd"
    for frames in (2, 1):
        live(video, *background, "--headless", "--save", rrd, "--frames", frames)
    assert len(component(read_back(rrd), "/height", "buffer")) == 1
    rrd.write_text("mine")
    printed = live(video, *background, "--headless", "--save", rrd, status=2)
    assert "is no recording of this command: move it away" in printed.err
    assert rrd.read_text() == "mine"
