# SPDX-License-Identifier: Apache-2.0
"""Packets of the link: framing, each kind as bytes, and what a reader does with a damaged line."""

import zlib

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from tactile_depth.base.errors import InputError
from tactile_depth.chip.contact.contact_events import Record
from tactile_depth.chip.link import packets as link
from tactile_depth.chip.link.depth_formats import DepthFormat
from tactile_depth.chip.link.framing import (
    LONGEST_BODY,
    LONGEST_ON_LINE,
    cobs_decode,
    cobs_encode,
    from_line,
    most_on_line,
    to_line,
)

RECORD = Record(3, 7, 123456, -5, (1, 2), -70000, 40, (0, 1), (5, 6), 1 << 40, (33, 35))
STATUS = link.Status(2, 96, 128, 24, True, True, DepthFormat.SHORT, 8, 1 << 31, 5, 6)
PACKETS: tuple[link.Packet, ...] = (
    link.Ask(),
    link.Select(DepthFormat.AVERAGED, 8),
    link.Read(255, (0x00, 0x6C, 0x100)),
    link.Read(0, tuple(range(0, 4 * link.MOST_ACCESSES, 4))),
    link.Write(1, ((0x14, 0xFFFFFFFF), (0x10, 0))),
    link.Write(2, ((0x50, 1 << 31),) * link.MOST_ACCESSES),
    link.Picture(1 << 31, 95, 127, bytes((255, 0, 1))),
    link.Picture(1, 0, 0, bytes(3 * link.MOST_PIXELS)),
    STATUS,
    link.ReadReply(9, ()),
    link.ReadReply(9, (0, 0xFFFFFFFF, 0x54444550)),
    link.WriteReply(9, 128),
    *(link.Depth(depth_format, 5, 1, 0, bytes((0xFF, 0x00) * 384)) for depth_format in DepthFormat if depth_format),
    link.Trailer(5, 65535, DepthFormat.WORDS, 0, 96, 128, False, 0xCBF43926, RECORD),
    link.RecordPacket(RECORD),
)


def bytes_of(packets: tuple[link.Packet, ...]) -> bytes:
    return b"".join(to_line(packet.pack()) for packet in packets)


@pytest.mark.parametrize(
    ("data", "encoded"),
    [
        (b"", b"\x01"),
        (b"\x00", b"\x01\x01"),
        (b"\x00\x00", b"\x01\x01\x01"),
        (b"\x11\x22\x00\x33", b"\x03\x11\x22\x02\x33"),
        (b"\x11\x00\x00\x00", b"\x02\x11\x01\x01\x01"),
        (bytes(range(1, 255)), b"\xff" + bytes(range(1, 255))),
        (bytes(range(0, 255)), b"\x01\xff" + bytes(range(1, 255))),
        (bytes(range(1, 256)), b"\xff" + bytes(range(1, 255)) + b"\x02\xff"),
        (bytes((*range(1, 255), 0)), b"\xff" + bytes(range(1, 255)) + b"\x01\x01"),
        (bytes((*range(2, 256), 0)), b"\xff" + bytes(range(2, 256)) + b"\x01\x01"),
    ],
)
def test_cobs_encodes_known_data(data: bytes, encoded: bytes) -> None:
    assert (cobs_encode(data), cobs_decode(encoded)) == (encoded, data)


def test_cobs_decodes_an_empty_last_block_behind_a_full_one() -> None:
    """A simple encoder closes each packet with a block, even if that is empty."""
    assert cobs_decode(b"\xff" + bytes(range(1, 255)) + b"\x01") == bytes(range(1, 255))


