# SPDX-License-Identifier: Apache-2.0
"""Calibrations: the built-in ones, files, and errors for bad files."""

import errno
import io
import os
import zipfile
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tactile_depth.base.errors import InputError, InputWarning
from tactile_depth.chip.configuration import Configuration
from tactile_depth.depth.pipeline import Pipeline
from tactile_depth.sensor.built_in import load
from tactile_depth.sensor.calibration_file import BUILT_IN, CAMERA_KEYS, FOLDER
from tactile_depth.sensor.samples import sample
from tactile_depth.sensor.scenes import GAIN, LIGHTS, REST
from tactile_depth.sensor.sensor import FORMAT_VERSION, TABLE_BITS, Camera, Sensor
from tactile_depth.sensor.synthetic import synthetic

OLD = {"gradient": np.zeros((4, 4, 4, 2)), "pixel_pitch_mm": 0.05}
CAMERA = {
    "format_version": 2,
    "camera_size": np.array((240, 320)),
    "pixel_format": "rgb888",
    "black_level": 0.0,
    "exposure_us": np.nan,
    "flat_field": True,
}
GOOD = {**OLD, **CAMERA}
QUADRATIC = {"coefficients": np.zeros((2, 3, 6)), "largest_slope": 0.7}
CUBIC = {"cubic": np.zeros((2, 3, 10)), "corrections": np.zeros((16, 16, 16, 2)), "largest_slope": 0.7}


def saved(folder: Path, **changed: Any) -> Any:
    path = folder / "mine.npz"
    np.savez(path, **{key: value for key, value in {**GOOD, **changed}.items() if value is not None})
    return path


def refused(path: Any) -> str:
    with pytest.raises(InputError) as caught:
        load(str(path))
    message = str(caught.value)
    assert "\n" not in message
    return message


# Built in.


@pytest.mark.parametrize("name", BUILT_IN)
def test_built_in_calibrations_fit_the_default_configuration(name: str) -> None:
    calibration = load(name)
    config = Configuration()
    assert calibration.name == name
    low, high = TABLE_BITS
    assert low <= calibration.bits_per_channel <= high
    assert calibration.gradient_limit == config.gradient_limit
    assert calibration.pixel_pitch_mm > 0


def test_synthetic_inverts_the_colour_model_at_bin_centres() -> None:
    calibration = synthetic(6)
    slope = calibration.gradient
    colour = REST + GAIN * slope @ LIGHTS.T  # type: ignore[operator]
    centre = np.stack(np.meshgrid(*[np.arange(64) * 4 + 1.5] * 3, indexing="ij"), axis=-1)
    inside = (np.abs(slope) < 0.98).all(axis=-1)  # type: ignore[arg-type]
    residual = (colour - centre)[inside]
    # A slope does not explain the brightness that the three lights share.
    np.testing.assert_allclose(residual, residual.mean(axis=-1, keepdims=True).repeat(3, axis=-1), atol=1e-9)


def test_the_rest_colour_of_the_synthetic_sensor_reads_exactly_flat() -> None:
    level = int(REST) >> 4
    assert not synthetic().gradient[level, level, level].any()  # type: ignore[index]


def test_a_rounded_slope_never_saturates() -> None:
    for largest in (0.2, 0.5, 0.96, 0.999, 1.0, 1.7):
        limit = Sensor("x", np.full((2, 2, 2, 2), largest), 1.0).gradient_limit
        step = limit / 256
        assert round(largest / step) <= 255
        assert limit / 2 <= largest * (1 + 2**-8)


def test_an_all_zero_table_has_a_gradient_limit() -> None:
    assert Sensor("x", GOOD["gradient"], 1.0).gradient_limit == 1.0  # type: ignore[arg-type]


def test_the_fitted_calibration_is_small() -> None:
    assert (FOLDER / "gelsight-mini.npz").stat().st_size < 140 * 1024


# Files.


