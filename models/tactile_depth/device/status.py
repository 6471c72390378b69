# SPDX-License-Identifier: Apache-2.0
"""State of a device and of the link to it."""

from __future__ import annotations

from typing import NamedTuple

from tactile_depth.chip.registers.register_map import REGISTERS
from tactile_depth.device.arrived import arrived
from tactile_depth.device.channel import Channel
from tactile_depth.device.registers import read_words


class DeviceStatus(NamedTuple):
    """State of a device and of the link to it. Counters of the pipeline stay at all ones rather than wrap.

    Attributes
    ----------
    rows, columns : int
        The grid.
    data_width : int
        Bits of a depth code.
    resets : int
        Resets since power-up, modulo 2^16.
    sent : int
        Number of the last depth frame that the device began to send.
    skipped : int
        Depth frames since the reset that a newer one replaced before they were sent.
    bad_packets_of_device : int
        Broken packets that the device received since the reset.
    bad_packets : int
        Broken packets that the host received since the device was opened.
    delivered : int
        Depth frames that came whole since the device was opened.
    lost : int
        Depth frames since the device was opened that did not come whole, and pictures that gave no depth.
    frames_in, frames_out, frames_dropped : int
        Whole pictures that came in, depth frames that went out, malformed pictures.
    saturations, dark_pixels : int
        Values clipped, and dark pixels, in all frames.
    depth_dropped, records_lost : int
        Depth frames and records that their sink did not take.
    flips : int
        Times that a device with parity saw a flipped bit.
    residuals : int
        Frames whose depth did not fit their slopes.
    touching, busy : bool
        Something touches; a frame is in the pipeline.
    hunting, stalled : bool
        Pixels are dropped up to a start of frame; what takes the depth stalls.
    arrived : tuple of int
        Rows of the picture before the one that began last, malformed or not; columns of the last row.
    input : str
        What is wrong with the pictures that come, and what to set; empty if nothing is.
    """

    rows: int
    columns: int
    data_width: int
    resets: int
    sent: int
    skipped: int
    bad_packets_of_device: int
    bad_packets: int
    delivered: int
    lost: int
    frames_in: int
    frames_out: int
    frames_dropped: int
    saturations: int
    dark_pixels: int
    depth_dropped: int
    records_lost: int
    flips: int
    residuals: int
    touching: bool
    busy: bool
    hunting: bool
    stalled: bool
    arrived: tuple[int, int]
    input: str


COUNTERS = (
    *("FRAMES_IN", "FRAMES_OUT", "FRAMES_DROPPED", "SATURATIONS", "DARK_PIXELS"),
    *("DEPTH_DROPPED", "RECORDS_LOST", "FLIPS", "RESIDUALS"),
)
"""Registers of the counters of the pipeline; fields have the same names."""


def status_of(line: Channel) -> DeviceStatus:
    """Return the state of the device at the other end of a line. Raises DeviceError if it does not answer."""
    status = line.ask()
    words = read_words(line, [*COUNTERS, "STATUS"])
    levels, came = REGISTERS["STATUS"].unpack(words["STATUS"]), arrived(line)
    return DeviceStatus(
        rows=status.rows,
        columns=status.columns,
        data_width=status.data_width,
        resets=status.resets,
        sent=status.sent,
        skipped=status.skipped,
        bad_packets_of_device=status.bad_packets,
        bad_packets=line.bad_packets,
        delivered=line.delivered,
        lost=line.lost,
        **{name.lower(): words[name] for name in COUNTERS},
        touching=bool(levels["touching"]),
        busy=bool(levels["busy"]),
        hunting=came.hunting,
        stalled=came.stalled,
        arrived=(came.rows, came.columns),
        input=came.line,
    )
