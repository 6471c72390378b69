# SPDX-License-Identifier: Apache-2.0
"""contact_events against its model in every cycle, and every field of a record against numpy on the map."""

from fractions import Fraction
from typing import Any

import cocotb
import numpy as np
from cocotb.triggers import RisingEdge

from formal.entries import Proof
from tactile_depth.chip.contact import contact_events
from tactile_depth.chip.contact.contact_events import (
    CYCLES_TO_TOUCHING,
    WORD_BITS,
    WORDS,
    ContactEvents,
    Settings,
    latency,
)
from tactile_depth.chip.contact.record_packets import RecordPackets
from tactile_depth.chip.fixed_point import joined, split
from tb.axis import profile
from tb.cases import on_bench
from tb.contact.depth_bench import WORD_HIGH, DepthBench
from tb.stream import REGRESS, parametrize
from tb.structures import BOTH, ICARUS, VERILATOR, Mutants, of_parameters

built = of_parameters("Width Rows Columns Lanes BottomFirst")
STRUCTURES = (
    built(24, 5, 8, 1, 0, on=VERILATOR),
    built(6, 5, 8, 1, 1, on=ICARUS, mutants=BOTH),
    built(32, 5, 16, 1, 1),
    built(12, 9, 4, 1, 0),
    built(24, 8, 16, 1, 0),
    built(24, 5, 32, 4, 1),
    built(16, 8, 32, 8, 0),
    built(12, 4, 16, 2, 0),
)
PROTOCOL = {
    "depth_frames": {"Columns": "Columns / Lanes"},
    "counts": "live & ~reset",
    "m_event_tdata m_event_tlast": "counts & m_event_tvalid",
}
MUTANTS = Mutants(outside=("frame",), flat=False)
PROOFS = (
    Proof(
        "rows and columns are only counted; whatever count, peak, sums and centroid come out: these have proofs",
        {"Rows": 4, "Columns": 8, "Latency": contact_events.latency(4, 8)},
        free=("sums", "count", "peak", "middle"),
    ),
)


FRAMES = {0.0: 1000, 0.1: 1000} if REGRESS else {0.0: 300, 0.1: 100}  # by the probability of a gap


def numpy_fields(depth: np.ndarray, threshold: int, level: int, first_row_last: Any) -> Any:
    """Return the fields of a record, computed by numpy alone from the map of a frame, row 0 at the top."""
    if not (depth > threshold).any():
        return [0] * 3 + [level] + [0] * 8
    upside_down = depth[::-1] if first_row_last else depth
    row, column = np.unravel_index(np.argmax(upside_down), depth.shape)
    if first_row_last:
        row = depth.shape[0] - 1 - row
    rows, columns = np.nonzero(depth > level)
    limits, weight = [row, column, row, column], 0
    centroid = [16 * int(row), 16 * int(column)]
    if rows.size:
        weights = depth[rows, columns] - level
        weight = int(weights.sum())
        centroid = [round(16 * Fraction(int((weights * places).sum()), weight)) for places in (rows, columns)]
        limits = [rows.min(), columns.min(), rows.max(), columns.max()]
    return [int(value) for value in (depth.max(), row, column, level, rows.size, *limits, weight, *centroid)]


def seen_fields(words: Any) -> list[Any]:
    """Return the same fields, read from the words of a packet."""
    halves = np.array(words, np.uint32)
    signed = halves.view(np.int32)

    def position(index: int) -> Any:
        return [int(halves[index]) >> 16, int(halves[index]) & 0xFFFF]

    weight = int(halves[10]) << 32 | int(halves[9])
    peak, level, area = int(signed[3]), int(signed[5]), int(halves[6])
    return [peak, *position(4), level, area, *position(7), *position(8), weight, *position(11)]


