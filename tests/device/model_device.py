# SPDX-License-Identifier: Apache-2.0
"""Model of a device for tests: the link, the registers with their tables, and the pipeline, on bytes of a line.

    python -m tests.device.model_device FILE [FOLDER] [--pins]

The process speaks as the simulator of the RTL does: bytes of the line on standard input and output, SIGUSR1 is a reset,
SIGUSR2 a power-up. FILE is a pickle of `Setup`.
"""

from __future__ import annotations

import os
import pickle
import select
import signal
import sys
import time
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from tactile_depth.chip.common.signature import Captured
from tactile_depth.chip.common.td_frame_size import FrameSize
from tactile_depth.chip.common.td_round_saturate import Monitor
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.contact.contact_events import ContactEvents, Settings
from tactile_depth.chip.contact.frame_flags import FrameFlags
from tactile_depth.chip.depth.zero_capture import captured_zero
from tactile_depth.chip.gradient.flat_field import captured_gains, pixel_gains
from tactile_depth.chip.gradient.light_gains import Light, LightFilter
from tactile_depth.chip.gradient.polynomial_gradient import coefficient_map
from tactile_depth.chip.limits import CUBIC
from tactile_depth.chip.link import device as link
from tactile_depth.chip.link.device import LinkDevice
from tactile_depth.chip.registers.axil_port import Response
from tactile_depth.chip.registers.axil_registers import RECORD, AxilRegisters, Build, Events, Live
from tactile_depth.chip.registers.register_map import REGISTERS, TABLES
from tactile_depth.chip.registers.table_banks import CAPTURES
from tactile_depth.chip.registers.table_signatures import REFERENCE, ZERO, TableSignatures, power_up_words
from tactile_depth.chip.self_test import self_test
from tactile_depth.chip.table_entries import one_word, reference_entries
from tactile_depth.chip.tactile_depth import Tables, depth_and_flags, top_parameters
from tactile_depth.chip.video.frame_guard import FrameGuard, Word

SETTINGS = ("THRESHOLD", "OFF_THRESHOLD", "AREA_THRESHOLD", "MINIMUM_AREA", "DEBOUNCE")
SIGNED = 1 << 31
BUS = {"select", "index", "low", "write", "read"}  # members of table_command_t


@dataclass
class Setup:
    """Device that a process models, and what its line does to packets of the device.

    Attributes
    ----------
    tables : dict of int64 array (entries, 2)
        That it holds at power-up; others hold zeros, so that a test sees what is loaded.
    camera : uint8 array (frames, rows, columns, 3), or None
        Pictures of its camera, one after another without end.
    camera_s : float
        Time between two of them.
    camera_starts : bool
        The camera marks the start of a frame.
    damage : dict
        Chances that a packet is lost (`drop`), has a wrong byte (`flip`) or has a byte twice (`double`), each way.
    says : str
        Lines on standard error before `ready`.
    """

    config: Configuration
    pitch_mm: float
    tables: dict[str, np.ndarray] = field(default_factory=dict)
    camera: np.ndarray | None = None
    camera_s: float = 0.02
    camera_starts: bool = True
    damage: dict[str, float] = field(default_factory=dict)
    says: str = ""


def signed(word: int) -> int:
    return (word ^ SIGNED) - SIGNED


