# SPDX-License-Identifier: Apache-2.0
"""record_packets against its model in every cycle: sinks of every kind, records close together, resets."""

import random
from typing import Any

import cocotb

from formal.entries import Proof
from tactile_depth.chip.contact.record_packets import RecordPackets
from tb.axis import PROFILES, profile
from tb.stream import drive, parameters, parametrize
from tb.structures import ICARUS, VERILATOR, of_parameters

built = of_parameters("Words")
STRUCTURES = (
    built(13, on=VERILATOR),
    built(3, on=ICARUS, mutants=ICARUS),
    built(2),
)
PROTOCOL = {"counts": "live & ~reset", "m_event_tdata m_event_tlast": "counts & m_event_tvalid"}
PROOFS = (
    Proof(
        "words are sent alike; as many to a packet as in use",
    ),
)


PROFILES["rarely"] = lambda rng: (rng.random() < 0.05 for _ in iter(int, 1))
PROFILES["never"] = lambda rng: iter(lambda: False, True)


def stimuli(words: int, accepts: str, chance: random.Random) -> list[dict[str, int]]:
    """Return records at random times, close together and far apart, and a few resets."""
    ready = profile(accepts)
    clocks: list[dict[str, int]] = []
    for _ in range(60):
        for clock in range(chance.choice([1, 2, words, words + 1, words + 2, 4 * words, chance.randint(1, 3 * words)])):
            new, reset = int(clock == 0), int(chance.random() < 0.002)
            record = chance.getrandbits(32 * words)
            clocks.append({"rst": reset, "new_valid": new, "new_record": record, "m_event_tready": int(next(ready))})
    calm = {"rst": 0, "new_valid": 0, "new_record": 0, "m_event_tready": 1}
    return [{**calm, "m_event_tready": 0}, *clocks, *[calm] * (3 * words)]


@cocotb.test(timeout_time=20, timeout_unit="ms")
@parametrize(accepts=[*PROFILES])
async def packets(dut: Any, accepts: str) -> None:
    """Receive whole packets in order; with a slow sink as many are missing as record_lost counts."""
    (words,) = parameters(dut, "Words")
    inputs = stimuli(words, accepts, random.Random(cocotb.RANDOM_SEED))
    outputs = ["record_valid", "record", "record_lost", "m_event_tvalid", "m_event_tdata", "m_event_tlast"]
    outputs_seen = await drive(dut, inputs, outputs)
    model, record, was_new = RecordPackets(), 0, False
    taken: list[int] = []
    lost = 0
    for clock, pins in enumerate(inputs):
        sending = model.sending
        assert bool(outputs_seen["record_valid"][clock]) == was_new, f"record_valid in clock {clock}"
        assert int(outputs_seen["record"][clock]) == record, f"record in clock {clock}"
        assert bool(outputs_seen["m_event_tvalid"][clock]) == bool(sending), f"m_event_tvalid in clock {clock}"
        if sending:
            assert int(outputs_seen["m_event_tdata"][clock]) == sending[0], f"m_event_tdata in clock {clock}"
            assert bool(outputs_seen["m_event_tlast"][clock]) == (len(sending) == 1), f"m_event_tlast in clock {clock}"
            taken += [sending[0]] * pins["m_event_tready"]
        if pins["rst"]:
            model.reset()
            record, was_new = 0, False
            continue
        was_new = bool(pins["new_valid"])
        new = tuple(pins["new_record"] >> 32 * word & 0xFFFF_FFFF for word in range(words)) if was_new else None
        lost_now = model.clock(new, bool(pins["m_event_tready"]))
        assert bool(outputs_seen["record_lost"][clock]) == lost_now, f"record_lost in clock {clock}"
        lost += lost_now
        record = pins["new_record"] if was_new else record
    assert taken, "the test is void: no word left"
    assert lost, "the test is void: no record was lost"
