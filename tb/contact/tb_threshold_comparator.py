# SPDX-License-Identifier: Apache-2.0
"""threshold_comparator against tactile_depth.chip.contact.threshold_comparator: contact in every cycle."""

import random
from typing import Any

import cocotb
from cocotb.triggers import RisingEdge

from formal.entries import FULL_WIDTH, Proof
from tactile_depth.chip.contact.threshold_comparator import ThresholdComparator
from tb.cases import on_bench
from tb.stream import parameters, start_clock
from tb.structures import BOTH, ICARUS, VERILATOR, of_parameters

built = of_parameters("Width Lanes")
STRUCTURES = (
    built(12, 1, on=BOTH, mutants=ICARUS),
    built(32, 1, on=VERILATOR),
    built(12, 4, on=ICARUS, mutants=ICARUS),
    built(24, 32),
    built(32, 2),
)
PROTOCOL = {
    "begun": {"begins": "in_valid & in_frame_start"},
    "holds": "rst | ~in_valid | begun | in_frame_start",
    "counts": "live & ~reset",
}
PROOFS = tuple(
    Proof(
        f"{FULL_WIDTH}; of several depths, which are only compared, any one decides",
        {"Width": width, "Lanes": lanes},
    )
    for width, lanes in ((24, 1), (4, 2))
)


CLOCKS = 5000
WORD_BITS = 32


class Bench:
    """Driver of one cycle at a time; contact is compared with the model, which takes the beats of earlier cycles."""

    def __init__(self, dut: Any) -> None:
        self.dut, self.model = dut, ThresholdComparator()
        self.random = random.Random(cocotb.RANDOM_SEED)
        self.width, self.lanes = parameters(dut, "Width", "Lanes")
        width = self.width
        self.lowest, self.highest = -(1 << width - 1), (1 << width - 1) - 1
        self.threshold, self.hold = self.highest, False

    async def start(self) -> None:
        start_clock(self.dut.clk)
        self.dut.rst.value = 1
        await self.edge(valid=False)
        self.dut.rst.value = 0
        await self.idle()

    async def edge(self, valid: Any, data: int = 0, user: Any = False) -> None:
        """Run one cycle with a depth in a random lane and depths that are no higher in the others."""
        depths = [self.random.choice((data, self.lowest, max(data - 1, self.lowest))) for _ in range(self.lanes)]
        depths[self.random.randrange(self.lanes)] = data
        beat = sum((depth & (1 << self.width) - 1) << lane * self.width for lane, depth in enumerate(depths))
        self.dut.in_valid.value, self.dut.in_frame_start.value, self.dut.in_data.value = int(valid), int(user), beat
        self.dut.threshold.value, self.dut.hold.value = self.threshold, int(self.hold)
        await RisingEdge(self.dut.clk)

    async def idle(self) -> None:
        """Run a cycle without a beat; random data and user have no effect."""
        await self.edge(False, self.highest, bool(self.random.getrandbits(1)))
        self.check()
        self.model.idle(self.hold)

    def check(self) -> None:
        contact = bool(self.dut.contact.value)
        assert contact == self.model.contact, f"contact is {contact}, threshold {self.model.threshold}"

    async def beat(self, data: Any, user: bool = False) -> None:
        await self.edge(True, data, user)
        self.check()  # as it was before this beat, which takes effect exactly one cycle later
        self.model.beat(data, user, self.threshold, self.hold)

    async def contact_after(self, *frame: Any) -> bool:
        """Send a frame of data; return contact in the cycle after its last beat."""
        for index, data in enumerate(frame):
            await self.beat(data, user=index == 0)
        await self.idle()
        return bool(self.dut.contact.value)