@pytest.mark.parametrize("table", [True, False])
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_quadratics_are_read_as_written(tmp_path: Path, table: Any, dtype: Any) -> None:
    coefficients = np.random.default_rng(1).normal(size=(2, 3, 6)).astype(dtype)
    changed = {"coefficients": coefficients, "largest_slope": 1.5, "model": "quadratic"}
    calibration = load(str(saved(tmp_path, **changed, **({} if table else {"gradient": None}))))
    np.testing.assert_array_equal(calibration.coefficients, coefficients)
    assert calibration.model == "quadratic"
    assert calibration.gradient_limit == 2
    assert (calibration.gradient is not None) == table


@pytest.mark.parametrize("version", [2, FORMAT_VERSION])
def test_cubics_are_read_as_written(tmp_path: Path, version: Any) -> None:
    rng = np.random.default_rng(1)
    changed = {"cubic": rng.normal(size=(2, 3, 10)), "corrections": rng.normal(size=(16, 16, 16, 2)).astype("f4")}
    path = saved(tmp_path, **CUBIC | changed, model="cubic", format_version=version, fitted_slope_cubic=0.6)
    sensor: Any = load(str(path))
    sensor.save(tmp_path / "again.npz")
    for read in (sensor, load(str(tmp_path / "again.npz"))):
        np.testing.assert_array_equal(read.cubic, changed["cubic"])
        np.testing.assert_array_equal(read.corrections, changed["corrections"])
        assert (read.model, read.models, read.fitted_slope) == ("cubic", ("lut", "cubic"), {"cubic": 0.6})


def test_the_sensor_of_a_pipeline_is_no_calibration(tmp_path: Path) -> None:
    """Its pitch is that of the grid: heights would be as many times too large as the grid is coarser."""
    drawn = sample()
    sensor = Pipeline(drawn.sensor, drawn.reference).sensor
    uses: list[Any] = [lambda: Pipeline(sensor, drawn.reference), lambda: sensor.save(tmp_path / "sensor.npz")]
    for use in uses:
        with pytest.raises(InputError, match="give the sensor that the pipeline was made from"):
            use()


def test_a_file_says_nothing_of_its_model_and_has_the_one_it_holds(tmp_path: Path) -> None:
    assert load(str(saved(tmp_path))).model == "lut"
    assert load(str(saved(tmp_path, **QUADRATIC))).model == "lut"
    assert load(str(saved(tmp_path, **QUADRATIC, gradient=None))).model == "quadratic"


def test_a_missing_table_is_named_where_it_is_needed(tmp_path: Path) -> None:
    calibration = load(str(saved(tmp_path, **QUADRATIC, gradient=None)))
    with pytest.raises(InputError, match="no `gradient` in it: the table is needed here"):
        _ = calibration.table


def test_an_unknown_name_is_answered_with_the_known_ones(tmp_path: Path) -> None:
    message = refused("gelsihgt")
    assert "gelsihgt" in message
    assert all(name in message for name in BUILT_IN)
    assert f"{tmp_path}/absent.npz: no such file" in refused(tmp_path / "absent.npz")
    assert "too long" in refused("x" * 5000)


def damaged(_: bytes) -> bytes:
    """Return a packed calibration with zeros in the middle."""
    packed = io.BytesIO()
    np.savez_compressed(packed, gradient=np.random.default_rng(1).normal(size=(4, 4, 4, 2)), pixel_pitch_mm=1.0)
    return packed.getvalue()[:200] + bytes(200) + packed.getvalue()[400:]


