# SPDX-License-Identifier: Apache-2.0
"""Files of a device on a Zynq: opened, closed, and refused in one line where they are not what they should be."""

from __future__ import annotations

import os
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import tactile_depth as td
from tactile_depth.chip.contact.frame_flags import FLAG_WORDS
from tactile_depth.chip.registers.axil_registers import RECORD
from tactile_depth.chip.registers.register_map import REGISTERS
from tactile_depth.device import frame_stores, mapped_words, vdma
from tests.device.conftest import BuildZynq
from tests.device.zynq import PHYSICAL, Zynq


def test_the_vdma_stops_with_the_device(zynq: Zynq, steady: td.Pipeline) -> None:
    with td.Device(zynq.address, steady) as device:
        assert zynq.dma.runs
        with pytest.raises(td.DeviceError, match=r"uio0 is in use by another program, or opened twice: close"):
            td.Device(zynq.address, steady)
        assert zynq.dma.runs
    assert not zynq.dma.runs
    assert device._line is None
    with td.Device(zynq.address, steady) as device:
        channel = device._line
        assert channel is not None
    with pytest.raises(td.DeviceError, match="uio0 is closed"):
        channel.read([0])
    channel.close()


def test_a_bare_uio_has_the_usual_files(steady: td.Pipeline, monkeypatch: pytest.MonkeyPatch) -> None:
    opened: list[str] = []

    def refuse(path: str, flags: int) -> int:
        opened.append(path)
        raise FileNotFoundError(2, "No such file or directory")

    monkeypatch.setattr(os, "open", refuse)
    with pytest.raises(td.InputError, match="address=/dev/uio0: there is no such file for the registers of the device"):
        td.Device("uio", steady)
    assert opened == ["/dev/uio0"]


@pytest.mark.parametrize("files", ["", "/dev/uio0", "/dev/uio0,/dev/uio1", "a,,c", "a,b,c,d"])
def test_addresses_that_do_not_name_three_files(files: str, steady: td.Pipeline) -> None:
    problem = f"address=uio:{files} does not name three files: accepted are uio, uio:/dev/uio0,/dev/uio1,/dev/udmabuf0"
    with pytest.raises(td.InputError, match=re.escape(problem)):
        td.Device(f"uio:{files}", steady)


def _without_buffer(zynq: Zynq) -> None:
    zynq.buffer.unlink()


def _small_buffer(zynq: Zynq) -> None:
    zynq.says("u-dma-buf", size="1024")


def _small_file(zynq: Zynq) -> None:
    zynq.buffer.write_bytes(bytes(1000))


def _small_region(zynq: Zynq) -> None:
    zynq.says("uio", "uio1", maps__map0__size="0x40")


def _not_said(zynq: Zynq) -> None:
    (zynq.folder / "class/u-dma-buf/udmabuf0/phys_addr").unlink()


def _far(zynq: Zynq) -> None:
    zynq.says("u-dma-buf", phys_addr="0x100000000")


def _odd_id(zynq: Zynq) -> None:
    zynq.model.registers.values["ID"] = 0xFFFF_FFFF


def _odd_grid(zynq: Zynq) -> None:
    zynq.model.registers.values["GRID"] = 0xFFFF_FFFF


def _odd_format(zynq: Zynq) -> None:
    zynq.model.registers.values["FORMAT"] = 0


def _older(zynq: Zynq) -> None:
    zynq.model.registers.values["DEVICE"] &= ~REGISTERS["DEVICE"].field("version").mask
    zynq.model.later = tuple(REGISTERS[name].offset for name in RECORD[-FLAG_WORDS:])


def _other_build(zynq: Zynq) -> None:
    zynq.model.registers.values["DEPTH_UNIT"] ^= 1


def _other_grid(zynq: Zynq) -> None:
    zynq.model.registers.values["GRID"] = 8 << 16 | 8


def _no_clock(zynq: Zynq) -> None:
    zynq.dma.stuck[vdma.CONTROL] = vdma.RESET


def _does_not_start(zynq: Zynq) -> None:
    zynq.dma.stuck[vdma.STATUS] = vdma.HALTED


def _no_vdma(zynq: Zynq) -> None:
    zynq.dma.stuck[vdma.START_ADDRESSES[1]] = 0


