# SPDX-License-Identifier: Apache-2.0
"""Formats of depth: words, 16 bits, and 16 bits averaged over 2 x 2 pixels."""

from __future__ import annotations

import itertools
from typing import Any, get_args

import numpy as np
import pytest

import tactile_depth as td
from tactile_depth.chip.contact.contact_events import WORDS, record
from tactile_depth.chip.link.depth_formats import FORMATS, DepthFormat, DepthFormatName
from tactile_depth.chip.link.device import Build, LinkDevice
from tactile_depth.chip.link.framing import from_line
from tactile_depth.chip.link.packets import Kind
from tactile_depth.cli import measure
from tactile_depth.cli.ply import vertices_mm
from tactile_depth.device import line
from tactile_depth.device.transport import Pace
from tests.device.conftest import GRID, BuildZynq, Plug
from tests.device.test_serial_line import RESET, require_one_error, until

ODD_GRID = (13, 16)
"""The bottom row leaves first, and the top one has no partner."""
NAMES: tuple[DepthFormatName, ...] = get_args(DepthFormatName)
RECORD = record([0] * WORDS)
CONFIGURATIONS: dict[str, dict[str, Any]] = {
    "even": {"grid": GRID},
    "odd": {"grid": ODD_GRID},
    "20 bits": {"grid": GRID, "data_width": 20},
    "16 bits": {"grid": GRID, "data_width": 16, "depth_range_mm": 2.0},
    "spectral": {"grid": (16, 16), "solver": "spectral", "boundary": "dirichlet"},
}


