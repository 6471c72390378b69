# SPDX-License-Identifier: Apache-2.0
"""Files that stand for a Zynq: registers of a device and of an AXI VDMA, and a buffer that the VDMA writes.

The registers lie in files that `MappedWords` maps. `Played` is a `MappedWords` that lets the block behind a file act on
each access, as the bus of a Zynq does: the model of the device with its tables, and a VDMA.
"""

from __future__ import annotations

import threading
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any, ClassVar, Protocol

import numpy as np

import tactile_depth as td
from tactile_depth.chip.contact.contact_events import Record
from tactile_depth.chip.link.depth_formats import DepthFormat, to_bytes
from tactile_depth.chip.registers.axil_registers import RECORD, Events, Live
from tactile_depth.chip.table_entries import table_entries
from tactile_depth.depth.result import thresholds_of
from tactile_depth.device import vdma
from tactile_depth.device.mapped_words import MappedWords
from tactile_depth.pictures.reader import Reader
from tests.device.model_device import ModelDevice, Setup

PAGE = 4096
PHYSICAL = 0x1E90_0000
POINTER, STORE_BIT = 0x28, 24  # PARK_PTR_REG, WrFrmStore
NOT_WRITTEN = 0xEE  # bytes of the buffer that no DMA writes


class Block(Protocol):
    """Registers behind a file."""

    def read(self, offset: int) -> int:
        """Return the word that a read gives."""

    def write(self, offset: int, word: int) -> None:
        """Take a word."""


class Played(MappedWords):
    """Registers in a file, with a block behind it."""

    blocks: ClassVar[dict[str, Block]] = {}
    lock: ClassVar[threading.RLock] = threading.RLock()

    def read(self, offset: int) -> int:
        with self.lock:
            if self.path in self.blocks:
                super().write(offset, self.blocks[self.path].read(offset))
            return super().read(offset)

    def write(self, offset: int, word: int) -> None:
        with self.lock:
            super().write(offset, word)
            if self.path in self.blocks:
                self.blocks[self.path].write(offset, super().read(offset))


class ShownDevice(ModelDevice):
    """Model of a device whose record stands in the registers from when it is shown on."""

    shown: tuple[int, ...] = (0,) * len(RECORD)
    later: tuple[int, ...] = ()  # registers that it does not have yet

    def _live(self) -> Live:
        return replace(super()._live(), record=self.shown)

    def reset(self) -> None:
        super().reset()
        self.shown = (0,) * len(RECORD)

    def read(self, offset: int) -> int:
        word = None if offset in self.later else self._read(offset)
        assert word is not None, f"SLVERR at {offset:#x}, which ends a program on a Zynq"
        return word

    def write(self, offset: int, word: int) -> None:
        assert self._write(offset, word), f"SLVERR at {offset:#x}, which ends a program on a Zynq"


