# SPDX-License-Identifier: Apache-2.0
"""The device's side of the link: order of packets, register accesses once each, pictures, and the newest frame."""

from __future__ import annotations

import numpy as np
import pytest

from tactile_depth.chip.contact.contact_events import Record
from tactile_depth.chip.link import packets as link
from tactile_depth.chip.link.depth_formats import DepthFormat
from tactile_depth.chip.link.depth_frames import DepthFrames
from tactile_depth.chip.link.device import Build, LinkDevice
from tactile_depth.chip.link.framing import to_line

BUILD = Build(16, 32, 24, bottom_first=True)
COUNTER, REFUSED = 0x10, 0x20


class Registers:
    """A register that counts its reads, one that is refused, and a list of all writes."""

    def __init__(self) -> None:
        self.reads = 0
        self.writes: list[tuple[int, int]] = []

    def read(self, address: int) -> int | None:
        self.reads += 1
        return None if address == REFUSED else self.reads

    def write(self, address: int, value: int) -> bool:
        if address == REFUSED:
            return False
        self.writes.append((address, value))
        return True


@pytest.fixture
def registers() -> Registers:
    return Registers()


@pytest.fixture
def device(registers: Registers) -> LinkDevice:
    device = LinkDevice(BUILD, registers.read, registers.write)
    assert kinds(device) == ["Status"]  # of power-up
    return device


def send(device: LinkDevice, *packets: link.Packet) -> None:
    device.receive(b"".join(to_line(packet.pack()) for packet in packets))


def packets_of(device: LinkDevice) -> list[link.Packet]:
    """Return all that the device has to send."""
    return link.PacketReader().feed(b"".join(iter(device.next_packet, b"")))


def kinds(device: LinkDevice) -> list[str]:
    return [type(packet).__name__ for packet in packets_of(device)]


def offer(device: LinkDevice, frame: int) -> None:
    device.offer(np.full((BUILD.rows, BUILD.columns), frame, np.int32), Record(0, frame, 100 * frame))


def test_replies_go_before_depth(device: LinkDevice) -> None:
    offer(device, 1)
    assert isinstance(link.PacketReader().feed(device.next_packet())[0], link.RecordPacket)
    assert isinstance(link.PacketReader().feed(device.next_packet())[0], link.Depth)
    send(device, link.Ask(), link.Read(1, (COUNTER,)))
    status, reply, depth, trailer = packets_of(device)
    assert isinstance(status, link.Status)
    assert (status.sent, status.sending) == (1, True)
    assert reply == link.ReadReply(1, (1,))
    assert isinstance(depth, link.Depth)
    assert (depth.row, depth.column) == (8, 0)
    assert isinstance(trailer, link.Trailer)


def test_a_request_that_is_repeated_is_done_once(device: LinkDevice, registers: Registers) -> None:
    read, write = link.Read(1, (COUNTER, COUNTER)), link.Write(1, ((0, 5),))
    for _ in range(2):
        send(device, read)
        assert packets_of(device) == [link.ReadReply(1, (1, 2))]
    for _ in range(2):
        send(device, write)
        assert packets_of(device) == [link.WriteReply(1, 1)]
    assert (registers.reads, registers.writes) == (2, [(0, 5)])
    send(device, link.Write(2, ((0, 5),)))
    assert len(registers.writes) == 2


def test_a_new_host_may_use_the_number_of_the_last_request(device: LinkDevice) -> None:
    send(device, link.Read(1, (COUNTER,)))
    packets_of(device)
    send(device, link.Ask(), link.Read(1, (COUNTER,)))
    assert packets_of(device)[1:] == [link.ReadReply(1, (2,))]


def test_each_request_is_answered(device: LinkDevice) -> None:
    send(device, link.Read(1, (COUNTER,)), link.Read(1, (COUNTER,)), link.Ask(), link.Read(1, (COUNTER,)))
    assert packets_of(device)[1:] == [link.ReadReply(1, (value,)) for value in (1, 1, 2)]


def test_a_refused_access_ends_a_request(device: LinkDevice, registers: Registers) -> None:
    send(device, link.Read(1, (COUNTER, REFUSED, COUNTER)))
    assert packets_of(device) == [link.ReadReply(1, (1,))]
    send(device, link.Write(2, ((0, 5), (REFUSED, 6), (0, 7))))
    assert packets_of(device) == [link.WriteReply(2, 1)]
    assert registers.writes == [(0, 5)]


def test_broken_requests_are_counted_and_do_nothing(device: LinkDevice, registers: Registers) -> None:
    line = bytearray(to_line(link.Write(1, ((0, 5),)).pack()))
    line[5] ^= 1
    device.receive(bytes(line))
    device.receive(to_line(bytes((link.Kind.SELECT, 4, 0))))
    assert (registers.writes, kinds(device)) == ([], [])
    assert device.status().bad_packets == 2


