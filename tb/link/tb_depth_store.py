# SPDX-License-Identifier: Apache-2.0
"""depth_store: a writer and a reader of any speed; every value and word of each frame that is taken.

The model of the banks says which frame waits and which is lost.
"""

import random
from collections.abc import Iterator
from typing import Any

import cocotb

from formal.entries import WORD_FREE, Proof
from tactile_depth.chip.contact.contact_events import WORDS
from tactile_depth.chip.link.bank_choice import BankChoice
from tb.stream import MANY, drive, parameters, parametrize
from tb.structures import ICARUS, VERILATOR, Mutants, of_parameters

built = of_parameters("Rows Columns DataWidth Lanes")
STRUCTURES = (
    built(5, 8, 24, 2, on=VERILATOR),
    built(3, 4, 12, 1, on=ICARUS, mutants=ICARUS),
    built(3, 4, 5, 2, on=ICARUS, mutants=ICARUS),
    built(6, 16, 20, 4),
    built(2, 2, 8, 1),
)
MUTANTS = Mutants(repeats=4, flat=False)
PROOFS = tuple(
    Proof(
        f"values and words are only stored, and an arbitrary one is followed; {WORD_FREE}",
        {"Rows": 2, "Columns": 2 * lanes, "Lanes": lanes},
    )
    for lanes in (1, 2)
)


Pins = dict[str, int]
LATENCY = 2  # clocks from value_read to the value


class Frame:
    """A frame and its record, with random values."""

    def __init__(self, count: int, width: int, chance: random.Random) -> None:
        self.values = [chance.randrange(-(1 << width - 1), 1 << width - 1) for _ in range(count)]
        self.record = [chance.getrandbits(32) for _ in range(WORDS)]


