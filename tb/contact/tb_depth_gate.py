# SPDX-License-Identifier: Apache-2.0
"""depth_gate against its model, every output in every cycle; and its rules, checked at the pins alone."""

import random
from typing import Any

import cocotb
from cocotb.triggers import RisingEdge

from formal.entries import WORD_FREE, Proof
from tactile_depth.chip.contact.depth_gate import DepthGate, Word
from tb.axis import PROFILES, AxisMonitor, profile
from tb.cases import on_bench
from tb.pins import Driver, by_name
from tb.stream import depth_position, parameters, parametrize, start_clock
from tb.structures import BOTH, ICARUS, Structure

STRUCTURES = (Structure({"Width": 12}, on=BOTH, mutants=ICARUS),)
PROOFS = (
    Proof(
        f"words of a frame are only counted; {WORD_FREE}",
    ),
)


ROWS, COLUMNS = 3, 5
FIELDS = ("data", "position")


def word_of(data: int, position: int) -> Word:
    """Unpack a word from its pins."""
    return Word(data, *(bool(position >> bit & 1) for bit in (2, 1, 0)))


class Bench:
    """Driver of one cycle at a time.

    `frames` holds the words of each frame that entered, `waits` whether it entered with drop_frames at 0, `sent` the
    number of its words that left; `tapped` holds all words that were tapped.
    """

    def __init__(self, dut: Any, accepts: str = "none") -> None:
        self.dut, self.drive, self.read = dut, Driver(dut), by_name(dut)
        self.edge = RisingEdge(dut.clk)
        self.random = random.Random(cocotb.RANDOM_SEED)
        (self.width,) = parameters(dut, "Width")
        self.accepts, self.drop_frames = profile(accepts), False
        self.model = DepthGate()
        self.monitor = AxisMonitor(dut, "m", FIELDS)  # the rules of the stream
        self.forget()

    def forget(self) -> None:
        self.frames: list[Any] = []
        self.waits: list[Any] = []
        self.dropped: list[Any] = []
        self.tapped: list[Any] = []
        # clocks
        self.left: list[Any] = []
        self.came: list[Any] = []
        self.taps: list[Any] = []
        self.stood, self.now = 0, 0
        self.monitor.forget()

    async def start(self) -> None:
        start_clock(self.dut.clk)
        self.drive(in_valid=0, m_ready=0, drop_frames=0, rst=1)
        for _ in range(2):
            await self.edge
        self.drive(rst=0)
        await self.clock()

    async def reset(self) -> None:
        self.drive(rst=1, in_valid=0)
        await self.edge
        self.drive(rst=0)
        self.model.reset()
        self.forget()
        await self.clock()

    async def clock(self, word: Any = None) -> Any:
        """Run one cycle, with a word or without; return whether the word moved. Marks without a word have no effect."""
        read, ready, coin = self.read, next(self.accepts), self.random.getrandbits
        self.drive(in_valid=word is not None, m_ready=ready, drop_frames=self.drop_frames)
        data, *marks = word or (coin(self.width), coin(1), coin(1), coin(1))
        self.drive(in_data=data, in_position=depth_position(*marks))
        await self.edge
        model = self.model
        assert read("en") == model.en, "en"
        assert read("event_dropped") == model.dropped(word), "event_dropped"
        assert read("m_valid") == bool(model.sending), "m_valid"
        if model.sending:
            assert self.pins("m") == model.sending[0], "a word offered"
        tap = model.tap(ready)
        assert read("tap_valid") == (tap is not None), "tap_valid"
        if tap is not None:
            assert self.pins("tap") == tap, "a word tapped"
            self.tapped.append(tap)
            self.taps.append(self.now)
        if model.sending and ready:
            self.left.append(self.now)
        moves = word is not None and model.en
        if moves:
            self.came.append(self.now)
        if model.dropped(word):
            self.dropped.append(len(self.frames) - 1)
        self.stood += not model.en
        model.clock(word, ready, self.drop_frames)
        self.now += 1
        return moves

    def pins(self, name: str) -> Any:
        return word_of(*(self.read(f"{name}_{field}") for field in FIELDS))

    async def frame(self, rows: int = ROWS, columns: int = COLUMNS, words: Any = None, each: Any = None) -> None:
        """Send a frame, or its first words; call `each` before every cycle."""
        total = rows * columns
        self.frames.append([])
        self.waits.append(not self.drop_frames)
        for place in range(total if words is None else words):
            last = place % columns == columns - 1
            word = Word(self.random.getrandbits(self.width), place == 0, last, place == total - 1)
            self.frames[-1].append(word)
            moved = False
            while not moved:
                if each:
                    each()
                moved = await self.clock(word)

    async def idle(self, clocks: int = 1) -> None:
        for _ in range(clocks):
            await self.clock()

    async def drain(self) -> None:
        self.accepts = profile("none")
        await self.idle(4)

    def check(self) -> Any:
        """Check that of each frame its first words left, all of them unless it was cut, and that every word was
        tapped."""
        assert self.tapped == [word for frame in self.frames for word in frame]
        words = [word_of(*word) for word in self.monitor.words]
        sent = []
        for number, frame in enumerate(self.frames):
            count = 0
            while count < len(frame) and words[: count + 1] == frame[: count + 1]:
                count += 1
            sent.append(count)
            words = words[count:]
            assert (count < len(frame)) == (number in self.dropped), f"{count} words left of frame {number}"
            assert count == len(frame) or not self.waits[number], f"frame {number} is not whole"
        assert not words, "words left that belong to no frame, or at a wrong position"
        assert len(set(self.dropped)) == len(self.dropped), "counted twice"
        return sent


