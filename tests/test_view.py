# SPDX-License-Identifier: Apache-2.0
"""Tests of the view: the share of the sensor's full picture that pictures show."""

import re
import warnings
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

import tactile_depth as td
from commands.common import run_request
from commands.hardware import synthesis
from tactile_depth.base.errors import InputError
from tactile_depth.chip.camera.camera_registers import CameraRegisters, camera_registers_parameters
from tactile_depth.chip.camera_configuration import CameraConfiguration
from tactile_depth.chip.registers.register_map import CAMERA_MAP
from tactile_depth.chip.resampling import resampling
from tactile_depth.cli.main import main
from tactile_depth.device.tables import window_doubts
from tactile_depth.pictures.grid_sampler import middle
from tactile_depth.sensor.sensor import equal_areas, lighting
from tactile_depth.sensor.view import completed, share_of, shown, view_of
from tests.real_data import FOLDER


@pytest.mark.parametrize(
    ("crop", "shares"),
    [
        ("none", (1, 1)),
        ("gs_sdk", (5 / 7, 5 / 7)),
        ("gsrobotics", (0.7, 0.7)),
        (1, (1, 1)),
        (0.8, (0.8, 0.8)),
        ("0.8", (0.8, 0.8)),
        ("0.8,0.75", (0.8, 0.75)),
        ((0.8, 0.75), (0.8, 0.75)),
    ],
)
def test_a_crop_is_a_convention_or_a_share(crop: Any, shares: tuple[float, float]) -> None:
    assert view_of(crop) == shares


@pytest.mark.parametrize("crop", [0, 1.01, "some", "0.8,", "nan", True, (0.8, 0.8, 0.8), (), None, "0.8,True"])
def test_another_crop_is_refused(crop: Any) -> None:
    with pytest.raises(InputError, match="none, gs_sdk, gsrobotics, or the share of the full picture"):
        view_of(crop)


# Shares of pictures.


@pytest.mark.parametrize("part", [Fraction(5, 7), Fraction(97, 100), Fraction(1, 3), Fraction(643, 1000)])
def test_a_share_of_a_picture_is_averaged_exactly(part: Fraction) -> None:
    """The mean of a ramp over a block is its value in its middle, but for steps of a pixel at its edges."""
    plan, size = resampling((240, 320), (12, 16), (part, part)), float(part * 20)
    ramp = np.stack(np.broadcast_arrays(*np.ogrid[:240, :320], 7), axis=-1).astype(np.float64)
    rows, columns, constant = np.moveaxis(plan.average(ramp), -1, 0)
    np.testing.assert_allclose(rows[:, 0], 119.5 + (np.arange(12) - 5.5) * size, atol=1 / (4 * size))
    np.testing.assert_allclose(rows + rows[::-1], 239, rtol=1e-12)
    np.testing.assert_allclose(columns + columns[:, ::-1], 319, rtol=1e-12)
    np.testing.assert_array_equal(constant, 7)


@pytest.mark.parametrize(
    ("view", "crop", "own", "kept"),
    [
        ((1.0, 1.0), None, (1, 1), (1, 1)),
        ((1.0, 1.0), "none", (1, 1), (1, 1)),
        ((5 / 7, 5 / 7), "gs_sdk", (1, 1), (1, 1)),
        ((5 / 7, 5 / 7), "none", (1, 1), (Fraction(5, 7), Fraction(5, 7))),
        ((5 / 7, 5 / 7), "gsrobotics", (0.98, 0.98), (1, 1)),
        ((0.8, 1.0), (1.0, 0.5), (1, 0.5), (Fraction(4, 5), 1)),  # width more, height less
    ],
)
def test_what_both_show_is_used(view: Any, crop: Any, own: Any, kept: Any) -> None:
    sensor = replace(td.sample().sensor, view=view)
    seen, share = shown(sensor, crop)
    assert share == kept[::-1]
    (width, height), camera = own, seen.camera
    assert camera is not None
    assert seen.view == pytest.approx((view[0] * width, view[1] * height))
    # The camera is as wide as before in mm, times the share of it that is used.
    across, down = camera.columns * seen.pixel_pitch_mm, camera.rows * seen.pixel_pitch_mm
    pitch = sensor.pixel_pitch_mm
    assert (across, down) == pytest.approx((320 * pitch * width, 240 * pitch * height))
    if own == (1, 1):
        assert seen == sensor


