# SPDX-License-Identifier: Apache-2.0
"""Addresses of devices: the transport, and where its line is."""

from __future__ import annotations

from tactile_depth.base.errors import Argument, InputError
from tactile_depth.chip.link.depth_formats import FORMATS, DepthFormat, DepthFormatName
from tactile_depth.depth.pipeline import Pipeline
from tactile_depth.device.channel import Channel
from tactile_depth.device.line import Line
from tactile_depth.device.serial_line import SerialLine, port_of
from tactile_depth.device.simulator import Simulator
from tactile_depth.device.transport import Transport
from tactile_depth.device.uio import DEFAULT, Uio

BAUD = 3_000_000
SERIAL, SIM, PINS, UIO = "serial", "sim", "pins", "uio"
UIO_FILES = f"{UIO}:REGISTERS,VDMA,BUFFER"
ACCEPTED = ("serial:PATH", "serial:PATH@BAUD", "serial:USB-SERIAL-NUMBER", "sim", "sim:pins", "uio", UIO_FILES)


def open_channel(address: str, pipeline: Pipeline, depth_format: DepthFormatName = "words") -> Channel:
    """Open the channel to the device of an address, which sends depth in a format.

    Raises
    ------
    InputError
        There is no such transport or no such port, the transport has not this format, or the device speaks another
        version of the link.
    DeviceError
        The line cannot be opened, or the device does not answer.
    """
    kind, colon, files = address.partition(":") if isinstance(address, str) else ("", "", "")
    if kind == UIO:
        if FORMATS[depth_format] != DepthFormat.WORDS:
            problem = f": {UIO} has depth in words alone, which a DMA writes into memory"
            raise InputError(Argument("depth_format", depth_format), problem, remedy="omit it")
        return Uio(*(_files(files, Argument("address", address)) if colon else DEFAULT))
    return Line(open_transport(address, pipeline), FORMATS[depth_format])


def open_transport(address: str, pipeline: Pipeline) -> Transport:
    """Open the line of an address. For errors see `open_channel`."""
    named = Argument("address", address)
    if not isinstance(address, str):
        raise InputError(named, " is no text", accepted=ACCEPTED)
    kind, _, place = (f"{SERIAL}:{address}" if address.startswith("/dev/") else address).partition(":")
    if kind == SERIAL and place:
        path, baud = _split(place, named)
        return SerialLine(port_of(path), baud)
    if kind == SIM and place in ("", PINS):
        return Simulator(pipeline, place == PINS)
    raise InputError(named, " is no address of a device", accepted=ACCEPTED)


def _files(files: str, named: Argument) -> tuple[str, str, str]:
    """Return the files of registers, VDMA and buffer."""
    registers, vdma, buffer, *more = [*files.split(","), "", "", ""]
    if not (registers and vdma and buffer) or any(more):
        raise InputError(named, " does not name three files", accepted=[UIO, f"{UIO}:{','.join(DEFAULT)}"])
    return registers, vdma, buffer


def _split(place: str, named: Argument) -> tuple[str, int]:
    """Return path or serial number, and baud rate."""
    path, at, rate = place.rpartition("@")
    if not at:
        return place, BAUD
    if not path or not (rate.isascii() and rate.isdecimal()) or not int(rate):
        raise InputError(named, " has no baud rate behind @", accepted=f"{SERIAL}:PATH@{BAUD}, for example")
    return path, int(rate)
