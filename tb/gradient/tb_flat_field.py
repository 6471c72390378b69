# SPDX-License-Identifier: Apache-2.0
"""flat_field against its model: colours, dark pixels and their counts; gains changed over while frames stream."""

import random
from typing import Any

import cocotb
import numpy as np
from cocotb.triggers import RisingEdge

from formal.entries import ROUNDING, WORD_FREE, Proof
from formal.tables import gain_rom
from tactile_depth.chip.common.td_node_map import node_map
from tactile_depth.chip.common.td_round_saturate import Monitor
from tactile_depth.chip.fixed_point import Format
from tactile_depth.chip.gradient.flat_field import (
    CODE,
    LATENCY,
    PixelGains,
    flat_field_parameters,
    pixel_gains,
    unit_gains,
)
from tactile_depth.chip.limits import DEVIATION, RATIO
from tactile_depth.chip.registers.register_map import TABLES
from tactile_depth.chip.rom_files import write_gains
from tb import pins
from tb.cases import on_bench
from tb.nodes import Grid, Nodes, reads_as_a_pause_ends
from tb.pixels import pack
from tb.stream import (
    MANY,
    Bench,
    StreamDriver,
    StreamMonitor,
    check_words,
    parameters,
    parametrize,
    raster,
    sample,
    send_apart,
)
from tb.structures import ICARUS, VERILATOR, Structure


def built(columns: int, rows: int, block_log2: int, output: Format, gain_width: int, **runs: Any) -> Structure:
    config = Grid(rows, columns, block_log2, Format(gain_width, 0))
    return Structure(
        flat_field_parameters(config, output),  # type: ignore[arg-type]
        roms=lambda folder: write_gains(folder, unit_gains(config), gain_width),  # type: ignore[arg-type]
        **runs,
    )


STRUCTURES = (
    built(16, 11, 2, CODE, 24, on=VERILATOR, mutants=ICARUS),
    built(
        16,
        8,
        1,
        DEVIATION,
        17,
        on=ICARUS,
    ),
    built(16, 11, 2, DEVIATION, 24, mutants=ICARUS),
    built(32, 21, 1, CODE, 24),
    built(128, 8, 3, CODE, 24),
    built(64, 64, 2, DEVIATION, 24),
    built(16, 8, 1, RATIO, 17, mutants=ICARUS),
    built(16, 8, 1, DEVIATION, 16),
    built(128, 8, 3, DEVIATION, 17),
)
PROTOCOL = {
    "protocol_node_map": {
        "Channels": 3,
        "Select": "td_register_map_pkg::TableSelectReference",
        "in_frame_start": "&in_position[1:0]",
    },
    "in_position": "in_valid & ~rst ? place : in_position",
    "out_position out_red out_green out_blue": "counts_out_valid & out_valid",
    "capture_read_gains": "captured",
    "dark saturations": "live & ~reset",
}
PROOFS = (
    Proof(
        f"every clock reads a node; {WORD_FREE}",
        {"Meets": 1},
        roms=gain_rom(2),
        free=("gains",),
    ),
    *(
        Proof(
            f"products are exact at any width; {ROUNDING}",
            {"Meets": 0, "GainWidth": 4, "Drop": 1, "Offset": offset, "OutWidth": width, "Flat": flat},
            roms=gain_rom(2),
            free=("gains", "gain_valid", "gain_position", "colours", "dim"),
        )
        for offset, width, flat in ((0, 1, 1), (2, 2, 0))
    ),
)


PIXELS = 2048  # that a test sends, at least
PIXEL = ["pixel", "position"]
COLOURS = ["red", "green", "blue", "position"]


def picture(rows: int, columns: int, chance: random.Random, level: int) -> Any:
    """Return random pixels, uint8 (rows, columns, 3), some of them dark or nearly dark: single ones, runs and whole
    rows."""
    generator = np.random.default_rng(chance.getrandbits(32))
    pixels = generator.integers(0, 256, (rows, columns, 3))
    if not level:
        return pixels.astype(np.uint8)
    dim = generator.integers(0, level, (rows, columns, 3))
    dark = generator.random((rows, columns)) < chance.choice((0.05, 0.5, 0.9))
    dark |= (generator.random(rows) < 0.2)[:, None]  # whole rows
    dark[:, 0] |= generator.random(rows) < 0.3
    pixels = np.where(dark[..., None], dim, pixels)
    nearly = generator.random((rows, columns)) < 0.1
    one = np.arange(3) == generator.integers(0, 3, (rows, columns, 1))
    return np.where((nearly[..., None] & one), level, pixels).astype(np.uint8)


