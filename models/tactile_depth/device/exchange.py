# SPDX-License-Identifier: Apache-2.0
"""Exchange of pictures and depth frames with a device: one picture at a time, or the frames of its camera."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager

from tactile_depth.base.errors import counted
from tactile_depth.base.npy import Bytes
from tactile_depth.chip.link.depth_frames import NUMBERS
from tactile_depth.device.arrived import arrived
from tactile_depth.device.channel import Arrival, Channel
from tactile_depth.device.errors import DeviceError
from tactile_depth.device.registers import read_words

MISSED = 5  # pictures without depth in a row after which the line is given up
MOST_INSIDE = 4  # whole frames in the pipeline; counters that were cleared with frames inside give fewer than 0
CAMERA_S = 2.0  # the slowest camera gives a picture in this time
CHECK_S = 5.0  # between two checks that a device still holds what it should


class Exchange(AbstractContextManager["Exchange"]):
    """Sends pictures, and waits for the depth of each before the next one; ends with its context.

    A depth frame belongs to a picture by its number in the pipeline. So depth that comes late goes to no other picture.
    """

    def __init__(self, line: Channel) -> None:
        self._line = line
        line.ask()  # frames up to now are delivered or lost
        line.collect(True)
        self._made, self._taken = self._counts()
        self._missed = 0

    def __exit__(self, *raised: object) -> None:
        self._line.collect(False)

    def depth_of(self, pixels: Bytes) -> Arrival | None:
        """Return the depth of a picture; None, and count it as lost, if a part of either got lost on the line.

        Parameters
        ----------
        pixels : uint8 array (rows, columns, 3)
            A picture on the grid.

        Raises
        ------
        DeviceError
            The device does not answer or was reset, or `MISSED` pictures in a row gave no depth.
        """
        line = self._line
        line.check()
        lost, number = line.lost, (self._made + 1) % NUMBERS
        line.send(pixels)
        limit_s = line.limit_s
        last = time.monotonic() + limit_s
        while time.monotonic() < last:
            end = time.monotonic() + line.depth_s
            while (arrival := line.frame(end - time.monotonic(), lost)) is not None:
                if arrival.frame.record.frame == number:
                    self._made, self._missed = number, 0
                    self._taken += 1
                    return arrival
            if self._is_missing(lost):
                self._missed += 1
                if self._missed == MISSED:
                    here = f"{counted(line.bad_packets, 'broken packet')} came to this host"
                    there = f"{line.status.bad_packets} to the device"
                    problem = f"{MISSED} pictures in a row gave no depth: {here}, {there}"
                    is_noisy = line.bad_packets or line.status.bad_packets
                    camera = "call depth() without pictures if the device has a camera; else check the cable"
                    raise DeviceError(problem, remedy="check cable and baud rate" if is_noisy else camera)
                return None
        remedy = "reset the device, then call load()"
        raise DeviceError(f"the depth of a picture has not come in {limit_s:.1f} s", remedy=remedy)

    def _is_missing(self, lost: int) -> bool:
        """Ask the device what became of the picture; return True if its depth will not come, which is then counted."""
        line = self._line
        line.ask()  # a frame that got lost is then counted
        made, taken = self._counts()
        if made == self._made and taken == self._taken:  # the picture did not come whole
            line.count_lost()
            return True
        if made != self._made and line.lost != lost:
            self._made, self._taken = made, taken
            return True
        return False

    def _counts(self) -> tuple[int, int]:
        """Return the number of the last frame that was made, and of pictures that came in."""
        words = read_words(self._line, ["RECORD_FRAME", "FRAMES_IN"])
        return words["RECORD_FRAME"], words["FRAMES_IN"]


def last_begun(line: Channel) -> int:
    """Return the number of the last frame that may still have the tables or thresholds of before this call.

    Depth leaves after the last pixel of its picture. So it is a frame that came in whole: it has its record, or is on
    its way through the pipeline.
    """
    counts = read_words(line, ["FRAMES_IN", "FRAMES_OUT", "DEPTH_DROPPED"])
    number = read_words(line, ["RECORD_FRAME"])["RECORD_FRAME"]  # later: a record follows its frame
    inside = counts["FRAMES_IN"] - counts["FRAMES_OUT"] - counts["DEPTH_DROPPED"]
    return (number + min(inside % NUMBERS, MOST_INSIDE)) % NUMBERS


def camera_frames(line: Channel, last_old: Callable[[], int], check: Callable[[], object]) -> Iterator[Arrival]:
    """Give the depth frames of the device's camera as they come.

    Parameters
    ----------
    last_old : function
        Returns the number of a frame. Frames up to it are left out, and do not count as lost.
    check : function
        Raises DeviceError if the device holds something else than it should; called every `CHECK_S`.

    Raises
    ------
    DeviceError
        No frame comes, the device does not answer, or it, or its pipeline alone, was reset.
    """
    line.collect(True)
    try:
        patience_s = line.depth_s + CAMERA_S
        last = checked = time.monotonic()
        bad, before = line.bad_packets, None
        while True:
            line.check()
            if time.monotonic() - checked > CHECK_S:
                check()
                checked = time.monotonic()
            arrival = line.frame(patience_s, line.lost)
            is_late = time.monotonic() - last > patience_s
            if arrival is None:
                if is_late:
                    raise _silence(line, patience_s, bad)
                continue
            number = arrival.frame.record.frame
            goes_on = before is None or 0 < (number - before) % NUMBERS < NUMBERS // 2
            behind = (last_old() - number) % NUMBERS  # from half of NUMBERS on, the frame is ahead
            is_old = MOST_INSIDE <= behind < NUMBERS // 2  # it had left the pipeline before
            if not goes_on or (is_old and is_late):
                raise DeviceError("the device was reset", remedy="call load()")
            before = number
            if behind > NUMBERS // 2:
                yield arrival
            if not is_old:
                last, bad = time.monotonic(), line.bad_packets
    finally:
        line.collect(False)


def _silence(line: Channel, patience_s: float, bad: int) -> DeviceError:
    """Return the error of a camera whose frames do not come; `bad` broken packets had come with the last one."""
    line.ask()
    if line.bad_packets != bad:
        broken = counted(line.bad_packets - bad, "broken packet")
        problem = f"no depth frame came whole in {patience_s:.1f} s: {broken}"
        return DeviceError(problem, remedy="check cable and baud rate")
    came = arrived(line, is_awaited=True)
    reason = f", {came.problem}" if came.problem else ""
    problem = f"the device has sent no depth for {patience_s:.1f} s{reason}"
    return DeviceError(problem, remedy=came.remedy or "let its camera send pictures of its grid, or give pictures")
