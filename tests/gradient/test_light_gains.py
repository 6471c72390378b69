# SPDX-License-Identifier: Apache-2.0
"""light_gains: RTL against the model, and the model against its definition."""

from typing import Any

import numpy as np
import pytest

from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.gradient.light_gains import Light, LightFilter, settled

LIGHT = Light.of(Configuration(columns=64, rows=48, solver="tridiagonal"))
SHAPE = LIGHT.rows, LIGHT.columns, 3


def gel(light: Any, contact: float = 0.0, seed: int = 1) -> np.ndarray:
    """Return ratios, int64 (rows, columns, 3), in `light`, of a gel with noise that a square touches in a part."""
    ratio = 1 + np.random.default_rng(seed).normal(0, 0.02, SHAPE)
    down, along = (np.linspace(-0.9, 0.9, round(np.sqrt(contact) * length)) for length in SHAPE[:2])
    if contact:
        ratio[: len(down), : len(along)] += np.stack(np.broadcast_arrays(down[:, None], along, -along), axis=-1)
    codes = np.rint(ratio * light * (1 << LIGHT.ratio_fraction)).astype(np.int64)
    return codes.clip(0, (1 << LIGHT.ratio_width) - 1)


@pytest.mark.parametrize("light", [0.55, 0.8, 0.95, 1.0, 1.1, 1.3, 1.9, (0.9, 1.0, 1.2)])
@pytest.mark.parametrize("contact", [0.0, 0.3])
def test_gains_undo_the_light_of_single_pictures(light: Any, contact: float) -> None:
    gains = settled(gel(light, contact), LIGHT) / LIGHT.unity
    np.testing.assert_allclose(gains * light, settled(gel(1.0, contact), LIGHT) / LIGHT.unity, rtol=2e-3)
    np.testing.assert_allclose(gains * light, 1, rtol=0.01)


@pytest.mark.parametrize("light", [0.8, 0.95, 1.05, 1.2])
def test_a_stream_converges_to_the_gains_of_a_single_picture(light: float) -> None:
    picture = gel(light, contact=0.2)
    stream = LightFilter(LIGHT)
    for _ in range(12):
        stream.take(picture)
    np.testing.assert_allclose(stream.gains, settled(picture, LIGHT), atol=LIGHT.unity * 2e-4)


@pytest.mark.parametrize("noise", [0.0005, 0.01])
def test_a_stream_comes_to_rest_in_any_light(noise: float) -> None:
    """Lights at which a part of the pixels is beyond 1/8 are among them; measured: within 0.01 % after 11 frames."""
    spread = np.random.default_rng(1).normal(1, noise, SHAPE)
    for light in np.arange(0.515, 1.99, 0.0137):
        picture = np.rint(light * spread * (1 << LIGHT.ratio_fraction)).astype(np.int64)
        stream = LightFilter(LIGHT)
        for _ in range(12):
            stream.take(picture.clip(0, (1 << LIGHT.ratio_width) - 1))
        before = stream.gains
        for _ in range(3):
            stream.take(picture.clip(0, (1 << LIGHT.ratio_width) - 1))
        np.testing.assert_allclose(before / LIGHT.unity * light, 1, atol=0.002, err_msg=f"{light}")
        np.testing.assert_allclose(stream.gains / LIGHT.unity * light, 1, atol=0.002, err_msg=f"{light}")


def test_a_slower_rate_takes_a_part_of_the_mean() -> None:
    picture = gel(1.04)
    moves = []
    for rate in (0, 1, 3):
        stream = LightFilter(LIGHT, rate=rate)
        stream.take(picture)
        moves.append(LIGHT.unity - stream.gains)
    np.testing.assert_allclose(np.array(moves[:2]) / moves[2], [[8] * 3, [4] * 3], rtol=0.02)


def test_a_quarter_of_the_pixels_moves_the_gains() -> None:
    """Let the light be off by 3 % where nothing touches, with as many steep slopes to either side elsewhere."""
    quarter = -(-LIGHT.pixels // 4)
    for untouched, moves in ((quarter, True), (quarter - 1, False)):
        deviations = np.full((LIGHT.pixels, 3), 2 * LIGHT.near)
        deviations[::2] *= -1
        deviations[:untouched] = LIGHT.near // 4
        assert LIGHT.move(deviations, np.full(3, LIGHT.unity)).all() == moves
        assert LIGHT.move(deviations, np.full(3, LIGHT.unity)).any() == moves


def test_a_very_large_contact_holds_the_gains() -> None:
    stream = LightFilter(LIGHT)
    stream.take(gel(1.0))
    before = stream.gains
    stream.take(gel(1.0, contact=0.98))
    np.testing.assert_array_equal(stream.gains, before)


def test_bad_frames_and_a_filter_that_is_off_hold_the_gains() -> None:
    stream = LightFilter(LIGHT)
    stream.take(gel(1.1), bad=True)
    assert stream.gains.tolist() == [LIGHT.unity] * 3
    stream.follow = False
    stream.take(gel(1.1))
    assert stream.gains.tolist() == [LIGHT.unity] * 3


def test_black_pixels_have_no_deviation_whatever_the_gains() -> None:
    ratios = np.zeros(SHAPE, np.int64)
    for gain in (0.5, 1.0, 1.5):
        assert not LIGHT.deviations(ratios, np.full(3, round(gain * LIGHT.unity))).any()
    assert settled(ratios, LIGHT).tolist() == [LIGHT.unity] * 3


def test_several_pictures_have_gains_of_their_own() -> None:
    pictures = np.stack([gel(light) for light in (0.9, 1.0, 1.1)])
    together = settled(pictures, LIGHT)
    np.testing.assert_array_equal(together, [settled(picture, LIGHT) for picture in pictures])
