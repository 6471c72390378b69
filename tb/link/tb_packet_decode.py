# SPDX-License-Identifier: Apache-2.0
"""packet_decode against unpack: every kind, lengths about the limits, fields, stalls, resets."""

import random
from typing import Any

import cocotb
from cocotb.triggers import ClockCycles, RisingEdge

from formal.entries import Proof
from tactile_depth.chip.link.framing import LONGEST_BODY
from tactile_depth.chip.link.packets import SELECT, TO_DEVICE, Ask, Kind, Picture, Read, Select, Write, unpack
from tb.axis import profile
from tb.cases import on_bench
from tb.pins import Driver, by_name
from tb.stream import parametrize, start_clock
from tb.structures import BOTH, Structure

STRUCTURES = (Structure(on=BOTH, mutants=BOTH),)
PROOFS = (
    Proof(
        "the widths in use",
        steps=3,
    ),
)


LENGTHS = {  # of kind and fields: about the limits, and near each power of two
    Kind.ASK: (1, 2, 3),
    Kind.SELECT: (1, 2, 3, 4, 6),
    Kind.READ: (1, 2, 3, 4, 5, 6, 7, 10, 18, 34, 66, 130, 257, 258, 259, 260),
    Kind.WRITE: (1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 12, 14, 20, 32, 68, 134, 260, 518, 770, 772, 773, 774, 775, 776),
    Kind.PICTURE: (1, 2, 8, 9, 10, 11, 12, 13, 14, 15, 18, 33, 66, 129, 258, 513, 777, 778, 779, 780),
}
OTHERS = tuple(kind for kind in range(256) if kind not in TO_DEVICE)
SOURCE = ("in_valid", "in_data", "in_last", "in_length", "in_length_mod3")
Event = tuple[Any, ...]


def expected(body: bytes) -> Event:
    """Return what a packet to the device causes, none for an unknown one.

    With `bad`, the second entry is set if its fields show it; otherwise kind and length do.
    """
    if body[0] not in TO_DEVICE:
        return ()
    packet = unpack(body)
    match packet:
        case Ask():
            return ("ask",)
        case Select():
            return "select", int(packet.depth_format), packet.shift
        case Read() | Write():
            return "request", int(isinstance(packet, Write)), body[1:]
        case Picture():
            return "picture", body[1:]
    return "bad", body[0] == Kind.SELECT and len(body) == SELECT.size


