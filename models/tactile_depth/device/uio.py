# SPDX-License-Identifier: Apache-2.0
"""Channel to a device in the same chip as this program, a Zynq: registers by /dev/uio, depth from a buffer of a DMA."""

from __future__ import annotations

import time
from collections.abc import Sequence
from contextlib import ExitStack

import numpy as np

from tactile_depth.base.errors import InputError, counted
from tactile_depth.base.npy import Bytes, Codes
from tactile_depth.chip.contact.contact_events import Record, record
from tactile_depth.chip.link.depth_formats import DepthFormat
from tactile_depth.chip.link.depth_frames import NUMBERS, RESETS, DepthFrame
from tactile_depth.chip.link.packets import LARGEST_GRID, OTHER_VERSION, Status
from tactile_depth.chip.registers.axil_registers import BY_OFFSET, RECORD, VERSION
from tactile_depth.chip.registers.register_map import REGISTERS, TABLES, WORD_BITS
from tactile_depth.chip.registers.table_access import HIGH, INDEX, LOW, PORTS, SIZE
from tactile_depth.chip.registers.table_banks import CAPTURES, COMMIT
from tactile_depth.device.channel import Arrival
from tactile_depth.device.errors import DeviceError
from tactile_depth.device.exchange import CAMERA_S
from tactile_depth.device.frame_stores import FrameStores
from tactile_depth.device.mapped_words import WORD_BYTES, MappedWords
from tactile_depth.device.vdma import SPAN, STORES, Vdma

DEFAULT = ("/dev/uio0", "/dev/uio1", "/dev/udmabuf0")
"""Registers, VDMA and buffer."""
REGISTER_BYTES = max(BY_OFFSET) + WORD_BYTES
NUMBER, DROPPED = "RECORD_FRAME", "DEPTH_DROPPED"
WATCHED = ("THRESHOLD", "OFF_THRESHOLD")  # a reset sets them to a value that nobody else needs
POLL_S = 0.001
SETTLE_S = 0.0002  # the last burst into memory, and the record, come some microseconds after a frame
DEPTH_S, LIMIT_S = 0.1, 1.0
RESTARTS = 3  # in a row, without a frame between them, after which the VDMA is given up
MISSES = 100  # of the first frame since a start, in a row, because this program was late