class Bench(DepthBench):
    """Driver of one cycle at a time; every output is compared with the model."""

    def __init__(self, dut: Any, accepts: str = "none", gap: float = 0.0) -> None:
        super().__init__(dut, gap)
        self.latency = latency(self.rows, self.columns, self.lanes)
        self.accepts = profile(accepts)
        self.model = ContactEvents(self.rows, self.columns, self.width, bool(self.bottom_first))
        self.lost = 0
        self.moved = False  # value of the record when it was read last
        # words of each new record, words of each packet
        self.records: list[Any] = []
        self.sent: list[Any] = []
        self.forget()

    def forget(self) -> None:
        """Forget all outputs that are due."""
        self.touching, self.packets = False, RecordPackets(WORDS)
        self.touching_due: dict[Any, Any] = {}
        self.record_due: dict[Any, Any] = {}
        self.open: list[Any] = []

    async def start(self) -> None:
        self.drive(m_event_tready=0)
        await super().start()
        cocotb.start_soon(self.watch())

    async def watch(self) -> None:
        while True:
            await self.dut.record.value_change
            self.moved = True

    async def reset(self) -> None:
        self.dut.rst.value = 1
        await self.edge(False, [0] * self.lanes, (0, 0, 0))
        self.dut.rst.value = 0
        self.model.reset()
        self.forget()

    async def edge(
        self, valid: bool, depths: list[int], position: tuple[Any, Any, Any], settings: Any = None, time: Any = None
    ) -> None:
        """Run one cycle. Settings and time get random values where the test gives none."""
        ready = next(self.accepts)
        self.drive_depth(valid, depths, position)
        self.drive(m_event_tready=int(ready))
        if settings is not None:
            self.drive(**settings._asdict(), in_time=time)
        await RisingEdge(self.dut.clk)
        self.check(ready)
        if valid:
            for depth in self.in_turn(depths, position):
                record = self.model.beat(*depth, settings, time)
            if record is not None:
                self.touching_due[self.now + CYCLES_TO_TOUCHING] = self.model.touching
                self.record_due[self.now + self.latency] = record.words
        if settings is not None:
            chance = self.random
            on, off, level = (chance.randint(self.low, self.high) for _ in range(3))
            others = Settings(on, off, level, chance.randint(0, 2), chance.randint(0, 2))
            self.drive(**others._asdict(), in_time=chance.getrandbits(32))
        self.now += 1

    def check(self, ready: Any) -> None:
        """Compare the outputs at the end of the cycle."""
        read, now = self.read, self.now
        self.touching = self.touching_due.pop(now, self.touching)
        assert read("touching") == self.touching, "touching"
        new = self.record_due.pop(now + 1, ())
        expected = self.packets.clock(
            rst=0, new_valid=bool(new), new_record=joined(new, WORD_BITS), m_event_tready=int(ready)
        )
        self.moved |= bool(expected["record_valid"])
        for pin, value in expected.items():
            if pin != "record" or self.moved:  # its many bits are read only when they change or should change
                assert read(pin) == value, pin
        self.moved = False
        if expected["record_valid"]:
            self.records.append(tuple(split(read("record"), WORDS, WORD_BITS)))
        if ready and expected["m_event_tvalid"]:
            self.open.append(expected["m_event_tdata"])
        self.lost += bool(expected["record_lost"])
        sending = self.packets.sending
        if not sending or len(sending) == WORDS:
            self.sent += [tuple(self.open)] * bool(self.open)
            self.open = []

    async def settle(self) -> None:
        """Run until the last record has left or waits for the sink."""
        await self.idle(self.latency + 2)


class Events:
    """State of contact, computed from the maps of all frames so far."""

    def __init__(self, bench: Bench) -> None:
        self.bench = bench
        self.touching = False
        self.contrary: list[Any] = []
        self.half_peak = WORD_HIGH  # of the last frame, if it had a depth above

    def frame(self, depth: np.ndarray, settings: Settings) -> tuple[int, list[int]]:
        """Return the status bits of a frame and the fields of its record."""
        threshold = settings.off_threshold if self.touching else settings.on_threshold
        level = max(threshold, min(settings.area_threshold, self.half_peak))
        level = int(np.clip(level, self.bench.low, self.bench.high))
        count = int(np.count_nonzero(depth > threshold))
        self.half_peak = int(np.floor(depth.max() / 2)) if count else WORD_HIGH
        fields = numpy_fields(depth, threshold, level, self.bench.bottom_first)
        return self.status(count, settings.minimum_area, settings.debounce), fields

    def status(self, count: int, minimum: Any, debounce: int) -> Any:
        self.contrary.append((count >= minimum) != self.touching)
        needed = max(debounce, 1)
        if len(self.contrary) < needed or not all(self.contrary[-needed:]):
            return int(self.touching)
        self.touching, self.contrary = not self.touching, []
        return 0b011 if self.touching else 0b100