def test_the_newest_frame_is_sent(device: LinkDevice) -> None:
    offer(device, 1)
    device.next_packet(), device.next_packet()  # its record, and a part of its depth
    for frame in (2, 3, 4):
        offer(device, frame)
    frames = DepthFrames()
    frames.take(device.status())
    trailers = [packet for packet in packets_of(device) if isinstance(packet, link.Trailer)]
    assert [(trailer.number, trailer.record.frame) for trailer in trailers] == [(1, 1), (2, 4)]
    assert device.skipped == 2


def test_a_line_that_is_slower_than_the_pipeline_carries_whole_recent_frames() -> None:
    """Offer a frame in each step, in which one packet leaves: a record, or one of the three packets of a frame."""
    device, host = LinkDevice(BUILD, lambda _: None, lambda _, __: False), DepthFrames()
    received, waits = [], 0
    for moment in range(601):
        offer(device, moment)
        for frame in host.feed(device.next_packet()):
            assert set(frame.codes.flat) == {frame.record.frame}
            received.append(frame.record.frame)
            waits = max(waits, moment - frame.record.frame)
    assert len(received) == 100
    assert waits <= 6
    assert (host.lost, device.skipped) == (0, 601 - device.sent - 1)


def test_a_format_holds_from_the_next_frame_on(device: LinkDevice) -> None:
    offer(device, 256)
    device.next_packet(), device.next_packet()
    send(device, link.Select(DepthFormat.AVERAGED, 4))
    offer(device, 512)
    trailers = [packet for packet in packets_of(device) if isinstance(packet, link.Trailer)]
    assert [(trailer.depth_format, trailer.shift, trailer.rows) for trailer in trailers] == [(1, 0, 16), (3, 4, 8)]
    send(device, link.Select(DepthFormat.NONE, 0))
    offer(device, 512)
    assert kinds(device) == ["Status", "RecordPacket"]


def test_a_reset_forgets_all_but_two_numbers(device: LinkDevice) -> None:
    send(device, link.Select(DepthFormat.SHORT, 4), link.Read(1, (COUNTER,)))
    offer(device, 1)
    device.reset()
    status, *others = packets_of(device)
    assert others == []
    assert status == link.Status(1, 16, 32, 24, True, False, DepthFormat.WORDS, 8, 0, 0, 0)


def picture(number: int, first: int, count: int, value: int = 7) -> link.Picture:
    return link.Picture(number, *divmod(first, BUILD.columns), bytes((value, 0, 255)) * count)


def test_pictures_become_words_of_video(device: LinkDevice) -> None:
    send(device, *(picture(1, first, 256) for first in (0, 256)))
    words, size = device.pixels, BUILD.rows * BUILD.columns
    assert [index for index, word in enumerate(words) if word.user] == [0]
    assert [index for index, word in enumerate(words) if word.last] == list(range(31, size, 32))
    assert {word.data for word in words} == {7 << 16 | 255 << 8 | 0}
    assert len(words) == size


@pytest.mark.parametrize("lost", [0, 1, 2, 3])
def test_a_picture_stops_where_a_packet_is_lost(device: LinkDevice, lost: int) -> None:
    """The frame that stops is malformed, which frame_guard drops; the next picture is whole."""
    send(device, *(picture(1, 128 * index, 128) for index in range(4) if index != lost))
    assert len(device.pixels) == (0 if lost == 0 else 128 * lost)
    device.pixels.clear()
    send(device, *(picture(2, 128 * index, 128) for index in range(4)), picture(2, 384, 128), picture(2, 512, 1))
    assert len(device.pixels) == 512


def test_packets_of_two_pictures_are_not_joined(device: LinkDevice) -> None:
    send(device, picture(1, 0, 256), picture(2, 256, 256))
    assert len(device.pixels) == 256


def test_pixels_behind_the_end_of_a_picture_are_dropped(device: LinkDevice) -> None:
    send(device, picture(1, 0, 256), picture(1, 256, 200), picture(1, 456, 100), picture(1, 512, 1))
    assert len(device.pixels) == 512
    assert (device.pixels[-1].last, device.pixels[-1].user) == (1, 0)


@pytest.mark.parametrize(("row", "column"), [(0, 64), (1, 32), (3, 0), (2, 1)])
def test_a_picture_goes_on_with_row_and_column_of_the_next_pixel(device: LinkDevice, row: int, column: int) -> None:
    send(device, picture(1, 0, 64), link.Picture(1, row, column, bytes(3)))
    assert len(device.pixels) == 64
    send(device, picture(1, 64, 1))
    assert len(device.pixels) == 65


def test_the_device_knows_the_kinds_to_it_alone(device: LinkDevice) -> None:
    for kind in link.Kind:
        device.receive(to_line(bytes((kind, 77))))
    assert device.status().bad_packets == len(link.TO_DEVICE)
