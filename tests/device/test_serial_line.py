# SPDX-License-Identifier: Apache-2.0
"""A device on a serial line that breaks, is noisy, or is none: one line says what happened, and the next call works."""

from __future__ import annotations

import argparse
import builtins
import itertools
import re
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import serial.tools.list_ports

import tactile_depth as td
from tactile_depth.chip.link.framing import to_line
from tactile_depth.chip.link.packets import VERSION, Status
from tactile_depth.device import line, serial_line
from tactile_depth.device.addresses import open_transport
from tests.device.cable import Cable
from tests.device.conftest import GRID, Plug

RESET = "the device was reset or lost its power: its settings are those of power-up: call load() again"


@pytest.fixture
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let devices that do not answer be given up soon."""
    monkeypatch.setattr(serial_line, "LIMIT_S", 0.3)


def until(reached: Callable[[], bool]) -> None:
    """Wait for what a thread does."""
    end = time.monotonic() + 10
    while not reached():
        assert time.monotonic() < end
        time.sleep(0.005)


def require_one_error(call: Callable[[], Any], message: str) -> None:
    """Require that a call fails with one line, and that it then works."""
    with pytest.raises(td.DeviceError) as caught:
        call()
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)
    call()


@pytest.mark.parametrize("loss", ["reset", "power_up"])
@pytest.mark.parametrize("call", ["status", "register", "depth", "load"])
def test_a_reset(loss: str, call: str, steady: td.Pipeline, sample: td.Sample, plug: Plug) -> None:
    cable = plug(steady)
    with td.Device(cable.address, steady) as device:
        calls: dict[str, Callable[[], Any]] = {
            "status": device.status,
            "register": lambda: device.registers["STATUS"],
            "depth": lambda: list(device.depth([sample.image])),
            "load": device.load,
        }
        device.load()
        cable.serving.wanted.add(loss)
        until(lambda: not cable.serving.wanted)
        until(lambda: isinstance(device._line, line.Line) and device._line._trouble is not None)
        if call == "depth":
            with pytest.raises(td.DeviceError, match=re.escape(RESET)):
                calls[call]()
            with pytest.raises(
                td.DeviceError, match=r"(settings|tables) of the device are not those .*: call load\(\) first"
            ):
                calls[call]()
        else:
            require_one_error(calls[call], RESET)
        device.load()
        frame = next(device.depth([sample.image]))
    np.testing.assert_array_equal(frame.codes, steady(sample.image).codes)


def test_a_reset_while_a_picture_is_on_its_way(steady: td.Pipeline, sample: td.Sample, plug: Plug) -> None:
    cable = plug(steady)
    with td.Device(cable.address, steady) as device:
        device.load()
        frames = device.depth(itertools.repeat(sample.image))
        next(frames)
        cable.serving.wanted.add("reset")
        with pytest.raises(td.DeviceError, match="was reset"):
            list(itertools.islice(frames, 1000))
        device.load()
        assert device.status().resets == 1
        np.testing.assert_array_equal(next(device.depth([sample.image])).codes, steady(sample.image).codes)


def test_an_unplugged_cable(steady: td.Pipeline, sample: td.Sample, plug: Plug) -> None:
    cable = plug(steady)
    with td.Device(cable.address, steady) as device:
        device.load()
        cable.unplug()
        with pytest.raises(td.DeviceError, match=r"is gone: plug the device in again, then call load\(\)"):
            device.status()
        with pytest.raises(td.InputError, match="there is no such port"):
            device.status()
        cable.plug()
        device.load()
        np.testing.assert_array_equal(next(device.depth([sample.image])).codes, steady(sample.image).codes)


def test_a_cable_that_is_unplugged_between_frames(steady: td.Pipeline, sample: td.Sample, plug: Plug) -> None:
    cable = plug(steady)
    with td.Device(cable.address, steady) as device:
        device.load()
        frames = device.depth([sample.image] * 3)
        assert next(frames).picture == 0
        cable.unplug()
        with pytest.raises(td.DeviceError, match="is gone"):
            next(frames)
        cable.plug()
        device.load()


def test_a_device_that_falls_silent(
    steady: td.Pipeline, sample: td.Sample, plug: Plug, quick: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    cable = plug(steady)
    with td.Device(cable.address, steady) as device:
        device.load()
        receive = cable.serving._receive
        monkeypatch.setattr(cable.serving, "_receive", lambda data: None)
        for call in (device.status, lambda: next(device.depth([sample.image]))):
            with pytest.raises(td.DeviceError, match=r"no answer to .* in 0.3 s: nothing came: "):
                call()
        monkeypatch.setattr(cable.serving, "_receive", receive)
        np.testing.assert_array_equal(next(device.depth([sample.image])).codes, steady(sample.image).codes)


def test_garbage_in_place_of_an_answer(
    steady: td.Pipeline, plug: Plug, quick: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    cable = plug(steady)
    with td.Device(cable.address, steady) as device:
        send = cable.serving._send
        monkeypatch.setattr(cable.serving, "_send", lambda data: send(b"\0\1\2garbage\0"))
        with pytest.raises(td.DeviceError, match=r"no answer to a request of its status .* with \d+ broken packets?"):
            device.status()
        monkeypatch.undo()
        assert device.status().bad_packets > 0


def test_a_line_that_loses_every_depth(
    steady: td.Pipeline, sample: td.Sample, plug: Plug, quick: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    cable = plug(steady)
    with td.Device(cable.address, steady) as device:
        device.load()
        monkeypatch.setattr(cable.serving, "_damaged", lambda packet: packet if len(packet) < 300 else b"")
        with pytest.raises(
            td.DeviceError,
            match=r"5 pictures in a row gave no depth: 0 broken packets .*: call depth\(\) without pictures",
        ):
            list(device.depth([sample.image] * 9))
        monkeypatch.undo()
        assert device.status().lost == 5


@pytest.mark.parametrize("damage", [{"drop": 0.03}, {"flip": 0.05}, {"double": 0.05}, {"drop": 0.02, "flip": 0.02}])
def test_a_noisy_line(damage: dict[str, float], steady: td.Pipeline, sample: td.Sample, plug: Plug) -> None:
    """No wrong frame comes, and each one that is missing is counted."""
    generator = np.random.default_rng(3)
    pictures = [np.roll(sample.image, shift, axis=1) for shift in generator.integers(0, 40, 60)]
    expected = steady(np.stack(pictures)).codes
    cable = plug(steady)
    frames: list[td.DeviceFrame] = []
    sent = 0
    with td.Device(cable.address, steady) as device:
        device.load()
        cable.setup.damage.update(damage)  # type: ignore[union-attr]
        while not device.status().lost:  # one time in a hundred the line loses none of these pictures
            frames += device.depth(pictures)
            sent += len(pictures)
        cable.setup.damage.clear()  # type: ignore[union-attr]
        status = device.status()
    for frame in frames:
        np.testing.assert_array_equal(frame.codes, expected[frame.picture])
    assert len(frames) + status.lost == sent
    assert frames[-1].lost <= status.lost


def test_tables_and_captures_over_a_noisy_line(steady: td.Pipeline, sample: td.Sample, plug: Plug) -> None:
    cable = plug(steady, damage={"drop": 0.015, "flip": 0.01, "double": 0.01})  # three captures in a row seldom fail
    with td.Device(cable.address, steady) as device:
        device.load()
        device.capture_reference([sample.reference] * 4)
        device.capture_zero([sample.reference] * 2)
        cable.setup.damage.clear()  # type: ignore[union-attr]
        frame = next(device.depth([sample.image]))
    expected = td.Pipeline(sample.sensor, reference=sample.reference, grid=GRID, light_gains=False)
    expected.capture_reference([sample.reference] * 4)
    expected.capture_zero([sample.reference] * 2)
    np.testing.assert_array_equal(frame.codes, expected(sample.image).codes)


def test_frames_that_the_program_does_not_take_are_counted(steady: td.Pipeline, plug: Plug) -> None:
    cable = plug(steady, camera=steady.sensor.reference, camera_s=0.002)
    with td.Device(cable.address, steady) as device:
        device.load()
        frames = device.depth()
        first = next(frames)
        sent = cable.serving.device.link.sent
        until(lambda: cable.serving.device.link.sent > sent + 20)
        rest = list(itertools.islice(frames, 2 * line.KEPT))
    assert rest[-1].lost > 0
    assert rest[-1].number - first.number == len(rest) + rest[-1].lost - first.lost


# Opening.


def test_no_such_port(steady: td.Pipeline, tmp_path: Path) -> None:
    with pytest.raises(td.InputError, match=f"address=serial:{tmp_path}/none: there is no such port: "):
        td.Device(f"serial:{tmp_path}/none", steady)


def test_a_system_that_does_not_set_the_latency_of_an_adapter(
    steady: td.Pipeline, plug: Plug, monkeypatch: pytest.MonkeyPatch
) -> None:
    cable = plug(steady)
    monkeypatch.setattr(serial_line, "sys", argparse.Namespace(platform="win32"))
    with pytest.warns(td.InputWarning, match="hold bytes back for 16 ms, .*: set its latency timer to 1 ms"):
        td.Device(cable.address, steady).close()


def test_a_port_in_use(steady: td.Pipeline, plug: Plug) -> None:
    cable = plug(steady)
    with td.Device(cable.address, steady), pytest.raises(td.DeviceError, match="is in use by another program"):
        td.Device(cable.address, steady)
    td.Device(cable.address, steady).close()


def test_a_file_is_no_port(steady: td.Pipeline, tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    with pytest.raises(td.DeviceError, match="cannot be opened"):
        td.Device(f"serial:{tmp_path}/file", steady)


def test_nothing_at_the_other_end(steady: td.Pipeline, plug: Plug, quick: None) -> None:
    cable = plug(None)
    message = r"at 115200 baud: no answer to a request of its status in .* s: nothing came: give serial:.*@BAUD if"
    with pytest.raises(td.DeviceError, match=message):
        td.Device(f"{cable.address}@115200", steady)


def test_another_baud_rate(steady: td.Pipeline, plug: Plug, quick: None) -> None:
    cable, generator = plug(None), np.random.default_rng(5)
    cable.answer(lambda data: generator.bytes(40))
    message = r"\d+ bytes? came, with \d+ broken packets?: give serial:.*@BAUD if the device has another baud rate"
    with pytest.raises(td.DeviceError, match=message):
        td.Device(cable.address, steady)


@pytest.mark.parametrize("version", [VERSION - 1, VERSION + 1], ids=["older device", "older host"])
def test_another_version_of_the_link(version: int, steady: td.Pipeline, plug: Plug) -> None:
    status = bytearray(Status(0, *GRID, 24, True, False, 1, 8, 0, 0, 0).pack())  # type: ignore[arg-type]
    status[1] = version
    cable = plug(None)
    cable.answer(lambda data: to_line(bytes(status)) if data else b"")
    text = f"the device speaks version {version} of the link: accepted is {VERSION}: install"
    with pytest.raises(td.InputError, match=text):
        td.Device(cable.address, steady)


def test_another_core_at_the_registers(steady: td.Pipeline, plug: Plug) -> None:
    cable = plug(steady)
    cable.serving.device.registers.values["ID"] = 0x1234
    with pytest.raises(td.DeviceError, match="the device has another ID, 0x00001234"):
        td.Device(cable.address, steady)


def test_pyserial_is_missing(steady: td.Pipeline, monkeypatch: pytest.MonkeyPatch) -> None:
    load = builtins.__import__

    def without(name: str, *more: Any) -> Any:
        if name.startswith("serial"):
            raise ImportError(name)
        return load(name, *more)

    monkeypatch.setattr(builtins, "__import__", without)
    with pytest.raises(
        td.DeviceError, match=r'pyserial: run pip install "tactile-depth\[serial\]", in a clone "\.\[serial\]"$'
    ):
        td.Device("/dev/ttyUSB0", steady)


class Port:
    """USB port as pyserial lists it."""

    def __init__(self, device: str, serial_number: str | None) -> None:
        self.device, self.serial_number = device, serial_number

    def __lt__(self, other: Port) -> bool:
        return self.device < other.device


@pytest.fixture
def ports(plug: Plug, steady: td.Pipeline, monkeypatch: pytest.MonkeyPatch) -> Cable:
    """Plug in a device with the serial number D1, two ports with the number D2, and one without."""
    cable = plug(steady)
    listed = [Port(str(cable.path), "D1"), Port("/dev/ttyUSB8", "D2"), Port("/dev/ttyUSB7", "D2")]
    listed.append(Port("/dev/ttyS0", None))
    monkeypatch.setattr(serial.tools.list_ports, "comports", lambda: listed)
    return cable


def test_a_serial_number_names_a_port(ports: Cable, steady: td.Pipeline) -> None:
    with td.Device("serial:D1@921600", steady) as device:
        assert device.status().rows == GRID[0]


def test_serial_numbers_that_name_no_single_port(ports: Cable, steady: td.Pipeline) -> None:
    with pytest.raises(td.InputError, match="several ports: accepted are serial:/dev/ttyUSB7, serial:/dev/ttyUSB8"):
        td.Device("serial:D2", steady)
    with pytest.raises(td.InputError, match=r"of no port: plugged in with a number are /dev/ttyUSB7 \(D2\), "):
        td.Device("serial:D3", steady)


@pytest.mark.parametrize(
    "address",
    [
        "",
        "serial:",
        "usb:1",
        "sim:pin",
        "tcp:localhost",
        "serial:/dev/ttyUSB0@",
        "serial:/dev/ttyUSB0@fast",
        "serial:@9",
    ],
)
def test_addresses_that_are_refused(address: str, steady: td.Pipeline) -> None:
    with pytest.raises(td.InputError) as caught:
        td.Device(address, steady)
    assert caught.value.argument == "address"
    assert "accepted" in str(caught.value)


def test_a_path_is_a_serial_line(steady: td.Pipeline, monkeypatch: pytest.MonkeyPatch) -> None:
    opened = []

    def opens(path: str, baud: int) -> None:
        opened.append((path, baud))

    monkeypatch.setattr("tactile_depth.device.addresses.SerialLine", opens)
    for address in ("/dev/ttyUSB0", "serial:/dev/ttyUSB0", "serial:COM3@9600", "/dev/serial/by-id/a@b@57600"):
        open_transport(address, steady)
    assert opened == [
        *(("/dev/ttyUSB0", 3_000_000), ("/dev/ttyUSB0", 3_000_000)),
        *(("COM3", 9600), ("/dev/serial/by-id/a@b", 57600)),
    ]


def test_the_line_of_a_slow_port(plug: Plug, steady: td.Pipeline) -> None:
    """A reply may wait for a packet of depth, which takes long on a slow line."""
    with_pace = serial_line.SerialLine(str(plug(None).path), 9600)
    assert with_pace.pace.repeat_s > 1400 * 10 / 9600
    with_pace.close()
    assert replace(with_pace.pace, byte_s=0.0) != with_pace.pace