class Bench:
    """Source of packets as packet_store is one, both sinks, and a check of every output in every clock.

    Attributes
    ----------
    seen : set of str
        What happened.
    """

    def __init__(self, dut: Any, offers: str, accepts: str, resets: float) -> None:
        self.dut, self.resets = dut, resets
        self.drive, self.read = Driver(dut), by_name(dut)
        self.random = random.Random(cocotb.RANDOM_SEED)
        self.offers, self.request, self.picture = profile(offers), profile(accepts, 1), profile(accepts, 2)
        self.pulse: Event = ()  # due in this clock
        self.judged = False  # the kind was offered in the clock before
        self.seen: set[str] = set()

    async def start(self) -> None:
        """Start the clock and reset."""
        dut = self.dut
        self.drive(rst=1, **dict.fromkeys((*SOURCE, "request_ready", "picture_ready"), 0))
        start_clock(dut.clk)
        self.edge = RisingEdge(dut.clk)
        await ClockCycles(dut.clk, 3)

    async def clock(self, word: tuple[int, ...] | None, event: Event, place: int) -> tuple[bool, bool]:
        """Offer a byte, or none; return whether it was taken, and whether the clock was in a reset.

        `event` is what its packet causes, `place` that of the byte in the packet.
        """
        read, reset = self.read, self.random.random() < self.resets
        ready = {"request": int(next(self.request)), "picture": int(next(self.picture))}
        offered = word or [self.random.randint(0, 1) for _ in SOURCE[1:]]
        self.drive(rst=reset, **dict(zip(SOURCE, (word is not None, *offered), strict=True)))
        self.drive(**{f"{name}_ready": value for name, value in ready.items()})
        await self.edge
        self.check_pulses()
        kind = event[0] if event else ""
        for name in ready:
            valid = read(f"{name}_valid")
            assert valid == int(word is not None and kind == name and place > 0), f"{name}_valid at byte {place}"
            if valid and word is not None:
                assert read(f"{name}_data") == word[0], f"{name}_data at byte {place}"
                assert read(f"{name}_last") == word[1], f"{name}_last at byte {place}"
                assert name == "picture" or read("request_write") == event[1]
        judged, self.judged = self.judged, word is not None and place == 0 and not self.judged and not reset
        if word is None:
            self.pulse = ()
            return False, reset
        taken = int(judged) if place == 0 else ready.get(kind, 1)
        last = bool(word[1])
        selects = event[0] == "select" if event else False
        drops = place == 0 and not (kind in ("select", *ready) or (kind == "bad" and event[1]))
        assert read("in_ready") == taken, f"in_ready at byte {place}"
        assert not taken or read("in_drop") == drops, f"in_drop at byte {place}"
        due = taken and (drops or (last and (selects or kind == "bad")))
        self.pulse = event if due and not reset else ()
        return bool(taken), reset

    def check_pulses(self) -> None:
        """Compare the pulses with the one that is due."""
        due = self.pulse[0] if self.pulse else ""
        for name in ("bad", "ask", "select"):
            assert self.read(name) == (name == due), f"{name}: due is {due or 'nothing'}"
        if due == "select":
            assert (self.read("select_format"), self.read("select_shift")) == self.pulse[1:]

    async def send(self, body: bytes) -> None:
        """Send a packet up to the byte with which the rest is dropped, or to a reset."""
        event = expected(body)
        for place, byte in enumerate(body):
            word = (byte, int(place == len(body) - 1), len(body), len(body) % 3)
            while not next(self.offers):
                if (await self.clock(None, event, place))[1]:
                    return
            taken = False
            while not taken:
                taken, reset = await self.clock(word, event, place)
                if reset:
                    return
            if self.read("in_drop"):
                break
        self.seen.add(event[0] if event else "unknown")

    async def finish(self) -> None:
        """Check the pulse of the last packet."""
        for _ in range(3):
            await self.clock(None, (), 0)


def body(kind: int, length: int, chance: random.Random) -> bytes:
    """Return a packet with random fields; those of a select are good."""
    if kind == Kind.SELECT:
        return bytes((kind, chance.randrange(4), chance.randrange(17), *chance.randbytes(length)))[:length]
    return bytes((kind, *chance.randbytes(length - 1)))


@on_bench(Bench, resets=0.0)
@parametrize(offers=["none", "random"], accepts=["none", "random"])
async def lengths(bench: Bench) -> None:
    """Give packets of every kind, with lengths about the limits, in any order."""
    packets = [body(kind, length, bench.random) for kind, some in LENGTHS.items() for length in some]
    packets += [body(kind, bench.random.choice([1, 3, 8, 10, 12]), bench.random) for kind in OTHERS]
    bench.random.shuffle(packets)
    for packet in packets:
        await bench.send(packet)
    assert bench.seen == {"ask", "select", "request", "picture", "bad", "unknown"}, "the test is void"


@on_bench(Bench, offers="none", accepts="none", resets=0.0)
async def wrong_lengths(bench: Bench) -> None:
    """Give packets of each kind with every length that it cannot have."""
    for kind in TO_DEVICE:
        for length in range(1, LONGEST_BODY + 1):
            packet = body(kind, length, bench.random)
            if expected(packet) == ("bad", False):
                await bench.send(packet)
    assert bench.seen == {"bad"}


@on_bench(Bench, offers="none", accepts="none", resets=0.0)
async def selects(bench: Bench) -> None:
    """Give selects with each format, and each bit of both fields."""
    fields = {*range(20), *(1 << bit for bit in range(8)), 31, 255}
    for field in sorted(fields):
        for packet in ((Kind.SELECT, field, 16), (Kind.SELECT, 1, field), (Kind.SELECT, 3 - field % 4, field)):
            await bench.send(bytes(packet))


@on_bench(Bench, offers="random", accepts="random", resets=0.02)
async def reset(bench: Bench) -> None:
    """Reset at any time: the next packet begins with its kind."""
    for _ in range(300):
        kind = bench.random.choice(TO_DEVICE)
        await bench.send(
            body(kind, bench.random.choice([length for length in LENGTHS[kind] if length < 20]), bench.random)
        )