class Play:
    """Pins of a writer and a reader for each clock, and what the outputs shall be."""

    def __init__(self, rows: int, columns: int, width: int, lanes: int, chance: random.Random) -> None:
        self.count, self.columns, self.width, self.lanes, self.chance = rows * columns, columns, width, lanes, chance
        self.bits = -(-width // 8) * 8
        self.model = BankChoice()
        self.banks: list[Frame | None] = [None, None]
        self.in_frame = self.awaited = False
        self.keep = 1
        self.clocks: list[Pins] = []
        self.seen: list[tuple[bool, bool]] = []  # frame_valid and skipped
        self.values: dict[int, int] = {}  # clock to value_data
        self.words: dict[int, int] = {}  # clock to record_data

    def beats(self) -> tuple[Frame, list[Pins]]:
        """Return a frame and its beats, each value sign-extended to whole bytes."""
        frame, beats = Frame(self.count, self.width, self.chance), []
        for first in range(0, self.count, self.lanes):
            values = frame.values[first:][: self.lanes]
            data = sum((value % (1 << self.bits)) << lane * self.bits for lane, value in enumerate(values))
            row_ends = (first + self.lanes) % self.columns == 0
            marks = {"s_axis_tuser": int(first == 0), "s_axis_tlast": int(row_ends)}
            beats.append({"s_axis_tvalid": 1, "s_axis_tdata": data, **marks})
        return frame, beats

    def writer(self, pause: float) -> Iterator[tuple[Pins, Frame | None]]:
        """Give the pins of each clock, and with the last beat of a frame the frame.

        Some frames begin again inside. A record comes at any time behind its frame and before the end of the next; now
        and then one comes without a frame.
        """
        chance, words = self.chance, list[Pins]()
        while True:
            frame, sent = self.beats()
            if chance.random() < 0.2:
                sent = [*self.beats()[1][: chance.randrange(1, len(sent))], *sent]
            delay = chance.choice([0, chance.randrange(len(sent)), len(sent)])
            while sent:
                beat: Pins = {"s_axis_tvalid": 0, "s_axis_tuser": chance.randrange(2), "s_axis_tdata": 0}
                if chance.random() >= pause and (len(sent) > 1 or not words):
                    beat = sent.pop(0)
                delay -= 1
                word: Pins = {"s_event_tvalid": 0, "s_event_tlast": chance.randrange(2), "s_event_tdata": 0}
                if words and delay < 0 and chance.random() >= pause:
                    word = words.pop(0)
                yield beat | word, None if sent else frame
            for record in [frame.record, frame.record[::-1]][: 2 if chance.random() < 0.2 else 1]:
                words += [{"s_event_tvalid": 1, "s_event_tdata": word, "s_event_tlast": 0} for word in record]
                words[-1]["s_event_tlast"] = 1

    def reader(self, pause: float) -> Iterator[Pins]:
        """Take each frame that waits, read its values and words in any order, and give it back."""
        chance = self.chance
        while True:
            while not self.keep or self.model.ready is None or chance.random() < pause:
                yield {"value_address": chance.randrange(self.count)}
            yield {"frame_take": 1}
            addresses = list(range(self.count)) if chance.random() < 0.8 else []
            chance.shuffle(addresses)
            for address in addresses:
                while chance.random() < pause:
                    yield {"value_address": chance.randrange(self.count)}
                yield {"value_read": 1, "value_address": address, "record_word": chance.randrange(WORDS)}
            for word in range(WORDS):
                yield {"record_word": word}
            for _ in range(chance.choice([0, 2, self.count])):
                yield {}
            yield {"frame_done": 1, "value_address": chance.randrange(self.count)}

    def clock(self, writes: Pins, ended: Frame | None, reads: Pins, reset: bool) -> None:
        """Add a clock."""
        now = len(self.clocks)
        zeros = dict.fromkeys(("rst", "frame_take", "frame_done", "value_read", "value_address", "record_word"), 0)
        pins = zeros | {"keep": self.keep} | writes | reads | {"rst": int(reset)}
        begins = bool(pins["s_axis_tvalid"] and pins["s_axis_tuser"])
        ends = ended is not None and self.in_frame
        publish = bool(self.awaited and pins["s_event_tvalid"] and pins["s_event_tlast"])
        if self.model.read is not None:
            frame = self.banks[self.model.read]
            assert frame is not None
            self.words[now + 1] = frame.record[pins["record_word"]]
            if pins["value_read"]:
                self.values[now + LATENCY] = frame.values[pins["value_address"]]
        take, done = pins["frame_take"], pins["frame_done"]
        seen = self.model.clock(
            rst=reset, keep=self.keep, write_begin=begins, write_end=ends, publish=publish, take=take, done=done
        )
        if ends and seen["write_bank"] is not None:
            self.banks[seen["write_bank"]] = ended
        self.in_frame = (self.in_frame or begins) and not ends
        self.awaited = ends or (self.awaited and not publish)
        if reset:
            self.in_frame = self.awaited = False
        self.clocks.append(pins)
        self.seen.append((bool(seen["waiting"]), bool(seen["replaced"])))

    def run(self, clocks: int, write_pause: float, read_pause: float) -> None:
        """Add so many clocks, with a few resets, and a few times without frames kept."""
        writer, reader = self.writer(write_pause), self.reader(read_pause)
        for _ in range(clocks):
            self.keep ^= int(self.chance.random() < (0.003 if self.keep else 0.05))
            reset = self.chance.random() < 0.001
            self.clock(*next(writer), next(reader), reset)
            if reset:
                reader = self.reader(read_pause)


@cocotb.test(timeout_time=20, timeout_unit="ms")
@parametrize(write_pause=[0.0, 0.6], read_pause=[0.0, 0.5, 0.95])
async def frames(dut: Any, write_pause: float, read_pause: float) -> None:
    """Compare every value and word, which frame waits, and which is lost."""
    rows, columns, width, lanes = parameters(dut, "Rows", "Columns", "DataWidth", "Lanes")
    play = Play(rows, columns, width, lanes, random.Random(cocotb.RANDOM_SEED))
    play.run(300 * MANY + 20 * play.count, write_pause, read_pause)
    seen = await drive(dut, play.clocks, ["frame_valid", "skipped", "value_data", "record_data"])
    for clock, (valid, skipped) in enumerate(play.seen):
        assert bool(seen["frame_valid"][clock]) == valid, f"frame_valid in clock {clock}"
        assert bool(seen["skipped"][clock]) == skipped, f"skipped in clock {clock}"
    last = len(play.clocks)
    for clock, value in play.values.items():
        assert clock >= last or seen["value_data"][clock].to_signed() == value, f"value_data in clock {clock}"
    for clock, word in play.words.items():
        assert clock >= last or int(seen["record_data"][clock]) == word, f"record_data in clock {clock}"
    assert play.values, "the test is void: no value was read"
