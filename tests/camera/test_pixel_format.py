# SPDX-License-Identifier: Apache-2.0
"""pixel_format: RTL against the model, the model against BT.601 in double precision and against pictures."""

import numpy as np
import pytest

from tactile_depth.chip.camera.pixel_format import CHROMA_OFFSET, photograph, pixel_format
from tactile_depth.chip.camera_configuration import FORMATS, PHASES, CameraConfiguration
from tactile_depth.chip.registers.register_map import CAMERA_REGISTERS


def test_the_formats_are_those_of_the_register() -> None:
    field = CAMERA_REGISTERS["CAMERA_FORMAT"].field("pixel_format")
    assert field.values == {name: form.code for name, form in FORMATS.items()}


def camera(form: str) -> CameraConfiguration:
    return CameraConfiguration((2, 4), (1, 1), form)


def words(*values: int) -> np.ndarray:
    return np.array([values, values], np.int64)


def test_raw_is_aligned_to_either_end_of_16_bits() -> None:
    assert pixel_format(words(0xFFC0, 0x0040), camera("raw10")).tolist()[0] == [1023, 1]
    assert pixel_format(words(0x03FF, 0x0001), camera("raw10_lsb")).tolist()[0] == [1023, 1]
    assert pixel_format(words(0x0FFF, 0x0001), camera("raw12_lsb")).tolist()[0] == [4095, 1]
    assert pixel_format(words(0xFFF0, 0x0010), camera("raw12")).tolist()[0] == [4095, 1]
    assert pixel_format(words(0xFF, 0x01), camera("raw8")).tolist()[0] == [255, 1]


def test_components_are_where_vendors_put_them() -> None:
    """Compare with AXI4-Stream Video: G lowest, then B, then R; in 4:2:2 luma below chroma."""
    assert pixel_format(words(0x112233), camera("rgb888")).tolist()[0] == [[0x11, 0x33, 0x22]]
    assert pixel_format(words(0xF800, 0x07E0, 0x001F, 0x0821), camera("rgb565")).tolist()[0] == [
        [255, 0, 0],
        [0, 255, 0],
        [0, 0, 255],
        [8, 4, 8],
    ]
    serial = camera("rgb565_bytes")
    assert pixel_format(words(0x00F8), serial).tolist()[0] == [[255, 0, 0]]  # the high byte comes first


def test_yuyv_is_bt601_of_full_range_without_clipping() -> None:
    rng = np.random.default_rng(1)
    luma, chroma = rng.integers(0, 256, (2, 40, 60))
    got = pixel_format(luma | chroma << 8, CameraConfiguration((40, 60), (1, 1), "yuyv"))
    cb, cr = (np.repeat(chroma[:, first::2] - CHROMA_OFFSET, 2, axis=1) for first in (0, 1))
    want = np.stack((luma + 1.402 * cr, luma - 0.344136 * cb - 0.714136 * cr, luma + 1.772 * cb), axis=-1)
    assert np.abs(got / 4 - want).max() < 1 / 8 + 128 * 2 * 2.0**-13 + 1e-4  # rounding, and that of two coefficients
    assert got.min() < 0
    assert got.max() > 4 * 255


@pytest.mark.parametrize("form", FORMATS)
def test_a_grey_picture_comes_back(form: str) -> None:
    grey = np.repeat(np.arange(256, dtype=np.uint8).reshape(16, 16), 3).reshape(16, 16, 3)
    device = CameraConfiguration((16, 16), (1, 1), form)
    samples = pixel_format(photograph(grey, device), device) / (1 << device.bits - 8)
    coarsest = 255 / 31 / 2 if form.startswith("rgb565") else 0
    want = grey[..., 0] if device.format.bayer else grey
    assert np.abs(samples - want).max() <= coarsest


@pytest.mark.parametrize("phase", range(4))
def test_a_pattern_has_the_colours_of_its_name(phase: int) -> None:
    device = CameraConfiguration((2, 2), (1, 1), "raw8", PHASES[phase])
    picture = np.tile(np.array([10, 20, 30], np.uint8), (2, 2, 1))
    sent = pixel_format(photograph(picture, device), device).reshape(-1).tolist()
    assert sent == [{"r": 10, "g": 20, "b": 30}[letter] for letter in PHASES[phase]]