def test_lighting_is_cut_as_the_pictures_are() -> None:
    """A smooth light: what the calibration holds of its middle is what a picture of the middle has."""
    light = np.stack([np.hypot(*np.mgrid[-120:120, -160:160] - at) for at in (30, 200, -90)], axis=-1) / 2 + 20
    sensor = replace(td.sample().sensor, view=(1.0, 1.0), untouched=equal_areas(light), lighting=lighting(light))
    seen: Any = shown(sensor, 0.75)[0]
    cut = middle(light, (Fraction(3, 4), Fraction(3, 4)))
    np.testing.assert_allclose(seen.untouched, equal_areas(cut), atol=1.5)
    assert seen.lighting_difference(cut) < 0.03 < seen.lighting_difference(light)


def test_the_aspect_ratio_is_that_of_the_full_picture() -> None:
    """A calibration of the middle of a 16:9 camera, cropped to 4:3, takes its whole pictures."""
    sensor = replace(td.sample().sensor, view=(0.75, 1.0))
    seen, share = shown(sensor, "none")
    assert seen.zoom((720, 1280), share=share) == 3
    with pytest.raises(InputError, match=r"1280 x 720 .*, but sample is calibrated .*, say with crop what part"):
        seen.zoom((720, 1280))
    with pytest.raises(InputError, match=r"640 x 480 .*, of which 480 x 480 are used, but"):
        seen.zoom((480, 640), share=share)


# Heights.


def heights(pipeline: td.Pipeline, picture: np.ndarray) -> tuple[float, float]:
    result = pipeline(picture)
    return float(result.height_mm.max()), result.contact.area_mm2


@pytest.mark.parametrize("crop", [0.97, 0.8, (0.9, 0.75)])
def test_pictures_that_show_less_are_right(crop: Any) -> None:
    sample = td.sample("ball")
    share = share_of(view_of(crop))
    truth = heights(td.Pipeline(sample.sensor, sample.reference), sample.image)
    pipeline = td.Pipeline(sample.sensor, middle(sample.reference, share), crop=crop)
    assert heights(pipeline, middle(sample.image, share)) == pytest.approx(truth, rel=0.05)
    assert pipeline.sensor.view == pytest.approx(view_of(crop))


@pytest.mark.parametrize("model", ["lut", "quadratic", "cubic"])
def test_whole_pictures_on_a_cropped_calibration_are_those_of_its_view(model: Any) -> None:
    """In whole pixels the cut is exact: not a code differs."""
    sample, share = td.sample("ball"), share_of((0.8, 0.8))
    sensor, _ = shown(sample.sensor, 0.8)
    cut = td.Pipeline(replace(sensor, view=None), middle(sample.reference, share), model=model)
    whole = td.Pipeline(sensor, sample.reference, model=model, crop="none")
    np.testing.assert_array_equal(whole(sample.image).codes, cut(middle(sample.image, share)).codes)
    assert whole.pixel_pitch_mm == cut.pixel_pitch_mm


@pytest.mark.parametrize(("kept", "given"), [(0.97, False), (0.95, True), (0.9, True), (0.8, True), (5 / 7, True)])
def test_real_presses_with_another_view(kept: float, given: bool) -> None:
    """Real presses in the middle, cropped once more; measured worst: 0.956, without the crop 1.053."""
    if not (FOLDER / "gelslam").is_dir():
        pytest.skip("TACTILE_DATA names no folder with gelslam/")
    left, top, right, bottom = ((n * (1 + side * kept)) / 2 for side in (-1, 1) for n in (320, 240))

    def pictures(path: Path) -> tuple[np.ndarray, np.ndarray]:
        picture = Image.open(path).convert("RGB")
        return np.asarray(picture), np.asarray(
            picture.resize((320, 240), Image.Resampling.BICUBIC, (left, top, right, bottom))
        )

    rest, cut_rest = pictures(FOLDER / "gelslam" / "background.png")
    sensor = td.load("gelsight-mini")
    base = td.Pipeline(sensor, rest)
    cut = td.Pipeline(sensor, cut_rest, crop=kept * 5 / 7 if given else None)
    presses = [press for press in td_presses() if abs(press[1] - 160) < 60 and abs(press[2] - 120) < 30]
    assert len(presses) >= 4
    for path, *_ in presses:
        picture, seen = pictures(path)
        assert heights(cut, seen)[0] == pytest.approx(heights(base, picture)[0], rel=0.055)