def sent(codes: np.ndarray, name: DepthFormatName, width: int) -> np.ndarray:
    """Return the codes that a device sends of those of the package: means and quotients in double precision."""
    if name == "words":
        return codes
    values, step = codes.astype(float), 2.0 ** max(width - 16, 0)
    if name == "averaged":
        values = values[len(values) % 2 :]
        values = values.reshape(len(values) // 2, 2, -1, 2).mean(axis=(1, 3))
    return (np.rint(values / step).clip(-32768, 32767) * step).astype(np.int32)


def require_sent(frame: td.DeviceFrame, result: td.Result, name: DepthFormatName) -> None:
    """Require that a frame is what a device sends in a format of what the package computes."""
    span, width = (2 if name == "averaged" else 1), result.recorder.width
    codes = sent(result.codes, name, width)
    np.testing.assert_array_equal(frame.codes, codes)
    assert frame.depth_format == name
    assert frame.depth_lsb_mm == result.depth_lsb_mm
    assert frame.pixel_pitch_mm == span * result.pixel_pitch_mm
    assert frame.pixel_aspect == result.pixel_aspect
    mask = codes > result.threshold
    depth_mm = codes * result.depth_lsb_mm
    height_mm = depth_mm - (np.where(mask, 0, depth_mm).ravel().sum() / (~mask).sum())
    np.testing.assert_array_equal(frame.mask, mask)
    np.testing.assert_array_equal(frame.contact.mask, mask)
    assert frame.height_mm.dtype == np.float32
    np.testing.assert_array_equal(frame.height_mm, height_mm.astype(np.float32))
    made, expected = frame.contact, result.contact
    assert made.record[3:-1] == expected.record[3:-1]
    of_grid = ("touching", "peak_mm", "peak_px", "area_mm2", "volume_mm3", "centroid_mm", "peak_position_mm")
    for attribute in (*of_grid, "is_central"):
        assert getattr(made, attribute) == getattr(expected, attribute), attribute


@pytest.mark.parametrize("configuration", CONFIGURATIONS)
@pytest.mark.parametrize("name", NAMES)
def test_depth_is_that_of_the_package_in_each_format(
    name: DepthFormatName, configuration: str, sample: td.Sample, pictures: list[np.ndarray], plug: Plug
) -> None:
    pipeline = td.Pipeline(sample.sensor, sample.reference, **CONFIGURATIONS[configuration])
    with td.Device(plug(pipeline).address, pipeline, depth_format=name) as device:
        assert device.depth_format == name
        device.load()
        frames = list(device.depth(iter(pictures)))
        single = list(device.depth(pictures[0]))
        assert device.status().lost == 0
    for frame, result in zip(frames, pipeline.stream(pictures), strict=True):
        require_sent(frame, result, name)
    require_sent(single[0], pipeline(pictures[0]), name)


def test_words_are_the_default(steady: td.Pipeline, sample: td.Sample, plug: Plug) -> None:
    with td.Device(plug(steady).address, steady) as device:
        device.load()
        assert device.depth_format == "words"
        require_sent(next(device.depth([sample.image])), steady(sample.image), "words")


@pytest.mark.parametrize("grid", [GRID, ODD_GRID])
def test_values_lie_in_the_middle_of_their_pixels(grid: tuple[int, int], sample: td.Sample, plug: Plug) -> None:
    """Compare with the mean position of the grid pixels of a value; those of an odd grid begin at its second row."""
    pipeline = td.Pipeline(sample.sensor, sample.reference, grid=grid, light_gains=False)
    pitch_mm, aspect = pipeline.pixel_pitch_mm, sample.sensor.pixel_aspect
    with td.Device(plug(pipeline).address, pipeline, depth_format="averaged") as device:
        device.load()
        frame = next(device.depth([sample.image]))
    first = grid[0] % 2
    rows = np.arange(first, grid[0]).reshape(-1, 2).mean(axis=1) * pitch_mm
    columns = np.arange(grid[1]).reshape(-1, 2).mean(axis=1) * pitch_mm * aspect
    top, left = frame.origin_mm
    np.testing.assert_allclose(top + np.arange(frame.codes.shape[0]) * frame.pixel_pitch_mm, rows, rtol=1e-12)
    np.testing.assert_allclose(
        left + np.arange(frame.codes.shape[1]) * frame.pixel_pitch_mm * aspect, columns, rtol=1e-12
    )
    points = vertices_mm(frame.height_mm, frame.pixel_pitch_mm, aspect, frame.origin_mm)
    right, up, _ = points.reshape(*frame.codes.shape, 3).transpose(2, 0, 1)
    np.testing.assert_allclose(right[0], columns, rtol=1e-6)
    np.testing.assert_allclose(up[:, 0], -rows, rtol=1e-6)


@pytest.mark.parametrize("name", NAMES)
def test_captures_do_not_depend_on_the_format(
    name: DepthFormatName, pipeline: td.Pipeline, sample: td.Sample, pictures: list[np.ndarray], plug: Plug
) -> None:
    untouched = [(level * sample.reference.astype(float)).astype(np.uint8) for level in (0.95, 0.96)]
    expected = td.Pipeline(sample.sensor, sample.reference, grid=GRID)
    expected.capture_reference(untouched)
    expected.capture_zero(untouched)
    with td.Device(plug(pipeline).address, pipeline, depth_format=name) as device:
        device.load()
        device.capture_reference(untouched)
        device.capture_zero(untouched)
        for frame, result in zip(device.depth(iter(pictures)), expected.stream(pictures), strict=True):
            require_sent(frame, result, name)


@pytest.mark.parametrize("wanted", ["float", "", None, 2, ["words"]])
def test_a_format_that_is_none(wanted: Any, steady: td.Pipeline) -> None:
    """Refuse it before the port is opened: there is none at this address."""
    with pytest.raises(td.InputError, match=r"is unknown: accepted are words, 16-bit, averaged$") as caught:
        td.Device("serial:/dev/none", steady, depth_format=wanted)
    assert (caught.value.argument, caught.value.value) == ("depth_format", wanted)
    assert caught.value.accepted == NAMES


def test_the_names_are_those_of_the_formats() -> None:
    assert tuple(FORMATS) == NAMES
    assert set(FORMATS.values()) == set(DepthFormat) - {DepthFormat.NONE}


@pytest.mark.parametrize("loss", ["reset", "power_up"])
@pytest.mark.parametrize("name", NAMES)
def test_the_format_is_selected_again_after_a_reset(
    name: DepthFormatName, loss: str, steady: td.Pipeline, sample: td.Sample, plug: Plug
) -> None:
    cable = plug(steady)
    with td.Device(cable.address, steady, depth_format=name) as device:
        device.load()
        cable.serving.wanted.add(loss)
        until(lambda: not cable.serving.wanted)
        until(lambda: isinstance(device._line, line.Line) and device._line._trouble is not None)
        require_one_error(device.status, RESET)
        device.load()
        require_sent(next(device.depth([sample.image])), steady(sample.image), name)


def test_the_format_is_selected_again_by_a_device_that_was_unplugged(
    steady: td.Pipeline, sample: td.Sample, plug: Plug
) -> None:
    cable = plug(steady)
    with td.Device(cable.address, steady, depth_format="averaged") as device:
        device.load()
        cable.unplug()
        with pytest.raises(td.DeviceError, match="is gone"):
            device.status()
        cable.plug()
        device.load()
        require_sent(next(device.depth([sample.image])), steady(sample.image), "averaged")


def test_the_next_program_gets_the_format_that_it_names(steady: td.Pipeline, sample: td.Sample, plug: Plug) -> None:
    """A device keeps its format when a program ends; its camera goes on meanwhile."""
    ((_, camera),) = steady._reader.pictures(sample.image, "picture")[0]
    cable, result = plug(steady, camera=camera[None], camera_s=0.002), steady(sample.image)
    for name in (*NAMES, *reversed(NAMES)):
        with td.Device(cable.address, steady, depth_format=name) as device:
            device.load()
            for frame in itertools.islice(device.depth(), 4):
                require_sent(frame, result, name)
    assert measure.grid_of(cable.address) == GRID


class Wire:
    """Transport to the model of a link that begins a frame of depth just before it is told the format.

    Attributes
    ----------
    device : LinkDevice
    is_held : bool
        Depth that is due waits.
    """

    name, silence, pace = "wire", "", Pace(1.0, 2.0, 1.0)

    def __init__(self, codes: np.ndarray) -> None:
        self.device = LinkDevice(Build(len(codes), len(codes.T), 24, True), lambda _: None, lambda _, __: False)
        self.is_held, self._codes, self._out = True, codes, b""

    def offer(self, frame: int) -> None:
        self.device.offer(self._codes, RECORD._replace(frame=frame))

    def read(self, timeout_s: float) -> bytes:
        data, self._out = self._out, b""
        while not self.is_held and (packet := self.device.next_packet()):
            data += packet
        return data

    def write(self, data: bytes) -> None:
        body = from_line(data.strip(b"\0"))
        assert body is not None
        if body[0] == Kind.SELECT:
            self.offer(1)
            self._out += b"".join(self.device.next_packet() for _ in range(2))  # the record, the first packet of depth
        self.device.receive(data)
        self._out += self.device.next_packet()

    def close(self) -> None:
        pass


@pytest.mark.parametrize("depth_format", [DepthFormat.SHORT, DepthFormat.AVERAGED])
def test_a_frame_that_was_begun_in_another_format_is_dropped(depth_format: DepthFormat) -> None:
    wire = Wire(np.arange(24 * 32, dtype=np.int32).reshape(24, 32) << 9)
    channel = line.Line(wire, depth_format)
    channel.collect(True)
    wire.is_held = False
    until(lambda: channel.delivered == 1)
    wire.offer(2)
    arrival = channel.frame(5.0, 0)
    channel.close()
    assert arrival is not None
    assert (arrival.frame.depth_format, arrival.frame.record.frame, arrival.lost) == (depth_format, 2, 0)


def test_a_zynq_has_words_alone(build_zynq: BuildZynq, steady: td.Pipeline) -> None:
    zynq = build_zynq(steady)
    message = "^depth_format=averaged: uio has depth in words alone, which a DMA writes into memory: omit it$"
    with pytest.raises(td.InputError, match=message):
        td.Device(zynq.address, steady, depth_format="averaged")
    td.Device(zynq.address, steady, depth_format="words").close()
