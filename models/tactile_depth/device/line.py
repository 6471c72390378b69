# SPDX-License-Identifier: Apache-2.0
"""The host's side of the link over a transport: requests, pictures, and the depth frames that come meanwhile."""

from __future__ import annotations

import random
import threading
import time
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from typing import TypeVar

import numpy as np

from tactile_depth.base.errors import InputError, counted
from tactile_depth.base.npy import Bytes
from tactile_depth.chip.link.depth_formats import DepthFormat, exact_shift
from tactile_depth.chip.link.depth_frames import DepthFrames
from tactile_depth.chip.link.framing import to_line
from tactile_depth.chip.link.packets import (
    LARGEST_SHIFT,
    MOST_ACCESSES,
    MOST_PIXELS,
    PIXEL_BYTES,
    Ask,
    Packet,
    Picture,
    Read,
    ReadReply,
    Select,
    Status,
    Write,
    WriteReply,
)
from tactile_depth.chip.link.rates import rate
from tactile_depth.device.channel import Arrival
from tactile_depth.device.errors import DeviceError
from tactile_depth.device.transport import Transport

KEPT = 8  # frames that wait for the program; the oldest is dropped and counted
READ_S = 0.1
QUIET_S = 0.2
REQUESTS = 256  # numbers of requests
Found = TypeVar("Found")
Reply = TypeVar("Reply", ReadReply, WriteReply)


