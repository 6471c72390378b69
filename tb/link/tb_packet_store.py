# SPDX-License-Identifier: Apache-2.0
"""packet_store against its model in every cycle: packets of every length, bad, lost and dropped ones, resets."""

import random
from collections.abc import Iterator
from typing import Any

import cocotb

from formal.entries import Proof
from tactile_depth.chip.link.framing import LONGEST_BODY
from tactile_depth.chip.link.packet_store import PacketStore
from tb.axis import PROFILES, profile
from tb.stream import drive, parameters, parametrize, sample
from tb.structures import BOTH, ICARUS, VERILATOR, of_parameters

built = of_parameters("BankBytes")
STRUCTURES = (
    built(1024, on=VERILATOR),
    built(8, on=ICARUS, mutants=BOTH),
    built(4),
)
REFUSED = {f"BankBytes={size}": "BankBytes_must_be_a_power_of_two_from_4_to_1024" for size in (2, 12, 2048)}
PROOFS = (
    Proof(
        "places are only counted; an arbitrary byte is followed",
        {"BankBytes": 4},
        steps=3,
    ),
)


PROFILES["rarely"] = lambda rng: (rng.random() < 0.05 for _ in iter(int, 1))
PROFILES["bursts"] = lambda rng: iter(bursts(rng).__next__, None)


def bursts(rng: random.Random) -> Iterator[bool]:
    """Yield the ready of a consumer that works and waits, for a few packets each."""
    while True:
        for ready in (True, False):
            yield from [ready] * rng.randint(20, 150)


def stimuli(bank: int, accepts: str, gap: float, resets: float, chance: random.Random) -> list[dict[str, int]]:
    """Return the pins for packets that come whether there is room or not."""
    ready = profile(accepts)
    clocks: list[dict[str, int]] = []

    def clock(**pins: int) -> None:
        idle = {"in_valid": 0, "in_data": chance.randint(0, 255), "in_end": 0, "in_good": chance.randint(0, 1)}
        drop = int(chance.random() < 0.06)
        reset = int(chance.random() < resets)
        clocks.append({"rst": reset, **idle, "out_ready": int(next(ready)), "out_drop": drop, **pins})

    lengths = [*range(1, 9), bank - 1, bank, bank + 1, min(2 * bank + 1, LONGEST_BODY)]
    for _ in range(90 if bank < 100 else 4):
        good, length = chance.random() < 0.85, chance.choice(lengths)
        for _ in range(length if good else chance.choice([0, length])):
            while chance.random() < gap:
                clock()
            clock(in_valid=1)
        while chance.random() < gap:
            clock()
        clock(in_end=1, in_good=int(good))
        for _ in range(chance.choice([0, 0, 0, 3, length, 3 * length])):
            clock()
    for _ in range(2 * bank if bank > 100 else 5 * bank):
        clock()
    length = 0
    for pins in clocks:  # a packet that a reset left without a byte is not good
        length += pins["in_valid"]
        pins["in_good"] &= int(length > 0)
        length = 0 if pins["rst"] or pins["in_end"] else length
    return clocks


class Check:
    """Model beside the recorded pins; `seen` names what happened, `bytes_taken` counts bytes."""

    def __init__(self, bank: int, outputs: Any) -> None:
        self.model, self.outputs = PacketStore(bank), outputs
        self.seen: set[str] = set()
        self.bytes_taken = 0

    def pin(self, name: str, clock: int) -> int:
        return int(self.outputs[name][clock])

    def compare(self, clock: int) -> None:
        """Compare the outputs in a clock."""
        assert bool(self.pin("in_ready", clock)) == self.model.ready, f"in_ready in clock {clock}"
        assert bool(self.pin("bad", clock)) == self.model.bad, f"bad in clock {clock}"
        offer = self.model.offer
        assert bool(self.pin("out_valid", clock)) == (offer is not None), f"out_valid in clock {clock}"
        if offer is not None:
            names = ("out_data", "out_last", "out_length", "out_length_mod3")
            got = tuple(self.pin(name, clock) for name in names)
            assert got == (*offer, offer.length % 3), f"clock {clock}: {got}, expected {offer}"

    def advance(self, pins: dict[str, int]) -> None:
        """Advance the model by the inputs of a clock."""
        model, offer = self.model, self.model.offer
        if pins["rst"]:
            model.reset()
            return
        taken = offer is not None and bool(pins["out_ready"])
        self.bytes_taken += taken
        if taken and offer is not None:
            self.seen |= {"last"} if offer.last else {"drop"} if pins["out_drop"] else set()
        self.seen |= {"full"} if not model.ready and pins["in_valid"] else set()
        byte = pins["in_data"] if pins["in_valid"] else None
        model.clock(byte, *(bool(pins[pin]) for pin in ("in_end", "in_good", "out_ready", "out_drop")))


async def compare(dut: Any, bank: int, inputs: list[dict[str, int]]) -> Check:
    """Drive the pins and compare the outputs with the model in each clock."""
    pins = ["in_ready", "bad", "out_valid", "out_data", "out_last", "out_length", "out_length_mod3"]
    check = Check(bank, await drive(dut, inputs, pins))
    for clock, at_pins in enumerate(inputs):
        check.compare(clock)
        check.advance(at_pins)
    assert check.bytes_taken, "the test is void: no byte left"
    return check


@cocotb.test(timeout_time=40, timeout_unit="ms")
@parametrize(accepts=sample(["none", "random", "bursts", "rarely"]), gap=[0.0, 0.5], resets=[0.0, 0.003])
async def packets(dut: Any, accepts: str, gap: float, resets: float) -> None:
    """Store packets, whether there is room or not, and read all of each, or a part."""
    (bank,) = parameters(dut, "BankBytes")
    inputs = stimuli(bank, accepts, gap, resets, random.Random(cocotb.RANDOM_SEED))
    check = await compare(dut, bank, inputs)
    assert bank > 100 or check.seen >= {"drop", *(["full"] if accepts == "rarely" else ["last"])}, (
        f"the test is void: {check.seen}"
    )


@cocotb.test(timeout_time=40, timeout_unit="ms")
async def lengths(dut: Any) -> None:
    """Store packets whose length is a power of two, one in each bank, and the longest."""
    (bank,) = parameters(dut, "BankBytes")
    chance = random.Random(cocotb.RANDOM_SEED)
    calm = {"rst": 0, "in_valid": 0, "in_data": 0, "in_end": 0, "in_good": 0, "out_ready": 1, "out_drop": 0}
    inputs = []
    for length in (1, 1, 2, 2, 4, 4, 8, 8, 16, 16, 32, 32, 64, 64, 128, 128, 256, 256, 512, 512, 1024, 1024, 2047):
        inputs += [calm | {"in_valid": 1, "in_data": chance.randint(0, 255)} for _ in range(length)]
        inputs += [calm | {"in_end": 1, "in_good": 1}, *[calm] * 4, *[calm | {"out_drop": 1}] * 4]
    await compare(dut, bank, inputs)
