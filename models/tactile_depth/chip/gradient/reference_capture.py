# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/gradient/reference_capture.sv; its arithmetic is that of `flat_field.captured_gains`."""

from __future__ import annotations

import numpy as np

from tactile_depth.chip.common import td_divide
from tactile_depth.chip.common.signature import Captured
from tactile_depth.chip.common.td_block_sum import BlockSum
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.fixed_point import joined, split
from tactile_depth.chip.gradient.flat_field import gains_of
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


def node_clocks(width: int) -> int:
    """Return the cycles of a node, with gains of `width` bits."""
    return READ_CLOCKS + 3 * gain_clocks(width)


def gain_clocks(width: int) -> int:
    """Return the cycles of a gain: with one bit to round by, and one to take it."""
    return td_divide.cycles(width + 1) + 1


class ReferenceCapture:
    """Capture of whole frames into a memory of nodes, which it writes and whose answers it gets.

    Attributes
    ----------
    place, size : int
        Pixels that came of the frame; pixels of a frame.
    busy : bool
        A capture is asked for, or goes on.
    clocks, at : int
        Cycles from the one behind the last pixel to `done`; those of them that have passed, -1 while none do.
    """

    def __init__(self, rows: int, columns: int, block_log2: int, width: int, fraction: int, largest: int) -> None:
        sides = {"Rows": rows, "Columns": columns, "BlockLog2": block_log2, "ColumnLog2": block_log2}
        self._sum = BlockSum(**sides, Channels=3, Width=PIXEL_WIDTH, Signed=0, SumWidth=width)
        self._width, self._largest, self._scale = width, largest, fraction + 1 + 2 * block_log2
        self.size, self.place = self._sum.size, 0
        self._nodes, self._node_clocks = (rows >> block_log2) * (columns >> block_log2), node_clocks(width)
        self.clocks = self._nodes * self._node_clocks + 1
        self._armed, self._log2, self._gains = False, 0, 0
        self._stop()

    def _stop(self) -> None:
        self._to_come: int | None = None  # frames behind this one, while it sums
        self.at = -1

    @property
    def busy(self) -> bool:
        return self._armed or self._to_come is not None or self.at >= 0

    def _take(self, starts: bool, position: int, bad: int, log2_frames: int) -> None:
        """Follow the frames of a capture with a pixel."""
        if starts and self._armed:
            self._armed, self._log2 = False, min(log2_frames, self._largest)
            self._to_come = (1 << self._log2) - 1
        elif position >> 2 == 3 and self._to_come is not None:
            self._armed, last = bool(bad), self._to_come == 0
            self._to_come = None if bad or last else self._to_come - 1
            self.at = 0 if last and not bad else -1

    def _signed(self) -> tuple[bool, bool, int]:
        """Return whether this is the clock of an entry of the signature, whether it is the last one, and its word."""
        node, step = divmod(self.at, self._node_clocks)
        channels = {self._node_clocks - channel * gain_clocks(self._width): 2 - channel for channel in (1, 2)}
        if node >= 0 and step in channels:
            channel = channels[step]
        elif node > 0 and step < 2:
            channel = 2 + step
        else:
            return False, False, 0
        gains = [*split(self._gains, 3, self._width), 0]
        return True, self.at == self.clocks, gains[channel]

    def clock(
        self, *, rst: int, request: int, log2_frames: int, in_pixel: int, in_position: int, in_bad: int, **pins: int
    ) -> dict[str, int | None]:
        """Advance by one clock edge; return the outputs before it, None where one does not count."""
        take, (node, step) = pins["en"] and pins["in_valid"], divmod(self.at, self._node_clocks)
        summing = self._armed or self._to_come is not None
        starts = bool(take and summing and in_position & 3 == 3)
        red, blue, green = (in_pixel >> place & 255 for place in (16, 8, 0))
        sums = self._sum.clock(
            rst=rst,
            in_valid=starts or (take and self._to_come is not None),
            in_frame_start=starts,
            in_first_frame=self._armed,
            in_last_frame=0,
            in_data=joined([red, green, blue], PIXEL_WIDTH),
            read_sums=pins["map_read_gains"],
        )
        writes, reads = node > 0 and step == 0, node >= 0 and step == 3
        write = (writes or sums["write_en"]) and not rst
        out: dict[str, int | None] = {"busy": self.busy, "done": self.at == self.clocks, "map_write": write}
        if write:
            out["map_write_node"] = node - 1 if writes else sums["write_block"]
            out["map_write_gains"] = self._gains if writes else sums["write_sums"]
        out["map_read"] = reads or sums["read_en"]
        if out["map_read"]:
            out["map_read_node"] = node if reads else sums["read_block"]
        if step == 4:
            words = np.array(split(pins["map_read_gains"], 3, self._width))
            gains = gains_of(words, 1 << self._scale + self._log2, self._width)
            self._gains = joined(gains.tolist(), self._width)
        whole = take and in_position >> 2 == 3 and self._to_come == 0 and not in_bad
        out["captured"] = Captured(bool(write), bool(whole), *self._signed()).bits
        self.at = -1 if self.at in (-1, self.clocks) else self.at + 1
        if take:
            self._take(starts, in_position, in_bad, log2_frames)
            self.place = (self.place + 1) % self.size
        if request or rst:
            self._armed = not rst
            self._stop()
        if rst:
            self.place = 0
        return out


def parts(config: Configuration) -> Parts:
    return [Words(config.gain_width)]
