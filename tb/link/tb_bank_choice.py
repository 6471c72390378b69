# SPDX-License-Identifier: Apache-2.0
"""bank_choice against its model in every clock: writers and readers of every speed, frames cut short, resets."""

import random
from typing import Any

import cocotb

from tactile_depth.chip.link.bank_choice import BankChoice, Seen
from tb.stream import drive, parametrize

CLOCKS = 1500


def stimuli(writes: float, publishes: float, reads: float, chance: random.Random) -> list[tuple[dict[str, int], Seen]]:
    """Return the pulses of a writer and a reader, and what the model says of each clock.

    The probabilities are those of a step of the writer, of a record, and of a step of the reader.
    """
    model = BankChoice()
    clocks: list[tuple[dict[str, int], Seen]] = []
    keep = 1
    for _ in range(CLOCKS):
        keep ^= int(chance.random() < (0.02 if keep else 0.2))
        pins = dict.fromkeys(("rst", "write_begin", "write_end", "publish", "take", "done"), 0) | {"keep": keep}
        if chance.random() < writes:
            pins["write_end" if model.written is not None and chance.random() < 0.7 else "write_begin"] = 1
        pins["publish"] = int(chance.random() < publishes)
        if model.read is not None:
            pins["done"] = int(chance.random() < reads)
        if keep and model.ready is not None and (model.read is None or pins["done"]):
            pins["take"] = int(chance.random() < max(reads, 0.3))
        pins["rst"] = int(chance.random() < 0.005)
        seen = model.clock(**{name: bool(value) for name, value in pins.items() if name != "rst"})
        if pins["rst"]:
            model.reset()
        clocks.append((pins, seen))
    return clocks


@cocotb.test(timeout_time=5, timeout_unit="ms")
@parametrize(writes=[0.1, 0.5, 1.0], publishes=[0.1, 0.6], reads=[0.03, 0.3, 1.0])
async def banks(dut: Any, writes: float, publishes: float, reads: float) -> None:
    """Compare every output; the write bank counts inside a frame, the read bank while it is read."""
    clocks = stimuli(writes, publishes, reads, random.Random(cocotb.RANDOM_SEED))
    outputs = ["write_bank", "waiting", "reading", "read_bank", "replaced"]
    pins = await drive(dut, [inputs for inputs, _ in clocks], outputs)
    for clock, (_, seen) in enumerate(clocks):
        if seen.write_bank is not None:
            assert int(pins["write_bank"][clock]) == seen.write_bank, f"write_bank in clock {clock}"
        assert bool(pins["reading"][clock]) == (seen.read_bank is not None), f"reading in clock {clock}"
        if seen.read_bank is not None:
            assert int(pins["read_bank"][clock]) == seen.read_bank, f"read_bank in clock {clock}"
        assert bool(pins["waiting"][clock]) == seen.waiting, f"waiting in clock {clock}"
        assert bool(pins["replaced"][clock]) == seen.replaced, f"replaced in clock {clock}"
    lost = any(seen.replaced for _, seen in clocks)
    assert lost or reads == 1, "the test is void: no frame was lost"
    assert any(inputs["take"] for inputs, _ in clocks), "the test is void: no frame was taken"
