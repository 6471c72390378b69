# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/camera/pixel_format.sv, and its inverse, which makes a camera of pictures."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from tactile_depth.chip.camera_configuration import CHROMA_FRACTION, CameraConfiguration
from tactile_depth.chip.common.td_round_saturate import round_half_even

WORD = 16  # bits that RAW10 and RAW12 are aligned in
GREY = 8  # bits of a colour of a picture
CHROMA_OFFSET = 128
# ITU-R BT.601, components of full range, as in JPEG (JFIF 1.02).
LUMA = (0.299, 0.587, 0.114)
RED_CR, BLUE_CB = 2 * (1 - LUMA[0]), 2 * (1 - LUMA[2])
COEFFICIENTS = {
    "RedCr": RED_CR,
    "GreenCb": -BLUE_CB * LUMA[2] / LUMA[1],
    "GreenCr": -RED_CR * LUMA[0] / LUMA[1],
    "BlueCb": BLUE_CB,
}


def chroma_codes() -> dict[str, int]:
    """Return the coefficients of BT.601 in units of 2**-CHROMA_FRACTION, by their names in td_camera_map_pkg."""
    return {name: round(value * (1 << CHROMA_FRACTION)) for name, value in COEFFICIENTS.items()}


def pixel_format_parameters(camera: CameraConfiguration) -> dict[str, int]:
    """Parameters of hdl/camera/pixel_format.sv."""
    return {"Format": camera.format.code, "Phase": camera.phase_code}


def raw_shift(camera: CameraConfiguration) -> int:
    """Return the lowest bit of a RAW sample in its word."""
    return WORD - camera.bits if camera.pixel_format in ("raw10", "raw12") else 0


def pixel_format(words: np.ndarray, camera: CameraConfiguration) -> np.ndarray:
    """Return the samples of a picture in the camera's format.

    Parameters
    ----------
    words : int array (rows, columns)
        One word for each pixel. Of byte-serial formats the first byte is below.

    Returns
    -------
    int64 array (rows, columns, 3), or of a Bayer pattern (rows, columns)
    """
    words = words.astype(np.int64)
    match camera.pixel_format:
        case "rgb888":
            return np.stack((words >> 16 & 255, words & 255, words >> 8 & 255), axis=-1)
        case "rgb565" | "rgb565_bytes":
            if camera.pixel_format == "rgb565_bytes":
                words = (words & 255) << 8 | words >> 8 & 255
            red, green, blue = words >> 11 & 31, words >> 5 & 63, words & 31
            return np.stack((red << 3 | red >> 2, green << 2 | green >> 4, blue << 3 | blue >> 2), axis=-1)
        case "yuyv" | "yuyv_bytes":
            luma, chroma = words & 255, (words >> 8 & 255) - CHROMA_OFFSET
            cb, cr = (np.repeat(chroma[:, first::2], 2, axis=1) for first in (0, 1))
            codes = chroma_codes()
            grey = luma << CHROMA_FRACTION
            green = grey + codes["GreenCb"] * cb + codes["GreenCr"] * cr
            colours = np.stack((grey + codes["RedCr"] * cr, green, grey + codes["BlueCb"] * cb), axis=-1)
            return round_half_even(colours, CHROMA_FRACTION + GREY - camera.bits)
    return words >> raw_shift(camera) & (1 << camera.bits) - 1


def colours(camera: CameraConfiguration) -> np.ndarray:
    """Return the colour of each pixel of a Bayer picture: 0 red, 1 green, 2 blue, int array (rows, columns)."""
    blue_row, blue_column = camera.phase_code >> 1, camera.phase_code & 1
    row, column = np.indices(camera.picture)
    return (row + blue_row) % 2 + (column + blue_column) % 2


def stream(words: np.ndarray, camera: CameraConfiguration) -> np.ndarray:
    """Return the words of pictures as they arrive, (..., rows, words of a row): of a pixel of bytes the first below."""
    count = camera.words_per_pixel
    if count == 1:
        return words
    return np.stack([words >> 8 * place & 255 for place in range(count)], -1).reshape(*words.shape[:-1], -1)