UNREADABLE: dict[str, Any] = {
    **{f"1 / {part}": (lambda whole, part=part: whole[: len(whole) // part]) for part in (10**6, 10, 2)},
    "cut at the end": lambda whole: whole[:-20],
    "damaged inside": damaged,
    "text": lambda _: b"not a calibration",
    "begins as a zip": lambda _: b"PK\x03\x04 not one either",
    "an npy": lambda _: npy((2, 2, 2, 2), data=bytes(128)),
}


@pytest.mark.parametrize("case", UNREADABLE)
def test_a_file_that_is_no_calibration_is_named(tmp_path: Path, case: str) -> None:
    path = saved(tmp_path)
    path.write_bytes(UNREADABLE[case](path.read_bytes()))
    assert f"{path}: not a readable .npz" in refused(path)


@pytest.mark.parametrize(
    ("changed", "part"),
    [
        ({"gradient": None}, "no `gradient`, `coefficients` or `cubic`"),
        ({"coefficients": np.zeros((2, 3, 6))}, "no `largest_slope`"),
        ({"cubic": np.zeros((2, 3, 10)), "largest_slope": 0.7}, "no `corrections`"),
        (CUBIC | {"cubic": np.zeros((2, 3, 6))}, "`cubic` is float64 (2, 3, 6)"),
        (CUBIC | {"corrections": np.zeros((16, 16, 2))}, "`corrections` is float64 (16, 16, 2)"),
        (CUBIC | {"corrections": np.full((16, 16, 16, 2), np.inf)}, "`corrections` holds NaN or infinity"),
        (CUBIC | {"corrections": np.full((16, 16, 16, 2), 1e3)}, "`corrections` reach 1e+03: accepted is up to 64"),
        (QUADRATIC | {"coefficients": np.zeros((2, 3, 5))}, "(2, 3, 5)"),
        (QUADRATIC | {"coefficients": np.zeros((2, 3, 6), int)}, "int64"),
        (QUADRATIC | {"coefficients": np.full((2, 3, 6), np.nan)}, "holds NaN"),
        (QUADRATIC | {"coefficients": np.full((2, 3, 6), 1e9)}, "over 1e+06"),
        (QUADRATIC | {"largest_slope": 0.0}, "`largest_slope` is 0:"),
        (QUADRATIC | {"largest_slope": np.nan}, "`largest_slope` is nan:"),
        (QUADRATIC | {"largest_slope": [0.7]}, "`largest_slope` is float64 (1,)"),
        (QUADRATIC | {"model": "cubic"}, "`model` is cubic: accepted is a model that the file holds: lut, quadratic"),
        (QUADRATIC | {"model": 1}, "`model` is int64 ()"),
        ({"model": "quadratic"}, "`model` is quadratic: accepted is a model that the file holds: lut"),
        ({"pixel_pitch_mm": None}, "no `pixel_pitch_mm`"),
        ({"gradient": np.zeros((4, 4, 4, 3))}, "(4, 4, 4, 3)"),
        ({"gradient": np.zeros((4, 4, 8, 2))}, "(4, 4, 8, 2)"),
        ({"gradient": np.zeros((6, 6, 6, 2))}, "(6, 6, 6, 2)"),
        ({"gradient": np.zeros((1, 1, 1, 2))}, "(1, 1, 1, 2)"),
        ({"gradient": np.zeros((4, 4, 4, 2), int)}, "int64"),
        ({"gradient": np.array([{}])}, "not a readable .npz (Object arrays cannot be loaded"),
        ({"gradient": np.full((4, 4, 4, 2), np.nan)}, "128 values of NaN or infinity"),
        ({"gradient": np.where(np.arange(2), np.zeros((4, 4, 4, 2)), np.inf)}, "64 values"),
        ({"pixel_pitch_mm": 0.0}, "is 0:"),
        ({"pixel_pitch_mm": -0.1}, "is -0.1:"),
        ({"pixel_pitch_mm": np.nan}, "is nan:"),
        ({"pixel_pitch_mm": np.inf}, "is inf:"),
        ({"pixel_pitch_mm": [0.1, 0.1]}, "(2,)"),
        ({"pixel_pitch_mm": "0.1"}, "<U3"),
        ({"pixel_pitch_mm": 1e-300}, "accepted are 1e-06 to 1000"),
        ({"pixel_pitch_mm": 1e300}, "accepted are 1e-06 to 1000"),
        ({"pixel_pitch_mm": 0.00634}, "is 0.00634: pictures of 320 x 240 pixels show 2.03 x 1.52 mm of gel: accepted"),
        ({"pixel_pitch_mm": 63.4}, "accepted is 3 to 120 mm along the longer side: correct `pixel_pitch_mm`"),
        ({"camera_size": np.array((2400, 3200))}, "pictures of 3200 x 2400 pixels show 160 x 120 mm of gel"),
        ({"format_version": 5}, "`format_version` is 5: accepted are 2, 3, 4: a newer file needs a newer package"),
        ({"format_version": 2.0}, "`format_version` is float64"),
        ({"camera_size": np.array((0, 320))}, "(0, 320): accepted are rows and columns"),
        ({"camera_size": np.array((240.0, 320.0))}, "(240.0, 320.0): accepted"),
        ({"camera_size": 240}, "int64 (): accepted"),
        ({"pixel_format": "raw14"}, "`pixel_format` is raw14: accepted is rgb888, rgb565"),
        ({"black_level": 16}, "`black_level` is 16: accepted is 0: subtract it"),
        ({"exposure_us": -1.0}, "`exposure_us` is -1"),
        ({"flat_field": 1}, "`flat_field` is int64 (): accepted is True or False"),
        ({"fitted_slope_lut": 0.0}, "`fitted_slope_lut` is 0"),
        ({"cap_height_lut": np.zeros(2)}, "`cap_height_lut` is float64 (2,)"),
        ({"cap_height_lut": np.array([-1.0, 0, 9])}, "`cap_height_lut` has negative values"),
        ({"cap_height_lut": np.array([1.0, 0, 0])}, "`cap_height_lut` is of no presses"),
        ({"lighting": np.zeros((2, 2, 3))}, "`lighting` is float64 (2, 2, 3)"),
        ({"view": np.array((0.7, 1.2))}, "`view` is 0.7, 1.2: accepted are shares of the full picture's width"),
        ({"view": np.array(0.7)}, "`view` is float64 ()"),
        ({"untouched": np.full((24, 32, 3), 300.0)}, "`untouched` reaches from 300 to 300: accepted are grey levels"),
        ({"lighting": np.full((4, 4, 3), np.nan)}, "`lighting` holds NaN"),
    ],
)
def test_wrong_contents_are_named(tmp_path: Path, changed: Any, part: Any) -> None:
    path = saved(tmp_path, **changed)
    message = refused(path)
    assert str(path) in message
    assert part in message


@pytest.mark.parametrize("order", "<>")
@pytest.mark.parametrize("key", ["pixel_format", "model"])
def test_characters_that_do_not_exist_are_refused(tmp_path: Path, key: str, order: Any) -> None:
    text = np.frombuffer(np.array([0x72, 0x110000], f"{order}u4").tobytes(), f"{order}U2")
    assert f"{key}.npy holds characters that do not exist" in refused(saved(tmp_path, **{key: text}))


@pytest.mark.parametrize("key", CAMERA_KEYS)
def test_a_file_without_a_part_of_its_camera_is_named(tmp_path: Path, key: str) -> None:
    assert f"no `{key}` in it" in refused(saved(tmp_path, **{key: None}))


def test_an_old_file_needs_the_size_of_its_camera(tmp_path: Path) -> None:
    path = saved(tmp_path, **dict.fromkeys(CAMERA), **QUADRATIC)
    assert "give camera_size=(<rows>, <columns>)" in refused(path)
    with pytest.warns(InputWarning, match="a calibration of version 0.1: taken for RGB pictures of 320 x 240 pixels"):
        sensor = load(path, camera_size=(240, 320))
    assert (sensor.camera, sensor.flat_field) == (Camera(240, 320), True)
    assert sensor.fitted_slope == {"quadratic": 0.7}


def test_a_camera_size_that_contradicts_the_file_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"contradicts .* 320 x 240 pixels .*: omit camera_size"):
        load(saved(tmp_path), camera_size=(480, 640))


@pytest.mark.parametrize("size", [(240,), 240, (0, 0), (240.0, 320.0), "320x240"])
def test_a_camera_size_that_is_none_is_refused_without_a_warning(tmp_path: Any, size: Any) -> None:
    with pytest.raises(InputError, match="accepted are rows and columns"):
        load(saved(tmp_path, **dict.fromkeys(CAMERA), **QUADRATIC), camera_size=size)


def test_names_and_sizes_that_mean_nothing_are_refused() -> None:
    with pytest.raises(InputError, match="takes pictures of any size: omit camera_size"):
        load("synthetic", camera_size=(240, 320))
    for name in (None, 3):
        with pytest.raises(InputError, match="accepted is a name or a path"):
            load(name)  # type: ignore[arg-type]


def test_what_is_saved_is_read_again(tmp_path: Path) -> None:
    sensor = load("gelsight-mini")
    sensor.save(tmp_path / "copy.npz")
    again = load(tmp_path / "copy.npz")
    assert [path.name for path in tmp_path.iterdir()] == ["copy.npz"]
    for part in fields(sensor):
        old, new = getattr(sensor, part.name), getattr(again, part.name)
        if part.name != "name":
            assert np.array_equal(old, new) if isinstance(old, np.ndarray) else old == new, part.name


@pytest.mark.parametrize("key", ["pixel_pitch_mm", "camera_size", "corrections", "untouched"])
def test_a_file_that_was_changed_after_the_fit_has_no_error(tmp_path: Path, key: str) -> None:
    path = tmp_path / "mini.npz"
    load("gelsight-mini").save(path)
    with np.load(path) as held:
        changed = dict(held)
    assert load(path).height_errors
    changed[key] = (changed[key] / 2).astype(changed[key].dtype)
    np.savez(path, **changed)
    with pytest.warns(InputWarning, match="was changed after the fit: its error does not hold any more"):
        sensor = load(path)
    assert not sensor.height_errors
    assert sensor.verdict is None


def test_a_calibration_without_a_camera_is_not_saved(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no camera in it"):
        synthetic().save(tmp_path / "copy.npz")


def test_a_full_disk_is_told_and_leaves_the_earlier_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: Any, **__: Any) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    (tmp_path / "copy.npz").write_text("earlier")
    monkeypatch.setattr(np, "savez_compressed", full)
    with pytest.raises(OSError, match="No space left on device"):
        load("gelsight-mini").save(tmp_path / "copy.npz")
    assert [path.read_text() for path in tmp_path.iterdir()] == ["earlier"]


def test_a_path_that_cannot_be_written_is_named(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match=r"file/copy\.npz: .*/file is a file"):
        load("gelsight-mini").save(tmp_path / "file" / "copy.npz")
    with pytest.raises(InputError, match=r"cannot be written \(File name too long\)"):
        load("gelsight-mini").save(tmp_path / f"{'x' * 300}.npz")
    with pytest.raises(InputError, match=r"give the name of an \.npz file"):
        load("gelsight-mini").save(tmp_path / "copy.npy")
    with pytest.raises(InputError, match=r"cannot be written \(a character that no path can hold\)"):
        load("gelsight-mini").save("a\0b.npz")
    with pytest.raises(InputError, match="path is a NoneType"):
        load("gelsight-mini").save(None)  # type: ignore[arg-type]


# Malicious files.


def npy(shape: Any, dtype: str = "<f8", data: Any = b"") -> bytes:
    store = io.BytesIO()
    np.lib.format.write_array_header_1_0(store, {"descr": dtype, "fortran_order": False, "shape": shape})
    return store.getvalue() + data


def archive(path: Any, method: Any = zipfile.ZIP_DEFLATED, **members: bytes) -> Any:
    with zipfile.ZipFile(path, "w", method, compresslevel=1) as store:
        for name, content in {"gradient": npy((2, 2, 2, 2), data=bytes(128)), **members}.items():
            store.writestr(f"{name}.npy", content)
    return path


@pytest.mark.parametrize("member", ["gradient", "pixel_pitch_mm"])
def test_an_archive_that_unpacks_to_much_is_refused_before(tmp_path: Any, member: Any) -> None:
    count = 1 << 21  # 16 MB
    path = archive(tmp_path / "c.npz", **{member: npy((count,), data=bytes(8 * count))})
    assert path.stat().st_size < 1 << 20
    assert f"{member}.npy has 16,777,344 bytes" in refused(path)


@pytest.mark.parametrize("shape", [(1 << 40,), (-1, 2, 2, 2), (1 << 62, 4, 4, 2), (64, 64, 64, 64)])
def test_a_member_that_claims_too_much_is_refused(tmp_path: Path, shape: Any) -> None:
    assert "gradient.npy is float64" in refused(archive(tmp_path / "c.npz", gradient=npy(shape)))


def test_a_packing_that_numpy_does_not_write_is_refused(tmp_path: Any) -> None:
    assert "packed in a way" in refused(
        archive(tmp_path / "c.npz", zipfile.ZIP_LZMA, pixel_pitch_mm=npy((), data=bytes(8)))
    )
