# SPDX-License-Identifier: Apache-2.0
"""A device that does not hold what the pipeline has is refused, with the remedy: of pictures and of its camera."""

from __future__ import annotations

import itertools
import time
import warnings
from collections.abc import Callable

import numpy as np
import pytest

import tactile_depth as td
from tactile_depth.chip.link.depth_formats import DepthFormatName
from tactile_depth.chip.registers.axil_registers import Events
from tactile_depth.chip.registers.register_map import TABLES
from tactile_depth.chip.table_entries import table_entries
from tactile_depth.device import tables
from tactile_depth.device.channel import Channel
from tests.device.cable import Cable
from tests.device.test_same_depth import FIRST, GRID, NAMES, in_light
from tests.device.test_same_depth import pipeline as pipeline
from tests.device.test_serial_line import until

FOREIGN = r"tables of the device are not those of this program \("

Depth = Callable[[td.Device], list[td.DeviceFrame]]


@pytest.fixture(params=["single", "stream", "camera"])
def depth(request: pytest.FixtureRequest, sample: td.Sample, cable: Cable, pipeline: td.Pipeline) -> Depth:
    """Return a function that sends a press, or lets the camera of the device on the `cable` give it."""
    if request.param != "camera":
        return lambda device: list(device.depth([sample.image], stream=request.param == "stream"))
    return lambda device: shown(device, cable, sample.image)


def shown(device: td.Device, cable: Cable, image: np.ndarray) -> list[td.DeviceFrame]:
    """Return a frame that a device gives of its camera, which then is off."""
    assert cable.setup is not None
    ((_, picture),) = device.pipeline.reader.pictures(image, "picture")[0]
    cable.setup.camera, cable.setup.camera_s = picture[None], 0.01
    try:
        return list(itertools.islice(device.depth(), 1))
    finally:
        cable.setup.camera = None
        time.sleep(0.05)


@pytest.fixture(scope="module")
def other(sample: td.Sample) -> td.Pipeline:
    """Pipeline with another reference."""
    return td.Pipeline(sample.sensor, in_light(sample.reference, 0.8), grid=GRID, model="quadratic")


def test_a_device_that_was_never_loaded(cable: Cable, pipeline: td.Pipeline, depth: Depth) -> None:
    with td.Device(cable.address, pipeline) as device:
        for _ in range(2):
            with pytest.raises(td.DeviceError, match=FIRST):
                depth(device)
        device.load()
        assert len(depth(device)) == 1


@pytest.mark.parametrize("loss", ["reset", "power_up"])
def test_a_device_that_was_reset(loss: str, cable: Cable, device: td.Device, depth: Depth) -> None:
    cable.serving.wanted.add(loss)
    until(lambda: not cable.serving.wanted)
    time.sleep(0.1)
    with pytest.raises(td.DeviceError, match="was reset or lost its power"):
        depth(device)
    with pytest.raises(td.DeviceError, match=FIRST):
        depth(device)
    device.load()
    assert len(depth(device)) == 1


def test_a_device_that_lost_its_power_between_two_programs(cable: Cable, device: td.Device, depth: Depth) -> None:
    device.close()
    cable.serving.wanted.add("power_up")
    until(lambda: not cable.serving.wanted)
    with td.Device(cable.address, device.pipeline) as opened:
        opened.set_thresholds()
        with pytest.raises(td.DeviceError, match=f"{FOREIGN}coefficients, reference, zero.*{FIRST}"):
            depth(opened)


def test_a_device_that_is_opened_again_needs_no_load(cable: Cable, device: td.Device, depth: Depth) -> None:
    device.close()
    with td.Device(cable.address, device.pipeline) as opened:
        opened.registers["DARK_LEVEL"] = 40  # as another program left it
        assert len(depth(opened)) == 1


@pytest.mark.parametrize("name", NAMES)
def test_the_reference_of_another_program(
    name: DepthFormatName, cable: Cable, pipeline: td.Pipeline, other: td.Pipeline, depth: Depth
) -> None:
    with td.Device(cable.address, other) as device:
        device.load()
    with td.Device(cable.address, pipeline, depth_format=name) as device:
        with pytest.raises(td.DeviceError, match=rf"{FOREIGN}reference\): {FIRST}"):
            depth(device)
        device.load()
        assert len(depth(device)) == 1


def test_a_cable_that_is_pulled_during_a_load(
    cable: Cable, pipeline: td.Pipeline, other: td.Pipeline, depth: Depth, monkeypatch: pytest.MonkeyPatch
) -> None:
    def pulled(line: Channel, name: str, entries: np.ndarray) -> None:
        if name == "zero":
            raise td.DeviceError("the port is gone")
        write(line, name, entries)

    write = tables._write_table
    with td.Device(cable.address, other) as device:
        device.load()
    with td.Device(cable.address, pipeline) as device:
        with monkeypatch.context() as patch:
            patch.setattr(tables, "_write_table", pulled)
            with pytest.raises(td.DeviceError, match="the port is gone"):
                device.load()
        with pytest.raises(td.DeviceError, match=rf"{FOREIGN}reference\): {FIRST}"):
            depth(device)
        device.load()
        assert len(depth(device)) == 1


