# SPDX-License-Identifier: Apache-2.0
"""A device in a process of its own, with the model in place of the simulator of the RTL."""

from __future__ import annotations

import os
import signal
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest

import tactile_depth as td
from commands.common.repository import ROOT
from tactile_depth.device import simulator
from tactile_depth.device.line import Line
from tactile_depth.device.simulator import Simulator
from tests.device.cable import setup_of
from tests.device.model_device import Setup

Simulate = Callable[[Setup], None]


@pytest.fixture
def device(steady: td.Pipeline, simulate: Simulate) -> Iterator[td.Device]:
    simulate(setup_of(steady))
    with td.Device("sim", steady) as device:
        device.load()
        yield device


def process_of(device: td.Device) -> int:
    assert isinstance(device._line, Line)
    transport = device._line._transport
    assert isinstance(transport, Simulator)
    assert transport._process is not None
    return transport._process.pid


@pytest.mark.parametrize("address", ["sim", "sim:pins"])
def test_the_same_program_as_on_a_serial_line(
    address: str, pipeline: td.Pipeline, pictures: list[np.ndarray], simulate: Simulate
) -> None:
    simulate(setup_of(pipeline))
    with td.Device(address, pipeline) as device:
        device.load()
        frames = list(device.depth(iter(pictures)))
    for frame, result in zip(frames, pipeline.stream(pictures), strict=True):
        np.testing.assert_array_equal(frame.height_mm, result.height_mm.astype(np.float32))


def test_the_command_gets_the_files_of_the_configuration(
    steady: td.Pipeline, simulate: Simulate, monkeypatch: pytest.MonkeyPatch
) -> None:
    simulate(setup_of(steady))
    model, listed = simulator.command_of, []

    def command_of(folder: Path, pins: bool) -> tuple[list[str], Path]:
        listed.append((pins, sorted(path.name for path in folder.iterdir()), folder))
        return model(folder, pins)

    monkeypatch.setattr(simulator, "command_of", command_of)
    td.Device("sim:pins", steady).close()
    pins, files, folder = listed[0]
    assert pins
    assert {"parameters.json", "gain_0.hex", "polynomial_0.hex", "tactile_depth_tables.h"} <= set(files)
    assert not folder.exists(), "it is removed with the simulator"


def test_the_command_of_the_repository(tmp_path: Path) -> None:
    command, root = simulator.command_of(tmp_path, pins=True)
    assert command == [sys.executable, "-m", "commands.run.device_sim", str(tmp_path), "--pins"]
    assert root == ROOT
    assert simulator.command_of(tmp_path, pins=False)[0] == command[:-1]


def test_another_python_of_a_clone_takes_that_of_make_setup(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(simulator, "find_spec", lambda name: None)
    own = tmp_path / ".venv" / "bin" / "python"
    for path in (tmp_path / "commands" / "run" / "device_sim.py", own):
        path.parent.mkdir(parents=True)
        path.touch()
    monkeypatch.setattr(td, "__file__", str(tmp_path / "models" / "tactile_depth" / "__init__.py"))
    assert simulator.command_of(tmp_path, pins=False)[0][0] == str(own)
    own.unlink()
    with pytest.raises(td.DeviceError, match=r"needs the RTL, .*: clone https://.*, run `make setup` there"):
        simulator.command_of(tmp_path, pins=False)


def test_a_wheel_has_no_simulator(steady: td.Pipeline, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(td, "__file__", str(tmp_path / "lib" / "tactile_depth" / "__init__.py"))
    with pytest.raises(td.DeviceError, match="needs the RTL, which pip does not install: clone https"):
        td.Device("sim", steady)


def test_a_reset(device: td.Device, steady: td.Pipeline, sample: td.Sample) -> None:
    os.kill(process_of(device), signal.SIGUSR1)
    time.sleep(0.3)
    with pytest.raises(td.DeviceError, match=r"was reset .* call load\(\) again"):
        device.status()
    device.load()
    assert device.status().resets == 1
    np.testing.assert_array_equal(next(device.depth([sample.image])).codes, steady(sample.image).codes)


def test_a_simulator_that_ends_is_started_anew(device: td.Device, steady: td.Pipeline, sample: td.Sample) -> None:
    ended = process_of(device)
    os.kill(ended, signal.SIGKILL)
    with pytest.raises(td.DeviceError, match=r"the simulator has ended.*: the next call starts it anew"):
        list(device.depth([sample.image] * 3))
    device.load()
    assert process_of(device) != ended
    np.testing.assert_array_equal(next(device.depth([sample.image])).codes, steady(sample.image).codes)


def test_closing_ends_the_process(device: td.Device) -> None:
    process = process_of(device)
    device.close()
    with pytest.raises(ProcessLookupError):
        os.kill(process, 0)


def test_what_is_said_before_it_is_ready_is_shown(
    steady: td.Pipeline, simulate: Simulate, capfd: pytest.CaptureFixture[str]
) -> None:
    simulate(setup_of(steady, says="building the simulator\n"))
    td.Device("sim", steady).close()
    assert capfd.readouterr().err == "building the simulator\n"


def test_a_simulator_that_does_not_start(steady: td.Pipeline, monkeypatch: pytest.MonkeyPatch) -> None:
    command = [sys.executable, "-c", "raise SystemExit('device_sim: Verilator is missing')"]
    monkeypatch.setattr(simulator, "command_of", lambda folder, pins: (command, ROOT))
    message = r"the simulator does not start \(device_sim: Verilator is missing\): the next call starts it anew"
    with pytest.raises(td.DeviceError, match=message):
        td.Device("sim", steady)


def test_a_simulator_that_hangs(steady: td.Pipeline, monkeypatch: pytest.MonkeyPatch) -> None:
    text = "import sys, time; print('ready', file=sys.stderr, flush=True); time.sleep(60)"
    monkeypatch.setattr(simulator, "command_of", lambda folder, pins: ([sys.executable, "-c", text], ROOT))
    monkeypatch.setattr(simulator, "PACES", {False: simulator.Pace(0.1, 0.3, 0.1)})
    monkeypatch.setattr(simulator, "END_S", 0.2)
    with pytest.raises(td.DeviceError, match=r"the simulator: no answer to a request of its status in 0.3 s"):
        td.Device("sim", steady)
    with pytest.raises(td.DeviceError, match=r"has taken no bytes for 0.3 s"):
        Simulator(steady).write(bytes(1 << 20))
