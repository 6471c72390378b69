# SPDX-License-Identifier: Apache-2.0
"""AXI VDMA of AMD, its channel from stream to memory (S2MM), with three frame stores in turn.

Registers, their bits and the order of the writes are those of AMD PG020, version 6.3 (AXI VDMA Register Address Map,
Programming Sequence, Line and Frame Errors), and of drivers/dma/xilinx/xilinx_dma.c of Linux.
"""

from __future__ import annotations

import time
from collections.abc import Sequence

from tactile_depth.device.errors import DeviceError
from tactile_depth.device.mapped_words import MappedWords

CONTROL, STATUS = 0x30, 0x34  # S2MM_VDMACR, S2MM_VDMASR
VSIZE, HSIZE, STRIDE = 0xA0, 0xA4, 0xA8
START_ADDRESSES = (0xAC, 0xB0, 0xB4)
FOURTH_ADDRESS = 0xB8
SPAN = FOURTH_ADDRESS + 4
STORES = len(START_ADDRESSES)
RUN, CIRCULAR, RESET = 1 << 0, 1 << 1, 1 << 2
ONE_FRAME = 1 << 16  # IRQFrameCount, whose least value is 1
HALTED = 1 << 0
ERRORS = {
    4: "VDMAIntErr",
    5: "VDMASlvErr",
    6: "VDMADecErr",
    7: "SOFEarlyErr",
    8: "EOLEarlyErr",
    11: "SOFLateErr",
    15: "EOLLateErr",
}
CLEARED = sum(1 << bit for bit in ERRORS)
LIMIT_S = 0.1  # a reset and a start take microseconds
SETTINGS = "docs/cable.md has its settings"


class Vdma:
    """Write channel of a VDMA: frames of a stream go to three frame stores in turn, each from its `tuser` on.

    Parameters
    ----------
    words : MappedWords
    rows, row_bytes, stride : int
        Rows of a frame, bytes of a row, and bytes from row to row in memory.
    addresses : sequence of int
        Physical addresses of the frame stores.

    Raises
    ------
    DeviceError
        These are not the registers of such a VDMA.
    """

    def __init__(self, words: MappedWords, rows: int, row_bytes: int, stride: int, addresses: Sequence[int]) -> None:
        self._words = words
        self._sizes = {STRIDE: stride, HSIZE: row_bytes, VSIZE: rows}
        self._addresses = dict(zip(START_ADDRESSES, addresses, strict=True))
        self.stop()
        self._require_three_stores()

    def _require_three_stores(self) -> None:
        """Raise DeviceError unless the three addresses hold, and no fourth: it would be written without an address."""
        words, first = self._words, next(iter(self._addresses.values()))
        for offset, address in self._addresses.items():
            words.write(offset, address)
        words.write(FOURTH_ADDRESS, first)
        if any(words.read(offset) != address for offset, address in self._addresses.items()):
            problem = f"{words.path} does not hold the addresses of three frame stores"
            raise DeviceError(problem, remedy=f"give an AXI VDMA with a write channel and three stores: {SETTINGS}")
        if words.read(FOURTH_ADDRESS) == first:
            problem = f"{words.path} has more than three frame stores, or addresses of more than 32 bits"
            raise DeviceError(problem, remedy=f"build the VDMA with three, and 32 bits: {SETTINGS}")

    def start(self) -> None:
        """Stop, then begin with the next `tuser` of the stream; errors are cleared.

        Raises
        ------
        DeviceError
            The VDMA does not stop or does not start.
        """
        self.stop()
        words = self._words
        words.write(CONTROL, ONE_FRAME | CIRCULAR | RUN)
        self._wait(STATUS, HALTED, "does not start")
        for offset, word in (*self._addresses.items(), *self._sizes.items()):
            words.write(offset, word)  # VSIZE, the last one, starts

    def stop(self) -> None:
        """Reset the channel, which completes what it writes. Raises DeviceError if the reset does not end."""
        self._words.write(CONTROL, RESET)
        self._wait(CONTROL, RESET, "does not come out of its reset")

    def _wait(self, offset: int, bit: int, otherwise: str) -> None:
        """Wait until a bit of a register is 0."""
        end = time.monotonic() + LIMIT_S
        while self._words.read(offset) & bit:
            if time.monotonic() > end:
                remedy = f"give an AXI VDMA whose clocks run: {SETTINGS}"
                raise DeviceError(f"{self._words.path}: the VDMA {otherwise}", remedy=remedy)

    @property
    def trouble(self) -> str:
        """Names of the errors since they were cleared, and `halted` if it does not run; empty without any."""
        status = self._words.read(STATUS)
        names = [name for bit, name in ERRORS.items() if status >> bit & 1]
        return ", ".join([*names, *(["halted"] if status & HALTED else [])])

    def clear(self) -> None:
        """Clear the errors."""
        self._words.write(STATUS, CLEARED)
