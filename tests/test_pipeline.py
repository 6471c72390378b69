# SPDX-License-Identifier: Apache-2.0
"""Python interface: from pictures to millimetres, equal to the models bit for bit, and near the drawn height."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

import tactile_depth as td
from tactile_depth.chip.contact.contact_events import ContactEvents, Settings
from tactile_depth.chip.resampling import resampling
from tactile_depth.chip.tactile_depth import light_of, slope_tables, tactile_depth
from tactile_depth.pictures.reader import default_grid
from tests.conftest import SMALL
from tests.drawn_light import no_contact


def on_grid(height_mm: Any, grid: Any) -> Any:
    return resampling(height_mm.shape, grid).average(height_mm[..., None])[..., 0]


def test_defaults_suit_a_real_sensor(pipeline: Any) -> None:
    config = pipeline.config
    assert pipeline.grid == (96, 128)
    assert (config.solver, config.neumann, config.gradient_model) == ("tridiagonal", True, "cubic")
    assert (config.data_width, config.coefficient_width, config.zero_offset) == (24, 18, True)
    assert (pipeline.arithmetic, pipeline.threshold_mm) == ("chip", 0.07)


@pytest.mark.parametrize(
    ("camera", "solver", "grid"),
    [
        ((240, 320), "tridiagonal", (96, 128)),
        ((480, 640), "tridiagonal", (96, 128)),
        ((720, 1280), "tridiagonal", (72, 128)),
        ((240, 320), "spectral", (128, 128)),
        ((60, 100), "tridiagonal", (38, 64)),
        (None, "tridiagonal", (128, 128)),
    ],
)
def test_the_default_grid_shows_the_whole_picture(ball: Any, camera: Any, solver: str, grid: Any) -> None:
    sensor = replace(ball.sensor, camera=None if camera is None else td.Camera(*camera))
    assert default_grid(sensor, solver) == grid


@pytest.mark.parametrize("name", ["ball", "cylinder", "cone"])
def test_the_height_is_what_was_drawn(name: str) -> None:
    """Compare with the drawn height: within 4 % of the peak, the error of the discretisation at 128 x 96."""
    drawn = td.sample(name)
    result = td.Pipeline(drawn.sensor, drawn.reference)(drawn.image)
    truth = on_grid(drawn.height_mm, (96, 128))
    assert np.abs(result.height_mm - truth).max() < 0.04 * truth.max()
    assert result.contact.touching
    assert not result.saturations
    assert not result.dark.any()


def test_the_untouched_surface_has_height_zero(pipeline: Any, ball: Any) -> None:
    result = pipeline(ball.image)
    assert result.height_mm[~result.mask].mean() == pytest.approx(0, abs=1e-12)
    assert result.depth_mm[~result.mask].mean() < -0.01  # its mean over the frame is zero
    np.testing.assert_allclose(result.height_mm - result.depth_mm, -result.depth_mm[~result.mask].mean())


def test_depth_is_codes_times_unit_and_both_arithmetics_agree(ball: Any, pipeline: Any) -> None:
    result = pipeline(ball.image)
    np.testing.assert_array_equal(result.depth_mm, result.codes * pipeline.depth_lsb_mm)
    exact = td.Pipeline(ball.sensor, ball.reference, arithmetic="float")(ball.image)
    error = result.depth_mm - exact.depth_mm
    assert np.sqrt((error**2).mean()) < 1e-4 * exact.depth_mm.max()
    assert np.abs(exact.codes * pipeline.depth_lsb_mm - exact.depth_mm).max() <= pipeline.depth_lsb_mm / 2


def test_codes_are_those_of_the_model_in_picture_order(small: Any, ball: Any) -> None:
    frames = np.stack([ball.image, ball.reference])
    result = small(frames)
    on_grid = np.rint(frames.reshape(2, 24, 10, 32, 10, 3).mean(axis=(2, 4))).astype(np.uint8)
    light = light_of(on_grid, slope_tables(small.sensor, small.config, small._gains), small.config)
    codes = tactile_depth(on_grid, small.sensor, small.config, gains=small._gains, zero=small._zero, light=light)
    np.testing.assert_array_equal(result.codes, codes[:, ::-1])


def test_a_stream_is_the_stream_of_the_hardware(small: Any, ball: Any) -> None:
    frames = np.stack([ball.reference, ball.image, np.rint(ball.image * 0.9).astype(np.uint8), ball.image])
    results = list(small.stream(iter(frames)))
    on_grid = np.rint(frames.reshape(4, 24, 10, 32, 10, 3).mean(axis=(2, 4))).astype(np.uint8)
    codes = tactile_depth(on_grid, small.sensor, small.config, gains=small._gains, zero=small._zero)
    np.testing.assert_array_equal([result.codes for result in results], codes[:, ::-1])
    assert results[0].light_gains.tolist() == [1, 1, 1]


def test_another_light_changes_no_height(ball: Any, pipeline: Any) -> None:
    before = pipeline(ball.image)
    for light in (0.8, 1.05, (1.05, 1.0, 0.95)):
        result = pipeline(np.rint(ball.image * np.array(light)).clip(0, 255).astype(np.uint8))
        np.testing.assert_allclose(result.light_gains * light, before.light_gains, rtol=2e-3)
        assert np.abs(result.height_mm - before.height_mm).max() < 0.01 * before.height_mm.max()
    without = td.Pipeline(ball.sensor, ball.reference, light_gains=False)
    assert without(ball.image).light_gains is None
    assert without.new_stream().light is None


@pytest.mark.parametrize("solver", ["spectral", "tridiagonal"])
@pytest.mark.parametrize("boundary", ["dirichlet", "neumann"])
def test_every_solver_and_boundary_sees_the_contact_upright(ball: Any, solver: Any, boundary: Any) -> None:
    result = td.Pipeline(ball.sensor, ball.reference, grid=(32, 32), solver=solver, boundary=boundary)(ball.image)
    row, column = np.unravel_index(result.height_mm.argmax(), (32, 32))
    drawn = np.unravel_index(ball.height_mm[:, 40:280].argmax(), (240, 240))
    assert abs(row + 0.5 - drawn[0] / 7.5) < 1.5
    assert abs(column + 0.5 - drawn[1] / 7.5) < 1.5


def test_a_batch_is_its_frames_one_by_one(ball: Any, small: Any) -> None:
    frames = np.stack([ball.image, ball.reference, ball.image])
    batch = small(frames)
    assert len(batch) == 3
    assert batch.codes.shape == (3, *SMALL)
    for index, frame in enumerate(frames):
        single = td.Pipeline(ball.sensor, ball.reference, grid=SMALL)(frame)
        np.testing.assert_array_equal(batch[index].codes, single.codes)
        np.testing.assert_array_equal(batch[index].height_mm, single.height_mm)
        assert batch[index].contact.record[2:] == single.contact.record[2:]
        assert batch[index].contact.touching == (index != 1)
    with pytest.raises(AttributeError, match=r"use result\[i\].contact"):
        _ = batch.contact
    assert list(batch) == [batch[0], batch[1], batch[2]]
    assert list(batch[1:]) == list(batch[-2:]) == [batch[1], batch[2]]
    assert len(batch[3:]) == 0
    single = small(ball.image)
    assert single
    for wrong in (lambda: single[0], lambda: len(single), lambda: list(single)):
        with pytest.raises(TypeError, match="has no frames"):
            wrong()
    with pytest.raises(TypeError, match="accepted is the number of a frame, or a slice"):
        _ = batch["codes"]


def test_records_are_computed_when_they_are_read(monkeypatch: pytest.MonkeyPatch, small: Any, ball: Any) -> None:
    calls: list[Any] = []
    monkeypatch.setattr("tactile_depth.depth.result.Recorder.record", lambda _, codes: calls.append(codes))
    result = small(np.stack([ball.image] * 2))
    assert result.height_mm.max() > 1
    assert not calls
    assert len(result.records) == len(calls) == 2


def test_a_slice_of_a_stream_keeps_its_records(small: Any, ball: Any) -> None:
    result = small(np.stack([ball.image, ball.reference]), small.new_stream())
    assert result[1:].records == result.records[1:]
    assert [frame.contact.record for frame in result] == list(result.records)


def test_paths_give_what_arrays_give(tmp_path: Path, ball: Any, small: Any) -> None:
    folder = tmp_path / "frames"
    folder.mkdir()
    for name, image in (("2.png", ball.image), ("10.png", ball.reference)):
        Image.fromarray(image).save(folder / name)
    frames = np.stack([ball.image, ball.reference])
    np.save(tmp_path / "frames.npy", frames)
    expected = small(frames).codes
    np.testing.assert_array_equal(small(folder).codes, expected)
    np.testing.assert_array_equal(small(str(tmp_path / "frames.npy")).codes, expected)
    np.testing.assert_array_equal(small(folder / "2.png").codes, expected[0])
    by_path = td.Pipeline(ball.sensor, folder / "10.png", grid=SMALL)
    np.testing.assert_array_equal(by_path(ball.image).codes, expected[0])


@pytest.mark.parametrize("grid", [(240, 320), (90, 120), (33, 44), (9, 12)])
@pytest.mark.parametrize("model", ["lut", "quadratic"])
def test_float_arithmetic_takes_any_grid(ball: Any, grid: Any, model: Any) -> None:
    """Compare height and position with those on a grid of the hardware."""
    pipeline = td.Pipeline(ball.sensor, ball.reference, grid=grid, model=model, arithmetic="float")
    result = pipeline(ball.image)
    assert result.height_mm.shape == pipeline.grid == grid
    usual = td.Pipeline(ball.sensor, ball.reference, model=model, arithmetic="float")(ball.image)
    assert result.height_mm.max() == pytest.approx(usual.height_mm.max(), rel=0.02 if min(grid) > 30 else 0.15)
    for position in ("peak_position_mm", "centroid_mm"):
        one, other = (getattr(each.contact, position) for each in (result, usual))
        np.testing.assert_allclose(one, other, atol=result.pixel_pitch_mm + usual.pixel_pitch_mm)
    assert np.abs(pipeline(ball.reference).depth_mm).max() < 0.01  # the zero offset acts
    pipeline.capture_reference(ball.reference)
    pipeline.capture_zero(ball.reference)
    np.testing.assert_array_equal(pipeline(ball.image).depth_mm, result.depth_mm)


def test_a_grid_for_double_precision_alone_has_no_hardware(ball: Any, tmp_path: Path) -> None:
    pipeline = td.Pipeline(ball.sensor, ball.reference, grid=(240, 320), arithmetic="float")
    with pytest.raises(td.InputError, match=r"grid=\(240, 320\) is for double precision alone: make the pipeline with"):
        pipeline.hardware(tmp_path / "hw")
    assert not (tmp_path / "hw").exists()


def test_attributes_of_a_pipeline_are_read_only(small: Any) -> None:
    names = [name for name, value in vars(td.Pipeline).items() if isinstance(value, property)]
    assert {"sensor", "config", "grid", "arithmetic", "pixel_pitch_mm", "depth_lsb_mm"} < set(names)
    assert {"threshold_mm", "area_threshold_mm"} < set(names)
    assert [name for name in vars(small) if not name.startswith("_")] == []
    for name in names:
        with pytest.raises(AttributeError, match=name):
            setattr(small, name, getattr(small, name))
    assert repr(small) == "Pipeline('sample', 32x24, cubic, tridiagonal, chip)"


def test_sequences_images_and_arrays_of_one_picture_are_pictures(tmp_path: Path, ball: Any, small: Any) -> None:
    one, both = small(ball.image), small(np.stack([ball.image, ball.reference]))
    image = Image.fromarray(ball.image)
    image.save(tmp_path / "a.png")
    np.save(tmp_path / "one.npy", ball.image)
    for single in (image, tmp_path / "one.npy"):
        assert small(single) == one
    for several in ([ball.image, ball.reference], (image, ball.reference), [tmp_path / "a.png", ball.reference]):
        assert small(several) == both
    assert len(small([ball.image])) == 1
    assert list(small.stream([image])) == list(small.stream([ball.image]))
    by_image = td.Pipeline(ball.sensor, Image.fromarray(ball.reference), grid=SMALL)
    np.testing.assert_array_equal(by_image(image).codes, one.codes)
    by_image.capture_zero([Image.fromarray(ball.reference)] * 2)
    assert td.BallPress(image, 4) == td.BallPress(ball.image, 4)  # type: ignore[arg-type]


def test_larger_pictures_of_the_camera_give_the_same_depth(ball: Any, small: Any) -> None:
    twice = ball.image.repeat(2, axis=0).repeat(2, axis=1)
    np.testing.assert_array_equal(small(twice).codes, small(ball.image).codes)


# Contact.


def test_the_record_of_a_whole_frame_is_that_of_its_beats() -> None:
    rng = np.random.default_rng(1)
    settings = Settings(40, 20, 30, 3, 2)
    for bottom_first in (False, True):
        beats, at_once = (ContactEvents(9, 16, 8, bottom_first) for _ in range(2))
        for time in range(12):
            frame = rng.integers(-50, rng.integers(1, 60), (9, 16))
            for row in range(9):
                for column in range(16):
                    last, end = column == 15, (row, column) == (8, 15)
                    record = beats.beat(int(frame[row, column]), row + column == 0, last, end, settings, time)
            assert at_once.whole_frame(frame, settings, time) == record


def test_the_contact_in_millimetres(pipeline: Any, ball: Any) -> None:
    result = pipeline(ball.image)
    contact = result.contact
    touched = result.codes * pipeline.depth_lsb_mm > pipeline.threshold_mm
    np.testing.assert_array_equal(contact.mask, touched)
    assert contact.peak_mm == pytest.approx(result.depth_mm.max())
    assert result.depth_mm[contact.peak_px] == result.depth_mm.max()
    pitch = result.pixel_pitch_mm
    assert contact.peak_position_mm == pytest.approx([pitch * index for index in contact.peak_px])
    assert contact.centroid_mm == pytest.approx([pitch * index for index in contact.centroid_px])
    assert contact.peak_height_mm == pytest.approx(result.height_mm.max())
    level = min(0.3, contact.peak_mm / 2)
    assert contact.area_threshold_mm == pytest.approx(level, abs=pipeline.depth_lsb_mm)
    area = result.depth_mm > contact.area_threshold_mm
    assert contact.area_mm2 == pytest.approx(area.sum() * pipeline.pixel_pitch_mm**2)
    assert contact.volume_mm3 == pytest.approx(result.depth_mm[area].sum() * pipeline.pixel_pitch_mm**2)
    centroid = np.average(np.argwhere(area), axis=0, weights=result.depth_mm[area] - contact.area_threshold_mm)
    np.testing.assert_allclose(contact.centroid_px, centroid, atol=1 / 32 + 1e-6)


def test_the_area_of_a_stream_follows_the_last_peak(ball: Any) -> None:
    """In a stream the area threshold is half the peak of the frame before; a picture by itself is one that stays."""
    pipeline = td.Pipeline(ball.sensor, ball.reference, grid=SMALL, light_gains=False, area_threshold_mm=4)
    first, second = (result.contact for result in pipeline.stream([ball.image, ball.image]))
    assert first.touching
    assert (first.area_mm2, first.centroid_px) == (0, first.peak_px)
    assert second.area_threshold_mm == pytest.approx(second.peak_mm / 2, abs=pipeline.depth_lsb_mm)
    assert second.area_mm2 > 0
    assert second.record[3:] == pipeline(ball.image).contact.record[3:]


@pytest.mark.parametrize("depth", [0.12, 0.2, 0.28])
def test_a_light_touch_has_a_record(ball: Any, pipeline: Any, depth: float) -> None:
    """Draw a touch that the area threshold is never below: area and centroid are those at half its height."""
    y, x = np.indices(pipeline.grid)
    row, column = 40, 70
    height = depth * np.exp(-((y - row) ** 2 + (x - column) ** 2) / (2 * 6**2))
    codes = np.rint(height / pipeline.depth_lsb_mm).astype(np.int32)
    record = pipeline._recorder.record(codes)
    assert (record.peak, record.peak_position) == (codes.max(), (row, column))
    level = max(pipeline.threshold_mm, depth / 2) / pipeline.depth_lsb_mm
    assert record.area_threshold == pytest.approx(level, abs=1)
    assert record.area == np.count_nonzero(codes > record.area_threshold) > 0
    np.testing.assert_allclose(np.divide(record.centroid, 16), (row, column), atol=0.1)


# Captures.


def test_a_threshold_below_what_untouched_gel_reads_is_warned_of(ball: Any) -> None:
    rest = ball.reference + np.random.default_rng(3).integers(0, 3, ball.reference.shape, np.uint8)
    with pytest.warns(td.InputWarning, match="of the untouched gel is above it.* or more"):
        pipeline = td.Pipeline(ball.sensor, rest, threshold_mm=1e-4)
    assert not pipeline(ball.image).contact.touching


@pytest.mark.parametrize(
    ("least", "greatest", "is_central"),
    [
        ((1, 5), (22, 26), True),
        ((0, 5), (22, 26), False),
        ((1, 4), (22, 26), False),
        ((1, 5), (23, 26), False),
        ((1, 5), (22, 27), False),
    ],
)
def test_a_central_contact_lies_within_the_middle_square(
    small: Any, ball: Any, least: Any, greatest: Any, is_central: bool
) -> None:
    """The grid has 24 rows and 32 columns; a contact that reaches the first or last pixel may be cut."""
    contact = small(ball.image).contact
    record = contact.record._replace(least=least, greatest=greatest)
    assert replace(contact, record=record).is_central is is_central


def test_depths_that_are_clipped_are_warned_of(ball: Any) -> None:
    right = td.Pipeline(ball.sensor, ball.reference, depth_range_mm=2)(ball.image)
    assert right.warnings == ()
    pipeline = td.Pipeline(ball.sensor, ball.reference, depth_range_mm=0.6)
    with pytest.warns(td.InputWarning, match="of its depths clipped, .*: give a larger depth_range_mm"):
        clipped = pipeline(np.stack([ball.image, ball.reference]))
    assert clipped.height_mm.max() < 0.9 * right.height_mm.max()
    assert (len(clipped.warnings[0]), clipped.warnings[1], clipped[0].height_error) == (1, (), None)


def test_a_stream_takes_a_path(ball: Any, tmp_path: Path) -> None:
    Image.fromarray(ball.image).save(tmp_path / "press.png")
    pipeline = td.Pipeline(ball.sensor, ball.reference)
    for path in (tmp_path, str(tmp_path / "press.png")):
        (result,) = pipeline.stream(path)
        assert (result.codes == next(pipeline.stream([ball.image])).codes).all()


# Flags.


def test_slopes_outside_the_calibrated_range_are_flagged(ball: Any) -> None:
    narrow = replace(ball.sensor, fitted_slope={"cubic": 0.4})
    result = td.Pipeline(narrow, ball.reference)(ball.image)
    steep = np.hypot(*np.moveaxis(result.slopes, -1, 0)) > 0.4
    assert 0 < steep.sum() < steep.size / 10
    np.testing.assert_array_equal(result.outside, steep)
    assert not td.Pipeline(ball.sensor, ball.reference)(ball.image).outside.any()


def test_dark_pixels_are_flagged_and_harm_no_others(ball: Any) -> None:
    reference = ball.reference.copy()
    reference[:40, :40] = 0
    for arithmetic in ("chip", "float"):
        result = td.Pipeline(ball.sensor, reference, arithmetic=arithmetic)(ball.image)
        assert result.dark[:12, :12].all()
        assert not result.dark[24:].any()
        assert np.isfinite(result.height_mm).all()
        assert result.height_mm.max() == pytest.approx(1.36, abs=0.05)


def test_a_reference_that_leaves_nothing_is_refused(ball: Any) -> None:
    for dark in (np.zeros_like(ball.reference), np.full_like(ball.reference, 4)):
        with pytest.raises(td.InputError, match="grey levels in a colour at 100 % of the pixels"):
            td.Pipeline(ball.sensor, dark)


def test_the_error_of_the_calibration_comes_with_the_result() -> None:
    mini = td.load("gelsight-mini")
    picture = no_contact(mini)
    result = td.Pipeline(mini, picture)(picture)
    assert result.height_error == mini.height_errors["cubic"]
    assert 0.03 < result.height_error.relative < 0.05
    assert result.fitted_slope == mini.fitted_slope["cubic"]


# Bad input.


@pytest.mark.parametrize(
    ("choices", "message"),
    [
        ({"sensor": "gelsight-mini"}, "sensor is a str: accepted is a Sensor"),
        ({"grid": 64}, "grid=64: accepted are"),
        ({"grid": (24.0, 32)}, r"grid=\(24\.0, 32\): accepted are"),
        ({"data_width": 24.5}, "data_width=24.5: accepted is a whole number"),
        ({"reference": np.zeros((3, 240, 320, 3), np.uint8)}, "reference: 3 pictures: the hardware averages"),
        ({"arithmetic": "exact"}, "arithmetic=exact is unknown: accepted are chip, float"),
        ({"boundary": "periodic"}, "boundary=periodic is unknown: accepted are neumann, dirichlet"),
        ({"solver": "multigrid"}, "solver=multigrid is unknown"),
        ({"model": "quartic"}, "gradient_model=quartic: sample holds only lut, quadratic, cubic"),
        ({"grid": (24, 33)}, "columns=33 is not a power of two"),
        ({"grid": (7, 33), "arithmetic": "float"}, "rows=7 is out of range: accepted are 8 to 4096"),
        ({"grid": (24, 33), "arithmetic": "float", "solver": "spectral"}, "rows=24"),
        ({"grid": (300, 400), "arithmetic": "float"}, "smaller than the grid"),
        ({"grid": (256, 512)}, "smaller than the grid"),
        ({"grid": (24, 32), "solver": "spectral"}, "rows=24"),
        ({"data_width": 33}, "data_width=33"),
        ({"coefficient_width": 9}, "coefficient_width=9"),
        ({"gain_width": 15}, "gain_width=15"),
        ({"depth_range_mm": float("nan")}, "depth_range_mm=nan"),
        ({"depth_range_mm": "deep"}, "depth_range_mm=deep: accepted is"),
        ({"depth_range_mm": 1e-6}, r"depth_range_mm=1e-06: accepted is 0\.0\d+ mm, 0\.0625 of a grid pixel, and more"),
        ({"zero_offset": "no"}, "zero_offset=no: accepted are True, False"),
        ({"zero_offset": 1}, "zero_offset=1: accepted"),
        ({"zero_offset": None}, "zero_offset=None: accepted"),
        ({"light_gains": "no"}, "light_gains=no: accepted"),
        ({"light_gains": 0}, "light_gains=0: accepted"),
        ({"threshold_mm": 0.0}, "threshold_mm=0.0"),
        ({"threshold_mm": None}, "threshold_mm=None: accepted is a depth above 0"),
        ({"threshold_mm": 1e3}, "threshold_mm=1000.0"),
        ({"area_threshold_mm": -0.1}, "area_threshold_mm=-0.1: accepted is a depth of 0 or more"),
        ({"area_threshold_mm": 300}, "area_threshold_mm=300: accepted is .* within the depth range of"),
        ({"reference": None}, "sample needs a reference"),
        ({"reference": "none.png"}, "none.png: no such file or folder"),
        ({"reference": 3}, "reference are int: accepted is a uint8 array or a path"),
        ({"reference": np.zeros((240, 321, 3), np.uint8)}, None),
        ({"reference": np.zeros((240, 300, 3), np.uint8)}, "300 x 240 pixels"),
        ({"reference": np.zeros((240, 320), np.uint8)}, r"reference are uint8 \(240, 320\)"),
    ],
)
def test_a_pipeline_that_cannot_be_is_refused(ball: Any, choices: Any, message: Any) -> None:
    with pytest.raises(td.InputError, match=message):
        td.Pipeline(**{"sensor": ball.sensor, "reference": ball.reference, **choices})


def test_an_upright_grid_of_wide_pictures_is_warned_of(ball: Any, recwarn: pytest.WarningsRecorder) -> None:
    for grid in ((64, 64), (32, 64)):
        td.Pipeline(ball.sensor, ball.reference, grid=grid)
    assert not recwarn
    message = r"grid=\(64, 32\) is rows and columns, and shows 0\.38 of the width .*give grid=\(32, 64\)"
    with pytest.warns(td.InputWarning, match=message):
        td.Pipeline(ball.sensor, ball.reference, grid=(64, 32))
    message = r"grid=\(24, 64\) is rows and columns, and shows 0\.5 of the height .*give grid=\(48, 64\)"
    with pytest.warns(td.InputWarning, match=message):
        td.Pipeline(ball.sensor, ball.reference, grid=(24, 64))
    with pytest.warns(td.InputWarning, match=r"shows 0\.67 of the width"):
        td.Pipeline(ball.sensor, ball.reference, grid=(36, 32))
    recwarn.clear()
    td.Pipeline(td.load("synthetic"), grid=(24, 64))  # takes pictures of any shape
    assert not recwarn


@pytest.mark.parametrize(
    ("picture", "message"),
    [
        (np.zeros((240, 320, 3)), r"pictures are float64 \(240, 320, 3\): accepted is uint8"),
        (np.zeros((240, 320, 4), np.uint8), r"\(240, 320, 4\)"),
        (np.zeros((0, 240, 320, 3), np.uint8), r"\(0, 240, 320, 3\)"),
        (np.zeros((240, 240, 3), np.uint8), "240 x 240 pixels .* calibrated for pictures of 320 x 240"),
        (np.zeros((12, 16, 3), np.uint8), "are smaller than the grid of 32 x 24"),
        ("none.png", "none.png: no such file or folder"),
        (None, "pictures are NoneType: accepted is a uint8 array or a path, or a sequence of them$"),
        (iter([]), "pictures are list_iterator: accepted is .*: give them to `stream`"),
        ([], "pictures are empty: accepted is one picture or more"),
        ([np.zeros((240, 320), np.uint8)], r"pictures\[0\] are uint8 \(240, 320\): accepted is uint8"),
        ([np.zeros((2, 240, 320, 3), np.uint8)], r"pictures\[0\] are several pictures: accepted is one picture"),
    ],
)
def test_pictures_of_no_use_are_refused(small: Any, picture: np.ndarray, message: Any) -> None:
    with pytest.raises(td.InputError, match=message):
        small(picture)


def test_a_sample_of_no_contact_is_refused() -> None:
    with pytest.raises(td.InputError, match="name=cube is unknown: accepted are ball"):
        td.sample("cube")


def test_names_of_the_package_exist() -> None:
    for name in td.__all__:
        assert getattr(td, name) is not None
    assert set(td.__all__) <= set(dir(td))
    with pytest.raises(AttributeError, match="no attribute 'heights'"):
        _ = td.heights
