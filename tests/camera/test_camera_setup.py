# SPDX-License-Identifier: Apache-2.0
"""camera_setup: RTL against the model, and the lists against the data sheets of the cameras."""

import pytest

from tactile_depth.base.errors import InputError
from tactile_depth.chip.camera.camera_setup import CameraSetup, Kind
from tactile_depth.chip.camera.register_lists import (
    CAMERAS,
    OV5640_LINE,
    OV5640_LINES,
    Camera,
    ov5640,
    ov7725,
)
from tb.camera.sccb_camera import SccbCamera

XCLK_HZ = 24e6


@pytest.mark.parametrize("name", list(CAMERAS))
def test_a_camera_gets_its_list(name: str) -> None:
    """Play every entry of the list with the model of the core and a model of the camera."""
    camera = CAMERAS[name]()
    core = CameraSetup(camera.entries, camera.address_bytes, camera.device_id, quarter_clocks=4, millisecond_clocks=2)
    checks = {entry.address: entry.data for entry in camera.entries if entry.kind == Kind.CHECK}
    device = SccbCamera(camera.device_id, camera.address_bytes, dict(checks))
    sio_d = 1
    while core.state not in ("done", "failed"):
        core.clock(sio_d=sio_d)
        sio_c, low = core.levels
        sio_d = int(not low) & device.follow(int(sio_c), int(not low) & device.line)
    assert core.state == "done"
    assert device.registers == checks | last_values(camera)


def last_values(camera: Camera) -> dict[int, int]:
    return {entry.address: entry.data for entry in camera.entries if entry.kind in (Kind.WRITE, Kind.PLAIN_WRITE)}


@pytest.mark.parametrize("name", list(CAMERAS))
def test_no_register_is_written_twice_but_for_the_reset(name: str) -> None:
    written = [entry.address for entry in CAMERAS[name]().entries if entry.kind == Kind.WRITE]
    again = {address for address in written if written.count(address) > 1}
    assert again <= {0x3008}  # the OV5640 sleeps, and wakes up


@pytest.mark.parametrize("name", list(CAMERAS))
def test_the_product_is_checked_before_anything_is_written(name: str) -> None:
    kinds = [entry.kind for entry in CAMERAS[name]().entries]
    assert kinds[:6] == [Kind.PINS] * 3 + [Kind.CHECK] * 2 + [Kind.PLAIN_WRITE]


def test_frames_per_second_of_the_ov7725() -> None:
    """Compute the rate by the data sheet: pixel clock, 748 of its cycles per line, 510 lines per frame."""
    registers = last_values(ov7725())
    multiplier = (1, 4, 6, 8)[registers[0x0D] >> 6]
    clock = XCLK_HZ * multiplier / (2 * ((registers[0x11] & 0x3F) + 1))
    assert clock / (748 * 510) == pytest.approx(ov7725().frames_per_s, rel=0.06)


def test_frames_per_second_of_the_ov5640() -> None:
    """Compute the rate from XCLK / front divider x multiplier / system divider / root divider / bits / 2."""
    registers = last_values(ov5640())
    front, root = registers[0x3037] & 0xF, (registers[0x3037] >> 4 & 1) + 1
    clock = XCLK_HZ / front * registers[0x3036] / (registers[0x3035] >> 4) / root / 2 / 2
    assert 500e6 <= XCLK_HZ / front * registers[0x3036] <= 1000e6
    assert clock / (OV5640_LINE * OV5640_LINES) == pytest.approx(ov5640().frames_per_s, rel=0.01)


@pytest.mark.parametrize("name", list(CAMERAS))
@pytest.mark.parametrize("lines", [0, 1000])
def test_an_exposure_beyond_a_frame_is_refused(name: str, lines: int) -> None:
    with pytest.raises(InputError, match="exposure_lines="):
        CAMERAS[name](lines)
