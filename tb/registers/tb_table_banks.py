# SPDX-License-Identifier: Apache-2.0
"""table_banks against tactile_depth.chip.registers.table_banks, every output in every cycle."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from formal.entries import Proof
from tactile_depth.chip.registers.register_map import TABLES, WORD
from tactile_depth.chip.registers.table_banks import CAPTURES, COMMIT, TableBanks
from tb import structs
from tb.cases import on_bench
from tb.registers.register_bench import WHOLE, RegisterBench
from tb.stream import parametrize
from tb.structures import BOTH, ICARUS, of_parameters

built = of_parameters("Present")
STRUCTURES = (
    built(15, on=BOTH, mutants=ICARUS),
    built(2, on=ICARUS),
    built(4, on=ICARUS),
    built(9, on=ICARUS),
)
PROTOCOL = {"counts": "live", "write": "write & ~rst"}
PROOFS = tuple(
    Proof(
        "all tables, and a build without some",
        {"Present": present},
    )
    for present in (15, 8)
)


ALL = (1 << len(TABLES)) - 1
START = {table: register.pack(start=1) for table, register in CAPTURES.items()}


def status(**flags: int) -> int:
    """Return the vector of a capture's status."""
    return structs.pack("capture_status_t", flags)


class Bench(RegisterBench):
    """Bench of table_banks; the tables follow in the next cycle, unless a test holds them."""

    idle: Mapping[str, int] = dict.fromkeys(
        ("frame_start", "cold_rst", "table_in_use", "reference_status", "zero_status"), 0
    )

    def __init__(self, dut: Any) -> None:
        super().__init__(dut)
        self.model = TableBanks(int(dut.Present.value))

    async def start(self) -> None:
        """Hold a cold reset for two clocks."""
        self.idle = {**self.idle, "cold_rst": 1}
        await super().start()
        self.model.bank = 0
        self.idle = {**self.idle, "cold_rst": 0}

    def capturing(self, flag: str) -> set[str]:
        """Return the tables whose capture has a flag of its status up."""
        return {t for t in CAPTURES if structs.unpack("capture_status_t", self.inputs[f"{t}_status"])[flag]}

    def word(self, name: str) -> int:
        if name == COMMIT.name:
            return self.model.pending(self.inputs["table_in_use"])
        busy = (
            register.pack(busy=1)
            for t, register in CAPTURES.items()
            if t in self.capturing("busy") and name == register.name
        )
        return sum(busy)

    def refuses(self, name: str, ones: int, mask: int) -> bool:
        return self.model.refuses(name, ones, self.inputs["table_in_use"], self.capturing("done"))

    def outputs(self) -> dict[str, int]:
        outputs = {
            "table_bank": self.model.wanted(bool(self.inputs["frame_start"] and not self.rst)),
            "closed": self.model.closed(self.inputs["table_in_use"], self.capturing("busy")),
        }
        started = self.model.started(*self.allowed[:2]) if self.allowed else None
        return outputs | {f"{table}_request": int(table == started) for table in CAPTURES}

    def step(self, write: tuple[str, int, int] | None) -> None:
        if write:
            self.model.write(*write[:2], self.inputs["table_in_use"], self.capturing("busy"))
        self.model.clock(bool(self.inputs["frame_start"]), self.capturing("done"))
        self._cold()

    def reset(self) -> None:
        self.model.reset()
        self._cold()

    def _cold(self) -> None:
        if getattr(self, "inputs", self.idle)["cold_rst"]:
            self.model.bank = 0

    async def follow(self) -> None:
        """Let all tables change to their next banks."""
        self.idle = {**self.idle, "table_in_use": self.model.bank}
        await self.clock(read_at=COMMIT.name)

    def random_inputs(self) -> dict[str, Any]:
        rng = self.random
        in_use = self.idle["table_in_use"]
        if rng.random() < 0.1:
            in_use ^= 1 << rng.randrange(4)
        elif rng.random() < 0.3:
            in_use = self.model.bank
        self.idle = {**self.idle, "table_in_use": in_use}
        captures = {
            f"{table}_status": status(busy=int(rng.random() < 0.3), done=int(rng.random() < 0.05)) for table in CAPTURES
        }
        return {"frame_start": int(rng.random() < 0.1), "cold_rst": int(rng.random() < 0.005)} | captures


