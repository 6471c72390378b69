# SPDX-License-Identifier: Apache-2.0
"""table_access against tactile_depth.chip.registers.table_access, every output in every cycle."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from tactile_depth.chip.registers.register_map import TABLES, WORD
from tactile_depth.chip.registers.table_access import HIGH, INDEX, LOW, PORTS, SIZE, TableAccess
from tb import structs
from tb.cases import on_bench
from tb.registers.register_bench import WHOLE, RegisterBench
from tb.structures import BOTH, ICARUS, Structure

ALL = {"GradientWords": 8, "CoefficientWords": 36, "ReferenceWords": 5000, "ZeroWords": 1250}
SMALL = {"GradientWords": 0, "CoefficientWords": 6, "ReferenceWords": 0, "ZeroWords": 5}
STRUCTURES = (
    Structure(SMALL, on=BOTH, mutants=ICARUS),
    Structure(
        ALL,
        on=ICARUS,
    ),
    Structure({"GradientWords": 4096}),
)
NO_PROOF = "every register and output of it is proven through the port: axil_registers"


PARAMETERS = {"gradient": "GradientWords", "coefficients": "CoefficientWords"}
PARAMETERS |= {"reference": "ReferenceWords", "zero": "ZeroWords"}


class Bench(RegisterBench):
    """Bench of table_access.

    Attributes
    ----------
    written : list of (table, index, high, low)
    """

    idle: Mapping[str, int] = dict.fromkeys(("read", "select", "closed", "table_answer"), 0)

    def __init__(self, dut: Any) -> None:
        super().__init__(dut)
        sizes = {code: int(getattr(dut, PARAMETERS[name]).value) for name, code in TABLES.items()}
        self.model = TableAccess(sizes)
        self.table_command = structs.reader(dut.table_command, "table_command_t")
        self.written: list[tuple[int, int, int, int]] = []
        self.asked = ""  # the register that was read in the previous cycle
        self.had_entry: bool | None = None  # word of the register that was read last
        self.asked_low = False

    def word(self, name: str) -> int:
        sizes = self.model.sizes[self.inputs["select"]] if name == SIZE else 0
        return self.model.values.get(name, 0) * (name == INDEX) | sizes

    def refuses(self, name: str, ones: int, mask: int) -> bool:
        return self.model.refuses(name, mask, self.inputs["select"], self.inputs["closed"])

    def outputs(self) -> dict[str, int]:
        select, model = self.inputs["select"], self.model
        has_entry = model.has_entry(select)
        writes = self.allowed is not None and self.allowed[0] == LOW
        command = {"write": int(writes), "read": int(bool(self.asked) and has_entry and not self.rst)}
        command |= {"select": select, "index": model.values[INDEX], "high": model.values[HIGH]}
        outputs = {"read_late": int(self.read_name in PORTS)}
        got = self.table_command()
        low = got.pop("low")
        assert got == command, f"clock {self.clocks}: table_command is {got}, expected {command}"
        assert low == self.ones
        if self.had_entry is not None:
            answer = structs.unpack("table_answer_t", self.inputs["table_answer"])
            late = answer["low" if self.asked_low else "high"] if self.had_entry else 0
            outputs |= {"late_data": late, "late_refused": int(not self.had_entry)}
        return outputs

    def step(self, write: tuple[str, int, int] | None) -> None:
        select = self.inputs["select"]
        if self.asked:
            self.had_entry = self.model.read(self.asked, select) is not None
        if self.inputs["read"]:
            self.asked_low = self.read_name == LOW
        entry = self.model.write(*write, select) if write else None
        self.written += [entry] if entry else []
        self.asked = self.read_name if self.inputs["read"] and self.read_name in PORTS else ""

    def reset(self) -> None:
        self.model.reset()
        self.asked, self.had_entry = "", None

    async def choose(self, table: int, index: int) -> None:
        """Set the index; the inputs select the table from then on."""
        self.idle = {**self.idle, "select": table}
        await self.clock(write=(INDEX, index, WHOLE))

    async def ask(self, name: str) -> None:
        """Read TABLE_HIGH or TABLE_LOW, with an answer that changes in every cycle."""
        await self.clock(read_at=name, read=1)
        for _ in range(4):
            await self.clock(table_answer=self.random.getrandbits(64))

    def random_inputs(self) -> dict[str, Any]:
        rng = self.random
        return {
            "read": int(rng.random() < 0.5 and not self.asked),
            "select": rng.choice(tuple(TABLES.values())),
            "closed": rng.getrandbits(4) & rng.getrandbits(4),
            "table_answer": rng.getrandbits(64),
        }

    async def clock(self, write: Any = None, *arguments: Any, **inputs: Any) -> int:
        """Run a cycle; the bus has no write in the cycle after a read of a table."""
        return await super().clock(None if self.asked else write, *arguments, **inputs)


def built(bench: Bench) -> dict[int, int]:
    """Return the tables that the build has, with their sizes."""
    return {table: size for table, size in bench.model.sizes.items() if size}


@on_bench(Bench)
async def entries_in_turn(bench: Bench) -> None:
    """Access entries in turn: TABLE_LOW increments the index, from the last entry to the first; TABLE_HIGH does not."""
    for table, size in built(bench).items():
        assert await bench.clock(read_at=SIZE, select=table) == size
        first = max(0, size - 2)
        await bench.choose(table, first)
        words = [(0x8000_0000, WORD), (0x7FFF_FFFF, 0), (0, 0x8000_0000), (1, 2), (WORD, WORD)]
        bench.written.clear()
        for high, low in words:
            await bench.clock(write=(HIGH, high, WHOLE))
            await bench.clock(write=(LOW, low, WHOLE))
        assert bench.written == [(table, (first + n) % size, *pair) for n, pair in enumerate(words)]
        await bench.choose(table, first)
        for n in range(5):
            assert await bench.clock(read_at=INDEX) == (first + n) % size
            await bench.ask(HIGH)
            await bench.ask(LOW)


@on_bench(Bench)
async def neighbours_of_the_last_entry(bench: Bench) -> None:
    """Access the entries around the last one: the index returns to 0 after the last entry only."""
    for table, size in built(bench).items():
        for bit in range(size.bit_length()):
            index = (size - 1) ^ 1 << bit
            if index < size:
                await bench.choose(table, index)
                await bench.clock(write=(LOW, 5, WHOLE))
                assert await bench.clock(read_at=INDEX) == index + 1
                await bench.choose(table, index)
                await bench.ask(LOW)
                assert await bench.clock(read_at=INDEX) == index + 1


@on_bench(Bench)
async def refused(bench: Bench) -> None:
    """Refuse writes outside of the table, of some bytes only, or to a closed table, and reads outside of the table."""
    for table, size in bench.model.sizes.items():
        await bench.choose(table, 0)
        for strobe in range(16):
            await bench.clock(write=(LOW, 5, strobe))
        for closed in range(16):
            await bench.choose(table, 0)
            await bench.clock(write=(LOW, 5, WHOLE), closed=closed)
        if size < 1 << bench.model.index_width:
            await bench.choose(table, size)
            bench.written.clear()
            await bench.clock(write=(LOW, 5, WHOLE))
            assert not bench.written
            for name in PORTS:
                await bench.ask(name)
            assert await bench.clock(read_at=INDEX) == size


@on_bench(Bench)
async def every_bit_of_index_and_upper_word(bench: Bench) -> None:
    """Write single bits and bytes: a write sets the bits of its strobed bytes, and no other bit."""
    for name in (INDEX, HIGH):
        for strobe in range(16):
            for word in (0, WORD, 0x5AA5_C33C):
                await bench.clock(write=(name, ~word & WORD, WHOLE))
                await bench.clock(write=(name, word, strobe))
                await bench.clock(read_at=name)
        for bit in range(32):
            await bench.clock(write=(name, 1 << bit, WHOLE))
            await bench.clock(read_at=name)


@on_bench(Bench)
async def a_reset_in_a_read(bench: Bench) -> None:
    """Reset one cycle after a read began: the table is not read in the reset."""
    table = next(iter(built(bench)))
    await bench.choose(table, 1)
    for name in PORTS:
        await bench.clock(read_at=name, read=1)
        await bench.clock(rst=True)
        await bench.clock()
        await bench.clock(read_at=name, read=1, rst=True)
        await bench.clock()
        await bench.choose(table, 1)


@on_bench(Bench)
async def random_accesses(bench: Bench) -> None:
    """Drive random writes, reads, tables and resets."""
    await bench.random_clocks((INDEX, HIGH, LOW, LOW, SIZE))


@on_bench(Bench)
async def other_offsets(bench: Bench) -> None:
    """Access offsets that differ in one bit from that of a register: they are not taken for it."""
    await bench.other_offsets((INDEX, HIGH, LOW, SIZE))