def random_settings(bench: Any, rng: Any, depth: np.ndarray) -> Any:
    """Return random settings: thresholds near the values of the map, areas near the number of depths above them."""
    on, off = bench.random_thresholds(rng, depth)
    level = int(rng.choice([*bench.random_thresholds(rng, depth), max(on, off), WORD_HIGH]))
    area = int(np.count_nonzero(depth > rng.choice([on, off])))
    minimum = rng.choice([0, 1, area, max(area - 1, 0), area + 1, bench.pixels, bench.pixels + 1, 2**32 - 1],
                         p=[0.02, 0.1, 0.28, 0.2, 0.3, 0.04, 0.04, 0.02])  # fmt: skip
    return Settings(on, off, level, int(minimum), int(rng.choice([0, 1, 2, 3], p=[0.2, 0.3, 0.3, 0.2])))


@on_bench(Bench, milliseconds=100)
@parametrize(gap=[0.0, 0.1])
async def random_frames(bench: Bench, gap: float) -> None:
    """Send random maps, back to back or with gaps: every field of every record equals numpy on the map."""
    rng = np.random.default_rng(cocotb.RANDOM_SEED)
    events, want = Events(bench), []
    for number in range(FRAMES[gap]):
        depth = bench.random_map(rng)
        settings, time = random_settings(bench, rng, depth), int(rng.integers(1 << 32))
        status, fields = events.frame(depth, settings)
        want.append(((status, number + 1, time), fields))
        await bench.frame(depth, settings, time)
    await bench.settle()
    got = [(words[:3], seen_fields(words)) for words in bench.records]
    for index, (ours, theirs) in enumerate(zip(got, want, strict=True)):
        assert ours == theirs, f"frame {index}: {ours}, numpy gives {theirs}"
    await bench.idle(WORDS + 2)
    assert bench.sent == bench.records, "packets are not the records"
    assert not bench.lost
    touching = [status & 1 for (status, _, _), _ in want]
    changes = np.count_nonzero(np.diff(touching))
    assert changes > len(want) // 20, f"the test is void: {changes} changes in {len(want)} frames"
    without_area = [any(fields[:3]) for _, fields in want if not fields[4]]  # whether it has a peak
    assert without_area.count(False) > len(want) // 50, "the test is void: too few frames have no depth above"
    assert without_area.count(True) > len(want) // 20, "the test is void: too few contacts have no area"


@on_bench(Bench, milliseconds=10)
async def centroids_between_two(bench: Bench) -> None:
    """Reach means half way between two codes, which round to the even one: of 32 pixels of equal weight, 16 moment / 32
    has halves."""
    want, halves = [], set()
    for _ in range(24):
        depth = np.zeros((bench.rows, bench.columns), np.int64)
        depth.flat[bench.random.sample(range(bench.pixels), 32)] = 1
        await bench.frame(depth, Settings(0, 0, 0, 1, 1))
        want.append(numpy_fields(depth, 0, 0, bench.bottom_first))
        halves |= {int(places.sum()) % 4 for places in np.nonzero(depth)}
    await bench.settle()
    assert [seen_fields(words) for words in bench.records] == want
    assert halves == {0, 1, 2, 3}, "the test is void: it did not reach both ties"


@on_bench(Bench, milliseconds=10)
async def hysteresis(bench: Bench) -> None:
    """Send depths between the thresholds: either state stays. A depth equal to a threshold is not above it."""
    settings, status = Settings(20, 10, 0, 2, 1), []
    levels = [0, 15, 20, 21, 15, 11, 10, 15, 21, 21, 0, 15]
    for level in levels:
        await bench.frame(bench.lone(level, (1, 1), (2, 3)), settings)
    for positions in ([(1, 1), (2, 2)], [(1, 1)]):  # an area that is too small ends contact
        await bench.frame(bench.lone(30, *positions), settings)
    await bench.settle()
    status = [words[0] for words in bench.records]
    assert status == [0, 0, 0, 3, 1, 1, 4, 0, 3, 1, 4, 0, 3, 4]


@on_bench(Bench, milliseconds=10)
async def the_area_threshold_follows_the_last_peak(bench: Bench) -> None:
    """Take half the peak of the last frame where that is less than the setting, never less than what counts as
    touched; without a last peak the setting."""
    settings, wanted = Settings(3, 3, 12, 1, 1), []
    for peak, level in [(20, 12), (20, 10), (9, 10), (9, 4), (5, 4), (5, 3), (0, 3), (20, 12), (31, 10), (31, 12)]:
        await bench.frame(np.maximum(bench.lone(peak, (2, 5)), 0), settings)
        wanted.append((level, int(peak > level), [2, 5] if peak else [0, 0]))
    await bench.settle()
    fields = [seen_fields(words) for words in bench.records]
    assert [(found[3], found[4], found[5:7]) for found in fields] == wanted
    assert [found[5:7] for found in fields] == [found[7:9] for found in fields]


