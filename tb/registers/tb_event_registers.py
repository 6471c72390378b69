# SPDX-License-Identifier: Apache-2.0
"""event_registers against its model in every clock; counts are set too, because 2^32 events would take too long."""

import random
from typing import Any

import cocotb

from tactile_depth.chip.registers.event_registers import (
    ARRIVED,
    COUNTERS,
    LARGEST,
    LARGEST_COUNT,
    LATENCY,
    LEVELS,
    SELF_TEST,
    STATUS,
    EventRegisters,
)
from tactile_depth.chip.registers.register_map import WORD
from tb import lockstep, structs
from tb.registers.bus import NAME_AT, Bus
from tb.structures import BOTH, ICARUS, Mutants, Structure

STRUCTURES = (Structure(on=BOTH, mutants=ICARUS),)
PROTOCOL = {"counts": "live"}
MUTANTS = Mutants(outside=("counts", "flips", "residuals"))
NO_PROOF = "every register and output of it is proven through the port: axil_registers"

COUNTER_ORDER = (  # names of the words of `counts`, from the lowest
    *("FRAMES_IN", "FRAMES_OUT", "FRAMES_DROPPED", "DARK_PIXELS", "DEPTH_DROPPED", "RECORDS_LOST", "SATURATIONS"),
)


class Registers:
    """The model at the pins of the core."""

    def __init__(self) -> None:
        self.model = EventRegisters()

    def clock(self, **pins: int) -> dict[str, int]:
        """Advance by one clock edge; return the outputs before it."""
        model, name = self.model, NAME_AT.get(pins["read_offset"], "")
        levels = structs.unpack("levels_t", pins["levels"])
        shown = {
            "STATUS": STATUS.pack(**{level: levels[level] for level in LEVELS}),
            "ARRIVED": ARRIVED.pack(rows=levels["arrived_rows"], columns=levels["arrived_columns"]),
            SELF_TEST: levels["self_test"],
        }
        out = {"read_data": model.values.get(name, 0) | shown.get(name, 0), "irq": model.irq}
        if pins["write"]:
            model.write(NAME_AT.get(pins["write_offset"], ""), pins["write_ones"])
        events = structs.unpack("events_t", pins["events"])
        saturations, valid = events.pop("saturations"), pins["first_depth_latency_valid"]
        latency = pins["first_depth_latency"] if valid else None
        residual = levels["residual"]
        model.clock([name for name in events if events[name]], saturations, residual, latency, pins["interrupt_mask"])
        if pins["rst"]:
            model.reset()
        return out


@cocotb.test
async def registers(dut: Any) -> None:
    chance, bits = random.Random(cocotb.RANDOM_SEED), len(dut.events)
    bus = Bus(dut, "STATUS", "INTERRUPT_STATUS", "CONTROL", "ARRIVED", SELF_TEST, LATENCY, LARGEST, *COUNTERS)
    pins = {
        **bus.choices,
        "events": [0, (1 << bits) - 1, *(1 << bit for bit in range(bits))],
        "levels": lockstep.WORD,
        "first_depth_latency": lockstep.WORD,
        "first_depth_latency_valid": 1.0,
        "interrupt_mask": [WORD, 0, *(1 << bit for bit in range(32))],
    }

    def counts(core: Registers, pins: dict[str, int]) -> None:
        """Set all counts at times: one may stand below a carry or the largest."""
        bus.drive(pins)
        if chance.random() < 0.02:
            words = [chance.choice((chance.getrandbits(32), WORD - chance.getrandbits(4))) for _ in COUNTER_ORDER]
            words[chance.randrange(len(words))] = (1 << chance.randrange(33)) - 1
            core.model.values.update(zip(COUNTER_ORDER, words, strict=True))
            dut.counts.value = sum(word << 32 * n for n, word in enumerate(words))
            for name, count in (("FLIPS", dut.flips), ("RESIDUALS", dut.residuals)):
                core.model.values[name] = LARGEST_COUNT[name] - chance.randrange(2)
                count.value = core.model.values[name]

    await lockstep.play(dut, Registers(), pins, counts)
