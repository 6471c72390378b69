# SPDX-License-Identifier: Apache-2.0
"""The device's own camera: captures and frames after a change of tables, light or thresholds."""

from __future__ import annotations

import itertools
import time
from collections.abc import Generator
from typing import Any

import numpy as np
import pytest

import tactile_depth as td
from tactile_depth.chip.registers.axil_registers import GAINS
from tactile_depth.device import exchange, self_test
from tactile_depth.device.line import Line
from tests.device.cable import Cable
from tests.device.conftest import Plug
from tests.device.zynq import on_grid

OTHER_LIGHT = (1.0, 0.8, 0.7)
UNITY = 1 << 15


def film(cable: Cable, pipeline: td.Pipeline, *pictures: np.ndarray) -> None:
    """Let the camera of a device give these pictures again and again."""
    cable.serving.setup.camera = on_grid(pipeline, pictures)


def in_light(picture: np.ndarray, light: float | tuple[float, ...] | np.ndarray) -> np.ndarray:
    return np.rint(picture * np.array(light)).clip(0, 255).astype(np.uint8)


@pytest.mark.filterwarnings("ignore:.*lighting differs", "ignore:the reference is not from")
def test_a_capture_has_the_light_gains_of_the_new_reference(
    pipeline: td.Pipeline, sample: td.Sample, plug: Plug
) -> None:
    cable = plug(pipeline, camera_s=0.01)
    rest = in_light(sample.reference, OTHER_LIGHT)
    film(cable, pipeline, rest)
    with td.Device(cable.address, pipeline) as device:
        device.load()
        for frame in device.depth():
            if frame.light_gains is not None and frame.light_gains[2] > 1.3:
                break
        device.registers["LIGHT.rate"] = 3
        device.capture_reference(frames=2)
        assert [device.registers[name] for name in GAINS] == [UNITY] * 3
        device.capture_zero(frames=2)
        assert device.registers["LIGHT"] == 1 | 3 << 4
    expected = pipeline.copy()
    expected.capture_reference([rest])
    expected.capture_zero([rest])
    np.testing.assert_allclose(cable.serving.device._zero(), expected.zero_codes, atol=0.001 / pipeline.depth_lsb_mm)


def test_a_zero_offset_waits_for_the_light(pipeline: td.Pipeline, sample: td.Sample, plug: Plug) -> None:
    cable = plug(pipeline, camera_s=0.01)
    film(cable, pipeline, sample.reference)
    with td.Device(cable.address, pipeline) as device:
        device.load()
        film(cable, pipeline, in_light(sample.reference, OTHER_LIGHT))
        device.capture_zero(frames=1)
        zero_mm = cable.serving.device._zero() * pipeline.depth_lsb_mm
        assert np.abs(zero_mm).max() < 0.02
        film(cable, pipeline, *(in_light(sample.reference, light) for light in np.linspace(0.8, 1, 50)))
        with pytest.warns(td.InputWarning, match="light of the device's camera does not stand still: switch lamps"):
            device.capture_zero(frames=2)


def test_a_load_sets_the_light_gains_to_one(device: td.Device) -> None:
    for name in GAINS:
        device.registers[name] = 40000
    device.registers["LIGHT"] = 2 << 4
    device.load()
    assert device.registers["LIGHT"] == 1
    assert max(abs(device.registers[name] - UNITY) for name in GAINS) < 16


@pytest.mark.filterwarnings("ignore:the reference is not from")
def test_no_frame_of_before_a_change_of_thresholds(pipeline: td.Pipeline, sample: td.Sample, plug: Plug) -> None:
    cable = plug(pipeline, camera_s=0.005)
    film(cable, pipeline, sample.image)
    with td.Device(cable.address, pipeline) as device:
        device.load()
        frames = device.depth()
        assert isinstance(frames, Generator)
        for touch_mm in (0.1, 1.5) * 3:
            time.sleep(0.05)  # frames wait in the host
            device.set_thresholds(touch_mm)
            assert next(frames).contact.touching == (touch_mm == 0.1)
        frames.close()


