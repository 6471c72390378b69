# SPDX-License-Identifier: Apache-2.0
"""Depth frames over the link: each is delivered whole and right, or counted as lost."""

from __future__ import annotations

import tracemalloc
import zlib
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt
import pytest

from tactile_depth.chip.contact.contact_events import Record
from tactile_depth.chip.link import packets as link
from tactile_depth.chip.link.depth_formats import DepthFormat, exact_shift, from_bytes, to_bytes
from tactile_depth.chip.link.depth_frames import DepthFrame, DepthFrames
from tactile_depth.chip.link.device import Build, LinkDevice
from tactile_depth.chip.link.framing import to_line

FORMATS = tuple(DepthFormat)[1:]
BUILD = Build(32, 48, 24, bottom_first=True)
PACKETS = 10_000


def device_of(build: Build) -> LinkDevice:
    return LinkDevice(build, lambda _: None, lambda _, __: False)


def extreme_codes(build: Build, generator: np.random.Generator) -> npt.NDArray[np.int32]:
    """Return random codes, or the same one everywhere, whose bytes are all 0, all 0xFF, or that is an extreme."""
    limit, shape = 1 << build.data_width - 1, (build.rows, build.columns)
    same = (0, -1, limit - 1, -limit)
    choice = generator.integers(0, 8)
    if choice < len(same):
        return np.full(shape, same[choice], np.int32)
    return generator.integers(-limit, limit, shape, np.int32)


def expected(codes: npt.NDArray[np.int32], build: Build, depth_format: DepthFormat) -> npt.NDArray[np.int32]:
    """Return what a host receives of codes in the order in which rows leave."""
    if depth_format != DepthFormat.WORDS:
        shift, rows = exact_shift(build.data_width), build.rows // (depth_format - 1)
        codes = from_bytes(to_bytes(codes, depth_format, build.data_width, shift), 2).reshape(rows, -1) << shift
    return codes[::-1] if build.bottom_first else codes


def lines(device: LinkDevice) -> Iterator[bytes]:
    """Yield all packets that the device has to send."""
    return iter(device.next_packet, b"")


def drain(device: LinkDevice) -> bytes:
    return b"".join(lines(device))


@pytest.mark.parametrize("depth_format", FORMATS, ids=lambda depth_format: depth_format.name)
@pytest.mark.parametrize(
    "build",
    [BUILD, Build(128, 128, 24, False), Build(9, 16, 12, True), Build(8, 1024, 32, False), Build(16, 16, 16, True)],
)
def test_frames_arrive_as_they_left(build: Build, depth_format: DepthFormat) -> None:
    device, host, generator = device_of(build), DepthFrames(), np.random.default_rng(1)
    device.receive(to_line(link.Select(depth_format, exact_shift(build.data_width)).pack()))
    for number in range(1, 9):
        codes, record = extreme_codes(build, generator), Record(1, 100 + number, 7, -3)
        device.offer(codes, record)
        (frame,) = host.feed(drain(device))
        np.testing.assert_array_equal(frame.codes, expected(codes, build, depth_format))
        assert (frame.number, frame.record, frame.depth_format) == (number, record, depth_format)
        assert frame.codes.dtype == np.int32
    assert (host.delivered, host.lost, host.reader.bad_packets) == (8, 0, 0)


@dataclass
class Line:
    """A line that damages packets at random, and the frames that were sent over it.

    Attributes
    ----------
    generator : Generator
    sent : dict
        Number of a frame to the codes that a host must receive.
    received : list of int
        Numbers of delivered frames.
    """

    generator: np.random.Generator
    host: DepthFrames = field(default_factory=DepthFrames)
    sent: dict[int, npt.NDArray[np.int32]] = field(default_factory=dict)
    received: list[int] = field(default_factory=list)

    def damage(self, line: bytes) -> bytes:
        """Return a packet without one byte, with one twice or changed, cut, twice, or not at all."""
        at, byte = int(self.generator.integers(len(line))), int(self.generator.integers(256))
        head, tail = line[:at], line[at + 1 :]
        choices: tuple[Callable[[], bytes], ...] = (
            lambda: head + tail,
            lambda: head + line[at : at + 1] * 2 + tail,
            lambda: head + bytes((byte,)) + tail,
            lambda: head + bytes((line[at] ^ 1 << byte % 8,)) + tail,
            lambda: head + b"\0" + tail,
            lambda: head,
            lambda: tail,
            lambda: line * 2,
            lambda: b"",
        )
        return choices[self.generator.integers(len(choices))]()

    def carry(self, line: bytes) -> None:
        """Give bytes to the host, in two parts, and check each frame that it delivers."""
        cut = int(self.generator.integers(len(line) + 1))
        for part in (line[:cut], line[cut:]):
            for frame in self.host.feed(part):
                np.testing.assert_array_equal(frame.codes, self.sent[frame.number])
                assert frame.record.frame == frame.number
                self.received.append(frame.number)