@pytest.mark.parametrize(
    ("spoil", "kind", "message"),
    [
        (_without_buffer, td.InputError, "udmabuf0: there is no such file for a buffer of 3 frames: load its driver"),
        (_small_buffer, td.DeviceError, "udmabuf0 has 1024 bytes, but a buffer of 3 frames needs 2304: give files in"),
        (_small_file, td.DeviceError, "udmabuf0 has 1000 bytes, but a buffer of 3 frames needs 2304"),
        (_small_region, td.DeviceError, "uio1 has 64 bytes, but the registers of the VDMA needs 188"),
        (_not_said, td.DeviceError, "phys_addr does not say where .*udmabuf0 lies: give a buffer of the driver u-dma"),
        (_far, td.DeviceError, "udmabuf0 lies at 0x100000000, beyond 32 bits: reserve memory for it below 4 GiB"),
        (_odd_id, td.DeviceError, "uio0 has the ID 0xffffffff, and no tactile_depth: give its registers first"),
        (_odd_grid, td.DeviceError, "uio0 reads GRID 0xffffffff and FORMAT .*: check its address in the device tree"),
        (_odd_format, td.DeviceError, "uio0 reads GRID 0x0010000c and FORMAT 0x00000000: check its address"),
        (
            _older,
            td.InputError,
            "uio0 has version 0 of the registers: accepted is 1: install a version of tactile-depth",
        ),
        (_other_build, td.InputError, "the device has another configuration: DEPTH_UNIT.mantissa is"),
        (_other_grid, td.InputError, r"grid=\(12, 16\), but the device has \(8, 8\), rows and columns"),
        (_no_clock, td.DeviceError, "uio1: the VDMA does not come out of its reset: give an AXI VDMA whose clocks run"),
        (_does_not_start, td.DeviceError, "uio1: the VDMA does not start: give an AXI VDMA whose clocks run"),
        (_no_vdma, td.DeviceError, "uio1 does not hold the addresses of three frame stores: give an AXI VDMA with"),
    ],
)
def test_what_cannot_be_used(
    spoil: Callable[[Zynq], None], kind: type[Exception], message: str, zynq: Zynq, steady: td.Pipeline
) -> None:
    spoil(zynq)
    with pytest.raises(kind, match=message) as caught:
        td.Device(zynq.address, steady)
    assert "\n" not in str(caught.value)
    assert not zynq.dma.runs
    spoiled = {str(zynq.registers), str(zynq.vdma), str(zynq.buffer)}
    assert not [path for path in map(_target, Path("/proc/self/fd").iterdir()) if path in spoiled], "files stay open"


def _target(link: Path) -> str:
    try:
        return os.readlink(link)
    except OSError:
        return ""


def test_registers_and_vdma_exchanged(zynq: Zynq, steady: td.Pipeline) -> None:
    with pytest.raises(td.DeviceError, match="uio1 has the ID 0x00000000, and no tactile_depth: give its registers"):
        td.Device(f"uio:{zynq.vdma},{zynq.registers},{zynq.buffer}", steady)


def test_a_vdma_with_more_stores(build_zynq: BuildZynq, steady: td.Pipeline) -> None:
    with pytest.raises(td.DeviceError, match="uio1 has more than three frame stores, or addresses of more than 32"):
        td.Device(build_zynq(steady, stores=4).address, steady)


@pytest.mark.parametrize(
    ("error", "message"),
    [
        (PermissionError(13, "Permission denied"), "udmabuf0 may not be opened by this user: give this user the right"),
        (OSError(16, "Device or resource busy"), "udmabuf0 is in use by another program, or opened twice: close"),
        (OSError(5, "Input/output error"), r"udmabuf0 cannot be mapped as a buffer of 3 frames \(Input/output error\)"),
    ],
)
def test_a_file_that_cannot_be_opened(
    error: OSError, message: str, zynq: Zynq, steady: td.Pipeline, monkeypatch: pytest.MonkeyPatch
) -> None:
    real = os.open

    def refuse(path: Any, *arguments: Any, **named: Any) -> int:
        if str(path) == str(zynq.buffer):
            raise error
        return real(path, *arguments, **named)

    monkeypatch.setattr(os, "open", refuse)
    with pytest.raises(td.DeviceError, match=message):
        td.Device(zynq.address, steady)


def test_a_buffer_that_may_not_be_copied(zynq: Zynq, steady: td.Pipeline, monkeypatch: pytest.MonkeyPatch) -> None:
    zynq.says("u-dma-buf", sync_mode="1\n")
    monkeypatch.setattr(frame_stores.platform, "machine", lambda: "aarch64")
    with pytest.raises(td.DeviceError, match=r"udmabuf0 has sync_mode 1: .* bus error on this processor: write 2 to"):
        td.Device(zynq.address, steady)


def test_a_driver_of_before(zynq: Zynq, steady: td.Pipeline) -> None:
    """Before version 2.0 the class of the buffer in sysfs had another name."""
    (zynq.folder / "class/u-dma-buf").rename(zynq.folder / "class/udmabuf")
    with td.Device(zynq.address, steady):
        assert zynq.dma.words[vdma.START_ADDRESSES[0]] == PHYSICAL


def test_words_go_to_the_file(tmp_path: Path) -> None:
    path = tmp_path / "uio0"
    path.write_bytes(bytes(range(64)))
    words = mapped_words.MappedWords(str(path), 64, "registers")
    assert words.read(4) == 0x07060504
    words.write(8, 0xDEAD_BEEF)
    words.close()
    words.close()
    assert path.read_bytes()[4:16] == bytes([4, 5, 6, 7, 0xEF, 0xBE, 0xAD, 0xDE, 12, 13, 14, 15])
