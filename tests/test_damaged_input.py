# SPDX-License-Identifier: Apache-2.0
"""Readers of files on damaged input: each returns a valid result or raises an InputError of one line.

Hypothesis damages the files. `make test` tries EXAMPLES of each kind, `make regress` FULL times as many.
"""

import csv
import io
import struct
import tempfile
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from PIL import Image

from commands.common.run_request import configure, parse
from tactile_depth.base.errors import InputError
from tactile_depth.calibrate.press_folder import read_presses
from tactile_depth.pictures.frames import load_frames
from tactile_depth.sensor import calibration_file
from tactile_depth.sensor.built_in import load
from tactile_depth.sensor.synthetic import synthetic
from tb.settings import RUN

EXAMPLES, FULL = 40, 50
GRID, CAMERA = (16, 16), (20, 24)
thorough = settings(
    max_examples=EXAMPLES * (FULL if RUN.full else 1), suppress_health_check=list(HealthCheck), print_blob=True
)
pytestmark = pytest.mark.filterwarnings("ignore")


def read(reader: Callable[[Path], bool], content: bytes | None, name: str = "file") -> bool:
    """Return True if a reader makes a valid result of a file, False if it refuses the file in one clear line."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, name)
        if content is not None:
            path.write_bytes(content)
        try:
            assert reader(path)
            return True
        except InputError as error:
            message = str(error)
        assert message
        assert message.isprintable()
        return False


@st.composite
def damaged(draw: st.DrawFn, file: bytes) -> bytes:
    """Return a file with up to four places cut off, inserted or replaced."""
    for _ in range(draw(st.integers(1, 4))):
        place = draw(st.integers(0, len(file)))
        kept = draw(st.sampled_from((len(file), place, place + 1)))
        file = file[:place] + draw(st.binary(max_size=4)) + file[kept if kept > place else len(file) :]
    return file


def saved(write: Callable[[Any], Any]) -> bytes:
    """Return what a function writes to a file."""
    file = io.BytesIO()
    write(file)
    return file.getvalue()


RAMP = np.add.outer(np.arange(CAMERA[0]), np.arange(CAMERA[1]))[..., None] * np.array([3, 4, 5], np.uint8)
PICTURE = Image.fromarray(RAMP.astype(np.uint8))
FRAME_FILES = {
    "frame.png": saved(lambda file: PICTURE.save(file, "PNG")),
    "frame.jpg": saved(lambda file: PICTURE.save(file, "JPEG")),
    "frames.npy": saved(lambda file: np.save(file, np.array(PICTURE)[None])),
}


def check_frames(path: Path) -> bool:
    result = load_frames(str(path), GRID)
    assert result.pixels.dtype == np.uint8
    assert result.pixels.shape[1:] == (*GRID, 3)
    assert 0 < len(result.pixels) == len(result.labels)
    return 1 <= result.pixel_scale < float("inf")


@thorough
@given(st.data(), st.sampled_from(list(FRAME_FILES)))
def test_a_damaged_picture(data: st.DataObject, name: str) -> None:
    read(check_frames, data.draw(damaged(FRAME_FILES[name])), name)


def chunk(kind: bytes, body: bytes) -> bytes:
    return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))


@thorough
@given(
    st.integers(1, 30) | st.integers(0, 2**32 - 1),
    st.integers(1, 30) | st.integers(0, 2**32 - 1),
    st.tuples(*[st.integers(0, 17)] * 5),
    st.lists(
        st.tuples(st.sampled_from((b"tRNS", b"PLTE", b"zTXt", b"iCCP", b"eXIf", b"acTL")), st.binary()), max_size=2
    ),
    st.binary(),
)
def test_a_png_with_any_header_and_right_checksums(width: int, height: int, kind: Any, more: Any, body: bytes) -> None:
    parts = [chunk(b"IHDR", struct.pack(">II", width, height) + bytes(kind)), *(chunk(*one) for one in more)]
    wanted = min(4 * width * height + height, 1 << 16)
    parts += [chunk(b"IDAT", zlib.compress((body + bytes(wanted))[:wanted])), chunk(b"IEND", b"")]
    read(check_frames, b"\x89PNG\r\n\x1a\n" + b"".join(parts), "frame.png")


ANY_ARRAY = arrays.arrays(arrays.scalar_dtypes(), arrays.array_shapes(min_dims=0, max_dims=4, max_side=4))


@thorough
@given(ANY_ARRAY)
def test_frames_of_any_type_and_shape(array: np.ndarray) -> None:
    read(check_frames, saved(lambda file: np.save(file, array)), "frames.npy")


def sensor_file() -> dict[str, Any]:
    """Return the arrays of a calibration file."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "sensor.npz")
        load("gelsight-mini").save(path)
        with np.load(path) as file:
            return {key: file[key] for key in file}


