# SPDX-License-Identifier: Apache-2.0
"""Frame stores that a VDMA writes, in a buffer of the driver u-dma-buf."""

from __future__ import annotations

import math
import os
import platform
from pathlib import Path

import numpy as np

from tactile_depth.base.npy import Bytes, Codes
from tactile_depth.chip.link.depth_formats import DepthFormat, from_bytes, value_bytes
from tactile_depth.device import mapped_words
from tactile_depth.device.errors import DeviceError
from tactile_depth.device.mapped_words import MappedFile, name_of, number_in
from tactile_depth.device.vdma import STORES

CLASSES = ("u-dma-buf", "udmabuf")  # in sysfs: of now, and of versions before 2.0
ALIGNED = 64  # bytes: no burst of a VDMA without data realignment begins elsewhere
MARK_BYTES = 8  # at the end of a frame
NOT_CACHED, SYNC_MODES = 1, 3  # a value of sync_mode, and its bits without that of `always`
ADDRESS_BITS = 32


class FrameStores(MappedFile):
    """Three frames of depth codes in a buffer. They hold words of `m_axis`: as many bytes a value, little-endian.

    Parameters
    ----------
    path : str
        Buffer, such as /dev/udmabuf0.
    rows, columns : int
    width : int
        Bits of a depth code.

    Attributes
    ----------
    row_bytes, stride : int
        Bytes of a row, and from row to row.
    addresses : list of int
        Physical address of each store.

    Raises
    ------
    InputError
        There is no such file.
    DeviceError
        It cannot be opened or mapped, is too small, or is not a buffer for a DMA.
    """

    def __init__(self, path: str, rows: int, columns: int, width: int) -> None:
        self._value_bytes = value_bytes(DepthFormat.WORDS, width)
        self.row_bytes = columns * self._value_bytes
        self.stride = -(-self.row_bytes // ALIGNED) * ALIGNED
        self._shape = STORES, rows, self.stride
        size = math.prod(self._shape)
        folder = _folder_of(path)
        super().__init__(path, size, number_in(folder / "size"), f"a buffer of {STORES} frames")
        try:
            first = _physical_address(path, folder, size)
        except BaseException:
            self.close()
            raise
        self.addresses = [first + store * rows * self.stride for store in range(STORES)]
        self._marks: Bytes = np.zeros((STORES, 0), np.uint8)

    def mark(self) -> None:
        """Write random bytes to the end of each store, which the VDMA must not write meanwhile."""
        count = min(MARK_BYTES, self.row_bytes)
        self._marks = np.frombuffer(os.urandom(STORES * count), np.uint8).reshape(STORES, count)
        self._ends[:] = self._marks

    @property
    def written(self) -> list[int]:
        """Stores whose end has been written since `mark`."""
        return np.flatnonzero((self._ends != self._marks).any(1)).tolist()

    def codes(self, store: int) -> Codes:
        """Return a copy of the codes of a store, int32 (rows, columns), in the order in which rows leave."""
        values = self._shown[store].copy()[:, : self.row_bytes]
        return from_bytes(values.tobytes(), self._value_bytes).reshape(len(values), -1)

    @property
    def _shown(self) -> Bytes:
        return np.frombuffer(self.memory, np.uint8, math.prod(self._shape)).reshape(self._shape)

    @property
    def _ends(self) -> Bytes:
        return self._shown[:, -1, max(self.row_bytes - MARK_BYTES, 0) : self.row_bytes]


def _folder_of(path: str) -> Path:
    """Return the folder of a buffer in sysfs; without one, where it would be."""
    folders = [mapped_words.SYSFS / name / name_of(path) for name in CLASSES]
    return next((folder for folder in folders if folder.is_dir()), folders[0])


def _physical_address(path: str, folder: Path, size: int) -> int:
    """Return where a buffer lies. Raises DeviceError for one that a VDMA cannot write or this program cannot copy."""
    address = number_in(folder / "phys_addr")
    if address is None:
        place = f"{mapped_words.SYSFS / CLASSES[0] / name_of(path)}/phys_addr"
        raise DeviceError(f"{place} does not say where {path} lies", remedy="give a buffer of the driver u-dma-buf")
    if address + size > 1 << ADDRESS_BITS:
        problem = f"{path} lies at {address:#x}, beyond {ADDRESS_BITS} bits"
        raise DeviceError(problem, remedy="reserve memory for it below 4 GiB: memory-region in its device tree")
    mode = number_in(folder / "sync_mode")
    if platform.machine() == "aarch64" and mode is not None and mode & SYNC_MODES == NOT_CACHED:
        problem = f"{path} has sync_mode {mode}: copying a frame may end in a bus error on this processor"
        raise DeviceError(problem, remedy=f"write 2 to {folder / 'sync_mode'}, or sync-mode = <2> in its device tree")
    return address
