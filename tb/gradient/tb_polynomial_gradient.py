# SPDX-License-Identifier: Apache-2.0
"""polynomial_gradient against its model: both banks, rewritten and read while frames stream; gaps, limits, reset.

The reference follows the pins in every cycle: a frame uses the words that its bank held as the frame began.
"""

import itertools
from pathlib import Path
from typing import Any

import cocotb
import numpy as np
from cocotb.triggers import ClockCycles, RisingEdge

from formal.entries import ROUNDING, Proof
from formal.tables import polynomial_roms
from tactile_depth.chip.common.td_round_saturate import Monitor
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.gradient.polynomial_gradient import LATENCY, coefficients, gradient_parameters, slope_codes
from tactile_depth.chip.registers.register_map import TABLES
from tactile_depth.chip.rom_files import write_polynomials
from tb import pins
from tb.cases import on_bench
from tb.stream import Bench, StreamDriver, StreamMonitor, parameters, parametrize, send_apart
from tb.structures import ICARUS, VERILATOR, Structure
from tb.table_bus import READ_CLOCKS, TableBus, signed

WORDS = (2, 3, 10)  # axes, colours, terms


def any_words(width: int, seed: int = 1) -> Any:
    return np.random.default_rng(seed).integers(-(1 << width - 1), 1 << width - 1, WORDS)


NAMES = ["Width", "DeviationWidth", "CoeffWidth", "WordWidth", "FineBits", "CorrectionWidth", "CorrectionUnit", "Drop"]


def built(*values: int, **runs: Any) -> Structure:
    word = values[NAMES.index("WordWidth")]
    return Structure(
        dict(zip(NAMES, values, strict=True)),
        roms=lambda folder: write_polynomials(folder, any_words(word), word),
        **runs,
    )


STRUCTURES = (
    built(*gradient_parameters(Configuration(columns=16)).values(), on=VERILATOR),
    built(3, 3, 3, 5, 1, 2, 5, 3, on=ICARUS, mutants=ICARUS),
    built(*gradient_parameters(Configuration(columns=16, data_width=12, coefficient_width=10)).values()),
    built(14, 4, 5, 9, 2, 3, 20, 0),
    built(*gradient_parameters(Configuration(columns=16, data_width=32, gradient_limit=2.0**-6)).values()),
    built(6, 4, 4, 4, 0, 4, 9, 1),
    built(10, 4, 5, 9, 3, 4, 3, -2),
    built(12, 4, 5, 9, 1, 4, 31, -2),
)
PROOFS = tuple(
    Proof(
        f"frames of any size; additions are exact at any width; each colour, both axes; {ROUNDING}",
        {"Polynomial": polynomial},
        steps=3,
        roms=polynomial_roms,
    )
    for polynomial in (0, 4, 2)
)


COLOURS = ["red", "green", "blue"]
DEVIATIONS = [*COLOURS, "position"]
SLOPES = ["gx", "gy", "position"]
COUNT, TERMS = 60, 10
TO_CORRECTION = 4  # cycles with en from a pixel to its correction
SMALLEST = [(2, 8), (3, 8), (2, 9)]  # rows and columns


def place(row: Any, column: Any, rows: int, columns: int) -> Any:
    return int(row == 0) | int(column == 0) << 1 | int(row == rows - 1) << 2 | int(column == columns - 1) << 3


