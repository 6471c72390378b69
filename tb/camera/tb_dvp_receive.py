# SPDX-License-Identifier: Apache-2.0
"""dvp_receive against its model at every edge of both clocks: anything at the pins, at many ratios of the clocks."""

import itertools
import random
from collections.abc import Iterable
from typing import Any

import cocotb
import numpy as np
from cocotb.triggers import ClockCycles, RisingEdge

from formal.entries import Proof
from tactile_depth.chip.camera.dvp_receive import IDLE, Beat, DvpReceive, Pins, camera_pins
from tactile_depth.chip.common.td_async_fifo import AsyncFifo
from tb.axis import AxisSink
from tb.pins import Driver
from tb.stream import REGRESS, parameters, parametrize
from tb.structures import BOTH, ICARUS, of_parameters
from tb.two_clocks import RATIOS, run_clock, watch

built = of_parameters("FifoLog2")
STRUCTURES = (built(4, on=BOTH), built(3, on=ICARUS, mutants=ICARUS))
REFUSED = {"FifoLog2_must_be_at_least_3_or_nearly_equal_clocks_lose_every_frame": "FifoLog2=2"}
PROTOCOL = {"counts": "live", "m_axis_tdata m_axis_tlast m_axis_tuser": "live & m_axis_tvalid"}
PROOFS = (Proof("the widths in use; td_async_fifo is proven by itself", free=("write_ready", "read_valid", "word")),)


ROWS, BYTES = 3, 12
CAMERA = ("vsync", "href", "data")
SYSTEM = ("rst", "m_axis_tready", "m_axis_tvalid", "m_axis_tdata", "m_axis_tlast", "m_axis_tuser", "frames_lost")


class Bench:
    """Both clocks, the sink, and a record of the pins; `check` compares the record with the model."""

    def __init__(self, dut: Any) -> None:
        self.dut, self.drive = dut, Driver(dut)
        self.random = random.Random(cocotb.RANDOM_SEED)
        self.events: list[Any] = []

    async def start(self, ratio: str, accepts: Iterable[bool]) -> None:
        """Start the clocks, empty the queue, and reset."""
        dut = self.dut
        dut.rst.value = 1
        self.drive(vsync=0, href=0, data=0)
        for seed, (clock, period) in enumerate(zip((dut.pclk, dut.clk), RATIOS[ratio], strict=True)):
            cocotb.start_soon(run_clock(clock, period, seed))
        (fifo_log2,) = parameters(dut, "FifoLog2")
        self.sink = AxisSink(dut, "m_axis", prefix="t")
        await self.settle(fifo_log2)
        self.model = DvpReceive(AsyncFifo(1 << fifo_log2))
        cocotb.start_soon(watch(dut.pclk, [getattr(dut, pin) for pin in CAMERA], self.events, "camera"))
        cocotb.start_soon(watch(dut.clk, [getattr(dut, pin) for pin in SYSTEM], self.events, "system"))
        self.sink.stall(accepts)
        dut.rst.value = 0
        await RisingEdge(dut.clk)

    async def settle(self, fifo_log2: int) -> None:
        """Begin and end a frame, so that the side of the camera waits for the next one; reset the words that have
        crossed."""
        await self.play([Pins(True, False, 0)] * 2)
        await self.play([IDLE] * 4)
        await ClockCycles(self.dut.clk, 8 + (1 << fifo_log2))
        await ClockCycles(self.dut.pclk, 4)
        await self.play([Pins(True, False, 0)] * 2)
        await self.play([IDLE] * 4)
        await ClockCycles(self.dut.clk, 8)
        await ClockCycles(self.dut.pclk, 4)

    async def play(self, pins: Iterable[Pins]) -> None:
        """Drive the pins of the camera, one entry in each cycle of pclk."""
        edge = RisingEdge(self.dut.pclk)
        for vsync, href, data in pins:
            self.drive(vsync=vsync, href=href, data=data)
            await edge
        self.drive(vsync=0, href=0)

    async def end(self) -> None:
        """Wait until the queue is empty, and check every edge."""
        self.sink.stall(itertools.repeat(True))
        (fifo_log2,) = parameters(self.dut, "FifoLog2")
        await ClockCycles(self.dut.pclk, 6)
        await ClockCycles(self.dut.clk, 10 + (1 << fifo_log2))
        self.check()

    def check(self) -> None:
        """Compare the outputs before each edge with the model, which takes the inputs before that edge."""
        model = self.model
        model.receiving = True  # as `settle` leaves it
        for time, edges in itertools.groupby(self.events, key=lambda event: event[0]):
            pins = {side: values for _, side, values in edges}
            camera, sink = pins.get("camera"), None
            if "system" in pins:
                at = pins["system"]
                sink = bool(at["rst"]), bool(at["m_axis_tready"])
                beat_at_pins = None
                if at["m_axis_tvalid"]:
                    flags = bool(at["m_axis_tlast"]), bool(at["m_axis_tuser"])
                    beat_at_pins = Beat(int(at["m_axis_tdata"]), *flags)
                assert beat_at_pins == model.beat, f"at {time} ps"
                assert int(at["frames_lost"]) == model.frames_lost, f"frames_lost at {time} ps"
            sampled = Pins(bool(camera["vsync"]), bool(camera["href"]), int(camera["data"])) if camera else None
            model.edges(sampled, sink)


@cocotb.test(timeout_time=5, timeout_unit="ms")
@parametrize(ratio=list(RATIOS))
async def anything(dut: Any, ratio: str) -> None:
    """Play frames, more of them than are counted while the sink stalls, and pins at random; reset at any time."""
    bench = Bench(dut)
    chance = bench.random
    runs = (
        [True] * chance.choice((1, 60, 400)) + [False] * chance.choice((1, 40, 400)) for _ in itertools.repeat(None)
    )
    await bench.start(ratio, itertools.chain.from_iterable(runs))
    empty = [Pins(True, False, 0), IDLE, Pins(False, True, 1), IDLE]
    for _ in range(60 if REGRESS else 20):
        picture = np.frombuffer(chance.randbytes(ROWS * BYTES), np.uint8).reshape(ROWS, BYTES)
        match chance.randrange(3):
            case 0:
                await bench.play(camera_pins(picture, 3, chance.choice((4, 40))))
            case 1:
                await bench.play(empty * chance.choice((1, 3)))
            case 2:
                vsync = [Pins(True, chance.random() < 0.2, chance.getrandbits(8))] * chance.choice((0, 1, 2, 6))
                href = [Pins(False, True, chance.getrandbits(8)) for _ in range(chance.choice((1, 2, 9, 20)))]
                await bench.play([*vsync, *[Pins(False, False, 255)] * chance.randint(0, 4), *href])
        if chance.random() < 0.1:
            dut.rst.value = 1
            await ClockCycles(dut.clk, chance.choice((1, 2, 5)))
            dut.rst.value = 0
    bench.sink.stall(itertools.repeat(False))
    await bench.play(camera_pins(picture, 3, 4))
    await bench.play(empty * 300)
    bench.sink.stall(itertools.repeat(True))
    await bench.play([IDLE] * 40)
    await bench.play(camera_pins(picture, 3, 4))
    await bench.end()