class Line:
    """Channel to a device at the end of a transport. A thread of its own takes what the device sends.

    The device is told a format and a shift that it does not have together after a reset. For depth in words, the format
    after a reset, that is another shift, although words have none. So a status with others shows a reset or a power-up.

    Parameters
    ----------
    transport : Transport
        It is closed with the line, and if the device does not answer.
    depth_format : DepthFormat
        Format in which depth comes; a frame that the device began in another one before is dropped. In 16 bits the
        shift is the least that keeps the range of a depth code.

    Attributes
    ----------
    broken : bool
        The transport is gone: the line must be opened anew.
    quiet_s : float
        A camera that gives no picture in this time is not waited for: one is sent.

    Raises
    ------
    InputError
        The device speaks another version of the link.
    DeviceError
        It does not answer.
    """

    quiet_s = QUIET_S

    def __init__(self, transport: Transport, depth_format: DepthFormat = DepthFormat.WORDS) -> None:
        self.broken = False
        self._format = depth_format
        self._transport, self._pace = transport, transport.pace
        self._frames = DepthFrames()
        self._changed = threading.Condition()
        self._arrivals: deque[Arrival] = deque()
        self._reply: ReadReply | WriteReply | None = None
        self._statuses = 0
        self._bytes = 0
        self._dropped = 0  # frames that the program did not take, and pictures without depth
        self._trouble: Exception | None = None  # to be raised once
        self._resets: int | None = None  # those that are known; None: they are not watched
        self._mark: tuple[DepthFormat, int] | None = None  # format and shift that were selected
        self._request = random.randrange(REQUESTS)
        self._picture = random.randrange(1 << 32)
        self._collects = self._ends = False
        self._idle_at = 0.0  # when the line has carried all that was sent
        self._thread = threading.Thread(target=self._listen, daemon=True)
        self._thread.start()
        try:
            self.ask()
            self._select()
        except BaseException:
            self.close()
            raise

    # What comes in, in the thread.

    def _listen(self) -> None:
        while not self._ends:
            try:
                data = self._transport.read(READ_S)
            except Exception as error:
                with self._changed:
                    self._trouble, self.broken = error, True
                    self._changed.notify_all()
                return
            if data:
                with self._changed:
                    self._bytes += len(data)
                    try:
                        for packet in self._frames.reader.feed(data):
                            self._take(packet)
                    except InputError as error:  # another version of the link
                        self._trouble = error
                    self._changed.notify_all()

    def _take(self, packet: Packet) -> None:
        frame = self._frames.take(packet)
        if isinstance(packet, ReadReply | WriteReply):
            self._reply = packet
        elif isinstance(packet, Status):
            self._statuses += 1
        if frame is not None and self._collects and frame.depth_format == self._format:
            if len(self._arrivals) == KEPT:
                self._arrivals.popleft()
                self._dropped += 1
            self._arrivals.append(Arrival(frame, time.time(), self.lost))
        has_mark = not isinstance(packet, Status) or (packet.depth_format, packet.shift) == self._mark
        if self._resets is None:
            if isinstance(packet, Status) and has_mark:
                self._resets = self._frames.resets
        elif not has_mark or self._frames.resets != self._resets:
            self._resets = self._mark = None
            remedy = "its settings are those of power-up: call load() again"
            self._trouble = DeviceError(
                f"{self._transport.name}: the device was reset or lost its power", remedy=remedy
            )

    # Waiting.

    def _wait(self, found: Callable[[], Found | None], timeout_s: float) -> Found | None:
        """Return what is found, None at the time-out; raise what happens meanwhile."""
        end = time.monotonic() + timeout_s
        with self._changed:
            while True:
                self._raise_trouble()
                result = found()
                left = end - time.monotonic()
                if result is not None or left <= 0:
                    return result
                self._changed.wait(left)

    def _raise_trouble(self) -> None:
        trouble, self._trouble = self._trouble, None
        if trouble is not None:
            raise trouble
        if self.broken:
            raise DeviceError(f"{self._transport.name} is gone", remedy="call again, which opens it anew")

    def _repeat(self, line: bytes, found: Callable[[], Found | None], what: str) -> Found:
        """Send a packet until its answer is found."""
        end = time.monotonic() + self._backlog_s + self._pace.limit_s
        bytes_before, bad_before = self._bytes, self.bad_packets
        while True:
            self._write_line(line)
            result = self._wait(found, self._backlog_s + self._pace.repeat_s)
            if result is not None:
                return result
            if time.monotonic() > end:
                raise self._silent(what, self._bytes - bytes_before, self.bad_packets - bad_before)

    def _silent(self, what: str, count: int, bad: int) -> DeviceError:
        """Return the error of an answer that did not come, although `count` bytes came with `bad` broken packets."""
        came = "nothing came"
        if count:
            what_came = f"with {counted(bad, 'broken packet')}" if bad else "but no answer"
            came = f"{counted(count, 'byte')} came, {what_came}"
        problem = f"{self._transport.name}: no answer to {what} in {self._pace.limit_s:.1f} s: {came}"
        return DeviceError(problem, remedy=self._transport.silence)

    # Requests.

    def check(self) -> None:
        """Raise what has happened since the last call, once; select the format of depth again after a reset."""
        with self._changed:
            self._raise_trouble()
        if self._resets is None:
            self._select()

    def ask(self) -> Status:
        """Return the status of the device.

        Raises
        ------
        InputError
            The device speaks another version of the link.
        DeviceError
            It does not answer.
        """
        before = self._statuses

        def status() -> Status | None:
            return self._frames.status if self._statuses > before else None

        return self._repeat(to_line(Ask().pack()), status, "a request of its status")

    def _select(self) -> None:
        """Select the format of depth, and watch for resets from then on."""
        shift = exact_shift(self.ask().shape[2])  # also that after a reset
        if self._format == DepthFormat.WORDS:
            shift = LARGEST_SHIFT if shift != LARGEST_SHIFT else 0
        mark = self._format, shift
        with self._changed:
            self._resets, self._mark = None, mark
        self._repeat(
            to_line(Select(*mark).pack()), lambda: None if self._resets is None else True, "the choice of depth"
        )

    def read(self, addresses: Sequence[int]) -> list[int]:
        """Return the words of registers at byte addresses; fewer if one was refused.

        Raises
        ------
        DeviceError
            The device does not answer.
        """
        words: list[int] = []
        for first in range(0, len(addresses), MOST_ACCESSES):
            part = tuple(addresses[first : first + MOST_ACCESSES])
            reply = self._access(Read(self._next_request(), part), ReadReply)
            words += reply.values
            if len(reply.values) < len(part):
                break
        return words

    def write(self, pairs: Sequence[tuple[int, int]]) -> int:
        """Write pairs of byte address and word, and return the number of those done: fewer if one was refused.

        Raises
        ------
        DeviceError
            The device does not answer.
        """
        done = 0
        for first in range(0, len(pairs), MOST_ACCESSES):
            part = tuple(pairs[first : first + MOST_ACCESSES])
            reply = self._access(Write(self._next_request(), part), WriteReply)
            done += reply.done
            if reply.done < len(part):
                break
        return done

    def _next_request(self) -> int:
        self._request = (self._request + 1) % REQUESTS
        return self._request

    def _access(self, packet: Read | Write, kind: type[Reply]) -> Reply:
        self._reply = None

        def answer() -> Reply | None:
            reply = self._reply
            return reply if isinstance(reply, kind) and reply.request == packet.request else None

        return self._repeat(to_line(packet.pack()), answer, "an access to its registers")

    def _write_line(self, line: bytes) -> None:
        if self._ends:
            raise DeviceError(f"{self._transport.name} is closed", remedy="open the device with Device(..)")
        self._idle_at = max(time.monotonic(), self._idle_at) + len(line) * self._pace.byte_s
        try:
            self._transport.write(line)
        except DeviceError:
            self.broken = True
            raise

    # Pictures and frames.

    def send(self, pixels: Bytes) -> None:
        """Send a picture of the grid, uint8 (rows, columns, 3). Raises DeviceError if the line is gone."""
        self._picture = (self._picture + 1) % (1 << 32)
        for packet in _packets(self._picture, pixels):
            self._write_line(to_line(packet.pack()))

    def frame(self, timeout_s: float, lost: int) -> Arrival | None:
        """Return the next depth frame; None at the time-out, or as soon as another number than `lost` are lost.

        Raises
        ------
        DeviceError
            The line is gone, or the device was reset.
        """
        changed = self._wait(lambda: True if self._arrivals or self.lost != lost else None, timeout_s)
        with self._changed:
            return self._arrivals.popleft() if changed and self._arrivals else None

    def collect(self, on: bool) -> None:
        """Begin or end to keep frames; those that wait are dropped."""
        with self._changed:
            self._collects = on
            self._arrivals.clear()

    def count_lost(self) -> None:
        """Count a picture that gave no depth as lost."""
        with self._changed:
            self._dropped += 1

    @property
    def _backlog_s(self) -> float:
        """Time in which the line carries what is sent and is still on its way."""
        return max(0.0, self._idle_at - time.monotonic())

    @property
    def depth_s(self) -> float:
        """Time in which the depth of a picture that was sent comes, as a rule."""
        rows, columns, width, _ = self.status.shape
        depth = rate(rows, columns, self._format, width).line_bytes
        return self._backlog_s + 1.5 * depth * self._pace.byte_s + self._pace.look_s

    @property
    def limit_s(self) -> float:
        """Time after which the depth of a picture that was sent, or an effect of it, does not come any more."""
        return self.depth_s + 3 * self._pace.limit_s

    @property
    def status(self) -> Status:
        """Last status."""
        assert self._frames.status is not None
        return self._frames.status

    @property
    def bad_packets(self) -> int:
        """Broken packets that came."""
        return self._frames.reader.bad_packets

    @property
    def delivered(self) -> int:
        """Depth frames that came whole."""
        return self._frames.delivered

    @property
    def lost(self) -> int:
        """Depth frames that did not come whole or were not taken in time, and pictures without depth."""
        return self._frames.lost + self._dropped

    def close(self) -> None:
        """Close the transport; closing twice does nothing."""
        self._ends = True
        if self._thread is not threading.current_thread():
            self._thread.join(10 * READ_S)
        self._transport.close()


def _packets(number: int, pixels: Bytes) -> Iterator[Picture]:
    """Give the packets of a picture."""
    rows, columns, _ = pixels.shape
    data = np.ascontiguousarray(pixels).tobytes()
    for first in range(0, rows * columns, MOST_PIXELS):
        row, column = divmod(first, columns)
        yield Picture(number, row, column, data[PIXEL_BYTES * first :][: PIXEL_BYTES * MOST_PIXELS])
