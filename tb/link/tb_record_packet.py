# SPDX-License-Identifier: Apache-2.0
"""record_packet against tactile_depth.chip.link.packets: records close together, sinks of every kind, resets."""

import random
from collections.abc import Sequence
from typing import Any

import cocotb

from formal.entries import WORD_FREE, Proof
from tactile_depth.chip.contact.contact_events import WORDS, record
from tactile_depth.chip.link.packets import RECORD, RecordPacket
from tb.axis import PROFILES, profile
from tb.stream import drive, parametrize
from tb.structures import BOTH, ICARUS, Mutants, Structure

STRUCTURES = (Structure(on=BOTH, mutants=ICARUS),)
MUTANTS = Mutants(flat=False)
PROOFS = (
    Proof(
        f"the size in use; one bit of an arbitrary word is followed: {WORD_FREE}",
    ),
)


PACKET = RECORD.size
CALM = {"rst": 0, "s_event_tvalid": 0, "s_event_tdata": 0, "s_event_tlast": 0, "record_ready": 1}


def stimuli(accepts: str, chance: random.Random) -> list[dict[str, int]]:
    """Return records, with and without gaps inside and between them, and a few resets."""
    ready = profile(accepts)
    clocks: list[dict[str, int]] = []

    def clock(**pins: int) -> None:
        clocks.append(CALM | {"record_ready": int(next(ready))} | pins)

    for _ in range(70):
        pause = chance.choice([0.0, 0.0, 0.3])
        words = [chance.getrandbits(32) for _ in range(WORDS)]
        cut = chance.random() < 0.05
        for index, word in enumerate(words[: chance.randrange(WORDS) if cut else WORDS]):
            while chance.random() < pause:
                clock(s_event_tdata=chance.getrandbits(32), s_event_tlast=chance.randrange(2))
            clock(s_event_tvalid=1, s_event_tdata=word, s_event_tlast=int(index == WORDS - 1))
        if cut:
            clock(rst=1)
        for _ in range(chance.choice([0, 0, 1, chance.randrange(40), 3 * PACKET])):
            clock()
    return [*clocks, *[CALM] * (4 * PACKET)]


class Expected:
    """The packets that leave, from the clocks of the records and of the bytes that were taken."""

    def __init__(self) -> None:
        self.clear()

    def clear(self) -> None:
        self.words: list[int] = []
        self.newest: tuple[int, ...] | None = None
        self.packet = b""  # the rest of it

    def clock(self, pins: dict[str, int], leaves: bool) -> None:
        """Advance by one clock edge; `leaves`: a byte was taken."""
        if leaves and not self.packet:
            assert self.newest is not None, "a packet without a record"
            self.packet, self.newest = RecordPacket(record(self.newest)).pack(), None
        self.packet = self.packet[int(leaves) :]
        if pins["s_event_tvalid"]:
            if not self.words and self.packet:  # both banks are in use
                self.newest = None
            self.words.append(pins["s_event_tdata"])
            if pins["s_event_tlast"]:
                self.newest, self.words = tuple(self.words), []
        if pins["rst"]:
            self.clear()


def check(inputs: Sequence[dict[str, int]], seen: dict[str, Any]) -> int:
    """Compare every byte; return how many packets left."""
    expected, stalled, silent, packets = Expected(), False, 0, 0
    for clock, pins in enumerate(inputs):
        valid = bool(seen["record_valid"][clock])
        if not expected.packet:
            assert valid == (expected.newest is not None), f"record_valid in clock {clock}"
        silent = 0 if valid or not expected.packet else silent + 1
        assert silent <= 2, f"clock {clock}: a byte waits for more than 2 clocks"
        assert valid or not stalled, f"clock {clock}: valid fell before ready came"
        if valid:
            byte = expected.packet[0] if expected.packet else 0x99
            assert int(seen["record_data"][clock]) == byte, f"record_data in clock {clock}"
            assert bool(seen["record_last"][clock]) == (len(expected.packet) == 1), f"record_last in clock {clock}"
        leaves = valid and bool(pins["record_ready"])
        packets += leaves and len(expected.packet) == 1
        stalled = valid and not leaves and not pins["rst"]
        expected.clock(pins, leaves)
    return packets


@cocotb.test(timeout_time=20, timeout_unit="ms")
@parametrize(accepts=[*PROFILES])
async def packets(dut: Any, accepts: str) -> None:
    """Compare every byte; a record that comes before the first byte is taken replaces the one that waits."""
    inputs = stimuli(accepts, random.Random(cocotb.RANDOM_SEED))
    seen = await drive(dut, inputs, ["record_valid", "record_data", "record_last"])
    assert check(inputs, seen) > 10, "the test is void: too few packets left"
