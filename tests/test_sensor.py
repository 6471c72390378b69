# SPDX-License-Identifier: Apache-2.0
"""Sensor, camera and configuration: combinations that do not fit are refused."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tactile_depth.base.errors import InputError, InputWarning
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.rom_files import pack, unsigned, write_words
from tactile_depth.chip.tactile_depth import tactile_depth, write_roms
from tactile_depth.depth.reference import slopes_of
from tactile_depth.pictures.frames import camera_scale, load_frames, on_grid, read_picture
from tactile_depth.pictures.identify import identify
from tactile_depth.pictures.reference_check import check_reference
from tactile_depth.sensor.built_in import load
from tactile_depth.sensor.scenes import render
from tactile_depth.sensor.sensor import Sensor, lighting
from tactile_depth.sensor.synthetic import synthetic
from tests.drawn_light import light_of
from tests.real_data import FOLDER, needs_real_data

GREY = np.full((16, 16, 3), 128, np.uint8)


@pytest.fixture(scope="module")
def mini() -> Any:
    return load("gelsight-mini")


def saved(path: Path, shape: Any, value: int = 128) -> str:
    np.save(path, np.full((1, *shape, 3), value, np.uint8))
    return str(path)


# The camera.


def test_a_larger_picture_is_scaled_with_its_pitch(tmp_path: Path, mini: Any) -> None:
    picture = mini.scaled(1, GREY)  # any reference
    for zoom in (1, 2, 3):
        frames = load_frames(saved(tmp_path / "f.npy", (240 * zoom, 320 * zoom)), (96, 128))
        frames = replace(frames, reference=frames.pixels[0])
        pitch = on_grid(mini, frames).pixel_pitch_mm
        assert pitch == pytest.approx(mini.pixel_pitch_mm * 2.5)
    assert picture.reference is not None


def test_pictures_of_another_aspect_ratio_are_refused(mini: Any) -> None:
    for rows, columns in ((240, 321), (478, 640)):
        assert mini.zoom((rows, columns)) == pytest.approx(columns / 320, rel=0.005)
    for rows, columns in ((240, 322), (480, 720), (320, 240)):
        with pytest.raises(InputError, match=f"{columns} x {rows} pixels .* calibrated for pictures of 320 x 240"):
            mini.zoom((rows, columns))


def test_a_scene_is_not_for_a_real_sensor(mini: Any) -> None:
    with pytest.raises(InputError, match="a scene is drawn for the synthetic sensor, not for gelsight-mini"):
        on_grid(mini, load_frames("ball", (16, 16), "flat"))


def test_a_real_sensor_needs_a_reference(tmp_path: Path, mini: Any) -> None:
    frames = load_frames(saved(tmp_path / "f.npy", (240, 320)), (96, 128))
    with pytest.raises(InputError, match="gelsight-mini needs a reference"):
        on_grid(mini, frames)
    with pytest.raises(InputError, match="fitted to colours as sent: omit the reference"):
        on_grid(replace(mini, flat_field=False), replace(frames, reference=GREY))


def test_the_scale_of_whole_pictures(mini: Any) -> None:
    assert camera_scale(mini, Configuration(columns=128, rows=96, solver="tridiagonal")) == 2.5
    assert camera_scale(mini, Configuration(columns=128)) == 1.875
    with pytest.raises(InputError, match="smaller than the grid"):
        camera_scale(mini, Configuration(columns=512, solver="tridiagonal"))


def test_the_lighting_of_another_sensor_is_noticed(mini: Any) -> None:
    rng = np.random.default_rng(1)
    own = light_of(mini) * rng.uniform(0.95, 1.05)
    assert not check_reference(mini, own.astype(np.uint8)[None])
    with pytest.warns(InputWarning, match="does not look like the sensor of gelsight-mini"):
        check_reference(mini, (own * (1, 1, 0.3)).astype(np.uint8)[None])


def test_lighting_does_not_depend_on_exposure() -> None:
    picture = np.random.default_rng(1).integers(20, 100, (41, 62, 3)).astype(np.uint8)
    np.testing.assert_allclose(lighting(picture), lighting(2 * picture), rtol=1e-12)


# The configuration.


def test_the_configuration_follows_from_the_sensor(mini: Any) -> None:
    config = mini.scaled(1, GREY).configuration(columns=16)
    assert (config.flat_field, config.gradient_model, config.bits_per_channel) == (True, "cubic", 5)
    assert config.gradient_limit == mini.gradient_limit
    assert synthetic(3).configuration(columns=16).bits_per_channel == 3
    with pytest.raises(InputError, match="gradient_model=quadratic: table holds only lut"):
        replace(synthetic(), name="table", coefficients=None).configuration("quadratic", columns=16)
    with pytest.raises(InputError, match="needs a reference"):
        mini.configuration(columns=16)


STEEP = Sensor("steep", np.full((16, 16, 16, 2), 1.5), 0.1)
DISAGREEING: dict[str, Any] = {
    "bits_per_channel": (synthetic(5), {}, "bits_per_channel=4 of the configuration, but the table of synthetic has 5"),
    "gradient_limit": (STEEP, {}, "gradient_limit=1.0 of the configuration is below the slopes of steep, which reach"),
    "flat_field": (synthetic().scaled(1, GREY), {}, "flat_field=False of the configuration, but synthetic has a ref"),
    "size of the reference": (
        synthetic().scaled(1, np.full((32, 16, 3), 128, np.uint8)),
        {"flat_field": True},
        "the reference of synthetic has 32 rows and 16 columns, the grid of the configuration has rows=16, columns=16",
    ),
    "no reference": (load("gelsight-mini"), {"flat_field": True, "bits_per_channel": 5}, "needs a reference"),
    "no flat field": (load("gelsight-mini"), {"bits_per_channel": 5}, "needs a reference"),
    "as sent": (replace(synthetic(), flat_field=False), {"flat_field": True}, "was fitted to colours as sent"),
    "model": (STEEP, {"flat_field": True, "gradient_model": "quadratic"}, "gradient_model=quadratic: steep holds only"),
}


@pytest.mark.parametrize("case", DISAGREEING)
@pytest.mark.parametrize("use", ["model", "reference", "tables"])
def test_a_sensor_and_a_configuration_that_disagree_are_refused(tmp_path: Path, case: Any, use: Any) -> None:
    sensor, choices, message = DISAGREEING[case]
    config = Configuration(columns=16, **choices)
    uses: dict[str, Any] = {
        "model": lambda: tactile_depth(GREY, sensor, config),
        "reference": lambda: slopes_of(GREY, sensor, config),
        "tables": lambda: write_roms(tmp_path, sensor, config),
    }
    with pytest.raises(InputError, match=message):
        uses[use]()
    assert not list(tmp_path.iterdir())


def test_gains_and_zeros_of_another_grid_are_refused(tmp_path: Path) -> None:
    config = Configuration(columns=16, flat_field=True, zero_offset=True)
    with pytest.raises(InputError, match=r"gains have the shape \(5, 5, 3\): accepted is \(8, 8, 3\)"):
        tactile_depth(GREY, synthetic(), config, gains=np.full((5, 5, 3), 4096))
    with pytest.raises(InputError, match="gains have the shape"):
        write_roms(tmp_path, synthetic(), config, gains=np.full((5, 5, 3), 4096))
    with pytest.raises(InputError, match=r"zero have the shape \(4, 4\)"):
        write_roms(tmp_path, synthetic(), config, np.zeros((4, 4), int), np.full((8, 8, 3), 1 << 20))
    assert not list(tmp_path.iterdir())


def test_a_wider_limit_than_needed_gives_the_same_depth() -> None:
    frames = render("ball", 32, seed=1).frames
    depth = [
        tactile_depth(frames, synthetic(), config) * config.depth_lsb_px
        for config in (Configuration(columns=32), Configuration(columns=32, gradient_limit=2.0))
    ]
    np.testing.assert_allclose(*depth, atol=1e-3)  # type: ignore[call-overload]


# The writers of tables never drop a bit.


def test_words_that_do_not_fit_are_refused(tmp_path: Path) -> None:
    for word in (-1, 16):
        with pytest.raises(ValueError, match="do not fit 4 unsigned bits"):
            write_words(tmp_path / "a.hex", [3, word], 4)
    assert not (tmp_path / "a.hex").exists()
    for word in (-9, 8):
        with pytest.raises(ValueError, match="do not fit 4 signed bits"):
            pack((np.array([word]),), 4)
    assert pack((np.array([-8]), np.array([7])), 4) == [0x87]
    assert unsigned(np.array([-1]), 4) == 15


# Sensor of a reference.


def rest_of(sensor: Any, zoom: Any = 1) -> Any:
    """Return a picture without contact as the camera of a sensor sees it."""
    rng = np.random.default_rng(1)
    picture = np.kron(sensor.lighting * 90, np.ones((60 * zoom, 80 * zoom, 1)))
    return (picture + rng.normal(size=picture.shape)).clip(0, 255).astype(np.uint8)


@pytest.mark.parametrize("zoom", [1, 2])
def test_a_sensor_is_identified_by_its_lighting(mini: Any, zoom: float) -> None:
    assert identify(rest_of(mini, zoom)).name == "gelsight-mini"
    assert identify(rest_of(mini, zoom) // 2).name == "gelsight-mini"


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        (lambda picture: np.full_like(picture, 128), "its lighting differs from gelsight-mini by 25 %"),
        (lambda picture: picture[..., ::-1], "its lighting differs from gelsight-mini"),
        (lambda picture: np.rot90(picture, 2), "its lighting differs from gelsight-mini"),
        (
            lambda picture: np.rot90(picture),
            "takes 320 x 240, this has 240 x 320 pixels.*rotate all pictures by 90 or 270",
        ),
        (lambda picture: picture[..., 0], r"the reference is uint8 \(240, 320\)"),
        (lambda picture: picture[:2], r"the reference is uint8 \(2, 320, 3\)"),
        (lambda picture: picture / 255, "the reference is float64"),
        (lambda picture: "background.png", "the reference is a str: accepted is uint8"),
    ],
    ids=["grey", "BGR", "upside down", "on its side", "one colour", "two rows", "floats", "a path"],
)
def test_a_picture_of_no_known_sensor_is_not_identified(mini: Any, change: Any, reason: Any) -> None:
    with pytest.raises(InputError, match=reason):
        identify(change(rest_of(mini)))


def test_a_crop_of_what_is_cut_off_is_named(mini: Any) -> None:
    with pytest.raises(InputError, match=r"or correct crop=0\.15, what the pictures show"):
        identify(rest_of(mini), crop=0.15)
    with pytest.raises(InputError, match=r"of which 320 x 172 are used.*or correct crop=\(0\.7, 1\)"):
        identify(rest_of(mini), crop=(0.7, 1))


@needs_real_data
def test_the_real_sensor_is_identified() -> None:
    background = read_picture(FOLDER / "gelslam" / "background.png")
    assert identify(background).name == "gelsight-mini"
    with pytest.raises(InputError, match="give the calibration of the sensor that took it"):
        identify(np.rot90(background, 2))
