# SPDX-License-Identifier: Apache-2.0
"""Pipelines, and devices that fit them, for tests of the host's side."""

from __future__ import annotations

import pickle
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest

import tactile_depth as td
from commands.common.repository import ROOT
from tactile_depth.device import line, mapped_words, simulator, uio
from tests.device.cable import Cable, setup_of
from tests.device.model_device import Setup
from tests.device.zynq import Played, Zynq

GRID = (12, 16)
Plug = Callable[..., Cable]
BuildZynq = Callable[..., Zynq]
QUIET_S = line.Line.quiet_s


@pytest.fixture(scope="session")
def sample() -> td.Sample:
    return td.sample("ball")


@pytest.fixture(scope="session")
def pipeline(sample: td.Sample) -> td.Pipeline:
    """Pipeline that all tests use and none changes. Its tables are small: 4,096 entries take most of such a test."""
    return td.Pipeline(sample.sensor, reference=sample.reference, grid=GRID, model="quadratic")


@pytest.fixture(scope="session")
def steady(sample: td.Sample) -> td.Pipeline:
    """Pipeline without light gains: the depth of a picture does not depend on those before it."""
    return td.Pipeline(sample.sensor, reference=sample.reference, grid=GRID, model="quadratic", light_gains=False)


@pytest.fixture(scope="session")
def pictures(sample: td.Sample) -> list[np.ndarray]:
    """Pictures with the contact at several places, uint8 (rows, columns, 3)."""
    return [sample.image, sample.reference, sample.image[:, ::-1].copy()[:, ::-1], sample.image]


@pytest.fixture
def plug(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Plug]:
    """Return a function that plugs a device which fits a pipeline into a serial port of its own."""
    cables: list[Cable] = []

    def plug(pipeline: td.Pipeline | None, **wanted: object) -> Cable:
        if "camera" in wanted:  # a load waits for its pictures
            monkeypatch.setattr(line.Line, "quiet_s", QUIET_S)
        setup = None if pipeline is None else setup_of(pipeline, **wanted)
        cables.append(Cable(tmp_path / f"port{len(cables)}", setup))
        return cables[-1]

    yield plug
    for cable in cables:
        cable.unplug()


@pytest.fixture
def cable(pipeline: td.Pipeline, plug: Plug) -> Cable:
    return plug(pipeline)


@pytest.fixture
def device(cable: Cable, pipeline: td.Pipeline) -> Iterator[td.Device]:
    """Device on the cable with the calibration of the `pipeline` of the test's module."""
    with td.Device(cable.address, pipeline) as device:
        device.load()
        yield device


@pytest.fixture
def simulate(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[[Setup], None]:
    """Return a function after which `sim` starts the model of a device in place of the simulator of the RTL."""

    def simulate(setup: Setup) -> None:
        file = tmp_path / "setup"
        file.write_bytes(pickle.dumps(setup))
        command = [sys.executable, "-m", "tests.device.model_device", str(file)]
        monkeypatch.setattr(simulator, "command_of", lambda folder, pins: (command, ROOT))

    return simulate


@pytest.fixture(autouse=True)
def no_camera(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let a load send its picture at once: few devices of these tests have a camera; see `plug`."""
    monkeypatch.setattr(line.Line, "quiet_s", 0.02)


@pytest.fixture
def build_zynq(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[BuildZynq]:
    """Return a function that builds a Zynq for a pipeline."""
    built: list[Zynq] = []
    monkeypatch.setattr(uio, "MappedWords", Played)
    monkeypatch.setattr(uio, "POLL_S", 0.0002)

    def build(pipeline: td.Pipeline, stores: int = 3) -> Zynq:
        zynq = Zynq(tmp_path / f"zynq{len(built)}", setup_of(pipeline), stores)
        monkeypatch.setattr(mapped_words, "SYSFS", zynq.folder / "class")
        built.append(zynq)
        return zynq

    yield build
    for zynq in built:
        zynq.close()


@pytest.fixture
def zynq(build_zynq: BuildZynq, steady: td.Pipeline) -> Zynq:
    """Zynq with the tables and the threshold of a pipeline."""
    zynq = build_zynq(steady)
    zynq.load(steady)
    return zynq
