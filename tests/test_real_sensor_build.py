# SPDX-License-Identifier: Apache-2.0
"""Presses of balls through the RTL of the real-sensor build, and through a camera's front end with its calibration."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from commands.run import bench
from tactile_depth.calibrate.evaluation import scores_of
from tactile_depth.calibrate.fitting import fit_presses
from tactile_depth.calibrate.press_pictures import gather
from tactile_depth.calibrate.presses import GridPresses, View
from tactile_depth.chip.camera_configuration import CameraChoice
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.depth.zero_capture import captured_zero
from tactile_depth.chip.latency import last_word_to_first_depth
from tactile_depth.chip.tactile_depth import tactile_depth
from tactile_depth.pictures.frames import read_picture
from tactile_depth.pictures.grid_sampler import grid_sampler
from tactile_depth.sensor.built_in import load
from tactile_depth.sensor.sensor import Sensor
from tests.ball_presses import read, real_folder, write_folder

FULL_WORDS: dict[str, Any] = {}  # the defaults, 24 bits
REAL_SENSOR_WORDS = {"data_width": 15, "coefficient_width": 18, "gain_width": 16}
DEPTH_RANGE_MM = 2.0  # twice the deepest press; words of 15 bits need a range that fits
HEIGHT_BAR = 0.01  # of a cap height


def on_grid(sensor: Sensor, presses: GridPresses) -> Sensor:
    return replace(sensor, pixel_pitch_mm=presses.grid_pitch_mm, reference=presses.background_on_grid)


def real_sensor(sensor: Sensor, presses: GridPresses, words: dict[str, Any]) -> Configuration:
    """Return what a real sensor needs: flat field, quadratic, zero slope at the edge, zero offset."""
    choices: dict[str, Any] = {
        "columns": presses.grid[1],
        "rows": presses.grid[0],
        "solver": "tridiagonal",
        "neumann": True,
        "zero_offset": True,
    }
    return on_grid(sensor, presses).configuration("quadratic", **choices, **words)


def depth_of(
    simulator: str,
    sensor: Sensor,
    config: Configuration,
    presses: GridPresses,
    views: Sequence[View],
    folder: Path,
    words: np.ndarray | None = None,
    choice: CameraChoice | None = None,
) -> np.ndarray:
    """Return depth in grid pixels (presses, rows, columns) from the RTL, which equals its model on every code.

    `words` are what the camera of `choice` sends for the views.
    """
    calibration = on_grid(sensor, presses)
    no_contact = presses.background_on_grid[None]
    zero = captured_zero(tactile_depth(no_contact, calibration, replace(config, zero_offset=False)), config)
    frames = np.stack([view.frame for view in views])
    camera = None if choice is None else choice.on(presses.background.shape[:2], (config.rows, config.columns))
    entries = bench.frame_entries(frames)
    if camera is not None and words is not None:
        entries = bench.picture_entries(words, camera)
    folder.mkdir()
    always = [bench.entry(side, bench.chance(0)) for side in ("sink", "source")]
    entries = np.concatenate([np.array(always, np.uint32), entries])
    count = len(views)
    clocks = 2 * bench.clocks_of(entries) + 4 * config.rows * config.columns
    choices: dict[str, Any] = {"clocks": clocks, "total_frames": count, "zero": zero, "camera": camera}
    played = bench.play(simulator, config, calibration, entries, folder, **choices)
    codes = tactile_depth(frames, calibration, config, zero=zero)
    np.testing.assert_array_equal(played.codes.reshape(codes.shape), codes)
    if camera is not None:
        cycles = {after - at for after, at in zip(played.clocks("d"), played.clocks("t")[1::2], strict=True)}
        assert cycles == {last_word_to_first_depth(camera, config)}
    return codes[:, ::-1] * config.depth_lsb_px


def heights(views: Sequence[View], depth: np.ndarray) -> np.ndarray:
    """Return recovered over true height of each cap."""
    return np.array([view.press.recovered(each) for view, each in zip(views, depth, strict=True)])


@pytest.mark.regress
def test_caps_keep_their_height_at_the_words_of_the_real_sensor_build(tmp_path: Path) -> None:
    """Every whole real press, in the RTL, against words of 24 bits."""
    folder = real_folder()
    sensor, presses = load("gelsight-mini"), read(folder)
    views = [view for view in presses.views if view.is_whole]
    recovered = {}
    fitting: dict[str, Any] = {**REAL_SENSOR_WORDS, "depth_range_px": DEPTH_RANGE_MM / presses.grid_pitch_mm}
    for name, words in (("full", FULL_WORDS), ("real", fitting)):
        config = real_sensor(sensor, presses, words)
        recovered[name] = heights(views, depth_of("verilator", sensor, config, presses, views, tmp_path / name))
    change = np.abs(recovered["real"] / recovered["full"] - 1)
    print(f"heights of {len(views)} caps change by {100 * change.mean():.3f} %, at most {100 * change.max():.3f} %")
    assert change.max() < HEIGHT_BAR


@pytest.mark.parametrize("where", ["drawn", pytest.param("real", marks=pytest.mark.regress)])
@pytest.mark.parametrize("form", ["raw10", pytest.param("yuyv", marks=pytest.mark.regress)])
def test_a_calibration_made_through_a_camera_holds_in_the_rtl(where: str, form: str, tmp_path: Path) -> None:
    """Fitted to what the camera sends, in the model; what the camera sends of presses, in the RTL."""
    folder = real_folder() if where == "real" else write_folder(tmp_path / "presses")
    choice = CameraChoice(form)
    presses = read(folder, choice=choice)
    fit = fit_presses(presses, ("quadratic",))
    assert fit.sensor.camera is not None
    assert fit.sensor.camera.pixel_format == form
    views = [view for view in presses.views if view.is_whole][:8]
    views.insert(0, views[0])  # light gains are those of the frame before
    sampler = grid_sampler("presses", presses.background.shape[:2], presses.grid, choice)
    pictures = {press.name: press.image for press in gather(folder).presses}
    words = np.stack([sampler.words(read_picture(Path(str(pictures[view.press.name])))) for view in views])
    config = real_sensor(fit.sensor, presses, FULL_WORDS)
    depth = depth_of("verilator", fit.sensor, config, presses, views, tmp_path / "run", words, choice)
    in_the_model = [score.cap_height for score in scores_of(fit.sensor, presses, views, "quadratic")]
    np.testing.assert_allclose(heights(views, depth)[1:], in_the_model[1:], atol=HEIGHT_BAR)