@on_bench(Bench, milliseconds=10)
async def settings_in_every_bit(bench: Bench) -> None:
    """Set each bit of the minimum area and of the debounce alone: it decides the state of its own frame."""
    for debounce in (1, 0):  # 1: each bit of the area decides alone
        for bit in range(32):
            await bench.frame(bench.full(1), Settings(0, 0, 0, 1 << bit, debounce or 1 << bit % 8))
    await bench.frame(bench.full(1), Settings(0, 0, 0, bench.pixels, 1))
    for count in (8, 7):  # the count is just below a debounce with one bit set, and reaches it with the next frame
        for bit in range(count):
            await bench.frame(bench.full(0), Settings(0, 0, 0, 1, 1 << 7 - bit))
    await bench.settle()


@on_bench(Bench, milliseconds=10)
async def frame_numbers(bench: Bench) -> None:
    """Count frames through every bit of the number and past its end."""
    for bits in range(6, 33):
        bench.dut.frame.value = bench.model.frames = (1 << bits) - 1
        await bench.frame(bench.full(0), Settings(0, 0, 0, 1, 1))
        await bench.settle()
    assert [words[1] for words in bench.records] == [*(1 << bits for bits in range(6, 32)), 0]


@on_bench(Bench, milliseconds=10)
async def interrupted_frames(bench: Bench) -> None:
    """Begin a frame inside another one: it is measured alone, with its own settings."""
    rng = np.random.default_rng(cocotb.RANDOM_SEED)
    for words in [*range(1, bench.beats), *rng.integers(1, bench.beats, 20)]:
        await bench.frame(bench.random_map(rng), Settings(-3, 5, 2, 1, 1), 7, words=int(words))
        if words % 3 == 0:
            depth = bench.random_map(rng)
            await bench.frame(depth, Settings(0, 0, 0, 1, 1), 8)
            await bench.settle()
            assert seen_fields(bench.records[-1]) == numpy_fields(depth, 0, 0, bench.bottom_first)
            assert bench.records[-1][1:3] == (len(bench.records), 8)


@on_bench(Bench, milliseconds=20)
async def the_sink_takes_the_last_word(bench: Bench) -> None:
    """Take the last word in any cycle around a new record: the waiting record leaves or is lost, never both."""
    for late in range(-3, 4):
        await bench.reset()
        bench.records, bench.sent, bench.lost = [], [], 0
        await bench.frame(bench.full(1), Settings(0, 0, 0, 1, 1))
        await bench.settle()
        left = len(bench.packets.sending) + WORDS * bench.packets.waiting
        bench.accepts = iter([True] * (left - 1) + [False] * (1 << 20))
        await bench.idle(WORDS)
        assert len(bench.packets.sending) == 1
        await bench.frame(bench.full(2), Settings(0, 0, 0, 1, 1))
        await bench.settle()
        await bench.frame(bench.full(3), Settings(0, 0, 0, 1, 1))
        bench.accepts = iter([False] * (bench.latency - 2 + late) + [True] * (1 << 20))
        await bench.settle()
        await bench.idle(3 * WORDS)
        assert bench.lost == (late > 0), late
        assert bench.sent == bench.records[: 1 if bench.lost else 3] + bench.records[2:] * bench.lost


@on_bench(Bench, milliseconds=20, accepts="alternate")
async def resets(bench: Bench) -> None:
    """Reset in any cycle of a frame and after it: nothing of the frame remains, and registers read zero."""
    rng = np.random.default_rng(cocotb.RANDOM_SEED)
    total = bench.beats + bench.latency + 2 * WORDS + 3
    for clocks in sorted({*range(1, total, 3), *range(bench.beats - 1, total)}):
        await bench.frame(bench.random_map(rng), Settings(0, 0, 0, 0, 1), 9, words=clocks)
        await bench.idle(max(0, clocks - bench.beats))
        await bench.reset()
        bench.records, bench.sent = [], []
        await bench.idle(int(rng.integers(0, bench.latency + 3)))
        assert not bench.records, f"a record after a reset at {clocks}"
        await bench.frame(bench.full(1), Settings(0, 0, 0, 1, 2))
        await bench.settle()
        assert [words[:2] for words in bench.records] == [(0, 1)]