def test_an_entry_that_another_program_writes(device: td.Device, sample: td.Sample, cable: Cable, depth: Depth) -> None:
    for name, word in (("TABLE_SELECT", TABLES["reference"]), ("TABLE_INDEX", 5), ("TABLE_LOW", 1 << 20)):
        device.registers[name] = word
    assert len(depth(device)) == 1
    device.registers["TABLE_COMMIT.reference"] = 1
    with pytest.raises(td.DeviceError, match=rf"about to change \(reference\): {FIRST}"):
        list(device.depth([sample.image]))
    for _ in range(2):  # the first picture takes it
        with pytest.raises(td.DeviceError, match=FIRST):
            depth(device)
        cable.serving.device.registers.clock(Events(frame_start=True))
    with pytest.raises(td.DeviceError, match=rf"{FOREIGN}reference\): {FIRST}"):
        depth(device)
    device.load()
    assert len(depth(device)) == 1


def test_a_capture_of_another_program(device: td.Device, sample: td.Sample, cable: Cable, depth: Depth) -> None:
    device.registers["REFERENCE_CAPTURE.start"] = 1
    with pytest.raises(td.DeviceError, match=rf"about to change \(REFERENCE_CAPTURE\): {FIRST}"):
        next(device.depth())
    ((_, picture),) = device.pipeline.reader.pictures(in_light(sample.reference, 0.9), "picture")[0]
    for _ in range(2):
        cable.serving.device.show(picture)
    with pytest.raises(td.DeviceError, match=rf"{FOREIGN}reference\): {FIRST}"):
        depth(device)
    device.close()
    with pytest.warns(td.InputWarning, match=r"the reference of the device comes from a capture .*: call load\(\)"):
        opened = td.Device(cable.address, device.pipeline)
    with opened, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        assert len(shown(opened, cable, sample.image)) == 1
        with pytest.raises(td.DeviceError, match=rf"the reference of the device is not known .*: {FIRST}"):
            list(opened.depth([sample.image]))
        opened.load()
        assert len(depth(opened)) == 1


def test_a_device_that_is_built_for_the_calibration_needs_no_load(
    cable: Cable, pipeline: td.Pipeline, depth: Depth
) -> None:
    assert cable.setup is not None
    cable.setup.tables = table_entries(pipeline.sensor, pipeline.config, pipeline.zero_codes)
    cable.unplug()
    cable.plug()
    for _ in range(2):
        with td.Device(cable.address, pipeline) as device:
            assert len(depth(device)) == 1
            cable.serving.wanted.add("power_up")
            until(lambda: not cable.serving.wanted)
            time.sleep(0.1)
            for message in ("was reset or lost its power", f"settings of the device are not .*: {FIRST}"):
                with pytest.raises(td.DeviceError, match=message):
                    depth(device)


def test_a_device_that_computes_otherwise(cable: Cable, pipeline: td.Pipeline) -> None:
    cable.serving.device.registers.values["ARITHMETIC"] ^= 1
    with pytest.raises(td.InputError, match=r"computes with other numbers .*: build the device for this calibration"):
        td.Device(cable.address, pipeline)


@pytest.mark.parametrize("table", ["reference", "zero"])
def test_a_capture_of_the_pipeline_after_the_load(
    table: str, cable: Cable, sample: td.Sample, pipeline: td.Pipeline, depth: Depth
) -> None:
    pipeline, other = pipeline.copy(), sample.image if table == "zero" else in_light(sample.reference, 0.9)
    with td.Device(cable.address, pipeline) as device:
        device.load()
        getattr(pipeline, f"capture_{table}")(other)
        with pytest.raises(td.DeviceError, match=rf"the pipeline has another {table} than was loaded: call load\(\)"):
            depth(device)
        getattr(device, f"capture_{table}")(other)
        assert len(depth(device)) == 1
        getattr(device, f"capture_{table}")(sample.reference)
        assert len(depth(device)) == 1
        device.load()
        assert len(depth(device)) == 1


@pytest.mark.parametrize("name", ["DARK_LEVEL", "DEBOUNCE", "MINIMUM_AREA"])
def test_a_setting_that_a_program_left(name: str, cable: Cable, device: td.Device, depth: Depth) -> None:
    device.registers[name] = 40
    with pytest.raises(td.DeviceError, match=rf"\({name}\): {FIRST}"):
        depth(device)
    device.load()
    assert len(depth(device)) == 1
    device.registers[name] = 40
    device.close()
    with td.Device(cable.address, device.pipeline) as opened:
        assert all(frame.contact.touching for frame in depth(opened))
