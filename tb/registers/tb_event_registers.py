# SPDX-License-Identifier: Apache-2.0
"""event_registers against tactile_depth.chip.registers.event_registers, every output in every cycle."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import cocotb

from tactile_depth.chip.registers.event_registers import (
    COUNTERS,
    EVENT_COUNTERS,
    EVENTS,
    INTERRUPT_EVENTS,
    INTERRUPT_STATUS,
    LATENCY,
    LEVELS,
    STATUS,
    STICKY_EVENTS,
    EventRegisters,
)
from tactile_depth.chip.registers.register_map import WORD
from tb import structs
from tb.cases import on_bench
from tb.registers.register_bench import WHOLE, RegisterBench
from tb.structures import BOTH, ICARUS, Mutants, Structure

STRUCTURES = (Structure(on=BOTH, mutants=ICARUS),)
PROTOCOL = {"counts": "live"}
MUTANTS = Mutants(outside=("counts",))
NO_PROOF = "every register and output of it is proven through the port: axil_registers"


COUNTER_ORDER = (  # names of the words of `counts`, from the lowest
    *("FRAMES_IN", "FRAMES_OUT", "FRAMES_DROPPED", "DARK_PIXELS", "DEPTH_DROPPED", "RECORDS_LOST", "SATURATIONS"),
)
READ = ("STATUS", "INTERRUPT_STATUS", LATENCY, *COUNTERS)


class Bench(RegisterBench):
    """Bench of event_registers."""

    idle: Mapping[str, int] = dict.fromkeys(
        ("events", "levels", "first_depth_latency", "first_depth_latency_valid", "interrupt_mask"), 0
    )

    def __init__(self, dut: Any) -> None:
        super().__init__(dut)
        self.model = EventRegisters()

    def word(self, name: str) -> int:
        levels = STATUS.pack(**structs.unpack("levels_t", self.inputs["levels"])) if name == "STATUS" else 0
        return self.model.values.get(name, 0) | levels

    def outputs(self) -> dict[str, int]:
        return {"irq": int(self.model.irq)}

    def step(self, write: tuple[str, int, int] | None) -> None:
        if write:
            self.model.write(*write[:2])
        events, valid = structs.unpack("events_t", self.inputs["events"]), self.inputs["first_depth_latency_valid"]
        saturations = events.pop("saturations")
        self.model.clock(
            [name for name, happens in events.items() if happens],
            saturations,
            self.inputs["first_depth_latency"] if valid else None,
            self.inputs["interrupt_mask"],
        )

    def reset(self) -> None:
        self.model.reset()

    async def happen(self, *events: str, saturations: int = 0, **inputs: Any) -> int:
        """Run a cycle with these events."""
        members = dict.fromkeys(events, 1) | {"saturations": saturations}
        return await self.clock(events=structs.pack("events_t", members), **inputs)

    def set_counters(self, **counts: int) -> None:
        """Put counts into the core and its model, because 2^32 events would take too long."""
        self.model.values.update(counts)
        words = (self.model.values[name] << 32 * n for n, name in enumerate(COUNTER_ORDER))
        self.dut.counts.value = sum(words)

    def random_inputs(self) -> dict[str, Any]:
        rng = self.random
        members: dict[str, int] = {name: int(rng.random() < 0.1) for name in EVENTS}
        members["saturations"] = rng.getrandbits(14) if rng.random() < 0.1 else 0
        return {
            "events": structs.pack("events_t", members),
            "levels": rng.getrandbits(3),
            "first_depth_latency": rng.getrandbits(32),
            "first_depth_latency_valid": int(rng.random() < 0.1),
            "interrupt_mask": rng.getrandbits(2),
        }


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def each_event(dut: Any) -> None:
    """Raise each event: it sets its bits and counts once. A written 1 clears only its bit. Levels are read directly."""
    assert {*EVENTS, "saturations"} == set(structs.members("events_t"))
    bench = Bench(dut)
    await bench.start()
    for event in (*EVENTS, "saturations"):
        for bit in range(14) if event == "saturations" else (0,):
            await bench.happen(*({event} - {"saturations"}), saturations=(event == "saturations") << bit)
            bits = {"STATUS": STATUS.pack(**{STICKY_EVENTS[event]: 1})} if event in STICKY_EVENTS else {"STATUS": 0}
            if event == "saturations":
                bits["STATUS"] = STATUS.pack(saturation=1)
            interrupt = INTERRUPT_EVENTS.get(event)
            bits["INTERRUPT_STATUS"] = INTERRUPT_STATUS.pack(**{interrupt: 1}) if interrupt else 0
            for register, expected in bits.items():
                assert await bench.clock(read_at=register) == expected, event
                await bench.clock(write=(register, WORD & ~expected, WHOLE))
                assert await bench.clock(read_at=register) == expected, f"{event} was cleared by a 0"
                await bench.clock(write=(register, expected, WHOLE))
                assert await bench.clock(read_at=register) == 0
            counts = {name: await bench.clock(read_at=name) for name in COUNTERS}
            counter = "SATURATIONS" if event == "saturations" else EVENT_COUNTERS.get(event)
            assert counts == {name: int(name == counter) << bit for name in COUNTERS}, event
            await bench.clock(write=("CONTROL", 2, WHOLE))
    for level in LEVELS:
        shown = await bench.clock(read_at="STATUS", levels=structs.pack("levels_t", {level: 1}))
        assert shown == STATUS.pack(**{level: 1})


@on_bench(Bench)
async def an_event_in_the_clock_of_its_clearing(bench: Bench) -> None:
    """Raise an event in the cycle that clears its bit: it is kept. One in the cycle before is cleared."""
    for register in ("STATUS", "INTERRUPT_STATUS", "CONTROL"):
        for before, same in ((1, 0), (0, 1), (1, 1)):
            await bench.happen(*(EVENTS if before else ()), saturations=9 * before)
            await bench.happen(*(EVENTS if same else ()), saturations=9 * same, write=(register, WORD, WHOLE))
            for name in READ:
                await bench.clock(read_at=name)
            for name in ("STATUS", "INTERRUPT_STATUS", "CONTROL"):
                await bench.clock(write=(name, WORD, WHOLE))


@on_bench(Bench)
async def counters_stay_at_the_top(bench: Bench) -> None:
    """Count up to all ones from a value near it, and through every bit: the counter stays there until it is cleared."""
    sources: dict[str, dict[str, Any]] = {name: {"events": event} for event, name in EVENT_COUNTERS.items()}
    for name in COUNTERS:
        event, step = sources.get(name, {}).get("events"), 1 if name in sources else 255
        for start in (WORD - step - 1, *((1 << bit) - 1 for bit in range(9, 32)), *(1 << bit for bit in range(32))):
            bench.set_counters(**{name: start})
            for _ in range(3):
                await bench.happen(*([event] if event else []), saturations=0 if event else step, read_at=name)
            expected = min(start + 3 * step, WORD)
            assert await bench.clock(read_at=name) == expected, f"{name} from {start:#x}"
        await bench.clock(write=("CONTROL", 2, 0xE), read_at=name)
        await bench.clock(write=("CONTROL", WORD & ~2, WHOLE), read_at=name)
        assert await bench.clock(read_at=name) == expected, f"{name} was cleared by a 0"
        await bench.clock(write=("CONTROL", 2, WHOLE))
        assert await bench.clock(read_at=name) == 0


@on_bench(Bench)
async def counters_count_for_themselves(bench: Bench) -> None:
    """Count on from random values: no counter depends on another one."""
    for _ in range(100):
        bench.set_counters(**{name: bench.random.getrandbits(32) for name in COUNTERS})
        await bench.clock(**bench.random_inputs())
        for name in COUNTERS:
            await bench.clock(read_at=name)


@on_bench(Bench)
async def the_last_latency_stays(bench: Bench) -> None:
    """Change the latency: the register follows only while it is valid."""
    for clocks in (0x1234_5678, WORD, 0, 34_567, *(1 << bit for bit in range(32))):
        await bench.clock(first_depth_latency=clocks, first_depth_latency_valid=1)
        await bench.clock(first_depth_latency=99, write=("CONTROL", 2, WHOLE))
        assert await bench.clock(read_at=LATENCY) == clocks


@on_bench(Bench)
async def the_interrupt(bench: Bench) -> None:
    """Check irq: high while a bit is set and not masked, one cycle late."""
    for event, bit in INTERRUPT_EVENTS.items():
        own = INTERRUPT_STATUS.field(bit).mask
        await bench.happen(event)
        for mask in (INTERRUPT_STATUS.mask() & ~own, own, 0, INTERRUPT_STATUS.mask()):
            for _ in range(2):
                await bench.clock(interrupt_mask=mask)
            assert bench.model.irq == bool(mask & own)
        await bench.clock(interrupt_mask=own, write=("INTERRUPT_STATUS", own, WHOLE))
        await bench.clock(interrupt_mask=own)
        await bench.clock(interrupt_mask=own)
        assert not bench.model.irq


@on_bench(Bench)
async def random_events(bench: Bench) -> None:
    """Drive random events, writes, reads and resets."""
    await bench.random_clocks((*READ, "STATUS", "INTERRUPT_STATUS", "CONTROL"))


@on_bench(Bench)
async def other_offsets(bench: Bench) -> None:
    """Access offsets that differ in one bit from that of a register: they are not taken for it."""
    await bench.other_offsets((*READ, "CONTROL"))
