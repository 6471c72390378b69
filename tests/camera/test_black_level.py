# SPDX-License-Identifier: Apache-2.0
"""black_level: RTL against the model; samples and black levels stay within the bits of a sample."""

import numpy as np
import pytest

from tactile_depth.chip.camera.black_level import black_level
from tactile_depth.chip.camera.pixel_format import pixel_format
from tactile_depth.chip.camera_configuration import FORMATS, CameraConfiguration


@pytest.mark.parametrize("form", FORMATS)
def test_no_difference_leaves_the_bits_of_a_sample(form: str) -> None:
    """Take the largest black level from the extreme samples of each format."""
    camera = CameraConfiguration((4, 8), (2, 4), form)
    words = np.array([0, 0xFF, 0xFF00, 0xFFFF, 0xFFFFFF, 0xFF00FF, 0x00FF, 0xFF0000])
    for first in words:
        samples = pixel_format(np.where(np.indices((4, 8))[1] % 2, first, words[None]), camera)
        for level in (0, (1 << camera.bits) - 1):
            difference = black_level(samples, level)
            assert difference.min() >= -(1 << camera.sample_width - 1)
            assert difference.max() < 1 << camera.sample_width - 1
