# SPDX-License-Identifier: Apache-2.0
"""Model of hdl/gradient/reference_capture.sv, frame by frame; its arithmetic is `flat_field.captured_gains`."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from tactile_depth.chip.common import td_divide
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.gradient.flat_field import captured_gains
from tactile_depth.chip.limits import PIXEL_WIDTH
from tactile_depth.chip.resources import Parts, Words

LARGEST_LOG2 = 8
"""Base-2 logarithm of the most frames in a capture; large blocks reduce it (`largest_log2_frames`)."""
READ_CLOCKS = 6
"""Cycles that the divider takes to read a node: write the node before it, wait for the memory, read, register, take."""


def largest_log2_frames(config: Configuration) -> int:
    """Return the base-2 logarithm of the most frames in a capture: the sum of a block must fit the word of a gain."""
    return min(LARGEST_LOG2, config.gain.width - PIXEL_WIDTH - 2 * config.reference_block_log2)


def reference_capture_parameters(config: Configuration) -> dict[str, int]:
    """Parameters of hdl/gradient/reference_capture.sv."""
    return {
        "Rows": config.rows,
        "Columns": config.columns,
        "BlockLog2": config.reference_block_log2,
        "Width": config.gain.width,
        "GainFraction": config.gain.fraction,
        "MaxLog2": largest_log2_frames(config),
    }


def reference_capture_clocks(config: Configuration) -> int:
    """Return the cycles from the cycle that takes the last pixel of the last frame to `done`."""
    rows, columns = config.reference_nodes
    a_gain = td_divide.cycles(config.gain.width + 1) + 1  # with one bit to round by; and a cycle to take it
    return rows * columns * (READ_CLOCKS + 3 * a_gain) + 2


def reference_capture(
    frames: Sequence[np.ndarray], bad: Sequence[bool], log2_frames: Sequence[int], largest: int, config: Configuration
) -> tuple[int, np.ndarray] | None:
    """Capture a reference from frames that begin after a request.

    Parameters
    ----------
    frames : uint8 arrays (rows, columns, 3)
    bad : sequence of bool
        True for each broken frame; a broken frame restarts the capture.
    log2_frames : sequence of int
        Value of the register when each frame begins; the first frame of the capture sets the number of frames.
    largest : int
        Upper limit of `log2_frames`, at most `largest_log2_frames`.

    Returns
    -------
    Index of the last frame of the capture, and the gains; None if there are too few good frames in a row.
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


def parts(config: Configuration) -> Parts:
    return [Words(config.gain_width)]
