# SPDX-License-Identifier: Apache-2.0
"""Files of Linux drivers, such as /dev/uio0 and /dev/udmabuf0, mapped into this program."""

from __future__ import annotations

import contextlib
import errno
import mmap
import os
import stat
import sys
from pathlib import Path

from tactile_depth.base.errors import Argument, InputError
from tactile_depth.device.errors import DeviceError

SYSFS = Path("/sys/class")
WORD_BYTES = 4
GONE = (errno.ENOENT, errno.ENXIO, errno.ENODEV, errno.ENOTDIR)
LARGER = "give files in the order REGISTERS,VDMA,BUFFER, or make it larger in the device tree: docs/cable.md"
RIGHTS = "give this user the right, by a udev rule or by its group: docs/cable.md"


class MappedFile:
    """File of a driver, mapped, and locked against other programs that use this class.

    Parameters
    ----------
    path : str
        A device file, or for tests a file.
    size : int
        Bytes that are mapped, at least; the last page is mapped whole if the file has it.
    region : int or None
        Bytes that the driver says it has; None for those of the file.
    what : str
        Names what the file should be, in errors.

    Attributes
    ----------
    path : str

    Raises
    ------
    InputError
        There is no such file.
    DeviceError
        It may not be opened, is in use, has fewer bytes, or cannot be mapped.
    """

    def __init__(self, path: str, size: int, region: int | None, what: str) -> None:
        if sys.platform != "linux":
            raise DeviceError("uio is a transport of Linux", remedy="run this on the Zynq, or use a serial line")
        import fcntl

        self.path = path
        try:
            descriptor = os.open(path, os.O_RDWR | os.O_SYNC | os.O_CLOEXEC)  # O_SYNC: not cached
            try:
                fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
                status = os.fstat(descriptor)
                if stat.S_ISREG(status.st_mode):
                    region = status.st_size if region is None else min(region, status.st_size)
                if region is not None and region < size:
                    raise DeviceError(f"{path} has {region} bytes, but {what} needs {size}", remedy=LARGER)
                length = -(-size // mmap.PAGESIZE) * mmap.PAGESIZE
                mapped = mmap.mmap(descriptor, length if region is None else min(length, region))
                self._map: mmap.mmap | None = mapped  # keeps the file open, and locked
            finally:
                os.close(descriptor)
        except OSError as error:
            raise _not_opened(path, what, error) from error

    @property
    def memory(self) -> mmap.mmap:
        """Bytes of the file. Raises DeviceError if it is closed."""
        if self._map is None:
            raise DeviceError(f"{self.path} is closed", remedy="open the device with Device(..)")
        return self._map

    def close(self) -> None:
        """Free the file; closing twice does nothing."""
        mapped, self._map = self._map, None
        if mapped is not None:
            with contextlib.suppress(BufferError):  # an array still shows it
                mapped.close()


class MappedWords(MappedFile):
    """32-bit registers of a file of the driver uio, each accessed as one aligned word.

    For parameters and errors see `MappedFile`.
    """

    def __init__(self, path: str, size: int, what: str) -> None:
        super().__init__(path, size, number_in(SYSFS / "uio" / name_of(path) / "maps/map0/size"), what)
        self._words = memoryview(self.memory)[: size // WORD_BYTES * WORD_BYTES].cast("I")

    def read(self, offset: int) -> int:
        """Return the word at a byte offset. Raises DeviceError if the file is closed."""
        return self._open[offset // WORD_BYTES]

    def write(self, offset: int, word: int) -> None:
        """Write the word at a byte offset. Raises DeviceError if the file is closed."""
        self._open[offset // WORD_BYTES] = word

    @property
    def _open(self) -> memoryview:
        _ = self.memory
        return self._words

    def close(self) -> None:
        """Free the file; closing twice does nothing."""
        self._words.release()
        super().close()


def name_of(path: str) -> str:
    """Return the name that a device file has in sysfs, given its path or a link to it."""
    return Path(path).resolve().name


def number_in(path: Path) -> int | None:
    """Return the number, decimal or with 0x, in a file of sysfs; None without such a file or number."""
    try:
        return int(path.read_text(), 0)
    except (OSError, ValueError):
        return None


def _not_opened(path: str, what: str, error: OSError) -> InputError | DeviceError:
    """Return the error that says why a file cannot be used."""
    if error.errno in GONE:
        remedy = "load its driver, uio_pdrv_genirq or u-dma-buf, and check the device tree: docs/cable.md"
        return InputError(Argument("address", path), f": there is no such file for {what}", remedy=remedy)
    if error.errno in (errno.EACCES, errno.EPERM):
        return DeviceError(f"{path} may not be opened by this user", remedy=RIGHTS)
    if error.errno in (errno.EBUSY, errno.EAGAIN):
        return DeviceError(f"{path} is in use by another program, or opened twice", remedy="close the other one")
    reason = error.strerror or str(error)
    return DeviceError(f"{path} cannot be mapped as {what} ({reason})", remedy="give a device file of Linux")
