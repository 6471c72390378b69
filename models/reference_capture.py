# SPDX-License-Identifier: Apache-2.0
"""Model of hdl/reference_capture.sv, frame by frame; the arithmetic is `models.flat_field.captured_gains`."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from models.configuration import GAIN_FRACTION, GAIN_WIDTH, Configuration
from models.flat_field import captured_gains

PIXEL_WIDTH = 8
LARGEST_LOG2 = 8
"""Of the frames of a capture, as far as a sum of their pixels fits the word of a gain."""
READ_CLOCKS = 4
"""Of the divider, for a node: write the one before, wait for the memory, read, take."""


def largest_log2_frames(config: Configuration) -> int:
    """Of the frames that a capture takes the mean of, at most."""
    return min(LARGEST_LOG2, GAIN_WIDTH - PIXEL_WIDTH - 2 * config.reference_block_log2)


def reference_capture_parameters(config: Configuration) -> dict[str, int]:
    """Parameters of hdl/reference_capture.sv."""
    return {
        "Rows": config.rows,
        "Columns": config.columns,
        "BlockLog2": config.reference_block_log2,
        "Width": GAIN_WIDTH,
        "GainFraction": GAIN_FRACTION,
        "MaxLog2": largest_log2_frames(config),
    }


def reference_capture_clocks(config: Configuration) -> int:
    """From the clock that takes the last pixel of the last frame to `done`."""
    rows, columns = config.reference_nodes
    a_gain = 1 + (GAIN_WIDTH + 1) + 1  # compare, a bit of the quotient each, round
    return rows * columns * (READ_CLOCKS + 3 * a_gain) + 2


def reference_capture(
    frames: Sequence[np.ndarray], bad: Sequence[bool], log2_frames: Sequence[int], largest: int, config: Configuration
) -> tuple[int, np.ndarray] | None:
    """What comes of frames that begin after a request.

    Parameters
    ----------
    frames : uint8 arrays (rows, columns, 3)
    bad : bool of each
    log2_frames : int of each, as the register stands when the frame begins: the first that counts is the one taken
    largest : int
        `largest_log2_frames`, or less

    Returns
    -------
    place of the last frame that counted, and the gains; None while there are not enough good frames in a row
    """
    taken: list[np.ndarray] = []
    wanted = 0
    for index, frame in enumerate(frames):
        if not taken:
            wanted = 1 << min(log2_frames[index], largest)
        taken = [] if bad[index] else [*taken, frame]
        if len(taken) == wanted:
            return index, captured_gains(np.stack(taken), config)
    return None