@pytest.mark.parametrize("depth_format", FORMATS, ids=lambda depth_format: depth_format.name)
def test_no_wrong_frame_is_delivered_and_each_loss_is_counted(depth_format: DepthFormat) -> None:
    """Send 10,000 packets: 1 in 25 is damaged, and 1 in 200 is cut by a reset of the device."""
    generator = np.random.default_rng(depth_format)
    line, device = Line(generator), device_of(BUILD)
    line.carry(device.next_packet())
    resets = 0
    select = to_line(link.Select(depth_format, exact_shift(24)).pack())
    device.receive(select)
    for _ in range(PACKETS):
        if device._frame is None and device._waiting is None:
            codes, number = extreme_codes(BUILD, generator), device.sent + 1
            line.sent[number] = expected(codes, BUILD, depth_format)
            device.offer(codes, Record(0, number, 0))
        packet = device.next_packet()
        if generator.random() < 1 / 200:
            packet = packet[: generator.integers(len(packet))]
            device.reset()
            device.receive(select)
            resets += 1
        elif generator.random() < 1 / 25:
            packet = line.damage(packet)
        line.carry(packet)
    line.carry(drain(device) + to_line(device.status().pack()))
    host = line.host
    assert device.sent > PACKETS // 10
    assert host.delivered + host.lost == device.sent
    assert host.delivered == len(line.received) > device.sent // 2
    assert line.received == sorted(set(line.received))
    assert host.resets == resets > 30
    assert host.reader.bad_packets > PACKETS // 50


@pytest.fixture
def frame_packets() -> list[bytes]:
    """Lines of a status, the record, 6 packets of depth and the trailer of frame 1, and of a status."""
    device = device_of(BUILD)
    device.offer(extreme_codes(BUILD, np.random.default_rng(7)), Record(0, 1, 0))
    return [*lines(device), to_line(device.status().pack())]


def test_each_packet_of_a_frame_is_needed_but_not_its_record(frame_packets: list[bytes]) -> None:
    needed = []
    for index in range(1, len(frame_packets) - 1):
        host = DepthFrames()
        found = host.feed(b"".join(frame_packets[:index] + frame_packets[index + 1 :]))
        assert (len(found), host.lost) in ((0, 1), (1, 0))
        needed.append(host.lost)
    assert needed == [0, 1, 1, 1, 1, 1, 1, 1]


def test_packets_that_come_twice_change_nothing(frame_packets: list[bytes]) -> None:
    host = DepthFrames()
    assert len(host.feed(b"".join(packet * 2 for packet in frame_packets))) == 1
    assert (host.delivered, host.lost) == (1, 0)


def test_a_status_that_waited_for_the_trailer_is_no_reset(frame_packets: list[bytes]) -> None:
    """The device takes the fields of a status when it is due, and finishes the packet that has begun."""
    device = device_of(BUILD)
    device.offer(extreme_codes(BUILD, np.random.default_rng(7)), Record(0, 1, 0))
    *_, trailer = lines(device)
    old = device.status()._replace(sending=True)
    host = DepthFrames()
    host.feed(b"".join([*frame_packets[:-2], trailer, to_line(old.pack()), frame_packets[-1]]))
    assert (host.delivered, host.lost, host.resets) == (1, 0, 0)


def test_packets_in_a_wrong_order_give_no_frame(frame_packets: list[bytes]) -> None:
    frame_packets[3], frame_packets[4] = frame_packets[4], frame_packets[3]
    host = DepthFrames()
    assert host.feed(b"".join(frame_packets)) == []
    assert host.lost == 1


def test_nothing_is_delivered_before_a_status(frame_packets: list[bytes]) -> None:
    host = DepthFrames()
    assert host.feed(b"".join(frame_packets[1:])) == []
    assert (host.delivered, host.lost) == (0, 0)


def trailer_of(frame_packets: list[bytes]) -> link.Trailer:
    (trailer,) = link.PacketReader().feed(frame_packets[-2])
    assert isinstance(trailer, link.Trailer)
    return trailer