def photograph(picture: np.ndarray, camera: CameraConfiguration) -> np.ndarray:
    """Return the words that a camera of this format sends for a picture.

    Lower bits than those of the picture are zero. RGB565 is rounded to nearest; chroma is the mean of two pixels.

    Parameters
    ----------
    picture : uint8 array (rows, columns, 3), RGB

    Returns
    -------
    uint32 array (rows, columns)
    """
    red, green, blue = np.moveaxis(picture.astype(np.int64), -1, 0)
    match camera.pixel_format:
        case "rgb888":
            words = red << 16 | blue << 8 | green
        case "rgb565" | "rgb565_bytes":
            five, six = 31 / 255, 63 / 255
            red, green, blue = (np.rint(value).astype(np.int64) for value in (red * five, green * six, blue * five))
            words = red << 11 | green << 5 | blue
            if camera.pixel_format == "rgb565_bytes":
                words = (words & 255) << 8 | words >> 8
        case "yuyv" | "yuyv_bytes":
            luma = LUMA[0] * red + LUMA[1] * green + LUMA[2] * blue
            cb, cr = (blue - luma) / BLUE_CB, (red - luma) / RED_CR
            chroma = np.stack([(value[:, ::2] + value[:, 1::2]) / 2 for value in (cb, cr)], axis=-1)
            chroma = np.clip(np.rint(chroma + CHROMA_OFFSET), 0, 255).astype(np.int64).reshape(luma.shape)
            words = np.rint(luma).astype(np.int64) | chroma << 8
        case _:
            grey = np.take_along_axis(picture, colours(camera)[..., None], axis=-1)[..., 0].astype(np.int64)
            words = grey << camera.bits - GREY << raw_shift(camera)
    return words.astype(np.uint32)


def latency(camera: CameraConfiguration) -> int:
    """Return the latency; YUYV: of the second pixel of a pair, one more than of its first."""
    return 4 if camera.format.is_yuyv else 1


@dataclass
class PixelFormat:
    """State of the core.

    Attributes
    ----------
    camera : CameraConfiguration
    first : dict or None
        Pins of the first pixel of a pair whose second has not come; YUYV alone.
    due : dict
        Outputs by the number of clocks with en until they leave.
    """

    camera: CameraConfiguration
    first: dict[str, int] | None = None
    due: dict[int, dict[str, int]] = field(default_factory=dict)

    def _leave(self, clocks: int, pixel: dict[str, int], samples: Any) -> None:
        width = self.camera.sample_width
        words = (int(sample) % (1 << width) << width * place for place, sample in enumerate(np.atleast_1d(samples)))
        marks = {f"out_{mark}": pixel[f"in_{mark}"] for mark in ("row_start", "frame_start")}
        self.due[clocks] = self.due.get(clocks, {}) | {"out_valid": 1, "out_samples": sum(words), **marks}
        if self.camera.format.bayer:
            site = pixel["in_odd_row"] << 1 | pixel["in_odd_column"]
            self.due[clocks]["out_colour"] = site ^ self.camera.phase_code

    def _take(self, pixel: dict[str, int]) -> None:
        if not self.camera.format.is_yuyv:
            if pixel["in_inside"]:
                self._leave(1, pixel, pixel_format(np.array([[pixel["in_data"]]]), self.camera)[0, 0])
        elif not pixel["in_odd_column"]:
            self.first = pixel
        elif self.first is not None:
            pair = self.first, pixel
            samples = pixel_format(np.array([[each["in_data"] for each in pair]]), self.camera)[0]
            for clocks, each, colours in zip((3, 4), pair, samples, strict=True):
                if each["in_inside"]:
                    self._leave(clocks, each, colours)
            self.first = None

    def clock(self, **pins: int) -> dict[str, int]:
        """Advance by one clock edge; return the outputs before it."""
        out = {"out_valid": 0, "out_abort": 0} | self.due.get(0, {})
        if pins["en"]:
            if pins["in_valid"]:
                self._take(pins)
            if pins["in_abort"]:
                clocks = latency(self.camera)
                self.due[clocks] = self.due.get(clocks, {}) | {"out_abort": 1}
            self.due = {clocks - 1: leaves for clocks, leaves in self.due.items() if clocks}
        if pins["rst"]:
            self.due, self.first = {}, None
        return out