@pytest.mark.filterwarnings("ignore:the reference is not from")
@pytest.mark.parametrize("first", [1, (1 << 32) - 2])
def test_frames_of_before_a_call_are_no_lost_ones(
    first: int, pipeline: td.Pipeline, sample: td.Sample, plug: Plug, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Frames in the pipeline have the numbers that follow, modulo 2^32."""
    cable = plug(pipeline, camera_s=0.03)
    with td.Device(cable.address, pipeline) as device:
        device.load()
        cable.serving.device.events.frames = first
        film(cable, pipeline, sample.image)
        next(device.depth())
        last = (device.registers["RECORD_FRAME"] + 2) % (1 << 32)
        monkeypatch.setattr("tactile_depth.device.device.last_begun", lambda line: last)
        frame = next(device.depth())
    assert 0 < (frame.record.frame - last) % (1 << 32) < 10
    assert frame.lost == 0


@pytest.mark.filterwarnings("ignore:the reference is not from")
@pytest.mark.parametrize("is_early", [True, False], ids=["before a frame", "after a frame"])
def test_a_pipeline_that_was_reset_without_its_link(
    is_early: bool, pipeline: td.Pipeline, sample: td.Sample, plug: Plug, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(exchange, "CAMERA_S", 0.1)
    cable = plug(pipeline, camera_s=0.01)
    with td.Device(cable.address, pipeline) as device:
        device.load()
        cable.serving.device.events.frames = 1000
        film(cable, pipeline, sample.image)
        frames = device.depth()
        if is_early:
            monkeypatch.setattr("tactile_depth.device.device.last_begun", lambda line: 1 << 20)
        else:
            next(frames)
            cable.serving.device.events.frames = 0
        with pytest.raises(td.DeviceError, match=r"the device was reset: call load\(\)"):
            list(itertools.islice(frames, 100))
        monkeypatch.undo()
        device.load()
        assert next(device.depth()).contact.touching


@pytest.mark.filterwarnings("ignore:the reference is not from")
@pytest.mark.parametrize(("name", "word"), [("TABLE_COMMIT.zero", 1), ("DEBOUNCE", 40)])
def test_what_another_bus_master_changes_between_frames(
    name: str, word: int, pipeline: td.Pipeline, sample: td.Sample, plug: Plug, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Checks lose no frame, and take the thresholds of this program."""
    monkeypatch.setattr(exchange, "CHECK_S", 0.1)
    cable = plug(pipeline, camera_s=0.05)
    with td.Device(cable.address, pipeline) as device:
        device.load()
        film(cable, pipeline, sample.image)
        frames = device.depth()
        given: list[td.DeviceFrame] = []
        for touch_mm in np.linspace(0.1, 0.2, 10):
            device.set_thresholds(touch_mm)
            given += itertools.islice(frames, 2)
        assert {frame.lost for frame in given} == {0}
        device.registers[name] = word
        with pytest.raises(
            td.DeviceError, match=r"(about to change|not those of this program) .*: call load\(\) first"
        ):
            list(itertools.islice(frames, 100))


def test_frames_in_the_pipeline_are_those_that_came_in(monkeypatch: pytest.MonkeyPatch) -> None:
    words = {"FRAMES_IN": 12, "FRAMES_OUT": 8, "DEPTH_DROPPED": 2, "RECORD_FRAME": (1 << 32) - 1}
    monkeypatch.setattr(exchange, "read_words", lambda line, names: {name: words[name] for name in names})
    line: Any = None
    assert exchange.last_begun(line) == 1
    words["FRAMES_OUT"] = 13  # the counters were cleared meanwhile
    assert exchange.last_begun(line) == exchange.MOST_INSIDE - 1


def test_a_self_test_knows_captures_of_the_camera(pipeline: td.Pipeline, sample: td.Sample, plug: Plug) -> None:
    cable = plug(pipeline, camera_s=0.01)
    redder = np.linspace((1, 1, 1), (1.1, 1, 1), sample.reference.shape[1])
    film(cable, pipeline, in_light(sample.reference, redder))
    with td.Device(cable.address, pipeline) as device:
        device.load()
        device.capture_zero(frames=1)
        assert cable.serving.device._zero().any()
        device.self_test()
        device.capture_reference(frames=2)
        device.self_test()
        assert device._unseen["reference"].entries is not None
        device._unseen["reference"].entries[0] ^= 1 << 6
        with pytest.raises(td.DeviceError, match="computes something else"):
            device.self_test()


def test_settings_that_a_failure_leaves_are_written_anew(
    device: td.Device, sample: td.Sample, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The answer of a self-test gets lost, and so does the write that lets light gains follow again."""
    device.load()
    with monkeypatch.context() as patch:

        def fails(*_: object) -> Any:
            patch.setattr(Line, "write", fails)
            raise td.DeviceError("no answer", remedy="check the cable")

        patch.setattr(self_test, "_awaited", fails)
        with pytest.raises(td.DeviceError, match="no answer"):
            device.self_test()
    assert device.registers["LIGHT"] == 0
    next(iter(device.depth([sample.image])))
    assert device.registers["LIGHT"] == 1