class Gains(Nodes):
    """Memory of the gains."""

    capture_pin, read_pin = "capture_gains", "capture_read_gains"

    def at_power_up(self) -> Any:
        return unit_gains(self.config)


class Field:
    """Device, and the words that the model expects for every frame sent."""

    def __init__(self, dut: Any, gap: float = 0.0, pause: float = 0.0) -> None:
        self.dut, self.gap = dut, gap
        self.config = Grid.of(dut, "GainWidth")
        offset, width = parameters(dut, "Offset", "OutWidth")
        self.model: Any = (
            PixelGains.deviations if offset else PixelGains.codes if width == CODE.width else PixelGains.ratios
        )
        self.places = raster(self.config.rows, self.config.columns)
        self.frames = max(2, PIXELS // len(self.places))
        self.large = len(self.places) > PIXELS  # so that a large grid gets a few frames only
        self.bench = Bench(dut, pause)
        self.gains = Gains(dut, self.config, TABLES["reference"], channels=3)
        self.driver = StreamDriver(dut, "in", "valid", PIXEL)
        self.source = StreamMonitor(dut, "in", "valid", PIXEL, unsigned=PIXEL)
        unsigned = ["position"] if self.model is PixelGains.deviations else COLOURS
        self.sink = StreamMonitor(dut, "out", "valid", COLOURS, unsigned=unsigned)
        self.monitor = Monitor()
        self.sent: list[Any] = []
        self.expected: list[Any] = []
        self.dark = 0
        self.darkened = 0
        dut.dark_level.value = 0

    async def start(self, written: bool = True) -> None:
        await self.bench.start()
        await self.gains.settle(written)
        cocotb.start_soon(self.count())

    async def count(self) -> None:
        edge, rst, dark = RisingEdge(self.dut.clk), pins.unsigned(self.dut.rst), pins.unsigned(self.dut.dark)
        while True:
            await edge
            if not rst():
                self.darkened += dark()

    async def send(self, frames: int = 1, level: int | None = None, pixels: Any = None, named: Any = None) -> None:
        """Send frames back to back, each with the gains and the dark level at its beginning.

        The other bank is selected after `change` words."""
        chance = self.bench.random
        for _ in range(frames):
            chosen_level = chance.choice((0, 1, 16, 100, 255)) if level is None else level
            frame = picture(self.config.rows, self.config.columns, chance, chosen_level) if pixels is None else pixels
            words = list(zip(pack(frame).ravel().tolist(), self.places, strict=True))
            while chance.random() < self.gap:
                await self.bench.clocks(1)
            gains = pixel_gains(self.gains.begin_frame().copy(), self.config)
            self.expected.append(self.model(gains, frame, chosen_level, self.monitor))
            self.dark += int(gains.dark(frame, chosen_level).sum())
            self.sent += words
            self.dut.dark_level.value = chosen_level
            await send_apart(self.bench, self.driver, words[:1], 0.0)
            self.dut.dark_level.value = chance.randrange(256)
            await send_apart(self.bench, self.driver, words[1:named], self.gap)
            if named:
                self.gains.change()
                await send_apart(self.bench, self.driver, words[named:], self.gap)

    async def check(self) -> None:
        await self.bench.clocks(LATENCY + 3)
        assert self.source.words == self.sent, "the driver sent other words than the test gave it"
        colours = np.concatenate([frame.reshape(-1, 3) for frame in self.expected]).astype(np.int64)
        want = np.column_stack((colours, [place for _, place in self.sent]))
        check_words(np.array(self.sink.words), want, self.config.columns, self.config.rows)
        assert self.sink.starts == [clock + LATENCY for clock in self.source.starts]
        assert self.darkened == self.dark, f"{self.darkened} dark pixels counted, the model has {self.dark}"
        clipped = self.monitor.saturations.total()
        assert self.bench.saturations == clipped, f"{self.bench.saturations} values clipped, {clipped} in the model"

    def forget(self) -> None:
        self.source.forget()
        self.sink.forget()
        self.sent, self.expected, self.monitor = [], [], Monitor()
        self.dark = self.darkened = 0


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def at_power_up(dut: Any) -> None:
    """Use the gains at power-up, those of a reference of 128: codes equal the pixels, the others are relative to
    128."""
    device = Field(dut, 0.0, 0.0)
    await device.start(written=False)
    rows, columns = device.config.rows, device.config.columns
    pixels = picture(rows, columns, device.bench.random, 0)
    pixels.reshape(-1)[:256] = np.arange(256)
    await device.send(level=0, pixels=pixels)
    await device.check()
    (codes,) = device.expected
    wide = pixels.astype(int)
    relative = {
        PixelGains.codes: wide,
        PixelGains.deviations: wide - 128 << DEVIATION.fraction - 7,
        PixelGains.ratios: wide << RATIO.fraction - 7,
    }
    np.testing.assert_array_equal(codes, relative[device.model])


@on_bench(Field, milliseconds=60)
@parametrize((("gap", "pause"), sample([(0.0, 0.0), (0.0, 0.3), (0.3, 0.0), (0.7, 0.5)])))
async def frames_while_the_bus_rewrites(device: Field) -> None:
    await device.gains.write(device.gains.random(device.bench.random))
    device.gains.due = True
    going_on = [True]
    rewriter = cocotb.start_soon(device.gains.rewrite(device.bench.random, lambda: going_on[0]))
    await device.send(device.frames)
    going_on[0] = False
    await rewriter
    await device.check()
    assert device.dark, "the test is void: no dark pixel"


@on_bench(Field, milliseconds=20)
async def read_as_a_pause_ends(device: Field) -> None:
    await reads_as_a_pause_ends(device, device.gains)
    await device.check()


@on_bench(Field, milliseconds=20)
async def named_inside_a_frame(device: Field) -> None:
    """Select the other bank at any word of a frame: the next frame uses it."""
    size = len(device.places)
    for count in range(3, size, size if device.large else max(device.config.columns + 1, size // 5)):
        await device.gains.write(device.gains.random(device.bench.random))
        await device.send(named=count)
        await device.send()
    await device.check()


@on_bench(Field, milliseconds=20)
async def products_at_their_limits(device: Field) -> None:
    """Reach ties of the rounding, the largest pixel with the largest gain that is not dark, and products just beyond
    both limits."""
    drop = parameters(device.dut, "Drop")[0]
    half = 1 << (drop - 1)
    dead = 1 << device.gains.width - 1
    gains = (half, 3 * half, dead - 1, dead, dead // 2 + half // 2)
    for gain in gains[2:3] if device.large else gains:
        await device.gains.write(np.full((*device.config.reference_nodes, 3), gain))
        device.gains.due = True
        await device.send(level=0)
        await device.send(level=0, pixels=np.full((device.config.rows, device.config.columns, 3), 255, np.uint8))
        await device.gains.changed()
    await device.check()
    assert device.bench.saturations, "the test is void: nothing was clipped"


def beside_ties(gains: np.ndarray, drop: int) -> Any:
    """Return the pixels, uint8 (rows, columns, 3), whose products with the gains at their positions lie nearest to a
    tie."""
    products = np.arange(256)[:, None, None, None] * gains
    return np.abs(products % (1 << drop) - (1 << drop - 1)).argmin(axis=0).astype(np.uint8)


@on_bench(Field, milliseconds=60)
async def products_beside_ties(device: Field) -> None:
    """Send pixels beside ties, whose rounding depends on the lowest bits of the gain."""
    (drop,) = parameters(device.dut, "Drop")
    for _ in range(2 if device.large else 2 * MANY):
        gains = device.gains.random(device.bench.random)
        await device.gains.write(gains)
        device.gains.due = True
        await device.send(level=0, pixels=beside_ties(node_map(gains, device.config), drop))
        await device.gains.changed()
    await device.check()


@on_bench(Field, milliseconds=20)
async def resets(device: Field) -> None:
    """Reset inside a frame with pixels in each stage: none of them leaves or is counted, and the next frame is
    right."""
    generator = np.random.default_rng(1)
    counts = (1, 2, 3, 4, 8, 10, 11, 12, 13, 14, 2 * device.config.columns + 3)
    for count in counts[-1:] if device.large else counts:
        await device.gains.write(
            generator.integers(1 << device.gains.width - 5, 1 << device.gains.width, device.gains.banks[0].shape)
        )
        words = [(generator.integers(0, 1 << 24), place) for place in device.places[:count]]
        device.dut.dark_level.value = 128
        await send_apart(device.bench, device.driver, words, 0.0)
        if count % 2:
            device.gains.change()
        await device.bench.reset()
        device.forget()
        if count % 3 == 0:
            await device.bench.clocks(LATENCY + 2)
            assert not device.sink.starts, f"words left after a reset at {count}"
            assert not device.darkened
        await device.send()
        await device.check()
