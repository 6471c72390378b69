# SPDX-License-Identifier: Apache-2.0
"""gradient_lookup against its model: both banks, rewritten and read while frames stream; gaps, pauses, reset.

The reference follows the pins in every cycle: a pixel gets the slopes in the bank of its frame.
"""

from typing import Any

import cocotb
import numpy as np
from cocotb.triggers import ClockCycles, RisingEdge

from formal.entries import WORD_FREE, Proof
from formal.tables import gradient_rom
from tactile_depth.chip.common.td_banked_table import BankedTable
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.gradient.gradient_lookup import LATENCY, gradient_codes, gradient_lookup
from tactile_depth.chip.registers.register_map import TABLES
from tactile_depth.chip.rom_files import write_gradient
from tactile_depth.sensor.synthetic import synthetic
from tb.cases import on_bench
from tb.pins import by_name
from tb.pixels import pack, unpack
from tb.stream import Bench, StreamDriver, StreamMonitor, configuration, parameters, parametrize, send_apart, uniform
from tb.structures import ICARUS, VERILATOR, Structure
from tb.table_bus import READ_CLOCKS, TableBus, signed


def built(bits: int, data_width: int, **runs: Any) -> Structure:
    choices: dict[str, Any] = {"columns": 16, "data_width": data_width, "bits_per_channel": bits}
    config = Configuration(**choices)
    width = config.gradient.width
    return Structure(
        {"Width": width, "BitsPerChannel": bits},
        device={"configuration": choices},
        roms=lambda folder: write_gradient(folder / "gradient.hex", gradient_codes(synthetic(bits), config), width),
        **runs,
    )


STRUCTURES = (
    built(2, 24, on=VERILATOR),
    built(1, 32, on=ICARUS, mutants=ICARUS),
    built(3, 12),
    built(4, 24),
)
PROOFS = (
    Proof(
        f"{WORD_FREE}; one bit a channel has the same index",
        roms=gradient_rom,
    ),
)


PIXEL = ["pixel", "position"]
SLOPES = ["gx", "gy", "position"]
FIRST = 0b0011  # position of the first pixel: in the first row and the first column


def every_colour(bits: int, random: Any) -> Any:
    """Return a colour of each bin of the table in random order, its lower bits random; then all in reverse order."""
    bins = np.array(random.sample(range(1 << 3 * bits), 1 << 3 * bits))
    top = np.stack((bins >> 2 * bits, bins >> bits, bins), axis=-1) & (1 << bits) - 1
    low = np.array([random.getrandbits(8 - bits) for _ in range(3 * len(bins))]).reshape(-1, 3)
    colours = (top << (8 - bits) | low).astype(np.uint8)
    return np.concatenate((colours, colours[::-1]))


class Lookup:
    """Device, its reference, and the accesses of software to the table."""

    banks: Any = None  # content of the banks; it survives a reset, so the next test begins with it

    def __init__(self, dut: Any, gap: float = 0.0, pause: float = 0.0) -> None:
        self.dut, self.gap = dut, gap
        self.width, self.bits = parameters(dut, "Width", "BitsPerChannel")
        self.bins = 1 << 3 * self.bits
        self.bench = Bench(dut, pause)
        self.driver = StreamDriver(dut, "in", "valid", PIXEL)
        self.source = StreamMonitor(dut, "in", "valid", PIXEL, unsigned=PIXEL)
        self.sink = StreamMonitor(dut, "out", "valid", SLOPES, unsigned=SLOPES[2:])
        self.power_up = gradient_codes(synthetic(self.bits), configuration())
        # slopes of the pixels taken; banks that frames used
        self.expected: list[Any] = []
        self.tables: set[Any] = set()
        self.bus = TableBus(dut, TABLES["gradient"], self.width, words=2, signed=True)
        dut.table_bank.value = 0
        dut.in_position.value = 0

    async def start(self) -> None:
        """Start and reset. On Verilator the first test rewrites both banks.

        The pins of Verilator are random at first and may write a word at the first edge. Icarus and the top test the
        content at power-up.
        """
        at_power_up = Lookup.banks is None
        if at_power_up:
            Lookup.banks = BankedTable.of(self.power_up)
        self.banks.wanted = self.banks.in_use = 0  # changed by the reset
        await self.bench.start()
        cocotb.start_soon(self.follow())
        if at_power_up and cocotb.SIM_NAME.lower().startswith("verilator"):
            for _ in range(2):
                await self.rewrite(self.power_up)
                await self.commit()
                await self.frame()
        self.tables.clear()

    async def follow(self) -> None:
        read, edge, table = by_name(self.dut), RisingEdge(self.dut.clk), self.banks.words[0]
        named = 0  # bank of the next frame
        changes = False  # the first pixel of a frame waits before the table
        while True:
            await edge
            assert read("table_in_use") == self.banks.in_use
            access = self.bus.step()
            if changes and read("en") and not read("rst"):
                self.banks.in_use, changes = named, False
            if access and access["read"]:  # in the cycle of a change-over: of the previous bank
                self.to_read = self.banks.free[access["index"]].tolist()
            self.banks.wanted = read("table_bank")
            if access and access["write"]:
                self.banks.write(access["index"], tuple(signed(access[word], self.width) for word in ("low", "high")))
            if read("rst"):
                table, changes = self.banks.begin_frame(), False
                self.expected.clear()
            elif read("en") and read("in_valid"):
                if read("in_position") & FIRST == FIRST:
                    named, changes = self.banks.wanted, True
                    table = self.banks.words[named]
                    self.tables.add(named)
                pixel = unpack(read("in_pixel"))
                self.expected.append(gradient_lookup(pixel, table, self.bits).copy())

    # Software.

    async def write(self, index: Any, gx: Any, gy: Any) -> None:
        """Write one entry of the free bank in one cycle, with en high or low."""
        await self.bus.write(index, gx, gy)

    async def rewrite(self, codes: np.ndarray, order: Any = None) -> None:
        for index in order or range(self.bins):
            await self.write(index, *codes[index])

    async def read(self, index: int) -> None:
        """Read the slopes of an entry of the free bank."""
        dut = self.dut
        await self.bus.ask(index, self.bench.random.randrange(self.bins))
        await ClockCycles(dut.clk, READ_CLOCKS)
        for _ in range(self.bench.random.choice((1, 1, 4))):
            self.bus.check(index, *self.to_read)
            await RisingEdge(dut.clk)
        self.bus.idle()

    async def commit(self) -> None:
        """Commit the free bank, when the last access has reached it: frames that begin from now on use it."""
        await RisingEdge(self.dut.clk)
        self.dut.table_bank.value = 1 - self.banks.in_use
        await RisingEdge(self.dut.clk)

    # Frames.

    def words(self, colours: Any) -> Any:
        """Return the words of a frame; only the first has the position of a first pixel."""
        random = self.bench.random
        marks = [FIRST | random.getrandbits(2) << 2]
        marks += [random.choice([m for m in range(16) if m & FIRST != FIRST]) for _ in colours[1:]]
        return list(zip(pack(colours).tolist(), marks, strict=True))

    async def frame(self) -> None:
        """Send every colour, and compare."""
        await send_apart(self.bench, self.driver, self.words(every_colour(self.bits, self.bench.random)), self.gap)
        await self.compare()

    async def compare(self) -> None:
        await self.bench.clocks(LATENCY + 2)
        marks = [place for _, place in self.source.words]
        assert len(self.expected) == len(marks)
        np.testing.assert_array_equal(np.array(self.sink.words), np.column_stack((np.array(self.expected), marks)))
        assert self.sink.starts == [clock + LATENCY for clock in self.source.starts]
        self.source.forget()
        self.sink.forget()
        self.expected.clear()


