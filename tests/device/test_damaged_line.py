# SPDX-License-Identifier: Apache-2.0
"""The RTL of a device on a line that loses, doubles and flips bytes, while it is reset again and again.

The host delivers no wrong frame, each loss is counted, and nothing hangs: a picture on a clean line gives its frame.
"""

import os
import random
import select
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import tactile_depth as td
from commands.common.repository import ROOT
from tactile_depth.chip.link import packets as link
from tactile_depth.chip.link.depth_frames import DepthFrame, DepthFrames
from tactile_depth.chip.link.framing import to_line
from tactile_depth.pictures.reader import Reader
from tests.device.test_rtl import small

PICTURES = 8  # different ones
WAIT_S = 60.0


class Host:
    """Host of a simulated device, with a line that damages one byte in `rarity`, either way.

    Attributes
    ----------
    packets : int
        Packets that were sent either way.
    frames : list of DepthFrame
        Those delivered.
    """

    def __init__(self, folder: Path, options: list[str], seed: int) -> None:
        sample = td.sample("ball")
        pipeline = small(sample)
        pipeline.hardware(folder)
        self.columns = pipeline.grid[1]
        shares = np.linspace(0, 1, PICTURES)[:, None, None, None]
        camera = list(np.rint((1 - shares) * sample.reference + shares * sample.image).astype(np.uint8))
        self.codes = [pipeline(picture).codes for picture in camera]
        reader = Reader(pipeline.sensor, pipeline.grid)
        self.pictures = [frame for _, frame in reader.pictures(camera, "picture")[0]]
        command = [sys.executable, "-m", "commands.run.device_sim", str(folder), *options]
        self.process = subprocess.Popen(
            command, cwd=ROOT, bufsize=0, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE
        )
        assert self.process.stdin is not None
        assert self.process.stdout is not None
        assert self.process.stderr is not None
        self.stdin, self.stdout = self.process.stdin, self.process.stdout
        lines = iter(self.process.stderr.readline, b"")
        assert any(line.strip() == b"ready" for line in lines)
        self.chance = random.Random(seed)
        self.rarity = 0
        self.host = DepthFrames()
        self.clean = link.PacketReader()  # of what the device sends, before the damage
        self.frames: list[DepthFrame] = []
        self.packets = self.statuses = 0

    def close(self) -> None:
        self.stdin.close()
        self.process.wait(WAIT_S)
        self.stdout.close()
        assert self.process.stderr is not None
        self.process.stderr.close()

    def damaged(self, data: bytes) -> bytes:
        """Return the bytes with some lost, doubled or flipped."""
        if not self.rarity:
            return data
        out, place = bytearray(), 0
        while (skip := int(self.chance.expovariate(1 / self.rarity))) < len(data) - place:
            out += data[place : place + skip]
            byte = data[place + skip]
            out += self.chance.choice((b"", bytes((byte, byte)), bytes((byte ^ 1 << self.chance.randrange(8),))))
            place += skip + 1
        return bytes(out + data[place:])

    def send(self, *packets: link.Packet) -> None:
        self.packets += len(packets)
        os.write(self.stdin.fileno(), self.damaged(b"".join(to_line(packet.pack()) for packet in packets)))

    def send_picture(self, number: int) -> None:
        data = self.pictures[number % PICTURES].tobytes()
        size = link.PIXEL_BYTES * link.MOST_PIXELS
        places = range(0, len(data), size)
        self.send(
            *(
                link.Picture(number, *divmod(first // link.PIXEL_BYTES, self.columns), data[first : first + size])
                for first in places
            )
        )

    def take(self, wait_s: float = 0.0) -> bool:
        """Take what the device has sent. True: something came."""
        if not select.select([self.stdout], [], [], wait_s)[0]:
            return False
        data = os.read(self.stdout.fileno(), 1 << 16)
        assert data, "the simulator has ended"
        packets = self.clean.feed(data)
        self.packets += len(packets)
        self.statuses += sum(isinstance(packet, link.Status) for packet in packets)
        for frame in self.host.feed(self.damaged(data)):
            assert any(np.array_equal(frame.codes, codes) for codes in self.codes), "a wrong frame was delivered"
            self.frames.append(frame)
        return True

    def wait(self, what: str, is_there: Any) -> None:
        end = time.monotonic() + WAIT_S
        while not is_there():
            assert time.monotonic() < end, f"no {what}"
            self.take(0.1)

    def status(self) -> link.Status:
        """Ask on a clean line until all else has come; return the status."""
        self.rarity = 0
        last, status = None, self.ask()
        while status.sending or status != last:
            last, status = status, self.ask()
        return status

    def ask(self) -> link.Status:
        before, end = self.statuses, time.monotonic() + WAIT_S
        while self.statuses == before:  # the device drops a packet while two others wait in it
            assert time.monotonic() < end, "no status"
            self.send(link.Ask())
            self.take(1.0)
        while self.take(0.2):
            pass
        assert self.host.status is not None
        return self.host.status

    def reset(self) -> None:
        self.process.send_signal(signal.SIGUSR1)


def disturb(host: Host, packets: int) -> int:
    """Send pictures and requests over a bad line until so many packets have gone; return the number of resets."""
    resets, number = 0, 0
    host.ask()
    while host.packets < packets:
        host.rarity = host.chance.choice((0, 300, 3000, 30000))
        number += 1
        host.send_picture(number)
        if host.chance.random() < 0.3:
            host.send(link.Read(number % 256, (4, 8)), link.Write(number % 256, ((0, 0),)))
        if number % 25 == 5:
            host.reset()
            resets += 1
        before = len(host.frames) + host.host.lost
        for _ in range(host.chance.choice((1, 20, 20))):
            if not host.take(0.02) or len(host.frames) + host.host.lost > before:
                break
    return resets


@pytest.fixture
def host(options: list[str], tmp_path: Path) -> Iterator[Host]:
    host = Host(tmp_path, options, seed=1)
    yield host
    host.close()


@pytest.mark.parametrize(
    ("options", "packets"),
    [
        pytest.param([], 1000, id="bytes-1000"),
        pytest.param(["--pins"], 200, id="pins-200"),
        pytest.param([], 10_000, id="bytes-10000", marks=pytest.mark.regress),
        pytest.param(["--pins"], 1000, id="pins-1000", marks=pytest.mark.regress),
    ],
)
def test_no_wrong_frame_and_each_loss_is_counted(host: Host, packets: int) -> None:
    resets = disturb(host, packets)
    status = host.status()
    assert resets
    assert len(host.frames) > packets / 20
    assert host.host.lost
    assert host.host.delivered == len(host.frames)
    assert host.host.delivered + host.host.lost == status.sent, "a loss is not counted"
    number = len(host.frames)
    host.send_picture(0)
    host.wait("frame on the clean line", lambda: len(host.frames) > number)
    assert np.array_equal(host.frames[-1].codes, host.codes[0])
