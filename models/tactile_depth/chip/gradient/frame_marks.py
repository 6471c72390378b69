# SPDX-License-Identifier: Apache-2.0
"""Model of hdl/gradient/frame_marks.sv: how far the slopes of a frame hold, and the setting above which they are steep.

A clip, a dark pixel or a steep pixel counts for the frame that is at its stage.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from tactile_depth.chip.calibration import Calibration
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.contact.frame_flags import HALF_BITS, NO_FLAGS
from tactile_depth.chip.fixed_point import joined, split
from tactile_depth.chip.limits import LIGHT_GAIN
from tactile_depth.chip.resources import Parts

LATENCY = 1
LIMIT_BITS = 8
NO_LIMIT = (1 << LIMIT_BITS) - 1
"""Value of the register above which there is no slope."""
MOST = (1 << HALF_BITS) - 1
STAGES = ("relative", "colour", "slope")


def steepness(slopes: np.ndarray, width: int) -> np.ndarray:
    """Return the upper bits of slope codes, int64, without their sign; a negative one counts as one code less."""
    drop = width - 1 - LIMIT_BITS
    magnitude = np.where(slopes < 0, ~slopes, slopes)
    return magnitude >> drop if drop >= 0 else magnitude << -drop


def slope_limit(calibration: Calibration, config: Configuration) -> int:
    """Return the word of SLOPE_LIMIT for a calibration: no slope that it was fitted to is above."""
    most = min(calibration.steepest(config) / config.gradient_lsb, (1 << config.gradient.width - 1) - 1)
    return int(steepness(np.array(int(most)), config.gradient.width))


def steep(slopes: np.ndarray, limit: int, config: Configuration) -> np.ndarray:
    """Return the pixels that are steeper than the setting along an axis: codes (.., 2) to bool (..)."""
    return np.any(steepness(slopes, config.gradient.width) > limit, axis=-1)


class FrameMarks:
    """Counts of the frame at each stage, and of the frame that was there last; None before one was."""

    def __init__(self, width: int, most: int = MOST) -> None:
        self.width, self.most = width, most
        self._last_clipped: list[bool | None] = [None] * len(STAGES)
        self._last: tuple[int, bool, Sequence[int]] | None = None  # dark pixels, light_moves, light gains
        self._steep = self._valid = 0
        self._clear()

    def _clear(self) -> None:
        self._clipped = [False] * len(STAGES)
        self.dark = self.steep = 0
        self._steep = self._valid = 0

    def _flags(self, resumed: int, steep_count: int) -> int | None:
        """Return the flags of the frame that has left all stages; None if there was none."""
        if self._last is None or None in self._last_clipped:
            return None
        dark, moves, (red, green, blue) = self._last
        counts = NO_FLAGS._replace(light_gains=(red, green, blue), dark=dark, steep=steep_count)
        clipped = any(self._last_clipped)
        flags = counts._replace(colours_clipped=clipped, light_moves=bool(moves), resumed=bool(resumed))
        return joined(flags.words, 32)

    def clock(
        self, *, rst: int, en: int, slope_limit: int, dark: int, light_gains: int, light_moves: int, **pins: int
    ) -> dict[str, int | None]:
        """Advance by one clock edge; return the outputs before it, None where one does not count."""
        steep_count = min(self.steep + self._steep, self.most)
        dark_count = min(self.dark + dark, self.most)
        out: dict[str, int | None] = {"out_valid": self._valid}
        out["out_flags"] = self._flags(pins["resumed"], steep_count) if self._valid else None
        self.dark, self.steep = dark_count, steep_count
        slopes = np.array([pins["slope_gx"], pins["slope_gy"]])
        slopes -= (slopes >> self.width - 1) << self.width
        above = bool((steepness(slopes, self.width) > slope_limit).any())
        for stage, name in enumerate(STAGES):
            self._clipped[stage] |= bool(pins[f"{name}_clipped"])
            if en and pins[f"{name}_ends"]:
                self._last_clipped[stage], self._clipped[stage] = self._clipped[stage], False
        if en and pins["relative_ends"]:
            gains = split(light_gains, 3, LIGHT_GAIN.width)
            self._last, self.dark = (dark_count, bool(light_moves), gains), 0
        if en and self._valid:
            self.steep = 0
        self._steep = int(en and pins["slope_valid"] and above)
        if en:
            self._valid = pins["slope_ends"]
        if rst:
            self._clear()
        return out


def parts(_config: Configuration) -> Parts:
    return []