def test_real_presses_that_were_squeezed_are_mended_as_the_message_says() -> None:
    """Measured: 0.991 to 1.009 of their heights, squeezed 1.16 to 1.24."""
    if not (FOLDER / "gelslam").is_dir():
        pytest.skip("TACTILE_DATA names no folder with gelslam/")
    rest, sensor = Image.open(FOLDER / "gelslam" / "background.png").convert("RGB"), td.load("gelsight-mini")

    def squeezed(picture: Image.Image) -> Image.Image:
        return picture.resize((320, 240), Image.Resampling.BILINEAR, (40, 0, 280, 240))

    with pytest.warns(td.InputWarning, match="shows 0.75 of the width and 1.00 of the height") as warned:
        td.Pipeline(sensor, squeezed(rest))
    named = re.search(r"resize the pictures to (\d+) x (\d+) and give crop=(\S+), what", str(warned[0].message))
    assert named
    size, base = (int(named[1]), int(named[2])), td.Pipeline(sensor, rest)
    mended = td.Pipeline(sensor, squeezed(rest).resize(size), crop=named[3])
    for path, *_ in [press for press in td_presses() if abs(press[1] - 160) < 40 and abs(press[2] - 120) < 30][:2]:
        picture = Image.open(path).convert("RGB")
        result = mended(squeezed(picture).resize(size))
        assert result.warnings == ()
        assert float(result.height_mm.max()) == pytest.approx(float(base(picture).height_mm.max()), rel=0.02)


def td_presses() -> list[tuple[Path, float, float]]:
    """Return paths of real presses, and where they lie."""
    lines = (FOLDER / "gelslam" / "presses.csv").read_text().splitlines()
    head = lines[0].split(",")
    rows = [dict(zip(head, line.split(","), strict=True)) for line in lines[1:]]
    return [(FOLDER / "gelslam" / row["frame"], float(row["centre_x_px"]), float(row["centre_y_px"])) for row in rows]


# Calibrations without a view.


def test_a_view_that_is_unknown_is_told_once_and_completed(tmp_path: Path) -> None:
    path, sample = tmp_path / "mine.npz", td.sample()
    replace(sample.sensor, view=None).save(path)
    with pytest.warns(td.InputWarning, match=r"mine.npz: view unknown: .*: say with crop what .*: none, gs_sdk"):
        sensor = td.load(path)
    with warnings.catch_warnings():
        warnings.simplefilter("error", td.InputWarning)
        assert td.load(str(path)).view is None
        assert td.load(path, crop="gs_sdk").view == (5 / 7, 5 / 7)
    pipeline = td.Pipeline(sensor, sample.reference, crop="gs_sdk")
    assert pipeline.sensor.view == (5 / 7, 5 / 7)
    np.testing.assert_array_equal(
        pipeline(sample.image).codes, td.Pipeline(sensor, sample.reference)(sample.image).codes
    )


def test_a_crop_that_contradicts_a_calibration_is_refused() -> None:
    assert td.load("gelsight-mini", crop=0.714).view == (5 / 7, 5 / 7)
    with pytest.raises(InputError, match=r"crop=none contradicts gelsight-mini, whose pictures show 0.714 of the full"):
        td.load("gelsight-mini", crop="none")
    with pytest.raises(InputError, match=r"crop=none with the synthetic sensor, .*: omit crop"):
        completed(td.load("synthetic"), "none")
    with pytest.raises(InputError, match="with the synthetic sensor"):
        td.Pipeline(td.load("synthetic"), crop=0.8)


