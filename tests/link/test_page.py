# SPDX-License-Identifier: Apache-2.0
"""docs/link.md and examples/link_packets.txt: bytes, tables and rates are those of the models."""

import re

import numpy as np
import pytest

from commands.common.repository import ROOT
from tactile_depth.chip.contact.contact_events import WORDS, Record
from tactile_depth.chip.contact.frame_flags import FrameFlags
from tactile_depth.chip.link import packets as link
from tactile_depth.chip.link.depth_formats import DepthFormat, exact_shift
from tactile_depth.chip.link.depth_frames import DepthFrames
from tactile_depth.chip.link.device import Build, LinkDevice
from tactile_depth.chip.link.framing import LONGEST_BODY, LONGEST_ON_LINE, most_on_line, to_line
from tactile_depth.chip.link.rates import rate

PAGE = (ROOT / "docs" / "link.md").read_text()
PACKETS = (ROOT / "examples" / "link_packets.txt").read_text()
FLAGS = FrameFlags(light_gains=(0x8000,) * 3)
RECORD = Record(3, 7, 1000, 256, (1, 0), 128, 1, (1, 0), (1, 0), 128, (16, 0), FLAGS)
CODES = np.array([[1, -1], [256, 0]], np.int32)
EXAMPLES: dict[str, link.Packet] = {
    "ask": link.Ask(),
    "select": link.Select(DepthFormat.AVERAGED, 8),
    "read": link.Read(1, (0x00, 0x04)),
    "read reply": link.ReadReply(1, (0x54444550, 0x00800060)),
    "write": link.Write(2, ((0x14, 500),)),
    "write reply": link.WriteReply(2, 1),
    "picture": link.Picture(1, 0, 0, bytes((200, 0, 17))),
    "status": link.Status(1, 2, 2, 24, False, False, DepthFormat.WORDS, 8, 0, 0, 0),
    "depth": link.Depth(DepthFormat.WORDS, 1, 0, 0, bytes((1, 0, 0, 255, 255, 255, 0, 1, 0, 0, 0, 0))),
    "trailer": link.Trailer(1, 1, DepthFormat.WORDS, 0, 2, 2, False, 0x2022E32D, RECORD),
    "record": link.RecordPacket(RECORD),
}
SIZES = {  # of kind and fields, without those that repeat
    **{"Ask": 1, "Select": link.SELECT.size, "Read": link.REQUEST.size, "Read reply": link.REPLY.size},
    **{"Write": link.REQUEST.size, "Write reply": link.REPLY.size, "Picture": link.PICTURE_HEADER.size},
    **{"Status": link.STATUS.size, "Depth": link.DEPTH_HEADER.size, "Trailer": link.TRAILER.size},
    "Record": link.RECORD.size,
}
GRIDS = ((128, 128), (96, 128))
FORMATS = {DepthFormat.WORDS: "24 bits", DepthFormat.SHORT: "16 bits", DepthFormat.AVERAGED: "16 bits, averaged"}


def example_lines(name: str, packet: link.Packet) -> str:
    """Return the lines of the file for a packet: 32 bytes in each."""
    line = to_line(packet.pack())
    parts = [line[first : first + 32].hex(" ") for first in range(0, len(line), 32)]
    return "\n".join(f"{label:<13}{part}" for label, part in zip([name, *[""] * len(parts)], parts, strict=False))


def rate_line(grid: tuple[int, int], depth_format: DepthFormat) -> str:
    """Return the line of the page for a grid and a format."""
    row = rate(*grid, depth_format)
    return (
        f"| {grid[0]} x {grid[1]} | {FORMATS[depth_format]} | {row.line_bytes:,} | {row.frames_a_second:.1f} | "
        f"{100 * row.share:.1f} % |"
    )


def test_the_examples_are_the_bytes_of_the_models() -> None:
    assert "".join(f"{example_lines(*example)}\n" for example in EXAMPLES.items()) == PACKETS


def test_the_examples_are_a_frame() -> None:
    host = DepthFrames()
    line = bytes.fromhex(re.sub(r"(?m)^.{13}", "", PACKETS))
    (frame,) = host.feed(line)
    np.testing.assert_array_equal(frame.codes, CODES)
    assert (frame.record, host.lost, host.reader.bad_packets) == (RECORD, 0, 0)


@pytest.mark.parametrize("title", SIZES)
def test_the_fields_of_a_packet_follow_one_another(title: str) -> None:
    section = PAGE.split(f"### {title}\n")[1].split("\n#")[0]
    offset = 1  # behind the kind
    for first, size in re.findall(r"^\| (\d+) \| ([\w ]+) \|", section, re.MULTILINE):
        assert int(first) == offset
        offset += int(size) if size.isdigit() else 0  # fields that repeat are the last
    assert offset == SIZES[title]


def test_the_page_has_each_kind() -> None:
    table = PAGE.split("## Kinds\n")[1].split("\n#")[0]
    listed = {int(kind, 16) for kind in re.findall(r"0x[0-9a-f]{2}", table)}
    assert listed == {*link._DECODERS}


def test_the_page_has_the_limits() -> None:
    assert f"at most {LONGEST_ON_LINE:,} bytes on the line" in PAGE
    assert f"at most {LONGEST_BODY:,} bytes of kind and fields" in PAGE
    assert f"1 to {link.MOST_ACCESSES} byte addresses" in PAGE
    assert f"1 to {link.MOST_PIXELS} pixels" in PAGE
    assert f"record | {WORDS} words of 32 bits" in PAGE


def test_the_page_has_the_bytes_of_other_packets() -> None:
    text = " ".join(PAGE.split())
    pixels = 128 * 128 // link.MOST_PIXELS * most_on_line(link.PICTURE_HEADER.size + 256 * link.PIXEL_BYTES)
    assert f"at most {pixels:,} bytes: {300_000 / pixels:.1f} pictures/s" in text
    record, reply = most_on_line(link.RECORD.size), most_on_line(link.REPLY.size + 4)
    assert f"record takes at most {record} bytes, and a reply of one register {reply}" in text
    wait = most_on_line(link.DEPTH_HEADER.size + 256 * 3) / 300_000
    assert f"reply waits at most {1000 * wait:.1f} ms" in text


@pytest.mark.parametrize("depth_format", FORMATS)
@pytest.mark.parametrize("grid", GRIDS)
def test_the_rates_are_those_of_the_device(grid: tuple[int, int], depth_format: DepthFormat) -> None:
    """Send a frame whose values have no zero byte: it takes the bytes of the table, and 90 % of them are values."""
    assert rate_line(grid, depth_format) in PAGE
    device = LinkDevice(Build(*grid, 24, True), lambda _: None, lambda _, __: False)
    device.receive(to_line(link.Select(depth_format, exact_shift(24)).pack()))
    device.next_packet()
    device.offer(np.full(grid, -257 if depth_format == DepthFormat.WORDS else -257 << 8, np.int32), RECORD)
    packets = [*iter(device.next_packet, b"")][1:]  # without the record
    row = rate(*grid, depth_format)
    assert row.line_bytes - len(packets) <= sum(map(len, packets)) <= row.line_bytes
    assert row.share >= 0.9
