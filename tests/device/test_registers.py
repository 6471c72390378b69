# SPDX-License-Identifier: Apache-2.0
"""Registers of a device by name."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

import tactile_depth as td
from tactile_depth.chip.registers.register_map import REGISTERS
from tests.device.cable import Cable, setup_of
from tests.device.conftest import GRID


@pytest.fixture(scope="module")
def device(steady: td.Pipeline, tmp_path_factory: pytest.TempPathFactory) -> Iterator[td.Device]:
    cable = Cable(tmp_path_factory.mktemp("registers") / "port", setup_of(steady))
    with td.Device(cable.address, steady) as device:
        yield device
    cable.unplug()


def test_names(device: td.Device) -> None:
    assert list(device.registers) == list(REGISTERS)
    assert len(device.registers) == len(REGISTERS)
    assert "FRAMES_OUT" in device.registers
    assert "CONTROL.hold_contact" in device.registers
    assert "FRAME" not in device.registers
    assert "CONTROL.hold" not in device.registers
    assert 3 not in device.registers  # type: ignore[comparison-overlap]
    assert repr(device.registers) == f"Registers({len(REGISTERS)})"


def test_words_and_fields(device: td.Device) -> None:
    rows, columns = GRID
    assert device.registers["ID"] == 0x54444550
    assert device.registers["GRID"] == columns << 16 | rows
    assert (device.registers["GRID.rows"], device.registers["GRID.columns"]) == GRID
    assert device.registers["DEPTH_UNIT.exponent"] < 0, "a field with a sign"


@pytest.mark.parametrize("value", [0, 5, -1, -1 << 31, (1 << 31) - 1])
def test_a_value_with_a_sign(value: int, device: td.Device) -> None:
    device.registers["THRESHOLD"] = value
    assert device.registers["THRESHOLD"] == value


def test_a_field_leaves_the_others(device: td.Device) -> None:
    device.registers["LIGHT"] = 1 | 3 << 4
    device.registers["LIGHT.follow"] = False
    assert (device.registers["LIGHT.follow"], device.registers["LIGHT.rate"]) == (0, 3)
    device.registers["CONTROL.hold_contact"] = 1
    device.registers["CONTROL.clear_counters"] = 1
    assert device.registers["CONTROL"] == 1, "a pulse is not written again"
    device.registers["CONTROL"] = 0


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("FRAME_OUT", "register=FRAME_OUT is unknown: accepted are FRAMES_OUT"),
        ("frames_out", "register=frames_out is unknown: accepted are ID, GRID, "),
        ("CONTROL.hold", "register=CONTROL.hold is unknown: accepted are CONTROL.hold_contact, "),
        (3, "register=3 is unknown"),
    ],
)
def test_unknown_names(name: str, message: str, device: td.Device) -> None:
    with pytest.raises(td.InputError, match=message):
        device.registers[name]
    with pytest.raises(td.InputError, match=message):
        device.registers[name] = 1


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("DEBOUNCE", 256, "DEBOUNCE=256: accepted is a whole number, 0 to 255"),
        ("THRESHOLD", 1 << 31, "THRESHOLD=2147483648"),
        ("THRESHOLD", 0.5, "THRESHOLD=0.5"),
        ("LIGHT.rate", 8, "LIGHT.rate=8: accepted is a whole number, 0 to 7"),
        ("CONTROL", -1, "CONTROL=-1"),
        ("FRAMES_OUT", 1, "FRAMES_OUT=1: the register is read-only"),
        ("STATUS.busy", 1, "STATUS.busy=1: the register is read-only"),
    ],
)
def test_values_that_are_refused(name: str, value: int, message: str, device: td.Device) -> None:
    with pytest.raises(td.InputError, match=message):
        device.registers[name] = value


def test_a_register_cannot_be_deleted(device: td.Device) -> None:
    with pytest.raises(td.InputError):
        del device.registers["THRESHOLD"]


def test_accesses_that_the_device_refuses(device: td.Device) -> None:
    device.registers["TABLE_SELECT"] = 3
    device.registers["TABLE_INDEX"] = (1 << 12) - 1
    with pytest.raises(td.DeviceError, match="the device refuses to write TABLE_LOW"):
        device.registers["TABLE_LOW"] = 1
    with pytest.raises(td.DeviceError, match="the device refuses to read TABLE_LOW"):
        device.registers["TABLE_LOW"]
    device.registers["TABLE_INDEX"] = 0
    assert device.registers["TABLE_LOW"] == 0
