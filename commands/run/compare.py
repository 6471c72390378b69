# SPDX-License-Identifier: Apache-2.0
"""Comparison of depth codes from the RTL with those of the model, and warnings about a run that is bit-exact."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from tactile_depth.base.errors import counted
from tactile_depth.chip.configuration import COEFFICIENT, STORED, WIDTHS, WORDS, Configuration

WARNED_RMS_PERCENT = 1.0  # mean RMS error to double precision, of the peak; the default widths stay below 0.001
TOO_DARK = (
    "pixels are dark in REFERENCE, and take the colour of their neighbour: light the gel evenly, or expose longer"
)
TOO_STEEP = (
    "slopes are steeper than any in the fit of the calibration: depth there is an extrapolation; press less deep, or "
    "calibrate with smaller balls"
)
OF_COLOURS = ("flat_field", "polynomial_gradient")  # nodes before the solver, which no depth range widens

*_, DEEPEST = WORDS.values()


@dataclass(frozen=True)
class Difference:
    """Codes that differ, in the order of depth.npy: frames, rows and columns count from 0."""

    differing: np.ndarray  # bool (frames, rows, columns)
    code: int  # the first differing one; 0 when all are equal
    expected: int  # of the model

    @property
    def count(self) -> int:
        return int(np.count_nonzero(self.differing))

    def sentence(self) -> str:
        """Return the verdict: the number of differing codes and the first of them."""
        frames, total = len(self.differing), self.differing.size
        if not self.count:
            return f"RTL equals the model on every code: {total:,} codes in {counted(frames, 'frame')}"
        frame, row, column = np.argwhere(self.differing)[0]
        return (
            f"RTL differs from the model in {self.count:,} of {total:,} codes; first at frame {frame}, row {row}, "
            f"column {column}: {self.code}, expected {self.expected}. Frames, rows and columns count from 0."
        )


def compare(codes: np.ndarray, expected: np.ndarray) -> Difference:
    """Compare codes (repeats, frames, rows, columns) with those expected: of all repeats, or of each alike."""
    differing = (codes != expected).reshape(-1, *expected.shape[-2:])
    if not differing.any():
        return Difference(differing, 0, 0)
    first = int(differing.argmax())  # of the flat array
    return Difference(differing, int(codes.reshape(-1)[first]), int(expected.reshape(-1)[first % expected.size]))


def warnings(config: Configuration, rms_percent: Sequence[float | None], saturations: Mapping[str, int]) -> list[str]:
    """Return a line when the mean RMS error exceeds `WARNED_RMS_PERCENT`, with the variable that reduces it.

    The error halves with each bit of a stored word, until the coefficients limit it. Clipped values need a
    larger range.
    """
    errors = [error for error in rms_percent if error is not None]
    mean = sum(errors) / len(errors) if errors else 0.0
    if mean <= WARNED_RMS_PERCENT:
        return []
    width = config.depth.width + math.ceil(math.log2(mean / WARNED_RMS_PERCENT)) + 1
    if colours := [node for node in saturations if node in OF_COLOURS]:
        change = (
            f"values saturate in {', '.join(colours)}: colours differ too much from REFERENCE; take it with the frames"
        )
    elif saturations:
        change = f"values saturate; give a larger {DEEPEST}"
    elif config.depth.width < config.coefficient.width and width <= WIDTHS[STORED].accepted[1]:
        change = (
            f"words of {config.depth.width} bits are too short for this grid; try {WIDTHS[STORED].variable}={width}"
        )
    else:
        change = f"give a larger {WIDTHS[STORED].variable} or {WIDTHS[COEFFICIENT].variable}"
    return [f"the mean RMS error is {mean:.2f} % of peak, above {WARNED_RMS_PERCENT:g} %: {change}"]


def doubts(dark: np.ndarray, outside: np.ndarray) -> list[str]:
    """Return a line on dark pixels and one on slopes outside the calibrated range, if there are any."""
    masks = ((dark, TOO_DARK), (outside, TOO_STEEP))
    return [f"{100 * mask.mean():.1f} % of the {what}" for mask, what in masks if mask.any()]