@on_bench(Bench)
async def boundaries(bench: Bench) -> None:
    """Send depths equal to the threshold and one above it, with thresholds at and beyond both full scales of the
    data."""
    low, high = bench.lowest, bench.highest
    word_low, word_high = -(1 << WORD_BITS - 1), (1 << WORD_BITS - 1) - 1
    for threshold in sorted({0, 1, -1, 1000, -1000, low, low + 1, high, high - 1, word_low, word_high}):
        bench.threshold = threshold
        for data in sorted({threshold - 1, threshold, threshold + 1, low, -1, 0, 1, high}):
            if low <= data <= high:
                for first in (True, False):
                    frame = (data,) if first else (low, data)
                    want = max(frame) > threshold
                    assert await bench.contact_after(*frame) == want, f"{frame} over {threshold}"


@on_bench(Bench)
async def clearing(bench: Bench) -> None:
    """Clear contact by the first beat of a frame, not by its second; a first beat above the threshold sets it."""
    bench.threshold = 10
    assert await bench.contact_after(0, 11, 0, 0)
    assert not await bench.contact_after(0), "the first beat did not clear contact"
    assert await bench.contact_after(11)
    for _ in range(5):
        await bench.idle()
    await bench.beat(11, user=True)  # contact stays high through this beat: `edge` checks every cycle
    await bench.idle()
    assert bench.dut.contact.value, "clearing won over setting"
    assert not await bench.contact_after(10, 10, 10)


@on_bench(Bench)
async def hold(bench: Bench) -> None:
    """Hold contact while the bit is set; afterwards it has the value that it would have without the bit."""
    bench.threshold, bench.hold = 10, True
    assert not await bench.contact_after(0, 0), "hold alone raised it"
    assert await bench.contact_after(0, 11)
    assert await bench.contact_after(0, 0, 0)
    bench.hold = False
    await bench.idle()
    await bench.idle()
    assert not bench.dut.contact.value, "contact stayed high after the bit was cleared between frames"

    bench.hold = True
    assert await bench.contact_after(0, 11)
    bench.hold = False
    await bench.beat(0)
    await bench.idle()
    assert bench.dut.contact.value, "clearing the bit inside a frame that raised contact cleared contact"
    bench.hold = True
    assert await bench.contact_after(0, 0)
    bench.hold = False
    await bench.beat(0)
    await bench.idle()
    assert not bench.dut.contact.value, "contact stayed high in a frame that did not raise it"


@on_bench(Bench)
async def threshold_change(bench: Bench) -> None:
    """Write a threshold inside a frame and between frames: it applies from the next frame on."""
    bench.threshold = 10
    await bench.beat(0, user=True)
    bench.threshold = -10
    await bench.beat(0)
    await bench.idle()
    assert not bench.dut.contact.value, "a lower threshold applied inside the frame in which it was written"
    assert await bench.contact_after(0), "it did not apply to the next frame"
    bench.threshold = 10
    await bench.beat(5)
    assert not await bench.contact_after(5)
    bench.threshold = 4
    await bench.idle()
    assert await bench.contact_after(5)


@on_bench(Bench)
async def random_frames(bench: Bench) -> None:
    """Send random beats near a changing threshold, with random gaps, hold and resets."""
    rng = bench.random
    left = 0
    raised = 0
    for _ in range(CLOCKS):
        if rng.random() < 0.05:
            bench.threshold = rng.choice((0, 3, -3, bench.lowest, bench.highest, rng.randint(-100, 100)))
        if rng.random() < 0.05:
            bench.hold = rng.random() < 0.3
        if rng.random() < 0.01:
            bench.dut.rst.value = 1
            await bench.edge(False)
            bench.dut.rst.value = 0
            bench.model.reset()
            left = 0
        elif rng.random() < 0.3:
            await bench.idle()
        else:
            near = bench.threshold + rng.randint(-20, 1)
            await bench.beat(min(max(near, bench.lowest), bench.highest), user=left == 0)
            left = left - 1 if left else rng.randint(0, 12)
        raised += bench.model.contact
    assert CLOCKS // 10 < raised < CLOCKS * 9 // 10, f"the test is void: contact in {raised} of {CLOCKS} clocks"