class ModelDevice:
    """Device with the pipeline of a configuration. Bytes of the host go to `link.receive`.

    Attributes
    ----------
    link : LinkDevice
    registers : AxilRegisters
    harms : tuple of str
        Flags that each frame has beside its own.
    tables : dict
        Name to the two banks, int64 (2, entries, 2): lower and upper word.
    """

    def __init__(self, config: Configuration, pitch_mm: float) -> None:
        self.config = config
        build = Build(top_parameters(config, pitch_mm))
        self.registers = AxilRegisters(build, self._entry)
        sizes = {name: build.table_sizes[code] for name, code in TABLES.items()}
        self.tables = {name: np.zeros((2, size, 2), np.int64) for name, size in sizes.items() if size}
        self.signatures = TableSignatures()
        bottom_first = config.solver == "tridiagonal"
        shape = link.Build(config.rows, config.columns, config.data_width, bottom_first)
        self.link = LinkDevice(shape, self._read, self._write)
        self.events = ContactEvents(config.rows, config.columns, config.data_width, bottom_first)
        self.harms: tuple[str, ...] = ()
        self._begin()

    def hold(self, tables: Mapping[str, np.ndarray]) -> None:
        """Hold tables from power-up on, by name: entries (n, 2), lower and upper word."""
        for name, entries in tables.items():
            self.tables[name][:] = entries
        self.signatures = TableSignatures(power_up_words(tables))

    def _begin(self) -> None:
        self.light = LightFilter(Light.of(self.config)) if self.config.light_gains else None
        self.record: tuple[int, ...] = (0,) * len(RECORD)
        self.captures: dict[str, list[np.ndarray]] = {}  # frames that are taken, by table
        self.wanted: dict[str, int] = {}  # frames of each capture
        self._frame: list[int] = []
        self._resumed = False
        self.tested = 0  # signature of the last self-test
        self._size, self._guard = FrameSize(), FrameGuard(self.config.rows, self.config.columns)

    def reset(self) -> None:
        self.link.reset()
        self.registers.reset()
        self.events.reset()
        self._sign(rst=1)
        self._begin()

    # Registers.

    def _live(self) -> Live:
        gains = (0, 0, 0) if self.light is None else tuple(self.light.gains.tolist())
        banks, capturing = self.registers.banks, frozenset(self.captures)
        levels = {"touching": self.events.touching, "hunting": self._guard.hunting}
        size = {"arrived_columns": self._size.columns, "arrived_rows": self._size.rows}
        signed = {"signature": self.signatures.shown, "held": self.signatures.held(banks.bank)}
        own = {**signed, "in_use": banks.bank, "capturing": capturing, "record": self.record}
        own |= {"light_gains": gains, "self_test": self.tested}
        return Live(**own, **levels, **size)  # type: ignore[arg-type]

    def _free(self, code: int) -> int:
        return 1 - (self.registers.banks.bank >> code & 1)

    def _entry(self, code: int, index: int) -> tuple[int, int]:
        name = next(name for name, number in TABLES.items() if number == code)
        low, high = self.tables[name][self._free(code), index].tolist()
        return high & 0xFFFF_FFFF, low & 0xFFFF_FFFF

    def _sign(self, captured: tuple[str, Captured] = ("reference", Captured()), **signals: Any) -> None:
        """Let the signatures see a clock, of the bus or of a capture."""
        command = dict.fromkeys(("write", "read", "low"), 0) | {name: signals.pop(name) for name in {*signals} & BUS}
        command |= {"select": self.registers.table, "index": self.registers.values["TABLE_INDEX"]} | command
        words = {code: Captured() for code in (REFERENCE, ZERO)} | {TABLES[captured[0]]: captured[1]}
        self.signatures.clock(command, self.registers.banks.bank, words, **signals)

    def _read(self, address: int) -> int | None:
        self._sign(read=int(self.registers.is_port(address)))
        word, response = self.registers.read(address, self._live())
        return word if response == Response.OKAY else None

    def _write(self, address: int, value: int) -> bool:
        registers, table, index = self.registers, self.registers.table, self.registers.values["TABLE_INDEX"]
        if registers.write(address, value, live=self._live()) != Response.OKAY:
            return False
        bus: dict[str, Any] = {"select": table, "index": index, "low": value, "write": len(registers.table_writes)}
        self._sign(**bus, write_offset=address)
        for _ in range(2):
            self._sign()
        names = {code: name for name, code in TABLES.items()}
        for code, index, high, low in registers.table_writes:
            self.tables[names[code]][self._free(code), index] = signed(low), signed(high)
        for name in registers.captures:
            log2 = registers.values[CAPTURES[name].name] & 0xF
            self.captures[name], self.wanted[name] = [], 1 << min(log2, 8)
        for colour, gain in registers.gains_written:
            if self.light is not None:
                self.light.gains = self.light.light.limited(self.light.gains)
                self.light.gains[colour] = max(gain, self.light.light.unity >> 1)
        for done in (registers.table_writes, registers.captures, registers.gains_written):
            done.clear()
        registers.clock(Events())
        control = REGISTERS["CONTROL"]
        if address == control.offset and value & control.field("self_test").mask:
            registers.clock(Events(frame_start=True))
            gains, zero = (
                None if self.light is None else self.light.gains,
                self._zero() if "zero" in self.tables else None,
            )
            self.tested = self_test(self.config, self._tables(), zero, registers.values["DARK_LEVEL"], gains)
        return True

    # Pictures.

    def take(self, word: Word) -> None:
        """Take a pixel; a whole picture gives a depth frame, and what is malformed a fault."""
        guard, fault = self._guard, "start_early"
        self._size.take(word.last, word.user)
        while fault == "start_early":
            hunted = guard.hunting
            fault = guard.take(word)
            if fault:
                self._fault(fault)
            if guard.out.get("out_frame_start"):
                self._frame, self._resumed = [], hunted
                self.registers.clock(Events(frame_start=True))
            if guard.out:
                self._frame.append(guard.out["out_data"])
            while guard.filling:
                guard.fill()
            if guard.out.get("out_frame_end") and not guard.out["out_bad"]:
                words = np.array(self._frame).reshape(self.config.rows, self.config.columns)
                self._picture(np.stack([words >> 16 & 0xFF, words & 0xFF, words >> 8 & 0xFF], axis=-1).astype(np.uint8))

    def show(self, picture: np.ndarray, starts: bool = True) -> None:
        """Take a picture of the camera, uint8 (rows, columns, 3); without `starts` one without a start of frame."""
        for row, pixels in enumerate(picture.astype(int)):
            for column, (red, green, blue) in enumerate(pixels):
                last = int(column == len(pixels) - 1)
                start = int(starts and not row and not column)
                self.take(Word(red << 16 | blue << 8 | green, last, start))

    def _fault(self, name: str) -> None:
        if "reference" in self.captures:
            self.captures["reference"] = []
        for events in (Events(flags=frozenset({name})), Events()):
            self.registers.clock(events)

    def _picture(self, picture: np.ndarray) -> None:
        config, monitor, tables = self.config, Monitor(), self._tables()
        registers = {"dark_level": self.registers.values["DARK_LEVEL"], "limit": self.registers.values["SLOPE_LIMIT"]}
        marks: dict[str, Any] = registers | {"resumed": self._resumed}
        if self.light is not None:
            assert tables.gains is not None
            light = self.registers.values["LIGHT"]
            self.light.follow, self.light.rate = bool(light & 1), light >> 4 & 7
            marks["light"] = self.light.take(tables.gains.ratios(picture, registers["dark_level"]))
            marks["light_moves"] = self.light.moves
        zero = self._zero() if config.zero_offset else None
        depth, codes, flags = depth_and_flags(picture, config, tables, monitor, zero=zero, **marks)
        flags = FrameFlags._make(name in self.harms or value for name, value in flags._asdict().items())
        self._capture("reference", picture)
        self._capture("zero", depth)
        settings = Settings(*(signed(self.registers.values[name]) for name in SETTINGS))
        record = self.events.whole_frame(codes, settings, int(time.monotonic() * 1e6) % (1 << 32), flags)
        self.record = record.words
        events_of_frame = frozenset({"frame_in", "frame_out", "record_valid"})
        for events in (Events(events_of_frame, saturations=sum(monitor.saturations.values())), Events()):
            self.registers.clock(events)
        self.link.offer(codes.astype(np.int32), record)

    def _capture(self, name: str, frame: np.ndarray) -> None:
        if name not in self.captures:
            return
        self.captures[name].append(frame)
        if len(self.captures[name]) < self.wanted[name]:
            return
        frames = np.stack(self.captures.pop(name))
        reference = name == "reference"
        entries = (
            reference_entries(captured_gains(frames, self.config))
            if reference
            else one_word(captured_zero(frames, self.config))
        )
        self.tables[name][self._free(TABLES[name])] = entries
        self._sign((name, Captured(starts=1)))
        for index, word in enumerate(entries[:, 0].tolist(), 1):
            self._sign((name, Captured(writes=1, steps=1, ends=index == len(entries), word=word)))
        self._sign()
        self.registers.clock(Events(captured=frozenset({name})))

    def _used(self, name: str) -> np.ndarray:
        return self.tables[name][1 - self._free(TABLES[name])]

    def _zero(self) -> np.ndarray:
        return self._used("zero")[:, 0].reshape(self.config.reference_nodes)

    def _tables(self) -> Tables:
        """Return the tables that frames use."""
        config, gains, corrections = self.config, None, None
        if config.flat_field:
            nodes = self._used("reference")[:, 0].reshape(*config.reference_nodes, 4)
            gains = pixel_gains(nodes[..., :3], config)
        if not config.polynomials:
            return Tables(gains, self._used("gradient"))
        if config.gradient_model == "cubic":
            corrections = self._used("gradient")
        words = self._used("coefficients")[:, 0].reshape(CUBIC)
        return Tables(gains, coefficient_map(words, config), corrections)