SENSOR = sensor_file()


def check_sensor(path: Path) -> bool:
    sensor = load(str(path))
    assert 0 < sensor.pixel_pitch_mm < float("inf")
    for table in (sensor.gradient, sensor.coefficients):
        assert table is None or np.isfinite(table).all()
    assert all(0 < slope < float("inf") for slope in sensor.fitted_slope.values())
    sensor.save(path)
    again = load(str(path))
    return (again.camera, again.height_errors) == (sensor.camera, sensor.height_errors)


@thorough
@given(st.data(), st.sampled_from(sorted(calibration_file.KEYS)))
def test_a_calibration_with_one_entry_of_any_kind(data: st.DataObject, key: str) -> None:
    good = SENSOR.get(key, np.array(1.0))
    same_kind = arrays.arrays(good.dtype, good.shape) if good.size < 100 else st.just(good * np.nan)
    entries: dict[str, Any] = {**SENSOR, key: data.draw(same_kind | ANY_ARRAY)}
    if data.draw(st.integers(0, 9)) == 0:
        del entries[key]
    read(check_sensor, saved(lambda file: np.savez_compressed(file, **entries)), "sensor.npz")


@thorough
@given(damaged(saved(lambda file: np.savez(file, **SENSOR))))
def test_a_damaged_calibration(content: bytes) -> None:
    read(check_sensor, content, "sensor.npz")


CELLS = st.sampled_from(("1.png", "12.5", "30", "-1", "nan", "inf", "1e400", "", "1_0")) | st.text(max_size=5)
COLUMNS = ("frame", "diameter_mm", "centre_x_px", "centre_y_px", "contact_radius_px", "ball_radius_px")


def check_presses(path: Path) -> bool:
    presses, notes = read_presses(path.parent)
    assert all(note.isprintable() for note in notes)
    for press in presses:
        assert 0 < press.diameter_mm < float("inf")
        if press.circle:
            assert np.isfinite(press.circle).all()
            assert 0 < press.circle[2] < (press.ball_radius_px or float("inf"))
    return True


@thorough
@given(st.data(), st.lists(st.lists(CELLS, max_size=7), max_size=3), st.integers(2, 6))
def test_a_table_of_presses_with_any_cells(data: st.DataObject, rows: list[list[str]], columns: int) -> None:
    text = io.StringIO()
    csv.writer(text).writerows([COLUMNS[:columns], *rows])
    content = text.getvalue().encode("utf-8", "replace")
    read(check_presses, data.draw(st.just(content) | damaged(content)), "presses.csv")


SYNTHETIC = synthetic(4)
KEYS = ("N", "ROWS", "SOLVER", "BOUNDARY", "SIM", "DATA_WIDTH", "DEPTH_RANGE", "SEED", "GAPS", "AT", "FRAMES", "OUT")
VALUES = ("16", "0", "-1", "1e3", "nan", "inf", "1_6", "0x10", "9" * 5000, "\uff11\uff16", "tridiagonal", "icarus", "")


@thorough
@given(st.lists(st.tuples(st.sampled_from(KEYS), st.sampled_from(VALUES) | st.text(max_size=12)), max_size=6))
def test_variables_of_any_value(words: list[tuple[str, str]]) -> None:
    def check(_: Path) -> bool:
        return configure(parse([f"{key}={value}" for key, value in words]), SYNTHETIC).columns > 0

    read(check, None)


@thorough
@given(st.text(), st.sampled_from((1, 30, 300)), st.sampled_from(("", ".png", ".npy", ".npz")))
def test_names_of_files_that_cannot_be(text: str, times: int, suffix: str) -> None:
    assert not read(lambda path: bool(load(f"{path.parent}/{text * times}{suffix}")), None)
    assert not read(lambda path: bool(load_frames(f"{path.parent}/{text * times}{suffix}", GRID)), None)


def test_the_undamaged_files_are_read() -> None:
    for name, content in FRAME_FILES.items():
        assert read(check_frames, content, name), name
    assert read(check_sensor, saved(lambda file: np.savez(file, **SENSOR)), "sensor.npz")