@on_bench(Bench)
@parametrize(accepts=list(PROFILES), gap=[0, 6])
async def waiting(bench: Bench, accepts: str, gap: int) -> None:
    """Stall with drop_frames at 0: no word is lost, and each is tapped in the cycle in which it leaves."""
    for _ in range(15):
        await bench.frame()
        await bench.idle(bench.random.randint(0, gap))
    await bench.drain()
    assert set(bench.check()) == {ROWS * COLUMNS}
    assert bench.taps == bench.left
    if accepts == "none":
        assert {left - came for came, left in zip(bench.came, bench.left, strict=True)} == {1}


@on_bench(Bench)
@parametrize(accepts=list(PROFILES), gap=[0, 6])
async def dropping(bench: Bench, accepts: str, gap: int) -> None:
    """Stall with drop_frames at 1: the pipeline never waits, and each word is tapped one cycle after it entered."""
    bench.drop_frames = True
    await bench.idle()
    stood = bench.stood
    for _ in range(40):
        await bench.frame()
        await bench.idle(bench.random.randint(0, gap))
    await bench.drain()
    sent = bench.check()
    assert bench.stood == stood, "the pipeline waited"
    assert {tap - came for came, tap in zip(bench.came, bench.taps, strict=True)} == {1}
    if accepts == "none":
        assert bench.left == bench.taps
        assert not bench.dropped
    else:
        assert bench.dropped
    if accepts in ("random", "long"):
        assert set(sent) & set(range(1, ROWS * COLUMNS)), "the test is void: no frame was cut"
    if accepts == "long":
        assert 0 in sent, "the test is void: no frame was dropped whole"
        assert ROWS * COLUMNS in sent


@on_bench(Bench)
@parametrize(stands=[0, 1, 2], gap=[0, 1, 2, 3, 4])
async def words_left_standing(bench: Bench, stands: Any, gap: Any) -> None:
    """Change drop_frames while words are in the gate: each of them is tapped once, in order."""
    total = ROWS * COLUMNS
    for ready_after in range(8):
        await bench.reset()
        # The sink takes all but the last words of the first frame, then nothing for a while.
        bench.drop_frames = False
        await bench.frame(words=total - stands)
        await bench.drain()
        bench.accepts = iter([False] * (stands + gap + 3 * ready_after) + [True] * (1 << 20))
        bench.drop_frames = True
        for word in remaining_words(bench, total, stands):
            while not await bench.clock(word):
                pass
        await bench.idle(gap)
        await bench.frame(each=lambda: setattr(bench, "drop_frames", False))
        await bench.frame()
        await bench.drain()
        bench.waits[1] = False
        bench.check()


def remaining_words(bench: Any, total: int, stands: int) -> Any:
    """Return the remaining words of the current frame."""
    words = []
    for place in range(total - stands, total):
        last = place % COLUMNS == COLUMNS - 1
        words.append(Word(bench.random.getrandbits(bench.width), False, last, place == total - 1))
    bench.frames[-1] += words
    return words


@on_bench(Bench, milliseconds=10)
@parametrize(accepts=list(PROFILES))
async def changes_at_random(bench: Bench, accepts: str) -> None:
    """Change the bit in random cycles: a frame keeps the value with which it began."""

    def coin() -> None:
        if bench.random.random() < 0.1:
            bench.drop_frames = not bench.drop_frames

    for _ in range(200):
        for _ in range(bench.random.choice([0, 0, 0, 1, 2, 9])):
            coin()
            await bench.clock()
        before = bench.model.dropping
        await bench.frame(bench.random.randint(1, 3), bench.random.randint(2, 4), each=coin)
        bench.waits[-1] = not before
    await bench.drain()
    bench.check()
    assert bench.dropped or accepts == "none"


@on_bench(Bench, milliseconds=10)
@parametrize(drop_frames=[False, True])
async def resets(bench: Bench, drop_frames: Any) -> None:
    """Reset in any cycle of a stalled frame: nothing of it leaves."""
    bench.drop_frames = drop_frames
    for words in range(1, ROWS * COLUMNS + 1):
        await bench.idle()
        bench.accepts = profile("none") if not drop_frames else profile("random")
        await bench.frame(words=words)
        bench.accepts = iter([False] * (1 << 20))
        await bench.clock(bench.frames[-1][-1]._replace(frame_start=False, frame_end=False) if words < 3 else None)
        await bench.reset()
        bench.accepts = profile("none")
        await bench.idle(2)
        assert not bench.tapped
        assert not bench.left
        await bench.frame()
        await bench.drain()
        assert bench.check() == [ROWS * COLUMNS]