@given(st.lists(st.sampled_from((b"\0", b"\xff", b"ab", b"\x01" * 253, b"\x02" * 254, b"\x03" * 255))).map(b"".join))
@example(b"\xff" * 1392)
def test_cobs_returns_the_data_and_has_no_zero(data: bytes) -> None:
    encoded = cobs_encode(data)
    assert 0 not in encoded
    assert len(encoded) <= len(data) + max(-(-len(data) // 254), 1)
    assert cobs_decode(encoded) == data


@given(st.binary(max_size=600).map(lambda data: data.replace(b"\0", b"\1")))
def test_cobs_takes_any_bytes(encoded: bytes) -> None:
    data = cobs_decode(encoded)
    assert data is None or len(data) < max(len(encoded), 1)


def test_the_longest_packet_fills_the_line_packet() -> None:
    assert len(to_line(b"\xff" * LONGEST_BODY)) == most_on_line(LONGEST_BODY) == LONGEST_ON_LINE
    with pytest.raises(InputError, match="1389 bytes: accepted are up to 1388: send it as several packets"):
        to_line(bytes(LONGEST_BODY + 1))


@pytest.mark.parametrize("packet", PACKETS, ids=lambda packet: type(packet).__name__)
def test_a_packet_is_read_as_it_was_sent(packet: link.Packet) -> None:
    line = to_line(packet.pack())
    assert (line[0], line[-1], line.count(0)) == (0, 0, 2)
    assert len(line) <= LONGEST_ON_LINE
    assert link.PacketReader().feed(line) == [packet]


words = st.integers(0, (1 << 32) - 1)


@given(st.integers(0, 255), st.lists(st.tuples(st.integers(0, 65535), words), min_size=1, max_size=128).map(tuple))
def test_register_writes_are_read_as_they_were_sent(number: int, pairs: tuple[tuple[int, int], ...]) -> None:
    packet = link.Write(number, pairs)
    assert link.PacketReader().feed(to_line(packet.pack())) == [packet]


@pytest.mark.parametrize("count", [0, 129])
def test_too_many_register_accesses_are_refused(count: int) -> None:
    for packet in (link.Read(0, (0,) * count), link.Write(0, ((0, 0),) * count)):
        with pytest.raises(InputError, match=f"{count} register accesses in a packet: accepted are 1 to 128: use"):
            packet.pack()


@given(st.lists(st.integers(0, 400)))
def test_a_line_may_come_in_any_parts(cuts: list[int]) -> None:
    line = bytes_of(PACKETS)
    reader, read, first = link.PacketReader(), [], 0
    for cut in cuts:
        read += reader.feed(line[first : first + cut])
        first += cut
    read += reader.feed(line[first:])
    assert (tuple(read), reader.bad_packets) == (PACKETS, 0)


def test_bytes_before_the_first_delimiter_are_dropped() -> None:
    reader = link.PacketReader()
    assert reader.feed(b"\x05half a packet" * 200) == []
    assert reader.feed(bytes_of(PACKETS)) == list(PACKETS)
    assert reader.bad_packets == 0


def test_one_wrong_byte_costs_one_packet() -> None:
    """Drop, double, flip and clear each byte of a packet between two others, delimiters included."""
    before, after = link.WriteReply(1, 1), link.WriteReply(2, 2)
    middle = link.Depth(DepthFormat.WORDS, 5, 1, 0, bytes((0, 1, 255, 7)))
    line = bytes_of((before, middle, after))
    for at, byte in enumerate(line):
        owner = 0 if at < len(bytes_of((before,))) else 1 if at < len(bytes_of((before, middle))) else 2
        for wrong in (b"", bytes((byte, byte)), bytes((byte ^ 0x10,)), b"\0"):
            reader = link.PacketReader()
            read = reader.feed(line[:at] + wrong + line[at + 1 :] + b"\0")
            expected = [packet for index, packet in enumerate((before, middle, after)) if index != owner]
            assert [packet for packet in read if packet in expected] == expected, (at, wrong)
            assert set(read) <= {before, middle, after}, (at, wrong)


@pytest.mark.parametrize("length", [LONGEST_ON_LINE - 1, 5000])
def test_an_oversized_packet_is_dropped_to_its_end(length: int) -> None:
    reader = link.PacketReader()
    reader.feed(b"\0")
    for _ in range(length):
        assert reader.feed(b"\x07") == []
    assert len(reader._rest) <= LONGEST_ON_LINE
    assert reader.feed(bytes_of((STATUS,))) == [STATUS]
    assert reader.bad_packets == 1


def test_truncated_packets_are_bad() -> None:
    reader = link.PacketReader()
    for packet in PACKETS:
        line = to_line(packet.pack())
        for length in range(2, min(len(line) - 1, 100)):
            assert reader.feed(line[:length] + b"\0") == []
            assert from_line(line[1:length]) is None
    assert reader.feed(bytes_of(PACKETS)) == list(PACKETS)


@pytest.mark.parametrize("packet", PACKETS, ids=lambda packet: type(packet).__name__)
def test_a_packet_of_a_wrong_length_is_bad(packet: link.Packet) -> None:
    """Cut and extend a packet under a right CRC; depth takes any number of bytes."""
    body = packet.pack()
    wrong = [] if isinstance(packet, link.Depth) else [body + b"\0"]
    wrong += [] if isinstance(packet, link.Ask) else [body[:1], body[:2]]
    reader = link.PacketReader()
    assert reader.feed(b"".join(map(to_line, wrong))) == []
    assert reader.bad_packets == len(wrong)


@pytest.mark.parametrize(
    "body",
    [
        bytes((link.Kind.SELECT, 4, 0)),
        bytes((link.Kind.SELECT, 1, 17)),
        STATUS._replace(rows=0).pack(),
        STATUS._replace(columns=4097).pack(),
        STATUS._replace(data_width=33).pack(),
        link.Trailer(1, 0, DepthFormat.SHORT, 17, 8, 8, False, 0, RECORD).pack(),
    ],
)
def test_a_field_out_of_range_makes_a_packet_bad(body: bytes) -> None:
    reader = link.PacketReader()
    assert (reader.feed(to_line(body)), reader.bad_packets) == ([], 1)


def test_unknown_kinds_are_skipped_and_counted() -> None:
    reader = link.PacketReader()
    unknown = sorted({*range(256)} - {*link._DECODERS})
    assert reader.feed(b"".join(to_line(bytes((kind, 1, 2))) for kind in unknown)) == []
    assert (reader.unknown_packets, reader.bad_packets) == (len(unknown), 0)


@pytest.mark.parametrize("version", [link.VERSION - 1, link.VERSION + 1])
def test_the_status_of_an_unknown_version_is_refused(version: int) -> None:
    reader = link.PacketReader()
    text = f"speaks version {version} of the link: accepted is {link.VERSION}: install a version"
    with pytest.raises(InputError, match=text):
        reader.feed(to_line(bytes((link.Kind.STATUS, version)) + b"of fields that this version does not know"))
    assert reader.feed(bytes_of((STATUS,))) == [STATUS]


def test_noise_is_no_packet() -> None:
    noise = np.random.default_rng(1).integers(0, 256, 200_000, np.uint8)
    noise[::50] = 0
    reader = link.PacketReader()
    assert reader.feed(noise.tobytes()) == []
    assert reader.bad_packets > 1000


def test_the_crc_is_that_of_ieee() -> None:
    """The CRC stands behind the body, low byte first: so a CRC over both always has the same value."""
    assert zlib.crc32(b"123456789") == 0xCBF43926
    data = cobs_decode(to_line(STATUS.pack())[1:-1])
    assert data is not None
    assert zlib.crc32(data) == 0x2144DF1C
