# SPDX-License-Identifier: Apache-2.0
"""Scenes: heights within the range of the sensor, and colours that give these heights."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tactile_depth.base.errors import InputError
from tactile_depth.chip.poisson.divergence import divergence
from tactile_depth.depth import reference
from tactile_depth.sensor.scenes import (
    BENCH,
    NOISE,
    REST,
    SCENES,
    SENSOR_WIDTH_MM,
    SLOPE_LIMIT,
    Press,
    dome,
    photograph,
    render,
    scene_pixel_pitch_mm,
    slopes_of,
)
from tactile_depth.sensor.synthetic import synthetic

SIZES = (16, 256)


@pytest.mark.parametrize("name", SCENES)
def test_scene_is_well_formed(name: str) -> None:
    for size in SIZES:
        scene = render(name, size)
        assert scene.name == name
        assert scene.frames.dtype == np.uint8
        assert scene.frames.shape == (*scene.height.shape, 3)
        assert scene.height.dtype == np.float64
        assert scene.height.shape[1:] == (size, size)
        assert (scene.height >= 0).all()
        assert np.abs(slopes_of(scene.height)).max() <= SLOPE_LIMIT + 1e-9
        border = np.ones((size, size), bool)
        border[1:-1, 1:-1] = False
        assert not scene.height[:, border].any(), "the contact reaches the edge of the frame"
        assert scene.frames.min() > 0
        assert scene.frames.max() < 255, "colours are clipped"


@pytest.mark.parametrize("name", SCENES)
def test_divergence_and_solve_return_the_very_map(name: str) -> None:
    height = render(name, 64).height
    np.testing.assert_allclose(reference.solve(divergence(slopes_of(height))), height, atol=1e-11)


# RMS of reference depth against true height, in % of peak: what 4 bits a channel and the noise cost.
# Measured with seeds 1 to 5: at most 1.1 at 64, 0.6 at 128.
@pytest.mark.parametrize(("size", "bound"), [(64, 1.3), (128, 0.7)])
@pytest.mark.parametrize("name", [name for name in SCENES if name != "flat"])
def test_reference_depth_resembles_the_true_height(name: str, size: int, bound: float) -> None:
    scene = render(name, size)
    error = reference.depth(scene.frames, synthetic()) - scene.height
    percent = 100 * np.sqrt((error**2).mean(axis=(1, 2))) / scene.height.max(axis=(1, 2))
    assert percent.max() < bound


def test_the_bench_has_15_contacts_each_a_scene_of_its_own() -> None:
    bench = render("bench", 64)
    assert len(bench.frames) == len(set(bench.labels)) == 15
    for label, height in zip(bench.labels, bench.height, strict=True):
        np.testing.assert_array_equal(render(label, 64).height[0], height)


@pytest.mark.parametrize("name", BENCH)
def test_a_press_is_as_deep_as_asked_for_and_where_asked_for(name: str) -> None:
    half = BENCH[name].depth / 2
    shallow = render(name, 128, press=Press(depth_mm=half * SENSOR_WIDTH_MM)).height[0]
    # The deepest point falls between samples, and where three strokes meet there may be none at full depth.
    assert shallow.max() == pytest.approx(128 * half, rel=0.01)
    pitch = scene_pixel_pitch_mm(128)
    shifted = render(name, 128, press=Press(at_mm=(3 * pitch, -5 * pitch))).height[0]
    np.testing.assert_allclose(shifted[:-5, 3:], render(name, 128).height[0][5:, :-3], atol=1e-9)


def test_a_contact_that_the_edge_cuts_goes_on_beyond_it() -> None:
    inside, cut = (render("ball", 64, seed=1, press=Press(at_mm=(x, 0), noise=0)) for x in (0, 7.14))
    assert cut.height[0, :, -1].max() > 3
    shift = 30  # 7.14 mm
    np.testing.assert_array_equal(cut.frames[0][:, shift:], inside.frames[0][:, :-shift])


def test_a_press_that_the_sensor_cannot_see_is_refused() -> None:
    with pytest.raises(InputError, match="seal pressed 1 mm deep"):
        render("seal", 64, press=Press(depth_mm=1))
    with pytest.raises(InputError, match="deep is what it is"):
        render("deep", 64, press=Press(depth_mm=1))


def test_noise_is_as_strong_as_asked_for() -> None:
    assert render("flat", 64, press=Press(noise=3)).frames.std() == pytest.approx(3, rel=0.05)
    assert len(np.unique(render("flat", 64, press=Press(noise=0)).frames)) == 1


def test_contacts_span_the_peaks_of_the_accuracy_bar() -> None:
    peaks = render("contacts", 128).height.max(axis=(1, 2))
    assert len(peaks) >= 6
    assert peaks.min() == pytest.approx(3, abs=0.1)
    assert peaks.max() == pytest.approx(18, abs=0.1)
    assert (np.diff(peaks) > 0).all()


@pytest.mark.parametrize("name", SCENES)
def test_heights_scale_with_the_grid(name: str) -> None:
    small, large = (render(name, size).height.max(axis=(1, 2)) for size in (128, 256))
    np.testing.assert_allclose(large, 2 * small, rtol=0.01, atol=1e-12)


@pytest.mark.parametrize("seed", range(5))
def test_a_flat_gel_reads_exactly_zero(seed: int) -> None:
    scene = render("flat", 128, seed=seed)
    assert not scene.height.any()
    assert not reference.depth(scene.frames, synthetic()).any()


def test_noise_is_that_of_the_seed() -> None:
    first, again, other = (render("flat", 64, seed=seed).frames.astype(float) for seed in (1, 1, 2))
    np.testing.assert_array_equal(first, again)
    assert (first != other).any()
    assert first.mean() == pytest.approx(REST, abs=0.05)
    assert first.std() == pytest.approx(np.hypot(NOISE, 12**-0.5), rel=0.05)  # and that of rounding


def test_each_light_brightens_the_slopes_that_face_it() -> None:
    y, x = np.mgrid[:32, :32].astype(float)
    down = photograph(0.5 * y)[0:31, 0:31].mean(axis=(0, 1))
    assert down[0] > REST + 50  # red shines from below
    assert (down[1:] < REST - 20).all()
    across = photograph(0.5 * x)[0:31, 0:31].mean(axis=(0, 1))
    assert across[1] < REST - 40 < REST + 40 < across[2]  # green from the left, blue from the right


def test_deep_is_as_deep_as_the_default_depth_range() -> None:
    assert render("deep", 128).height.max() == pytest.approx(32, rel=1e-12)


@settings(max_examples=30, deadline=None)
@given(st.sampled_from([16, 64, 128]), st.floats(0.001, 1))
def test_a_dome_has_the_depth_asked_for_and_slopes_in_range(size: int, share: float) -> None:
    peak = share * 0.26 * size
    height = dome(size, peak)
    assert height.max() == peak
    assert np.abs(slopes_of(height)).max() <= SLOPE_LIMIT + 1e-9


@pytest.mark.parametrize("peak", [0.3 * 128, 1000, float("inf"), float("nan"), 0, -1])
def test_a_dome_that_cannot_be_is_refused(peak: float) -> None:
    with pytest.raises(InputError) as caught:
        dome(128, peak)
    assert f"{peak:g}" in str(caught.value)
    assert "\n" not in str(caught.value)


def test_an_unknown_scene_is_answered_with_the_known_ones() -> None:
    with pytest.raises(InputError, match="unknown scene bal") as caught:
        render("bal", 64)
    assert all(name in str(caught.value) for name in SCENES)
    assert "\n" not in str(caught.value)