class Uio:
    """Channel to a device by three device files of Linux, for one thread.

    The VDMA runs while the channel is open, collected or not: a stream that nobody takes stops the pipeline. It puts
    frame after frame into three stores in turn. When it starts, the channel marks the stores, waits for the one that is
    written first, and reads its number in RECORD_FRAME. From then on the number of a frame tells its store.
    PARK_PTR_REG.WrFrmStore does not: it moves with the `tuser` of the next frame, so between two frames it still points
    to the store that is whole. A frame is delivered if it is the newest, its record stood still while it was read, at
    most one frame came while the store was copied, the VDMA had no error, the device dropped no depth
    (DEPTH_DROPPED), and area and weight of the record are those of the codes. After an error, or a frame without its
    record, the VDMA is started anew. Frames between two that are delivered are counted as lost, by RECORD_FRAME.

    An access that the device would refuse is not made: on a Zynq its answer, SLVERR, ends the program (SIGBUS).

    A reset of the device is seen if RECORD_FRAME has gone back, or if both thresholds are those of power-up and were
    not before. It is not seen if nobody had set a threshold and as many frames have come since. The counters do not
    help, because CONTROL.clear_counters clears them; RECORD_TIME wraps after 2^32 clocks.

    In the status, `sent` is RECORD_FRAME, so a reset clears it, and `resets` counts those that were seen. `sending`,
    `skipped` and `bad_packets` are always 0: there are no packets.

    Parameters
    ----------
    registers, vdma : str
        Files of the driver uio: the registers of the device, and those of the VDMA.
    buffer : str
        File of the driver u-dma-buf.

    Attributes
    ----------
    broken : bool
        False: the files do not go away.
    delivered, lost : int
    bad_packets : int
        0.

    Raises
    ------
    InputError
        A file does not exist, or the device has another version of the registers.
    DeviceError
        A file may not be opened, is in use or too small, or is not what it should be.
    """

    broken = False
    bad_packets = 0
    quiet_s = CAMERA_S
    depth_s = DEPTH_S
    limit_s = LIMIT_S

    def __init__(self, registers: str, vdma: str, buffer: str) -> None:
        self.delivered = self.lost = 0
        with ExitStack() as opened:
            self._words = MappedWords(registers, REGISTER_BYTES, "the registers of the device")
            opened.callback(self._words.close)
            self._read_build()
            vdma_words = MappedWords(vdma, SPAN, "the registers of the VDMA")
            opened.callback(vdma_words.close)
            self._stores = FrameStores(buffer, self._rows, self._columns, self._data_width)
            opened.callback(self._stores.close)
            sizes = self._rows, self._stores.row_bytes, self._stores.stride
            self._vdma = Vdma(vdma_words, *sizes, self._stores.addresses)
            opened.callback(self._vdma.stop)  # first: it must not write into a buffer that is not there any more
            self._resets = self._restarts = self._misses = 0
            self._number = self._seen = self._word(NUMBER)
            self._is_set = self._thresholds_are_set()
            self._done = self._number  # the last frame that is delivered, lost or not wanted
            self._collects = self._is_fresh = False  # fresh: no frame was delivered yet
            self._start()
            self._opened = opened.pop_all()

    def _read_build(self) -> None:
        """Read what the device is, of registers that all versions have.

        Raises DeviceError if that is no tactile_depth, and InputError for registers of another version.
        """
        path, word = self._words.path, self._word("ID")
        if word != REGISTERS["ID"].reset:
            problem = f"{path} has the ID {word:#010x}, and no tactile_depth"
            raise DeviceError(problem, remedy="give its registers first: uio:REGISTERS,VDMA,BUFFER")
        grid, layout = self._fields("GRID"), self._fields("FORMAT")
        self._rows, self._columns, self._data_width = grid["rows"], grid["columns"], layout["data_width"]
        sides_are_right = all(1 <= side <= LARGEST_GRID for side in (self._rows, self._columns))
        if not sides_are_right or not 1 <= self._data_width <= WORD_BITS:
            problem = f"{path} reads GRID {self._word('GRID'):#010x} and FORMAT {self._word('FORMAT'):#010x}"
            raise DeviceError(problem, remedy="check its address in the device tree, its clock and its reset")
        build = self._fields("DEVICE")
        if build["version"] != VERSION:
            problem = f"{path} has version {build['version']} of the registers"
            raise InputError(problem, accepted=str(VERSION), remedy=OTHER_VERSION)
        self._bottom_first = bool(build["solver"])

    # Registers.

    def _word(self, name: str) -> int:
        return self._words.read(REGISTERS[name].offset)

    def _fields(self, name: str) -> dict[str, int]:
        return REGISTERS[name].unpack(self._word(name))

    def read(self, addresses: Sequence[int]) -> list[int]:
        """Return the words of registers at byte addresses, up to the first that the device would refuse."""
        words: list[int] = []
        for address in addresses:
            register = BY_OFFSET.get(address)
            if register is None or (register.name in PORTS and not self._has_entry()):
                break
            words.append(self._words.read(address))
        return words

    def write(self, pairs: Sequence[tuple[int, int]]) -> int:
        """Write pairs of byte address and word, up to the first that would be refused; return the number of those."""
        is_open = False  # the table takes entries until something else is written
        for done, (address, word) in enumerate(pairs):
            register = BY_OFFSET.get(address)
            if register is None or not register.writable:
                return done
            if register.name == LOW:
                is_open = is_open or (self._has_entry() and not self._is_closed())
                if not is_open:
                    return done
            elif register.name != HIGH:
                is_open = False
            if self._refuses_capture(register.name, word):
                return done
            self._words.write(address, word)
            if register.name in WATCHED:
                self._is_set = self._thresholds_are_set()
        return len(pairs)

    def _has_entry(self) -> bool:
        """Return True if the table has an entry TABLE_INDEX."""
        return self._word(INDEX) < self._word(SIZE)

    def _is_closed(self) -> bool:
        """Return True if the table that is selected waits for a frame, or is captured."""
        code = self._fields("TABLE_SELECT")["select"]
        captures = [register for table, register in CAPTURES.items() if TABLES[table] == code]
        busy = any(self._fields(register.name)["busy"] for register in captures)
        return busy or bool(self._word(COMMIT.name) >> code & 1)

    def _refuses_capture(self, name: str, word: int) -> bool:
        """Return True for a start of a capture that cannot be made."""
        table = next((table for table, register in CAPTURES.items() if register.name == name), None)
        if table is None or not word & CAPTURES[table].field("start").mask:
            return False
        build = self._fields("DEVICE")
        if table == "reference":
            return not build["flat_field"]
        return not build["zero_offset"] or bool(self._fields(COMMIT.name)["zero"])

    # Resets.

    def _thresholds_are_set(self) -> bool:
        return any(self._word(name) != REGISTERS[name].reset for name in WATCHED)

    def check(self) -> None:
        """Raise DeviceError, once, if the device was reset."""
        number, are_set = self._word(NUMBER), self._thresholds_are_set()
        was_reset = (number - self._number) % NUMBERS >= NUMBERS // 2 or (self._is_set and not are_set)
        self._number, self._is_set = number, are_set
        if was_reset:
            self._resets = (self._resets + 1) % RESETS
            self._done, self._is_fresh = number, True
            self._start()
            problem = f"{self._words.path}: the device was reset or lost its power"
            raise DeviceError(problem, remedy="its settings are those of power-up: call load() again")

    def ask(self) -> Status:
        """Return the status of the device; frames before the newest are then counted as lost."""
        self.check()
        if self._collects and not self._is_fresh:
            self._account(self._number - 1)
        return self.status

    @property
    def status(self) -> Status:
        """Status, with the number of the newest frame that was seen."""
        shape = self._rows, self._columns, self._data_width, self._bottom_first
        return Status(self._resets, *shape, False, DepthFormat.WORDS, 0, self._number, skipped=0, bad_packets=0)

    # Frames.

    def send(self, pixels: Bytes) -> None:
        """Raise DeviceError: this channel carries no pictures."""
        problem = "uio carries no pictures to the device: they come from its camera"
        raise DeviceError(problem, remedy="let the camera send pictures of the grid, and give none")

    def collect(self, on: bool) -> None:
        """Begin or end to deliver frames; those before are not wanted."""
        self._collects, self._is_fresh = on, on
        self._done = self._word(NUMBER)
        if on and self._first is None and self._done != self._begun:
            self._start()

    def frame(self, timeout_s: float, lost: int) -> Arrival | None:
        """Return the newest depth frame, once; None at the time-out, or as soon as another number than `lost` are lost.

        Raises
        ------
        DeviceError
            The device was reset, or the VDMA has errors again and again.
        """
        end = time.monotonic() + timeout_s
        while True:
            arrival = self._newest() if self._collects else None
            if arrival is not None or self.lost != lost or time.monotonic() >= end:
                return arrival
            time.sleep(POLL_S)

    def count_lost(self) -> None:
        """Count a picture that gave no depth as lost."""
        self.lost += 1

    def _account(self, done: int) -> None:
        """Count frames up to this number as lost, as far as they are neither delivered nor lost."""
        more = (done - self._done) % NUMBERS
        if more < NUMBERS // 2:
            self.lost += more
            self._done = done % NUMBERS

    def _start(self) -> None:
        """Start the VDMA with marked stores: `_find` then sees which of them it writes first."""
        self._vdma.stop()
        self._stores.mark()
        self._first: tuple[int, int] | None = None  # number and store of a frame
        self._begun = self._word(NUMBER)
        self._vdma.start()

    def _restart(self, problem: str, remedy: str = "docs/cable.md has the settings of the VDMA") -> None:
        """Start the VDMA anew; raise DeviceError if that has not helped before."""
        self._restarts += 1
        self._start()
        if self._restarts > RESTARTS:
            self._restarts = 0
            raise DeviceError(problem, remedy=remedy)

    def _find(self) -> None:
        """Find the store of the first frame since the start, and its number."""
        written = self._stores.written
        if not written:
            passed = (self._word(NUMBER) - self._begun) % NUMBERS
            trouble = self._vdma.trouble
            if trouble.endswith("halted") or passed > STORES:
                problem = f"{counted(passed, 'frame')} passed, and none reached the buffer: {trouble or 'no error'}"
                self._restart(problem, "connect m_axis to the VDMA, and map the buffer without cache: docs/cable.md")
            return
        _settle()
        number = self._word(NUMBER)
        if number == self._begun:
            return
        dropped = self._word(DROPPED)
        _settle()  # if the next frame has come before its number was read, its end has too
        if len(written) > 1 or self._stores.written != written:
            self._misses += 1
            self._start()
            if self._misses > MISSES:
                self._misses = 0
                raise DeviceError("frames come faster than this program reads them", remedy="let the camera send fewer")
            return
        self._vdma.clear()  # of what came before the first frame
        self._first, self._dropped = (number, written[0]), dropped
        if self._is_fresh:
            self._done = (number - 1) % NUMBERS

    def _newest(self) -> Arrival | None:
        """Return the newest frame if it is not delivered yet, and whole."""
        self.check()
        if self._first is None:
            self._find()
            return None
        number = self._number
        if self._fails() or number == self._done:
            return None
        if number != self._seen:
            self._seen = number
            _settle()
        words = [self._word(name) for name in RECORD]
        if words[RECORD.index(NUMBER)] != number or self._word(NUMBER) != number:
            return None
        first, store = self._first
        store = (store + (number - first) % NUMBERS) % STORES
        codes = self._stores.codes(store)
        if (self._word(NUMBER) - number) % NUMBERS > 1 or self._fails():
            return None
        made = record(words)
        if not _fits(made, codes):
            remedy = "m_axis goes to the VDMA with all its bytes, and the buffer is mapped without cache: docs/cable.md"
            self._restart("the depth in the buffer is not that of the record", remedy)
            return None
        self._first = number, store
        self._account(number - 1)
        self._done, self._is_fresh = number, False
        self._restarts = self._misses = 0
        self.delivered += 1
        codes = np.ascontiguousarray(codes[::-1]) if self._bottom_first else codes
        frame = DepthFrame(codes, DepthFormat.WORDS, 0, number, self._resets, made)
        return Arrival(frame, time.time(), self.lost)

    def _fails(self) -> bool:
        """Return True, and start anew, if numbers may not tell the stores any more."""
        trouble = self._vdma.trouble
        if trouble:
            self._restart(f"the VDMA has errors: {trouble}")
        elif self._word(DROPPED) != self._dropped:
            self._restart("the device drops depth frames, because the VDMA does not take them")
        else:
            return False
        return True

    def close(self) -> None:
        """Stop the VDMA and free the files; closing twice does nothing."""
        self._opened.close()


def _settle() -> None:
    """Wait until the last words of a frame, and its record, have come."""
    time.sleep(SETTLE_S)


def _fits(made: Record, codes: Codes) -> bool:
    """Return True if area and weight of a record are those of the codes."""
    above = codes[codes > made.area_threshold].astype(np.int64)
    return (above.size, int(above.sum()) - above.size * made.area_threshold) == (made.area, made.weight)
