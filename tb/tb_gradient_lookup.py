# SPDX-License-Identifier: Apache-2.0
"""gradient_lookup against its model: the whole table, rewritten between frames; gaps, pauses, reset."""

import cocotb
import numpy as np
from cocotb.triggers import RisingEdge
from stream import Bench, StreamDriver, StreamMonitor, configuration, parameters, send_apart, uniform

from models.calibration import synthetic
from models.gradient_lookup import gradient_codes, gradient_lookup
from models.latency import GRADIENT_LOOKUP

PIXEL = ["pixel", "place"]
SLOPES = ["gx", "gy", "place"]


def every_colour(bits, random):
    """Each bin of the table once, in random order, its lower bits random; and each again in reverse."""
    bins = np.array(random.sample(range(1 << 3 * bits), 1 << 3 * bits))
    top = np.stack((bins >> 2 * bits, bins >> bits, bins), axis=-1) & (1 << bits) - 1
    low = np.array([random.getrandbits(8 - bits) for _ in range(3 * len(bins))]).reshape(-1, 3)
    colours = (top << (8 - bits) | low).astype(np.uint8)
    return np.concatenate((colours, colours[::-1]))


class Lookup:
    """The device, and what the model says of each frame sent."""

    def __init__(self, dut, gap, pause):
        self.dut, self.gap = dut, gap
        self.width, self.bits = parameters(dut, "Width", "BitsPerChannel")
        self.codes = gradient_codes(synthetic(self.bits), configuration())  # the table at power-up
        self.bench = Bench(dut, pause)
        self.driver = StreamDriver(dut, "in", "valid", PIXEL)
        self.source = StreamMonitor(dut, "in", "valid", PIXEL, unsigned=PIXEL)
        self.sink = StreamMonitor(dut, "out", "valid", SLOPES, unsigned=SLOPES[2:])
        dut.write_en.value = 0

    async def start(self):
        """Verilator begins with random pins, so that a first edge may have written a word: there the table is written
        anew, and what it holds at power-up is tested on Icarus and by the top."""
        await self.bench.start()
        if cocotb.SIM_NAME.lower().startswith("verilator"):
            for index, slopes in enumerate(self.codes.tolist()):
                await self.write(index, *slopes)

    async def write(self, index, gx, gy):
        """One word of the table, in one clock, whether or not the pipeline moves."""
        for pin, value in (("write_en", 1), ("write_index", index), ("write_gx", gx), ("write_gy", gy)):
            getattr(self.dut, pin).value = int(value)
        await RisingEdge(self.dut.clk)
        self.dut.write_en.value = 0
        self.codes[index] = gx, gy

    async def frame(self):
        """Every colour, with random marks; then compare."""
        self.source.forget()
        self.sink.forget()
        colours = every_colour(self.bits, self.bench.random)
        marks = np.array([self.bench.random.getrandbits(4) for _ in colours])
        red, green, blue = colours.astype(np.int64).T
        words = list(zip(red << 16 | blue << 8 | green, marks, strict=True))
        await send_apart(self.bench, self.driver, words, self.gap)
        await self.bench.clocks(GRADIENT_LOOKUP + 2)
        assert self.source.words == words, "the driver sent something else"
        slopes = gradient_lookup(colours, self.codes, self.bits)
        expected = np.column_stack((slopes, marks))
        np.testing.assert_array_equal(np.array(self.sink.words), expected)
        assert self.sink.starts == [clock + GRADIENT_LOOKUP for clock in self.source.starts]


@cocotb.test(timeout_time=10, timeout_unit="ms")
@cocotb.parametrize((("gap", "pause"), [(0.0, 0.0), (0.3, 0.3)]))
async def whole_table_then_rewritten(dut, gap, pause):
    lookup = Lookup(dut, gap, pause)
    await lookup.start()
    initial = lookup.codes.copy()
    await lookup.frame()
    for index, (gx, gy) in enumerate(uniform((len(initial), 2), lookup.width)):
        await lookup.write(index, gx, gy)
    await lookup.frame()
    for index in lookup.bench.random.sample(range(len(initial)), len(initial)):
        await lookup.write(index, *initial[index])  # as the next test, and the model, expects it
    await lookup.frame()


@cocotb.test(timeout_time=10, timeout_unit="ms")
async def reset_in_mid_frame_keeps_the_table(dut):
    lookup = Lookup(dut, 0.0, 0.0)
    await lookup.start()
    initial = lookup.codes[0].copy()
    await lookup.write(0, 1, -2)
    await send_apart(lookup.bench, lookup.driver, [(0, 15)] * 3, 0.0)
    await lookup.bench.reset()
    await lookup.frame()
    await lookup.write(0, *initial)
