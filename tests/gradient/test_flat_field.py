# SPDX-License-Identifier: Apache-2.0
"""flat_field: RTL against the model, and the model against its definition."""

import numpy as np
import pytest

from tactile_depth.chip.common.td_node_map import node_map
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.gradient.flat_field import (
    captured_gains,
    pixel_gains,
    unit_gains,
)
from tactile_depth.chip.limits import DEVIATION, RATIO

CONFIG = Configuration(columns=32, rows=21, solver="tridiagonal")


@pytest.mark.parametrize("level", [8, 16, 40, 128, 255])
def test_a_frame_like_the_reference_is_flat(level: int) -> None:
    """Send the reference as a frame, at every level. Below 16 grey levels pixels are dark, and flat as well."""
    frames = np.full((1, 21, 32, 3), level, np.uint8)
    gains = captured_gains(frames, CONFIG)
    assert np.all(np.abs(node_map(gains, CONFIG) * level - (1 << CONFIG.gain.fraction)) <= level)
    assert np.all(pixel_gains(gains, CONFIG).codes(frames) == 128)
    assert not np.any(pixel_gains(gains, CONFIG).deviations(frames))


def test_gains_at_power_up_leave_pixels_as_they_are() -> None:
    frames = np.random.default_rng(1).integers(0, 256, (2, 21, 32, 3), dtype=np.uint8)
    np.testing.assert_array_equal(pixel_gains(unit_gains(CONFIG), CONFIG).codes(frames), frames)
    relative = frames.astype(int) - 128 << (DEVIATION.fraction - 7)
    np.testing.assert_array_equal(pixel_gains(unit_gains(CONFIG), CONFIG).deviations(frames), relative)
    wide = frames.astype(int) << (RATIO.fraction - 7)
    np.testing.assert_array_equal(pixel_gains(unit_gains(CONFIG), CONFIG).ratios(frames), wide)


def test_interpolation_is_linear_between_the_centres_of_blocks() -> None:
    """Interpolate gains on a plane: between the outermost centres the result is that plane."""
    log2 = CONFIG.reference_block_log2
    rows, columns = CONFIG.reference_nodes
    centre = np.arange(max(rows, columns)) * (1 << log2) + ((1 << log2) - 1) / 2
    plane = 2**16 * (centre[:rows, None] * 3 + centre[None, :columns] * 5) + 2**20
    gains = np.repeat(plane[..., None], 3, axis=-1).astype(np.int64)
    row = np.clip(np.arange(21), centre[0], centre[rows - 1])
    column = np.clip(np.arange(32), centre[0], centre[columns - 1])
    want = 2**16 * (row[:, None] * 3 + column[None] * 5) + 2**20
    assert np.abs(node_map(gains, CONFIG)[..., 1] - want).max() <= 0.5


def test_a_dark_pixel_takes_over_its_neighbour_and_is_not_counted_as_clipped() -> None:
    frames = np.full((21, 32, 3), 100, np.uint8)
    frames[3, 0] = frames[3, 1] = frames[5, 4] = frames[5, 5] = 2
    frames[5, 3] = 77
    frames[7, 9] = 2, 3, 2  # one colour is not
    codes = pixel_gains(unit_gains(CONFIG), CONFIG).codes(frames, dark_level=3)
    assert codes[3, :3, 0].tolist() == [128, 128, 100]
    assert codes[5, 2:7, 0].tolist() == [100, 77, 77, 77, 100]
    assert codes[7, 9].tolist() == [2, 3, 2]
