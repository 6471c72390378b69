# SPDX-License-Identifier: Apache-2.0
"""contact_sums against its model: the sums of each frame, valid in their cycle only."""

from typing import Any

import cocotb
import numpy as np
from cocotb.triggers import RisingEdge

from tactile_depth.chip.contact.contact_sums import ContactSums, cycles_to_sums
from tb.cases import on_bench
from tb.contact.depth_bench import MeasureBench
from tb.contact.tb_contact_peak import proofs, structures
from tb.stream import REGRESS, parametrize

STRUCTURES = structures(8)
PROTOCOL = {
    "depth_frames": {"Columns": "Columns / Lanes"},
    "counts": "live & ~reset",
    "sums": "counts & sums_valid",
}
PROOFS = proofs(
    "positions are only counted; sums are exact at any width; either order of rows; the sums of a beat of "
    "several depths are proven of beat_sums",
)


FRAMES = 1000 if REGRESS else 200
# Lowest bit and bits of the fields of contact_sums_t: least row and column, greatest row and column, moments, weight
# and area.
FIELDS = ((16, 16), (0, 16), (48, 16), (32, 16), (64, 64), (128, 64), (192, 64), (256, 32))


class Bench(MeasureBench):
    """Driver of one cycle at a time."""

    def __init__(self, dut: Any, gap: float = 0.0) -> None:
        super().__init__(dut, gap, cycles_to_sums)
        self.model = ContactSums(self.rows, self.columns, bool(self.bottom_first))

    async def edge(
        self, valid: bool, depths: list[int], position: tuple[Any, Any, Any], settings: Any = None, time: Any = None
    ) -> None:
        self.drive_depth(valid, depths, position)
        if settings is not None:
            self.drive(threshold=settings)
        await RisingEdge(self.dut.clk)
        self.check()
        if valid:
            for depth, frame_start, _, frame_end in self.in_turn(depths, position):
                sums = self.model.beat(depth, frame_start, frame_end, settings)
            if sums is not None:
                self.due[self.now] = sums
        if settings is not None:  # from now on it has no effect
            self.drive(threshold=self.random.randint(self.low, self.high))
        self.now += 1

    def check(self) -> None:
        dut = self.dut
        sums = self.due.pop(self.now - self.latency, None)
        assert bool(dut.sums_valid.value) == (sums is not None), "sums_valid"
        if sums is not None:
            value = int(dut.sums.value)
            seen = [value >> low & (1 << bits) - 1 for low, bits in FIELDS]
            limits = tuple(seen[:2]), tuple(seen[2:4])
            assert seen[4:] == [sums.column_moment, sums.row_moment, sums.weight, sums.area], f"expected {sums}"
            assert not sums.area or limits == (sums.least, sums.greatest), f"limits {limits}, expected {sums}"
            self.received.append(sums)


@on_bench(Bench, milliseconds=100)
@parametrize(gap=[0.0, 0.1])
async def random_frames(bench: Bench) -> None:
    """Send maps of every kind, back to back or with gaps, with a threshold near their values."""
    rng = np.random.default_rng(cocotb.RANDOM_SEED)
    for _ in range(FRAMES):
        depth = bench.random_map(rng)
        await bench.frame(depth, bench.random_level(rng, depth))
    await bench.settle()
    areas = [sums.area for sums in bench.received]
    assert len(areas) == FRAMES
    assert areas.count(0) > FRAMES // 50, "the test is void: too few frames have no depth above"
    assert areas.count(bench.pixels) > FRAMES // 100, "the test is void: too few frames have all depths above"


@on_bench(Bench, milliseconds=10)
async def ties_and_edges(bench: Bench) -> None:
    """Sum a single depth in each corner, all and no depths above, and the largest weights there are."""
    maps = bench.edge_maps()
    for depth in maps:
        await bench.frame(depth, 0)
    await bench.frame(bench.full(bench.high), bench.low)
    await bench.settle()
    assert len(bench.received) == len(maps) + 1


@on_bench(Bench, milliseconds=10)
async def interrupted_frames(bench: Bench) -> None:
    """Begin a frame inside another one: it is measured alone, with its own threshold."""
    await bench.interrupt_frames(-3, 0)


@on_bench(Bench, milliseconds=20)
async def resets(bench: Bench) -> None:
    """Reset in any cycle of a frame and after it: nothing of it remains."""
    await bench.reset_in_every_cycle(-1, 0)