class Serving:
    """Model device between two file descriptors, such as those of a process or of a pty.

    Attributes
    ----------
    device : ModelDevice
    """

    def __init__(self, setup: Setup, source: int, sink: int) -> None:
        self.setup, self.source, self.sink = setup, source, sink
        self._power_up()
        self.wanted: set[str] = set()  # `reset`, `power_up` or `end`, from signals and other threads
        self._random = np.random.default_rng(1)
        self._shown, self._next = 0, time.monotonic()

    def run(self) -> None:
        """Serve until the source ends or `end` is wanted."""
        while "end" not in self.wanted:
            self._act()
            ready, *_ = select.select([self.source], [], [], 0.002)
            if ready:
                try:
                    data = os.read(self.source, 1 << 16)
                except OSError:
                    return
                if not data:
                    return
                self._receive(data)
            self._camera()
            while packet := self.device.link.next_packet():
                self._send(self._damaged(packet))

    def _act(self) -> None:
        if "reset" in self.wanted:
            self.wanted.discard("reset")
            self.device.reset()
        if "power_up" in self.wanted:
            self.wanted.discard("power_up")
            self._power_up()

    def _power_up(self) -> None:
        self.device = ModelDevice(self.setup.config, self.setup.pitch_mm)
        self.device.hold(self.setup.tables)

    def _receive(self, data: bytes) -> None:
        first, *pieces = data.split(b"\0")
        self.device.link.receive(first)
        for piece in pieces:
            self.device.link.receive(self._damaged(b"\0" + piece) if piece else b"\0")
        words, self.device.link.pixels = self.device.link.pixels, []
        for word in words:
            self.device.take(word)

    def _camera(self) -> None:
        camera = self.setup.camera
        if camera is not None and time.monotonic() > self._next:
            self._next = time.monotonic() + self.setup.camera_s
            self.device.show(camera[self._shown % len(camera)], self.setup.camera_starts)
            self._shown += 1

    def _damaged(self, packet: bytes) -> bytes:
        """Return what comes of a packet."""
        chances, at = self.setup.damage, int(self._random.integers(len(packet)))
        if self._random.random() < chances.get("drop", 0):
            return b""
        if self._random.random() < chances.get("flip", 0):
            packet = packet[:at] + bytes((packet[at] ^ 0x55,)) + packet[at + 1 :]
        if self._random.random() < chances.get("double", 0):
            packet = packet[: at + 1] + packet[at:]
        return packet

    def _send(self, data: bytes) -> None:
        while data and "end" not in self.wanted:
            if select.select([], [self.sink], [], 0.1)[1]:
                try:
                    data = data[os.write(self.sink, data[:512]) :]
                except OSError:
                    return


def main() -> None:
    setup: Any = pickle.loads(Path(sys.argv[1]).read_bytes())
    serving = Serving(setup, 0, 1)
    signal.signal(signal.SIGUSR1, lambda *_: serving.wanted.add("reset"))
    signal.signal(signal.SIGUSR2, lambda *_: serving.wanted.add("power_up"))
    print(setup.says + "ready", file=sys.stderr, flush=True)
    serving.run()


if __name__ == "__main__":
    main()
