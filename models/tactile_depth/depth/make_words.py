# SPDX-License-Identifier: Apache-2.0
"""Words of make that choose the hardware of a pipeline: with them `make wrap` and FuseSoC write the same tables."""

from __future__ import annotations

import math
import shlex
import warnings
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from tactile_depth.base.errors import InputError
from tactile_depth.chip.configuration import CHOICES, NUMBERS, Configuration
from tactile_depth.pictures.frames import PICTURE_SUFFIXES
from tactile_depth.pictures.pictures import Pictures
from tactile_depth.sensor.built_in import read
from tactile_depth.sensor.sensor import Sensor
from tactile_depth.sensor.view import Crop

EARLIER_REFERENCE = "<captured with an earlier reference>"


def make_words(config: Configuration, pixel_pitch_mm: float, sources: Mapping[str, str]) -> str:
    """Return all words that choose a configuration, with none left to a default, as a shell takes them.

    Parameters
    ----------
    sources : mapping
        Words that the configuration does not hold: CALIBRATION, REFERENCE, ZERO, those of a camera.
    """
    square = config.rows == config.columns
    words = {
        "PRESET": "sensor" if config.zero_offset else "published",
        **({"N": config.columns} if square else {"ROWS": config.rows, "COLS": config.columns}),
        "SOLVER": config.solver,
        "BOUNDARY": config.boundary,
        "LANES": config.lanes,
        **{number.variable: getattr(config, name) for name, number in NUMBERS.items()},
        CHOICES["depth_range_px"].variable: _depth_range(config, pixel_pitch_mm),
        "GRADIENT": config.gradient_model,
        "LIGHT_GAINS": int(config.light_gains),
        "PARITY": int(config.parity),
        "SELF_CHECK": int(config.self_check),
        **sources,
    }
    return " ".join(shlex.quote(f"{name}={word}") for name, word in words.items() if word != "")


def _depth_range(config: Configuration, pixel_pitch_mm: float) -> str:
    """Return the shortest number of mm that gives the depth range of a configuration; "" for the default."""
    if config.deepest_px == min(config.rows, config.columns) / 4:
        return ""
    mm = config.deepest_px * pixel_pitch_mm
    near = (mm, math.nextafter(mm, 0), math.nextafter(mm, math.inf))
    texts = [f"{mm:.{digits}g}" for digits in range(1, 17)] + [repr(each) for each in near]
    return next((text for text in texts if float(text) / pixel_pitch_mm == config.deepest_px), repr(mm))


class Sources:
    """Origin of sensor and pictures of a pipeline; what no word names stands in < >.

    Parameters
    ----------
    sensor : Sensor
        As the pipeline is given it.
    crop : Crop or None
    zero_offset : bool
    """

    def __init__(self, sensor: Sensor, crop: Crop | None, zero_offset: bool) -> None:
        self.sensor, self.crop, self.zero_offset = sensor, crop, zero_offset
        self.reference = ""
        self.zero = "<no picture was captured>" if zero_offset else ""

    def take_reference(self, pictures: Pictures) -> None:
        """Note the pictures of a reference."""
        path = _path(pictures)
        one = Path(path).suffix.lower() in PICTURE_SUFFIXES
        self.reference = path if one else "<the picture of its reference>"
        self.zero = EARLIER_REFERENCE if self.zero_offset else ""

    def take_zero(self, pictures: Pictures) -> None:
        """Note the pictures of a zero offset."""
        self.zero = _path(pictures) or "<the pictures of its zero offset>"

    def words(self) -> dict[str, str]:
        """Return the words that the configuration does not hold."""
        return {**self._of_sensor(), "REFERENCE": self.reference, "ZERO": self.zero}

    def _of_sensor(self) -> dict[str, str]:
        """Return the words of the sensor, if a file that they name holds the same."""
        camera = self.sensor.camera
        crop = "" if self.crop is None else _crop(self.crop)
        for size in (None, (camera.rows, camera.columns)) if camera else (None,):
            try:
                with warnings.catch_warnings():
                    warnings.simplefilter("ignore")
                    held = read(self.sensor.name, size)
            except InputError:
                continue
            if held.view is None and self.sensor.view is not None and not crop:
                crop, held = _crop(self.sensor.view), replace(held, view=self.sensor.view)
            if held == self.sensor:
                of_camera = {} if size is None else {"CAMERA_SIZE": f"{size[1]}x{size[0]}"}
                return {"CALIBRATION": self.sensor.name, "CROP": crop, **of_camera}
        return {"CALIBRATION": "<the file of its sensor>", "CROP": crop}


def _crop(crop: Crop) -> str:
    return ",".join(map(str, crop)) if isinstance(crop, tuple | list) else str(crop)


def _path(pictures: Pictures) -> str:
    """Return the path of pictures that one path names; "" for others."""
    if isinstance(pictures, list | tuple) and len(pictures) == 1:
        pictures = pictures[0]
    return str(pictures) if isinstance(pictures, str | Path) else ""
