# SPDX-License-Identifier: Apache-2.0
"""Serial line to a device, with pyserial."""

from __future__ import annotations

import contextlib
import errno
import sys
from typing import Any

from tactile_depth.base.errors import Argument, InputError, InputWarning, install, warn
from tactile_depth.chip.link.framing import LONGEST_ON_LINE
from tactile_depth.chip.link.rates import BITS_A_BYTE
from tactile_depth.device.errors import DeviceError
from tactile_depth.device.transport import Pace

REPEAT_S, LIMIT_S, LOOK_S = 0.05, 1.0, 0.1
STUCK_S = 5.0  # a port that takes no bytes for so long does not take any


def load_pyserial() -> Any:
    """Return the module serial of pyserial. Raises DeviceError if it is not installed."""
    try:
        import serial
        import serial.tools.list_ports
    except ImportError as error:
        raise DeviceError("a device on a serial line needs pyserial", remedy=install("serial")) from error
    return serial


def port_of(place: str) -> str:
    """Return the path of a port, given its path or its USB serial number.

    Raises
    ------
    InputError
        No port, or more than one, has the number.
    DeviceError
        pyserial is not installed.
    """
    if "/" in place or place.upper().startswith("COM"):
        return place
    ports = load_pyserial().tools.list_ports.comports()
    paths = sorted(port.device for port in ports if port.serial_number == place)
    if len(paths) == 1:
        return paths[0]
    if paths:
        problem = " is the serial number of several ports"
        raise InputError(Argument("address", f"serial:{place}"), problem, accepted=[f"serial:{path}" for path in paths])
    raise InputError(Argument("address", f"serial:{place}"), " is the serial number of no port", remedy=_present(ports))


def _present(ports: Any) -> str:
    """Return a sentence on the USB ports that are there."""
    listed = ", ".join(f"{port.device} ({port.serial_number})" for port in sorted(ports) if port.serial_number)
    return f"plugged in with a number are {listed}" if listed else "no USB port with a number is plugged in"


class SerialLine:
    """Serial line to a device: 8 data bits, no parity, one stop bit, no flow control.

    Parameters
    ----------
    path : str
        Path of the port.
    baud : int
        Bits a second.

    Raises
    ------
    InputError
        There is no such port, or it does not have the baud rate.
    DeviceError
        The port is in use, or may not be opened; or pyserial is not installed.
    """

    def __init__(self, path: str, baud: int) -> None:
        self._serial = serial = load_pyserial()
        self.name = f"{path} at {baud} baud"
        self.silence = f"give serial:{path}@BAUD if the device has another baud rate, and check cable and power"
        byte_s = BITS_A_BYTE / baud
        a_packet_each_s = 2 * LONGEST_ON_LINE * byte_s  # of depth, for which a reply waits, and the reply
        self.pace = Pace(REPEAT_S + a_packet_each_s, LIMIT_S + 4 * a_packet_each_s, LOOK_S, byte_s)
        self._path = path
        try:
            self._port = serial.Serial(path, baud, timeout=0, write_timeout=STUCK_S, exclusive=True)
        except (serial.SerialException, OSError, ValueError, OverflowError) as error:
            raise _not_opened(path, baud, error, serial.tools.list_ports.comports()) from error
        with contextlib.suppress(Exception):  # a USB adapter that hands on each byte at once; others need nothing
            self._port.set_low_latency_mode(True)
        if sys.platform != "linux":
            problem = f"{path}: a USB adapter may hold bytes back for 16 ms, which slows each access to a register"
            warn(InputWarning(problem, remedy="set its latency timer to 1 ms; on Linux the program does"))
        self._port.reset_input_buffer()

    def read(self, timeout_s: float) -> bytes:
        """Return bytes of the device; none at the time-out. Raises DeviceError if the port is gone."""
        try:
            self._port.timeout = timeout_s
            first = self._port.read(1)
            return first + self._port.read(self._port.in_waiting) if first else b""
        except (self._serial.SerialException, OSError, TypeError) as error:
            raise self._gone() from error

    def write(self, data: bytes) -> None:
        """Send bytes. Raises DeviceError if the port is gone or takes none."""
        try:
            self._port.write(data)
        except self._serial.SerialTimeoutException as error:
            remedy = "unplug the device and plug it in again"
            raise DeviceError(f"{self.name} has taken no bytes for {STUCK_S:g} s", remedy=remedy) from error
        except (self._serial.SerialException, OSError, TypeError) as error:
            raise self._gone() from error

    def close(self) -> None:
        """Close the port."""
        with contextlib.suppress(Exception):  # it may be gone
            self._port.close()

    def _gone(self) -> DeviceError:
        return DeviceError(f"{self._path} is gone", remedy="plug the device in again, then call load()")


def _not_opened(path: str, baud: int, error: Exception, ports: Any) -> InputError | DeviceError:
    """Return the error that says why a port cannot be opened."""
    number = getattr(error, "errno", None)
    if number in (errno.ENOENT, errno.ENXIO, errno.ENODEV) or isinstance(error, FileNotFoundError):
        names = sorted(port.device for port in ports)
        return InputError(
            Argument("address", f"serial:{path}"),
            ": there is no such port",
            remedy=f"give one of {', '.join(names)}" if names else "plug the device in",
        )
    if number in (errno.EBUSY, errno.EAGAIN) or "exclusively lock" in str(error):
        return DeviceError(f"{path} is in use by another program, or opened twice", remedy="close the other one")
    if number in (errno.EACCES, errno.EPERM):
        remedy = "become a member of the group that owns the port, such as dialout"
        return DeviceError(f"{path} may not be opened by this user", remedy=remedy)
    if isinstance(error, ValueError | OverflowError):
        problem = f": the port does not have {baud} baud"
        return InputError(Argument("address", f"serial:{path}@{baud}"), problem, remedy="give the rate of the device")
    reason = getattr(error, "strerror", None) or str(error)
    return DeviceError(f"{path} cannot be opened ({reason})", remedy="give the port of a serial line")
