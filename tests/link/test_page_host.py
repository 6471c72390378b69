# SPDX-License-Identifier: Apache-2.0
"""docs/link.md, played by a host written from the page alone: it delivers each frame right, or counts it as lost."""

import ast
import inspect

import numpy as np
import pytest

from tactile_depth.chip.contact.contact_events import WORDS, record
from tactile_depth.chip.link import packets as link
from tactile_depth.chip.link.depth_formats import DepthFormat, exact_shift, received
from tactile_depth.chip.link.device import Build, LinkDevice
from tactile_depth.chip.link.framing import to_line
from tests.link import page_host
from tests.link.page_host import ASK, PageHost

FORMATS = (DepthFormat.WORDS, DepthFormat.SHORT, DepthFormat.AVERAGED)
FRAMES = 60


class Line:
    """Line between a device and the host of the page, which asks for the status again and again.

    A status has the values of the clock in which it was due: one that waits for a packet leaves behind it, as before.

    Attributes
    ----------
    damage : float
        Chance that a packet of the device is damaged.
    sent : dict
        Codes that a host gets, by number of the frame.
    """

    def __init__(self, build: Build, depth_format: DepthFormat, damage: float = 0.0, seed: int = 1) -> None:
        self.build, self.depth_format, self.damage = build, depth_format, damage
        self.generator = np.random.default_rng(seed)
        self.host = PageHost()
        self.sent: dict[int, np.ndarray] = {}
        self.power_up()

    def power_up(self) -> None:
        self.device = LinkDevice(self.build, lambda _: None, lambda _, __: False)
        self.device.receive(to_line(link.Select(self.depth_format, exact_shift(self.build.data_width)).pack()))
        self.carry(self.device.next_packet())

    def carry(self, line: bytes) -> None:
        if self.generator.random() < self.damage:
            at = int(self.generator.integers(len(line)))
            line = (line[:at] + line[at + 1 :], line[:at], b"", line * 2, line[:at] + b"\5" + line[at + 1 :])[at % 5]
        self.host.feed(line)

    def show(self) -> None:
        """Let the device send a frame, with a status that waits behind some packets of it."""
        device, shape = self.device, (self.build.rows, self.build.columns)
        limit = 1 << self.build.data_width - 1
        codes = self.generator.integers(-limit, limit, shape, np.int32)
        device.offer(codes, record([0] * WORDS))
        order = slice(None, None, -1 if self.build.bottom_first else 1)
        shift = 0 if self.depth_format == DepthFormat.WORDS else exact_shift(self.build.data_width)
        form = self.depth_format, self.build.data_width, shift, self.build.bottom_first
        self.sent[device.sent + 1] = received(codes[order], *form)
        while True:
            status = to_line(device.status().pack())
            packet = device.next_packet()
            if not packet:
                return
            self.carry(packet)
            if self.generator.random() < 0.5:
                self.carry(status)

    def end(self) -> None:
        """Ask on a clean line; a zero ends what a damaged packet has left."""
        self.device.receive(ASK)
        self.host.feed(b"\0" + self.device.next_packet())

    def require_right(self) -> None:
        for number, frame in self.host.frames:
            np.testing.assert_array_equal(frame, self.sent[number])


@pytest.mark.parametrize("depth_format", FORMATS, ids=lambda each: each.name)
@pytest.mark.parametrize("build", [Build(8, 16, 24, True), Build(24, 32, 16, False), Build(9, 64, 20, True)], ids=str)
def test_a_clean_line_loses_no_frame(build: Build, depth_format: DepthFormat) -> None:
    line = Line(build, depth_format)
    for _ in range(FRAMES):
        line.show()
    line.end()
    assert [number for number, _ in line.host.frames] == list(range(1, FRAMES + 1))
    assert (line.host.lost, line.host.bad) == (0, 0)
    line.require_right()


@pytest.mark.parametrize("depth_format", FORMATS, ids=lambda each: each.name)
@pytest.mark.parametrize("seed", range(4))
def test_a_line_that_damages_packets_loses_frames_that_are_counted(seed: int, depth_format: DepthFormat) -> None:
    line = Line(Build(24, 32, 24, True), depth_format, seed=seed)
    line.damage = 0.1
    for _ in range(FRAMES):
        line.show()
    line.end()
    assert len(line.host.frames) + line.host.lost == line.device.sent == FRAMES
    assert line.host.frames
    assert line.host.lost
    line.require_right()


@pytest.mark.parametrize("frames", [1, 2, 9])
def test_a_power_up_counts_the_frame_alone_that_was_begun(frames: int) -> None:
    line = Line(Build(24, 32, 24, False), DepthFormat.WORDS)
    for _ in range(9):
        line.show()
    line.device.offer(np.zeros((24, 32), np.int32), record([0] * WORDS))
    for _ in range(2):  # the record and a packet of depth
        line.carry(line.device.next_packet())
    line.require_right()
    line.host.frames.clear()
    line.sent.clear()
    line.power_up()
    for _ in range(frames):
        line.show()
    line.end()
    assert [number for number, _ in line.host.frames] == list(range(1, frames + 1))
    assert line.host.lost == 1
    line.require_right()


@pytest.mark.parametrize("version", [link.VERSION - 1, link.VERSION + 1])
def test_another_version_ends_in_one_line(version: int) -> None:
    with pytest.raises(ValueError, match=f"^version {version} of the protocol, this host has {link.VERSION}$"):
        PageHost().feed(to_line(bytes((link.Kind.STATUS, version))))


def test_the_host_imports_no_package() -> None:
    tree = ast.parse(inspect.getsource(page_host))
    names = [alias.name for node in ast.walk(tree) if isinstance(node, ast.Import) for alias in node.names]
    assert names == ["zlib"]
    assert not any(isinstance(node, ast.ImportFrom) for node in ast.walk(tree))
