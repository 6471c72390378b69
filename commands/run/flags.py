# SPDX-License-Identifier: Apache-2.0
"""Pixels with uncertain depth: without light, or with slopes steeper than those of the calibration."""

from dataclasses import dataclass

import numpy as np

from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.gradient.flat_field import dark_pixels, reference_gains, require_light
from tactile_depth.depth import reference
from tactile_depth.sensor.sensor import Sensor


@dataclass(frozen=True)
class Flags:
    """Flagged pixels of frames, bool arrays (frames, rows, cols)."""

    dark: np.ndarray  # the reference is too dark there, so the pixel takes the colour of the one before it
    outside: np.ndarray  # not dark, but steeper than any slope in the fit of the calibration

    def report(self, repeat: int) -> dict[str, list[int]]:
        """Return the number of flagged pixels of each frame, the sequence `repeat` times."""
        return {
            "dark_pixels": self.dark.sum(axis=(1, 2)).tolist() * repeat,
            "slopes_outside_calibration": self.outside.sum(axis=(1, 2)).tolist() * repeat,
        }

    def warnings(self) -> list[str]:
        """Return a line for each kind of flag that is set."""
        lines = []
        if self.dark.any():
            lines.append(
                f"{100 * self.dark.mean():.1f} % of the pixels are dark in REFERENCE, and take the colour of their "
                "neighbour: light the gel evenly, or expose longer"
            )
        if self.outside.any():
            lines.append(
                f"{100 * self.outside.mean():.1f} % of the slopes are steeper than any in the fit of the calibration: "
                "depth there is an extrapolation; press less deep, or calibrate with smaller balls"
            )
        return lines


def flags(
    frames: np.ndarray,
    calibration: Sensor,
    config: Configuration,
    reference_name: str | None,
    light: np.ndarray | None,
) -> Flags:
    """Flag pixels of frames, uint8 (frames, rows, cols, 3), with their light gains (frames, 3), if there are any.

    Raises InputError: the reference leaves nothing.
    """
    dark = np.zeros(frames.shape[:-1], bool)
    if config.flat_field:
        gains = reference_gains(calibration, config)
        require_light(gains, config, f"REFERENCE={reference_name}")
        dark = dark_pixels(frames, gains, config)
    slopes = reference.slopes_of(frames, calibration, config, light=light)
    steepest = calibration.steepest(config)
    return Flags(dark, ~dark & (np.hypot(slopes[..., 0], slopes[..., 1]) > steepest))