@on_bench(Bench)
async def change_overs(bench: Bench) -> None:
    """Commit: tables change over with the next frame, and are pending and closed until the table has followed."""
    present = bench.model.present
    for tables in range(ALL + 1):
        before = bench.model.bank
        await bench.clock(write=(COMMIT.name, tables, 0xE))
        assert await bench.clock(read_at=COMMIT.name) == 0
        await bench.clock(write=(COMMIT.name, WORD & ~ALL | tables, WHOLE))
        assert await bench.clock(read_at=COMMIT.name) == tables & present
        await bench.clock(write=(COMMIT.name, 0, WHOLE))  # cancels nothing
        await bench.clock(frame_start=1)
        assert bench.model.bank == before ^ tables & present
        for _ in range(3):
            assert await bench.clock(read_at=COMMIT.name) == tables & present
        await bench.clock(write=(COMMIT.name, tables, WHOLE))  # no effect while it is pending
        await bench.follow()
        await bench.clock(frame_start=1)
        assert await bench.clock(read_at=COMMIT.name) == 0


@on_bench(Bench)
async def a_frame_that_starts_with_the_commit(bench: Bench) -> None:
    """Start a frame in the cycle of the commit: it still uses the old table."""
    for _ in range(2):
        before = bench.model.bank
        await bench.clock(write=(COMMIT.name, ALL, WHOLE), frame_start=1)
        assert bench.model.bank == before
        await bench.clock(frame_start=1)
        assert bench.model.bank == before ^ bench.model.present
        await bench.follow()


@on_bench(Bench)
async def resets(bench: Bench) -> None:
    """Reset: commits that no frame has taken are dropped, and the banks stay. A cold reset clears the banks."""
    present = bench.model.present
    for cold in (0, 1):
        await bench.clock(write=(COMMIT.name, ALL, WHOLE))
        await bench.clock(frame_start=1)
        await bench.follow()
        await bench.clock(write=(COMMIT.name, ALL, WHOLE))
        await bench.clock(rst=True, cold_rst=cold, frame_start=1)
        await bench.clock(frame_start=1)
        assert bench.model.bank == (0 if cold else present)
        assert await bench.clock(read_at=COMMIT.name) == (present if cold else 0)  # the tables have not followed
        await bench.follow()
        await bench.clock(write=(COMMIT.name, ALL, WHOLE))
        await bench.clock(frame_start=1)
        await bench.follow()


@on_bench(Bench)
@parametrize(table=list(CAPTURES))
async def captures(bench: Bench, table: str) -> None:
    """Capture: a start makes a request, the capture closes only its table, and its end commits it."""
    register, start, bit = CAPTURES[table], START[table], COMMIT.field(table).mask

    def capturing(**flags: int) -> dict[str, Any]:
        return {f"{table}_status": status(**flags)}

    has = bool(bench.model.present & bit)
    for word, strobe in ((start, WHOLE), (start, 0xD), (WORD & ~start, WHOLE), (WORD, WHOLE)):
        await bench.clock(write=(register.name, word, strobe))
    for busy in (0, 1):
        await bench.clock(read_at=register.name, **capturing(busy=busy))
    await bench.clock(write=(COMMIT.name, ALL, WHOLE), **capturing(busy=1))
    assert await bench.clock(read_at=COMMIT.name) == bench.model.present & ~bit
    await bench.clock(frame_start=1)
    await bench.follow()
    # A frame that starts with the end of the capture still uses the old table.
    for together in (0, 1):
        before = bench.model.bank
        await bench.clock(write=(register.name, start, WHOLE), frame_start=together, **capturing(busy=1, done=1))
        assert bench.model.bank == before
        assert await bench.clock(read_at=COMMIT.name) == bit * has
        await bench.clock(write=(register.name, start, WHOLE))
        await bench.clock(frame_start=1)
        await bench.clock(write=(register.name, start, WHOLE))
        assert bench.model.bank == before ^ bit * has
        await bench.follow()


@on_bench(Bench)
async def random_writes(bench: Bench) -> None:
    """Drive random commits, starts, frames, captures and resets."""
    await bench.random_clocks((COMMIT.name, COMMIT.name, *(register.name for register in CAPTURES.values())))


@on_bench(Bench)
async def other_offsets(bench: Bench) -> None:
    """Access offsets that differ in one bit from that of a register: they are not taken for it."""
    await bench.other_offsets((COMMIT.name, *(register.name for register in CAPTURES.values())))