@pytest.mark.parametrize(
    "changed",
    [
        {"crc": 0},
        {"rows": 48, "columns": 32},
        {"bottom_first": False},
        {"depth_format": DepthFormat.SHORT},
        {"number": 2},
    ],
    ids=lambda changed: next(iter(changed)),
)
def test_a_trailer_that_does_not_match_delivers_nothing(frame_packets: list[bytes], changed: dict) -> None:
    trailer = trailer_of(frame_packets)._replace(**changed)
    host = DepthFrames()
    assert host.feed(b"".join(frame_packets[:-2]) + to_line(trailer.pack())) == []
    assert (host.delivered, host.lost) == (0, trailer.number)


def test_a_trailer_alone_delivers_nothing(frame_packets: list[bytes]) -> None:
    empty = trailer_of(frame_packets)._replace(depth_format=DepthFormat.NONE, crc=0)
    host = DepthFrames()
    assert host.feed(frame_packets[0] + to_line(empty.pack())) == []
    assert host.lost == 1


def test_rows_of_before_and_after_a_power_up_do_not_mix() -> None:
    """Cut frame 1 by a power-up, of which no status arrives, and send another frame 1 whose first packet is lost."""
    host = DepthFrames()
    first, second = device_of(BUILD), device_of(BUILD)
    for device, seed in ((first, 1), (second, 2)):
        codes = np.random.default_rng(seed).integers(-1000, 1000, (BUILD.rows, BUILD.columns), np.int32)
        device.offer(codes, Record(0, 1, 0))
    before, after = [*lines(first)], [*lines(second)]
    for kept in range(3, 8):
        host = DepthFrames()
        assert host.feed(b"".join(before[:kept] + after[3:])) == []
        assert (host.delivered, host.lost) == (0, 1)


def test_frames_arrive_after_a_power_up() -> None:
    host, generator = DepthFrames(), np.random.default_rng(3)
    received: list[DepthFrame] = []
    for _ in range(3):
        device = device_of(BUILD)
        for number in range(1, 4):
            device.offer(extreme_codes(BUILD, generator), Record(0, number, 0))
            received += host.feed(drain(device))
    assert [frame.number for frame in received] == [1, 2, 3] * 3
    assert (host.lost, host.resets) == (0, 2)


def test_numbers_wrap() -> None:
    host, device = DepthFrames(), device_of(Build(8, 16, 24, False))
    device.sent, device.resets = (1 << 32) - 3, (1 << 16) - 1
    received: list[DepthFrame] = []
    host.feed(device.next_packet())
    for _ in range(6):
        device.offer(np.zeros((8, 16), np.int32), Record(0, 1, 0))
        line = drain(device)
        received += host.feed(line) if device.sent else []  # frame 0 is lost
    device.reset()
    host.feed(drain(device))
    assert [frame.number for frame in received] == [(1 << 32) - 2, (1 << 32) - 1, 1, 2, 3]
    assert (host.lost, host.resets) == (1, 1)


def test_a_frame_that_ends_early_is_lost(frame_packets: list[bytes]) -> None:
    """Close a frame after its first packet, with the CRC of that."""
    (depth,) = link.PacketReader().feed(frame_packets[2])
    assert isinstance(depth, link.Depth)
    trailer = trailer_of(frame_packets)._replace(crc=zlib.crc32(depth.values))
    host = DepthFrames()
    assert host.feed(b"".join(frame_packets[:3]) + to_line(trailer.pack())) == []
    assert host.lost == 1


def test_a_status_of_another_grid_drops_the_frame_that_was_begun(frame_packets: list[bytes]) -> None:
    status = device_of(Build(48, 32, 24, bottom_first=True)).status()._replace(sent=1, sending=True)
    trailer = trailer_of(frame_packets)._replace(rows=48, columns=32)
    host = DepthFrames()
    end = to_line(status.pack()) + to_line(trailer.pack())
    assert host.feed(b"".join(frame_packets[:-2]) + end) == []
    assert host.lost == 1


def test_memory_is_bounded() -> None:
    """Feed a frame that does not end, records, and bytes without a delimiter."""
    host = DepthFrames()
    host.feed(to_line(device_of(BUILD).status().pack()))
    record = to_line(link.RecordPacket(Record(0, 1, 0)).pack()) * 100
    tracemalloc.start()
    for packet in range(500):
        depth = link.Depth(DepthFormat.WORDS, 1, *divmod(256 * packet, BUILD.columns), bytes(768))
        assert host.feed(to_line(depth.pack())) == []
    for _ in range(50):
        assert host.feed(b"\x01" * 20_000) == []
        assert host.feed(b"\0" + record) == []
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 200_000  # a frame has 4,608 bytes