class Gradient:
    """Device, its reference, and the accesses of software to the words."""

    in_use = [0] * len(COLOURS)  # bank of each colour; the colours change over in turn
    banks: Any = None  # content of the banks; it survives a reset, so the next test begins with it

    def __init__(self, dut: Any, gap: float = 0.0, pause: float = 0.0) -> None:
        self.dut, self.gap = dut, gap
        names = ("Width", "DeviationWidth", "CoeffWidth", "WordWidth", "Drop")
        self.width, self.deviation_width, self.coefficient_width, self.word_width, self.drop = parameters(dut, *names)
        self.fine_bits, self.correction_width, self.correction_unit = parameters(
            dut, "FineBits", "CorrectionWidth", "CorrectionUnit"
        )
        self.bench = Bench(dut, pause)
        self.random = self.bench.random
        self.driver = StreamDriver(dut, "in", "valid", DEVIATIONS)
        self.source = StreamMonitor(dut, "in", "valid", DEVIATIONS, unsigned=DEVIATIONS[3:])
        self.sink = StreamMonitor(dut, "out", "valid", SLOPES, unsigned=SLOPES[2:])
        # words and pixels (row, column, colours) taken; banks that frames used
        self.frames: list[Any] = []
        self.used: set[Any] = set()
        self.bus = TableBus(dut, TABLES["coefficients"], self.word_width, signed=True)
        dut.table_bank.value = 0
        dut.in_position.value = 0
        dut.correction_gx.value = dut.correction_gy.value = 0

    async def start(self) -> None:
        """Start and reset. On Verilator the first test rewrites both banks.

        The pins of Verilator are random at first and may write a word at the first edge. Icarus tests the content at
        power-up.
        """
        at_power_up = Gradient.banks is None
        if at_power_up:
            lines = [line for p in range(COUNT // TERMS) for line in Path(f"polynomial_{p}.hex").read_text().split()]
            raw = np.array([int(line, 16) for line in lines])
            Gradient.banks = np.stack(2 * [raw - (raw >> (self.word_width - 1) << self.word_width)])
        await self.bench.start()
        Gradient.in_use = [0] * len(COLOURS)  # changed by the reset
        cocotb.start_soon(self.follow())
        if at_power_up and cocotb.SIM_NAME.lower().startswith("verilator"):
            for words in self.banks[::-1].copy():
                await self.rewrite(words)
                await self.commit()
                await self.send(2, 8)
            await self.compare()
        self.used.clear()
        self.bench.saturations = 0

    async def follow(self) -> None:
        dut = self.dut
        rst, en, valid, position = map(pins.unsigned, (dut.rst, dut.en, dut.in_valid, dut.in_position))
        table_in_use, table_bank = pins.unsigned(dut.table_in_use), pins.unsigned(dut.table_bank)
        corrections = [pins.signed(dut.correction_gx), pins.signed(dut.correction_gy)]
        colours = [pins.signed(getattr(dut, f"in_{colour}")) for colour in COLOURS]
        named = 0  # bank of the next frame
        waiting: list[tuple[int, list[Any]]] = []  # cycles with en since each pixel was taken, and the pixel
        begun: list[int] = []  # cycles with en since each first pixel was taken
        while True:
            await RisingEdge(dut.clk)
            assert table_in_use() == self.in_use[-1]
            wanted = table_bank()
            access = self.bus.step()
            if access and access["write"]:
                assert [wanted] * len(COLOURS) == self.in_use, "written while a change-over is due"
                self.banks[1 - wanted][access["index"]] = signed(access["low"], self.word_width)
            if rst():
                named, begun, Gradient.in_use = wanted, [], [wanted] * len(COLOURS)
                waiting.clear()
                self.frames.clear()
            elif en():
                begun = [age + 1 for age in begun if age < len(COLOURS)]
                waiting = [(age + 1, pixel) for age, pixel in waiting]
                if waiting and waiting[0][0] == TO_CORRECTION:
                    waiting.pop(0)[1].append([read() for read in corrections])
                self.correct()
                for colour in (age - 1 for age in begun):
                    self.in_use[colour] = named
            if not rst() and en() and valid():
                marks = position()
                if marks & 3 == 3:
                    named = wanted
                    begun.append(0)
                    self.used.add(named)
                    self.frames.append((self.banks[named].copy(), []))
                    row = column = 0
                elif marks & 2:
                    row, column = row + 1, 0
                else:
                    column += 1
                self.frames[-1][1].append([row, column, [read() for read in colours]])
                waiting.append((0, self.frames[-1][1][-1]))
            if access and access["read"]:  # in the cycle of a change-over: of the previous bank
                index = access["index"]
                self.to_read = int(self.banks[1 - self.in_use[index // TERMS % len(COLOURS)]][index])

    def correct(self) -> None:
        """Drive other corrections: none, at the limits, or any."""
        low, high = -1 << self.correction_width - 1, (1 << self.correction_width - 1) - 1
        for axis in ("gx", "gy"):
            value = self.random.choice((0, 0, low, high, self.random.randint(low, high)))
            getattr(self.dut, f"correction_{axis}").value = value

    # Software.

    async def write(self, index: Any, word: Any) -> None:
        """Write one word of the free bank in one cycle, as soon as no change-over is due, with en high or low."""
        while len({*self.in_use, int(self.dut.table_bank.value)}) > 1:
            await RisingEdge(self.dut.clk)
        await self.bus.write(index, word)

    async def rewrite(self, words: Any) -> None:
        for index in self.random.sample(range(COUNT), COUNT):
            await self.write(index, words[index])

    async def read(self, index: int) -> None:
        dut = self.dut
        await self.bus.ask(index, self.random.randrange(COUNT))
        await ClockCycles(dut.clk, READ_CLOCKS)
        for _ in range(self.random.choice((1, 1, 4))):
            self.bus.check(index, self.to_read)
            await RisingEdge(dut.clk)
        self.bus.idle()

    async def commit(self) -> None:
        """Commit the free bank, when the last access has reached it: frames that begin from now on use it."""
        await RisingEdge(self.dut.clk)
        self.dut.table_bank.value = 1 - int(self.dut.table_bank.value)
        await RisingEdge(self.dut.clk)

    async def use(self, words: Any) -> None:
        """Write these words and commit them: the next frame uses them."""
        await self.rewrite(words)
        await self.commit()

    # Frames.

    def any_words(self) -> Any:
        """Return random words: at the limits, over the whole range, small ones, planes, or constants."""
        kind = self.random.randrange(5)
        if kind == 0:
            return corners_of(self.random, COUNT, self.word_width)
        width = self.word_width - (self.random.randrange(self.word_width // 2) if kind > 1 else 0)
        words = np.array([self.random.randrange(-1 << width - 1, 1 << width - 1) for _ in range(COUNT)])
        words = words.reshape(WORDS)
        if kind == 3:
            words[:, :, [2, 3, 5, 6, 7, 8, 9]] = 0
        if kind == 4:
            words[:, :, 1:] = 0
        return words.reshape(COUNT)

    def any_deviation(self) -> Any:
        """Return random deviations: over a range, at the limits, or multiples of half a step of the result, which are
        ties."""
        width = self.deviation_width
        kind = self.random.randrange(4)
        if kind == 0:
            return corners_of(self.random, 3, width)
        if kind == 1:
            width = self.random.randrange(1, width)
        grain = min(max(self.drop - 1, 0), width - 1) if kind == 2 else 0
        return [self.random.randrange(-1 << width - 1, 1 << width - 1) >> grain << grain for _ in COLOURS]

    async def send(self, rows: int, columns: int, pixels: Any = None, deviations: Any = None) -> None:
        """Send a frame, or its first pixels."""
        words = []
        for index in range(rows * columns if pixels is None else pixels):
            colours = self.any_deviation() if deviations is None else deviations[index]
            words.append((*colours, place(*divmod(index, columns), rows, columns)))
        await send_apart(self.bench, self.driver, words, self.gap)

    async def compare(self, last: int = 0) -> Any:
        """Compare all pixels, or those of the last frame; return the number of values clipped."""
        await self.bench.clocks(LATENCY + 2)
        assert self.sink.starts == [clock + LATENCY for clock in self.source.starts]
        if last:
            self.source.forget_but(last)
            self.sink.forget_but(last)
            del self.frames[:-1]
        slopes, clipped = [], Monitor()
        for words, pixels in self.frames:
            rows, columns, colours, corrections = (np.array(part) for part in zip(*pixels, strict=True))
            grid, widths = (
                (rows.max() + 1, columns.max() + 1),
                (self.word_width, self.fine_bits, self.coefficient_width),
            )
            factors = coefficients(words.reshape(WORDS), *grid, *widths)[:, :, rows, columns][:, :, None]
            added = corrections[None] * self.correction_unit
            slopes.append(slope_codes(colours[None], factors, self.drop, self.width, clipped, added)[0])
        marks = [word[-1] for word in self.source.words]
        expected = np.column_stack((np.concatenate(slopes), marks))
        np.testing.assert_array_equal(np.array(self.sink.words), expected)
        total = clipped.saturations.total()
        assert last or self.bench.saturations == total, f"{self.bench.saturations} values clipped, {total} in the model"
        self.forget()
        return total

    def forget(self) -> None:
        self.source.forget()
        self.sink.forget()
        self.frames.clear()
        self.bench.saturations = 0


def corners_of(random: Any, count: int, width: int) -> Any:
    """Return random values, mostly the lowest and the highest."""
    low, high = -1 << width - 1, (1 << width - 1) - 1
    return np.array([random.choice((*6 * [low, high], -1, 0)) for _ in range(count)])


TRAFFIC = parametrize((("gap", "pause"), [(0.0, 0.0), (0.3, 0.3)]))


@on_bench(Gradient, milliseconds=20)
@TRAFFIC
async def both_banks(device: Gradient) -> None:
    """Send frames with the words of power-up, then with new words, each read back before it is used."""
    await device.send(5, 9)
    await device.compare()
    for _ in range(2):
        words = device.any_words()
        await device.rewrite(words)
        for index in device.random.sample(range(COUNT), COUNT):
            await device.read(index)
        await device.send(3, 8)  # pixels that use the old words
        await device.commit()
        await device.send(5, 9)
        await device.compare()
        np.testing.assert_array_equal(device.banks[device.in_use[-1]], words)
    assert device.used == {0, 1}


@on_bench(Gradient, milliseconds=20)
@TRAFFIC
async def limits(device: Gradient) -> None:
    """Use words and deviations of every kind, so that sums clip in both directions and polynomials overflow."""
    clipped = 0
    for _ in range(25):
        await device.use(device.any_words())
        await device.send(device.random.choice((3, 3, 9)), 8)  # in the lowest bit a carry of rows counts late
        clipped += await device.compare()
    for word in (-1 << device.word_width - 1, (1 << device.word_width - 1) - 1):
        await device.use(np.where(np.arange(COUNT) % TERMS, 0, word))
        low, high = -1 << device.deviation_width - 1, (1 << device.deviation_width - 1) - 1
        await device.send(2, 8, deviations=[[low] * 3, [high] * 3] * 8)
        clipped += await device.compare()
    largest = (3 << device.deviation_width + device.coefficient_width - 2) * 2.0**-device.drop
    assert clipped or largest < 2 ** (device.width - 1), "the test is void: nothing was clipped"


@on_bench(Gradient, milliseconds=20)
@TRAFFIC
async def rewritten_while_frames_stream(device: Gradient) -> None:
    """Send frames back to back; write, read and commit in every one of their cycles."""
    random, running, changes = device.random, True, 0

    async def software() -> None:
        nonlocal changes
        while running:
            words = device.any_words()
            for index in random.sample(range(COUNT), random.randrange(COUNT)):
                await device.write(index, words[index])
            for _ in range(random.randrange(4)):
                await device.read(random.randrange(COUNT))
            await ClockCycles(device.dut.clk, random.randrange(1, 4))
            await device.commit()
            while running and device.in_use[-1] != int(device.dut.table_bank.value):
                if random.random() < 0.5:  # while the change-over is due, in its cycle, and after it
                    await device.read(random.randrange(COUNT))
                else:
                    await RisingEdge(device.dut.clk)
            changes += 1

    working = cocotb.start_soon(software())
    for _ in range(120):
        await device.send(*random.choice(SMALLEST))
    running = False
    await working
    await device.compare()
    assert changes > 20, "the test is void: the words hardly changed"


@on_bench(Gradient, milliseconds=20)
async def reset_keeps_the_words_and_takes_the_bank_over(device: Gradient) -> None:
    """Reset among pixels that all clip: none is counted after it, the words stay, and the due bank is taken."""
    lowest = [[-1 << device.deviation_width - 1] * 3]
    words = np.where(np.arange(COUNT) % TERMS, 0, -1 << device.word_width - 1)
    for pixels, moving in itertools.product((*range(1, 15), 16, 20), (False, True)):
        await device.use(words)
        await device.send(3, 8, pixels, lowest * pixels)
        if device.random.random() < 0.5:
            await device.commit()
        if moving:  # with en
            device.dut.rst.value = 1
            await RisingEdge(device.dut.clk)
            device.dut.rst.value = 0
        else:
            await device.bench.reset()
        device.forget()
        if pixels % 2:
            await device.bench.clocks(LATENCY + 2)
            assert not device.sink.starts, f"pixels left after a reset at {pixels}"
            assert device.bench.saturations == 0, f"clipped words were counted after a reset at {pixels}"
        await device.use(device.any_words())
        await device.send(3, 8)
        await device.compare()
    await device.read(3)


@on_bench(Gradient, milliseconds=20)
@TRAFFIC
async def a_cut_frame_does_no_harm_to_the_next(device: Gradient) -> None:
    """Cut a frame short, which only an upset of a mark can do: the next frame is right."""
    for pixels in (*range(1, 15), 20):
        await device.use(device.any_words())
        await device.send(3, 8, pixels)
        await device.use(device.any_words())
        await device.send(3, 8, pixels)
        await device.send(3, 8)
        await device.compare(last=24)
