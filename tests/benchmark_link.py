# SPDX-License-Identifier: Apache-2.0
"""Time of the host's parser for a recorded stream of depth frames, and the part of the line that is depth values.

A stream is what the model of the device sends of 10 frames of 128 x 128, with their records. Codes: those of a press,
which have many zero bytes; 0, which are zero bytes alone; -1, which has none. One core. The suite does not collect this
file: docs/commands.md.
"""

from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

from tactile_depth.chip.contact.contact_events import Record
from tactile_depth.chip.link.depth_formats import DepthFormat, exact_shift
from tactile_depth.chip.link.depth_frames import DepthFrame, DepthFrames
from tactile_depth.chip.link.device import Build, LinkDevice
from tactile_depth.chip.link.framing import to_line
from tactile_depth.chip.link.packets import Select
from tactile_depth.chip.link.rates import rate

SIDE, FRAMES = 128, 10
LEAST_FRAMES_A_SECOND = 60
LEAST_SHARE = 0.9  # of the line's bytes are values


def codes_of(name: str) -> npt.NDArray[np.int32]:
    """Return depth codes (SIDE, SIDE) of 24 bits: of a press of 1/40 of the range, or all the same."""
    if name != "press":
        return np.full((SIDE, SIDE), int(name), np.int32)
    row, column = np.mgrid[:SIDE, :SIDE]
    distance = (row - SIDE / 2) ** 2 + (column - SIDE / 2) ** 2
    return np.rint(200_000 * np.exp(-distance / 400)).astype(np.int32)


def stream(codes: npt.NDArray[np.int32], depth_format: DepthFormat) -> bytes:
    """Return the bytes of FRAMES frames, with a status before them."""
    device = LinkDevice(Build(SIDE, SIDE, 24, True), lambda _: None, lambda _, __: False)
    device.receive(to_line(Select(depth_format, exact_shift(24)).pack()))
    line = bytearray()
    for number in range(1, FRAMES + 1):
        device.offer(codes, Record(0, number, 0))
        line += b"".join(iter(device.next_packet, b""))
    return bytes(line)


def parse(line: bytes) -> list[DepthFrame]:
    """Return the frames of a stream that comes in parts of 4 KB, as a serial port delivers it."""
    frames = DepthFrames()
    return [frame for first in range(0, len(line), 4096) for frame in frames.feed(line[first : first + 4096])]


@pytest.mark.parametrize("depth_format", [*DepthFormat][1:], ids=lambda depth_format: depth_format.name)
@pytest.mark.parametrize("codes", ["press", "0", "-1"])
def test_stream_to_frames(benchmark: Any, codes: str, depth_format: DepthFormat) -> None:
    line = stream(codes_of(codes), depth_format)
    benchmark.group = f"{depth_format.name}, {FRAMES} frames"
    frames = benchmark(parse, line)
    assert len(frames) == FRAMES
    frames_a_second = FRAMES / benchmark.stats.stats.median
    share = FRAMES * rate(SIDE, SIDE, depth_format).value_bytes / len(line)
    benchmark.extra_info |= {"frames_a_second": frames_a_second, "share": share}
    print(f"\n{depth_format.name}, codes {codes}: {frames_a_second:.0f} frames/s, {share:.1%} of the line are values")
    assert frames_a_second >= LEAST_FRAMES_A_SECOND
    assert share >= LEAST_SHARE
