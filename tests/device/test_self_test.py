# SPDX-License-Identifier: Apache-2.0
"""Self-test of a device on a host: it finds an entry that differs, and leaves the device as it was."""

from __future__ import annotations

import pytest

import tactile_depth as td
from tactile_depth.chip.gradient.polynomial_gradient import correction_codes
from tactile_depth.chip.limits import CORRECTION_BITS, RATIO
from tactile_depth.chip.registers.register_map import TABLES
from tactile_depth.chip.video.test_picture import picture
from tactile_depth.device import self_test
from tests.device.cable import Cable
from tests.device.conftest import GRID, Plug


def bin_of_first_pixel(pipeline: td.Pipeline) -> int:
    """Return the entry of the table of colours that the first pixel of the picture reads."""
    tables, frame = pipeline.twin.tables, picture(*GRID)
    assert tables.gains is not None
    if pipeline.config.polynomials:
        colours = correction_codes(tables.gains.ratios(frame) - (1 << RATIO.fraction))
    else:
        colours = tables.gains.codes(frame)
    bits = CORRECTION_BITS if pipeline.config.polynomials else pipeline.config.bits_per_channel
    red, green, blue = (colours[0, 0].astype(int) >> 8 - bits).tolist()
    return (red << bits | green) << bits | blue


@pytest.mark.parametrize("choices", [{}, {"model": "lut"}, {"model": "quadratic", "light_gains": False}])
def test_an_entry_that_differs_is_found(sample: td.Sample, plug: Plug, choices: dict) -> None:
    pipeline = td.Pipeline(sample.sensor, reference=sample.reference, grid=GRID, **choices)
    read = {"coefficients": 6, "gradient": bin_of_first_pixel(pipeline)}
    cable = plug(pipeline)
    with td.Device(cable.address, pipeline) as device:
        with pytest.raises(td.DeviceError, match=r"call load\(\)"):
            device.self_test()
        device.load()
        device.self_test()
        model = cable.serving.device
        for name, banks in model.tables.items():
            entry = banks[model.registers.banks.bank >> TABLES[name] & 1][read.get(name, 0)]
            bit = 1 << (6 if name == "gradient" else 18)
            entry[0] ^= bit
            with pytest.raises(td.DeviceError, match="computes something else"):
                device.self_test()
            entry[0] ^= bit
        device.self_test()


def test_light_gains_and_settings_stay(device: td.Device, sample: td.Sample) -> None:
    device.registers["LIGHT_GAIN_RED"] = 0x7123
    device.registers["CONTROL.drop_frames"] = 1
    before = {name: device.registers[name] for name in ("LIGHT", "LIGHT_GAIN_RED", "LIGHT_GAIN_BLUE", "CONTROL")}
    device.self_test()
    assert {name: device.registers[name] for name in before} == before
    (frame,) = device.depth(sample.image)
    assert frame.contact.touching


def test_captures_are_known(device: td.Device, sample: td.Sample) -> None:
    device.capture_reference(sample.reference)
    device.self_test()


def test_a_picture_that_does_not_come_through(device: td.Device, cable: Cable, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tests.device.model_device.self_test", lambda *_: 0)
    monkeypatch.setattr(self_test, "CAMERA_S", 0.0)
    with pytest.raises(td.DeviceError, match=r"has not come through in .*: let the camera end its frame"):
        device.self_test()
