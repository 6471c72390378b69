# SPDX-License-Identifier: Apache-2.0
"""contact_peak against its model: count and peak of each frame, each valid in its cycle only."""

from typing import Any, NamedTuple

import cocotb
import numpy as np
from cocotb.triggers import RisingEdge

from formal.entries import Proof
from tactile_depth.chip.contact.contact_peak import CYCLES_TO_COUNT, ContactPeak, cycles_to_peak
from tb.cases import on_bench
from tb.contact.depth_bench import WORD_LOW, MeasureBench
from tb.stream import REGRESS, parametrize
from tb.structures import ICARUS, VERILATOR, Structure, of_parameters

built = of_parameters("Width Rows Columns Lanes BottomFirst")


def structures(columns: int) -> tuple[Structure, ...]:
    """Return the structures of a core that measures frames, with the columns of the first one that has mutants."""
    return (
        built(24, 5, 8, 1, 0, on=VERILATOR),
        built(6, 5, columns, 1, 1, on=ICARUS, mutants=ICARUS),
        built(6, 5, 8, 4, 1, on=ICARUS, mutants=ICARUS),
        built(6, 5, 8, 1, 0),
        built(32, 5, 16, 1, 1),
        built(12, 9, 4, 1, 0),
        built(24, 5, 16, 2, 0),
        built(12, 3, 128, 64, 1),
        built(32, 5, 16, 8, 1),
    )


def proofs(bounds: str) -> tuple[Proof, ...]:
    """Return the proofs of such a core, for both orders of rows, and for one and two depths per beat."""
    return tuple(
        Proof(bounds, {"BottomFirst": bottom_first, "Columns": columns, "Lanes": lanes})
        for bottom_first, columns, lanes in ((0, 3, 1), (1, 3, 1), (0, 4, 2), (1, 4, 2))
    )


STRUCTURES = structures(7)
PROTOCOL = {
    "depth_frames": {"Columns": "Columns / Lanes"},
    "counts": "live & ~reset",
    "count": "counts & count_valid",
    "any_above peak peak_row peak_column": "counts & peak_valid",
}
PROOFS = proofs(
    "positions are only counted; either order of rows; the peak of a beat of several depths is proven of beat_peak",
)


FRAMES = 1000 if REGRESS else 200


class Thresholds(NamedTuple):
    """Depth codes of a frame."""

    on: int
    off: int


class Bench(MeasureBench):
    """Driver of one cycle at a time; `touching` changes in the cycle of count_valid, the earliest allowed."""

    def __init__(self, dut: Any, gap: float = 0.0) -> None:
        super().__init__(dut, gap, cycles_to_peak)
        self.model = ContactPeak(self.rows, self.columns, bool(self.bottom_first))
        self.thresholds = Thresholds(0, 0)
        self.each_beat = False  # beats of a frame have their own thresholds
        self.touching = False  # of the frame that enters
        self.changes: dict[int, bool] = {}  # values of `touching` by cycle

    async def edge(
        self, valid: bool, depths: list[int], position: tuple[Any, Any, Any], settings: Any = None, time: Any = None
    ) -> None:
        self.drive_depth(valid, depths, position)
        if settings is not None:
            self.thresholds = settings
        if valid and self.each_beat:
            self.thresholds = Thresholds(*(self.random.randint(self.low, self.high) for _ in range(2)))
        if valid:
            self.drive(on_threshold=self.thresholds.on, off_threshold=self.thresholds.off)
        self.drive(touching=int(self.changes.pop(self.now, self.drive.driven.get("touching", 0))))
        await RisingEdge(self.dut.clk)
        self.check()
        if valid:
            for depth in self.in_turn(depths, position):
                peak = self.model.beat(*depth, self.thresholds.off if self.touching else self.thresholds.on)
            if peak is not None:
                self.due[self.now] = peak
                self.touching = bool(self.random.getrandbits(1))
                self.changes[self.now + CYCLES_TO_COUNT] = self.touching
        self.now += 1

    def check(self) -> None:
        dut = self.dut
        count_of = self.due.get(self.now - CYCLES_TO_COUNT)
        assert bool(dut.count_valid.value) == (count_of is not None), "count_valid"
        if count_of is not None:
            assert int(dut.count.value) == count_of.above, "count"
        peak = self.due.pop(self.now - self.latency, None)
        assert bool(dut.peak_valid.value) == (peak is not None), "peak_valid"
        if peak is not None:
            assert bool(dut.any_above.value) == bool(peak.above), "any_above"
            position = int(dut.peak_row.value), int(dut.peak_column.value)
            assert (dut.peak.value.to_signed(), position) == peak[1:], f"expected {peak}"
            self.received.append(peak)


@on_bench(Bench, milliseconds=100)
@parametrize(gap=[0.0, 0.1])
async def random_frames(bench: Bench) -> None:
    """Send maps of every kind, back to back or with gaps, with thresholds near their values."""
    rng = np.random.default_rng(cocotb.RANDOM_SEED)
    for _ in range(FRAMES):
        depth = bench.random_map(rng)
        await bench.frame(depth, Thresholds(*bench.random_thresholds(rng, depth)))
    await bench.settle()
    counts = [peak.above for peak in bench.received]
    assert len(counts) == FRAMES
    assert counts.count(0) > FRAMES // 50, "the test is void: too few frames have no depth above"
    assert counts.count(bench.pixels) > FRAMES // 50, "the test is void: too few frames have all depths above"


@on_bench(Bench, milliseconds=10)
async def ties_and_edges(bench: Bench) -> None:
    """Find the first of equal peaks in stream order, a single one in each corner, and all and no depths above."""
    maps = bench.edge_maps()
    for depth in maps:
        await bench.frame(depth, Thresholds(0, 0))
    await bench.frame(bench.full(bench.low), Thresholds(WORD_LOW, WORD_LOW))
    await bench.settle()
    assert len(bench.received) == len(maps) + 1
    first_row = bench.rows - 1 if bench.bottom_first else 0
    assert bench.received[4].position == (first_row, 0), "the peak is not the first of the equal ones"


@on_bench(Bench, milliseconds=20)
async def thresholds_change_inside_a_frame(bench: Bench) -> None:
    """Compare depths with the threshold of their beat: what is not above may be higher than the peak so far."""
    rng = np.random.default_rng(cocotb.RANDOM_SEED)
    bench.each_beat = True
    for _ in range(FRAMES // 10):
        await bench.frame(bench.random_map(rng), Thresholds(0, 0))
    await bench.settle()
    assert len(bench.received) == FRAMES // 10


@on_bench(Bench, milliseconds=10)
async def interrupted_frames(bench: Bench) -> None:
    """Begin a frame inside another one: it is measured alone, with its own thresholds."""
    await bench.interrupt_frames(Thresholds(-3, 5), Thresholds(0, 0))


@on_bench(Bench, milliseconds=20)
async def resets(bench: Bench) -> None:
    """Reset in any cycle of a frame and after it: nothing of it remains."""
    await bench.reset_in_every_cycle(Thresholds(0, -1), Thresholds(0, 0))