TRAFFIC = parametrize((("gap", "pause"), [(0.0, 0.0), (0.3, 0.3)]))


@on_bench(Lookup, milliseconds=20)
@TRAFFIC
async def whole_table_then_rewritten(lookup: Lookup) -> None:
    await lookup.frame()
    for _ in range(2):
        codes = uniform((lookup.bins, 2), lookup.width)
        await lookup.rewrite(codes, lookup.bench.random.sample(range(lookup.bins), lookup.bins))
        for index in lookup.bench.random.sample(range(lookup.bins), min(lookup.bins, 64)):
            await lookup.read(index)
        await lookup.frame()  # pixels that use the old table
        await lookup.commit()
        await lookup.frame()
        np.testing.assert_array_equal(lookup.banks.words[lookup.banks.in_use], codes)
    assert lookup.tables == {0, 1}


@on_bench(Lookup, milliseconds=20)
@TRAFFIC
async def rewritten_while_frames_stream(lookup: Lookup, gap: float) -> None:
    """Send short frames back to back; write, read and commit in every one of their cycles."""
    random, running, changes = lookup.bench.random, True, 0

    async def software() -> None:
        nonlocal changes
        while running:
            for _ in range(random.randrange(6)):
                await lookup.write(
                    random.randrange(lookup.bins), *(random.getrandbits(lookup.width - 1) for _ in range(2))
                )
            for _ in range(random.randrange(4)):
                await lookup.read(random.randrange(lookup.bins))
            await ClockCycles(lookup.dut.clk, random.randrange(1, 4))
            await lookup.commit()
            while running and lookup.banks.in_use != int(lookup.dut.table_bank.value):
                if random.random() < 0.5:  # while the change-over is due, in its cycle, and after it
                    await lookup.read(random.randrange(lookup.bins))
                else:
                    await RisingEdge(lookup.dut.clk)
            changes += 1

    working = cocotb.start_soon(software())
    for _ in range(300):
        pixels = np.array([[random.getrandbits(8) for _ in range(3)] for _ in range(random.randrange(4, 24))], np.uint8)
        await send_apart(lookup.bench, lookup.driver, lookup.words(pixels), gap)
    running = False
    await working
    await lookup.compare()
    assert changes > 50, "the test is void: the table hardly changed"
    await lookup.frame()


@on_bench(Lookup, milliseconds=20)
async def reset_keeps_the_table_and_takes_the_bank_over(lookup: Lookup) -> None:
    await lookup.write(0, 1, -2)
    await send_apart(lookup.bench, lookup.driver, lookup.words(np.zeros((3, 3), np.uint8)), 0.0)
    for changes in (False, True, False):
        if changes:
            await lookup.commit()
        await lookup.bench.reset()
        lookup.source.forget()
        lookup.sink.forget()
        await lookup.frame()
    assert (lookup.banks.words[lookup.banks.in_use][0] == (1, -2)).all()
    await lookup.bus.ask(0)  # a read that a reset ends early
    await lookup.bench.reset()
    await lookup.read(0)