def test_the_command_takes_a_crop(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    sample, share = td.sample(), share_of((0.8, 0.8))
    sensor, _ = shown(sample.sensor, 0.8)
    replace(sensor, view=None).save(tmp_path / "old.npz")
    sensor.save(tmp_path / "new.npz")
    for name, picture in (("press", sample.image), ("background", sample.reference)):
        Image.fromarray(picture).save(tmp_path / f"{name}.png")
        Image.fromarray(middle(picture, share)).save(tmp_path / f"cut-{name}.png")

    def depth(calibration: str, cut: str, *options: str) -> tuple[np.ndarray, str]:
        words = ["--reference", f"{tmp_path}/{cut}background.png", "--calibration", f"{tmp_path}/{calibration}.npz"]
        assert main(["depth", f"{tmp_path}/{cut}press.png", "--out", f"{tmp_path}/out", *words, *options]) == 0
        return np.load(tmp_path / "out" / "depth_mm.npy"), capsys.readouterr().err

    expected, said = depth("new", "cut-")
    assert said == ""
    for arguments in (("new", "", "--crop", "none"), ("old", "cut-", "--crop", "0.8")):
        found, said = depth(*arguments)
        np.testing.assert_array_equal(found, expected)
        assert said == ""
    assert "old.npz: view unknown" in depth("old", "cut-")[1]
    assert main(["depth", "x", "--reference", f"{tmp_path}/background.png", "--crop", "half"]) == 2
    assert "--crop half: accepted are none, gs_sdk, gsrobotics" in capsys.readouterr().err


def test_the_simulator_plays_what_a_pipeline_reads(tmp_path: Path) -> None:
    sample = td.sample()
    sensor, _ = shown(sample.sensor, 0.8)
    sensor.save(tmp_path / "new.npz")
    Image.fromarray(sample.image).save(tmp_path / "press.png")
    Image.fromarray(sample.reference).save(tmp_path / "background.png")
    words = [f"FRAMES={tmp_path}/press.png", f"REFERENCE={tmp_path}/background.png", f"CALIBRATION={tmp_path}/new.npz"]
    frames, on_grid, _ = synthesis.design(run_request.parse([*words, "CROP=none"], preset="sensor"))
    pipeline = td.Pipeline(sensor, sample.reference, crop="none")
    ((_, picture),) = pipeline.reader.pictures(sample.image, "press")[0]
    np.testing.assert_array_equal(frames.pixels[0], picture)
    assert on_grid.pixel_pitch_mm == pytest.approx(pipeline.pixel_pitch_mm)


# Cameras.


@pytest.mark.parametrize(
    ("words", "picture", "window"),
    [
        (["CAMERA=raw8"], (480, 640), (91, 68, 457, 343)),
        (["CAMERA=raw8", "CROP=gs_sdk"], (480, 640), (0, 0, 640, 480)),
        (["CAMERA=raw8", "CROP=gsrobotics"], (480, 640), (0, 0, 640, 480)),
        (["CAMERA=raw8", "WINDOW=64,48,512,384"], (480, 640), (64, 48, 512, 384)),
    ],
)
def test_a_camera_sends_the_full_picture(words: Any, picture: Any, window: Any) -> None:
    """The grid covers what the calibration's pictures show, so its pixels have their size in mm; more is warned of."""
    variables = (*run_request.CONFIGURING, *run_request.CAMERA)
    with warnings.catch_warnings(record=True) as given:
        warnings.simplefilter("always")
        frames, sensor, _ = synthesis.design(run_request.parse(words, variables, "sensor", ""))
    told = "window=(64, 48, 512, 384) shows gel up to 27 pixels beyond the calibration's pictures"
    assert [str(each.message).startswith(told) for each in given] == [True] * ("WINDOW" in words[-1])
    assert frames.camera is not None
    assert (frames.camera.picture, frames.camera.crop) == (picture, window)
    shares = view_of(words[1].partition("=")[2]) if "CROP" in words[-1] else (1, 1)
    full_mm = 320 * 0.0634 / (5 / 7)
    grid_mm = full_mm * shares[0] * window[2] / 640 / 128
    assert sensor.pixel_pitch_mm == pytest.approx(grid_mm, rel=1e-3)


@pytest.mark.parametrize(
    ("window", "right"),
    [(None, False), ((91, 68, 457, 343), True), ((96, 72, 448, 336), True), ((0, 0, 456, 342), False), ((), True)],
)
def test_a_device_with_another_window_is_named(window: Any, right: bool) -> None:
    sensor: Any = td.load("gelsight-mini")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        pipeline = td.Pipeline(sensor, np.repeat(np.repeat(sensor.untouched, 10, 0), 10, 1).astype(np.uint8))

    class Line:
        """Registers of a device; without a camera front end it refuses to read them."""

        def read(self, addresses: list[int]) -> list[int]:
            if window == ():
                return []
            camera = CameraConfiguration((480, 640), (96, 128), "raw8", window=window)
            registers = CameraRegisters(camera_registers_parameters(camera))
            return [registers.values[{r.offset: r.name for r in CAMERA_MAP}[address]] for address in addresses]

    line: Any = Line()
    doubts = window_doubts(line, pipeline)
    assert len(doubts) == (not right)
    for doubt in doubts:
        assert "gelsight-mini is for 91,68,457,343 of a picture of 640 x 480" in str(doubt)
        assert "build the device with WINDOW=91,68,457,343" in str(doubt)