class Dma:
    """Write channel of an AXI VDMA with three frame stores.

    Attributes
    ----------
    status : int
        S2MM_VDMASR.
    store : int
        Store of the next frame.
    starts : int
    stuck : dict
        Offset to the word that it always reads as.
    """

    def __init__(self, buffer: Path, stores: int = 3) -> None:
        self.buffer, self.stores = buffer, stores
        self.stuck: dict[int, int] = {}
        self.starts = 0
        self._reset()

    def _reset(self) -> None:
        self.words: dict[int, int] = {}
        self.status, self.store, self.runs = vdma.HALTED, 0, False

    def read(self, offset: int) -> int:
        held = {POINTER: self.store << STORE_BIT, vdma.STATUS: self.status}
        return {**self.words, **held, **self.stuck}.get(offset, 0)

    def write(self, offset: int, word: int) -> None:
        if offset == vdma.CONTROL and word & vdma.RESET:
            self._reset()
        elif offset == vdma.STATUS:
            self.status &= ~(word & vdma.CLEARED)
        elif offset < vdma.START_ADDRESSES[0] + 4 * self.stores:
            self.words[offset] = word
        if offset == vdma.CONTROL and word & vdma.RUN:
            self.status &= ~vdma.HALTED
        if offset == vdma.VSIZE and not self.status & vdma.HALTED:
            self.runs = True
            self.starts += 1

    def fail(self, name: str) -> None:
        """Have an error, as from now on."""
        self.status |= 1 << next(bit for bit, error in vdma.ERRORS.items() if error == name)

    def take(self, codes: np.ndarray, data_width: int) -> None:
        """Write a frame into the next store, if it runs."""
        if not self.runs:
            return
        size, stride = self.words[vdma.HSIZE], self.words[vdma.STRIDE]
        rows = to_bytes(codes, DepthFormat.WORDS, data_width, 0)
        assert (len(codes), size) == (self.words[vdma.VSIZE], len(rows) // len(codes))
        first = self.words[vdma.START_ADDRESSES[self.store]] - PHYSICAL
        with self.buffer.open("r+b") as file:
            for row in range(len(codes)):
                file.seek(first + row * stride)
                file.write(rows[row * size :][:size])
        self.store = (self.store + 1) % 3


class Zynq:
    """Device with a camera, a VDMA and a buffer, as files in a folder.

    Attributes
    ----------
    model : ShownDevice
    dma : Dma
    made : dict
        Number of a frame to its codes, rows in the order of the picture, and its record.
    landing : function
        Called with what brings a frame into memory.
    """

    def __init__(self, folder: Path, setup: Setup, stores: int = 3) -> None:
        folder.mkdir()
        self.setup, self.folder = setup, folder
        self.registers, self.vdma, self.buffer = (folder / name for name in ("uio0", "uio1", "udmabuf0"))
        config = setup.config
        self.size = 3 * config.rows * (-(-config.columns * 4 // 64) * 64)
        self.registers.write_bytes(bytes(PAGE))
        self.vdma.write_bytes(bytes(PAGE))
        self.buffer.write_bytes(bytes([NOT_WRITTEN]) * (self.size + PAGE))
        self.says("u-dma-buf", phys_addr=f"{PHYSICAL:#x}\n", size=f"{self.size + PAGE}\n", sync_mode="2\n")
        self.model, self.dma = ShownDevice(config, setup.pitch_mm), Dma(self.buffer, stores)
        self.model.link.offer = self._offer  # type: ignore[method-assign]
        Played.blocks |= {str(self.registers): self.model, str(self.vdma): self.dma}
        self.made: dict[int, tuple[np.ndarray, Record]] = {}
        self.landing: Callable[[Callable[[], None]], None] = lambda land: land()
        self.dropped: set[int] = set()  # frames of which m_axis has nothing
        self._offered: tuple[np.ndarray, Record] | None = None
        self._camera: threading.Thread | None = None
        self._ends = threading.Event()

    @property
    def address(self) -> str:
        return f"uio:{self.registers},{self.vdma},{self.buffer}"

    def says(self, kind: str, name: str = "udmabuf0", **files: str) -> None:
        """Write files of a driver in sysfs; names have / as __."""
        for file, text in files.items():
            path = self.folder / "class" / kind / name / file.replace("__", "/")
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)

    def load(self, pipeline: td.Pipeline) -> None:
        """Put the tables and the thresholds of a pipeline into the device."""
        self.model.hold(table_entries(pipeline.sensor, pipeline.config, pipeline.zero_codes))
        settings = pipeline.settings(pipeline.threshold_mm, pipeline.threshold_mm, pipeline.area_threshold_mm)
        self.model.registers.values |= thresholds_of(settings)

    def _offer(self, codes: np.ndarray, record: Record) -> None:
        self._offered = codes, record

    def show(self, picture: np.ndarray) -> None:
        """Let the camera give a picture of the grid, uint8 (rows, columns, 3)."""
        with Played.lock:
            self.model.show(picture)
            assert self._offered is not None
            codes, record = self._offered
            upright = codes[::-1] if self.setup.config.solver == "tridiagonal" else codes
            self.made[record.frame] = upright.copy(), record
            if record.frame in self.dropped:
                for events in (Events(frozenset({"depth_dropped"})), Events()):
                    self.model.registers.clock(events)
            else:
                self.landing(lambda: self.dma.take(codes, self.setup.config.data_width))
            self.model.shown = record.words

    def film(self, pictures: np.ndarray, period_s: float = 0.004) -> None:
        """Let the camera give pictures again and again, until `stop`."""

        def run() -> None:
            index = 0
            while not self._ends.wait(period_s):
                self.show(pictures[index % len(pictures)])
                index += 1

        self._camera = threading.Thread(target=run, daemon=True)
        self._camera.start()

    def stop(self) -> None:
        """End the camera."""
        self._ends.set()
        if self._camera is not None:
            self._camera.join()
        self._ends.clear()
        self._camera = None

    def reset(self) -> None:
        """Reset the device, and the VDMA with it."""
        with Played.lock:
            self.model.reset()
            self.dma._reset()

    def close(self) -> None:
        self.stop()
        for path in (self.registers, self.vdma):
            Played.blocks.pop(str(path), None)


def on_grid(pipeline: td.Pipeline, pictures: Any) -> np.ndarray:
    """Return pictures as the camera of a device gives them, uint8 (pictures, rows, columns, 3)."""
    reader = Reader(pipeline.sensor, pipeline.grid)
    return np.stack([frame for picture in pictures for _, frame in reader.pictures(picture, "picture")[0]])
