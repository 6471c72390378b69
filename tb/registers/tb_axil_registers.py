# SPDX-License-Identifier: Apache-2.0
"""axil_registers against tactile_depth.chip.registers.axil_registers, every output in every cycle.

The cores inside have their own testbenches. The tests here check that together they implement the register map.
"""

from __future__ import annotations

import random
from typing import Any

import cocotb
from cocotb.triggers import ClockCycles, RisingEdge, gather

from formal.entries import FULL_WIDTH, Proof
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.registers.axil_port import BYTES, Response, strobed_bits
from tactile_depth.chip.registers.axil_registers import GAINS, RECORD, Build
from tactile_depth.chip.registers.event_registers import COUNTERS, EVENT_COUNTERS, EVENTS, INTERRUPT_STATUS, STATUS
from tactile_depth.chip.registers.register_map import ADDRESS_WIDTH, MAP, REGISTERS, TABLES, WORD
from tactile_depth.chip.registers.setting_registers import SETTINGS
from tactile_depth.chip.registers.table_access import PORTS
from tactile_depth.chip.registers.table_banks import CAPTURES, COMMIT
from tactile_depth.chip.tactile_depth import config_value, default_parameters, top_parameters
from tb import structs
from tb.axil import CLIENT, OFFSET, master_of, read, response_of, take, value_of, write_beats
from tb.axil import write as write_at
from tb.cases import on_bench
from tb.registers.axil_pins import reset
from tb.registers.register_file import (
    CONTROL,
    Checker,
    entry,
    everything_happens,
    levels,
    pulse,
    write,
)
from tb.stream import REGRESS, parametrize
from tb.structures import BOTH, ICARUS, VERILATOR, Mutants, Structure


def fields_of(**choices: Any) -> dict[str, int]:
    """Return the fields of a configuration."""
    return top_parameters(Configuration(**choices), 0.0634)


EXTREMES = default_parameters() | {
    "Tridiagonal": 1,
    "Neumann": 1,
    "Rows": 65535,
    "Columns": 1,
    "DataWidth": 32,
    "GradientWidth": 32,
    "GradientFraction": 31,
    "BitsPerChannel": 1,
    "FlatField": 1,
    "Polynomial": 0,
    "LightGains": 1,
    "ZeroOffset": 1,
    "Lanes": 32,
    "BlockLog2": 0,
    "GainWidth": 32,
    "DepthMantissa": (1 << 24) - 1,
    "DepthExponent": -128,
    "SlopeMantissa": 1 << 23,
    "SlopeExponent": 127,
    "PitchNm": (1 << 31) - 1,
}
QUADRATIC = fields_of(columns=128, rows=96, solver="tridiagonal", flat_field=True, gradient_model="quadratic")


def built(name: str, fields: dict[str, int], **runs: Any) -> Structure:
    return Structure({"Config": config_value(fields)}, name=name, **runs)


STRUCTURES = (
    built("128", fields_of(columns=128), on=VERILATOR),
    built("extremes", EXTREMES, on=ICARUS, mutants=BOTH),
    built(
        "quadratic",
        QUADRATIC,
    ),
)
PROTOCOL = CLIENT | {"counts": "live"}
MUTANTS = Mutants(flat=False)
PROOFS = tuple(
    Proof(
        f"{FULL_WIDTH}; each gradient model, with a camera or without, all options",
        {"Polynomial": polynomial, "Corrections": corrections, "Camera": camera},
    )
    for polynomial, corrections, camera in ((0, 0, 0), (1, 0, 1), (1, 1, 0))
)


RANDOM_CLOCKS = 10_000 if REGRESS else 2_000
SATURATION_BITS = structs.members("events_t")["saturations"][1]  # of the count of values clipped in a cycle
# The ends of the map, all of its offsets, and the words between them.
ADDRESSES = tuple(range(0, max(OFFSET.values()) + 8, BYTES)) + tuple(range(256, 1 << ADDRESS_WIDTH, 64))


def tables_present(build: Build) -> int:
    """Return the bits in TABLE_COMMIT of the tables in this build."""
    return build.present


@on_bench(Checker)
async def reset_values(checker: Checker, dut: Any) -> None:
    """Read every register after a reset: fields have the value of the map or of the build, other bits read 0."""
    for register in MAP:
        data = (await read(dut, register.offset))[0]
        assert data & ~register.mask() == 0, f"{register.name} has bits that are not listed"
        for field in register.fields:
            if field.reset is not None:
                got = register.unpack(data)[field.name]
                assert got == field.reset, f"{register.name}.{field.name} is {got:#x} after reset"
    assert (await value_of(dut, "ID")).to_bytes(4, "big") == b"TDEP"
    build = checker.build
    for name, word in (build.description | {"PITCH": build.parameters["PitchNm"]}).items():
        assert await value_of(dut, name) == word, name


@on_bench(Checker)
@parametrize(register=[name for name in REGISTERS if name not in PORTS])
async def access(checker: Checker, dut: Any, register: Any) -> None:
    """Write and read every register: each field has the access of the map. The ports to the tables have other tests."""
    register, build = REGISTERS[register], checker.build
    refused = {  # bits of a word that is refused, by register
        capture.name: capture.field("start").mask
        for table, capture in CAPTURES.items()
        if not build.table_sizes[TABLES[table]]
    }
    held = register.mask("rw")
    if register.name == "TABLE_INDEX":
        held = (1 << checker.model.access.index_width) - 1
    if register.name in GAINS and not build.parameters["LightGains"]:
        held = 0
    await everything_happens(dut)
    before = await value_of(dut, register.name)
    if not register.writable:
        for word in (0, WORD):
            assert await write(dut, register.name, word) == Response.SLVERR
        assert await value_of(dut, register.name) == before
        return
    rng = random.Random(cocotb.RANDOM_SEED)
    words = [(WORD, 0), (WORD, 0xF), (0, 0xF), (WORD, 0xF)]
    for word, strobe in [*words, *((rng.getrandbits(32), strobe) for strobe in range(1 << BYTES))]:
        old = await value_of(dut, register.name)
        strobed = strobed_bits(strobe)
        if word & strobed & refused.get(register.name, 0):
            assert await write(dut, register.name, word, strobe) == Response.SLVERR
            assert await value_of(dut, register.name) == old
            continue
        assert await write(dut, register.name, word, strobe) == Response.OKAY
        left = {
            "ro": old & register.mask("ro"),
            "rw": (word & strobed | old & ~strobed) & held,
            "w1c": old & ~(word & strobed) & register.mask("w1c"),
            "w1s": (old | word & strobed & tables_present(build)) & register.mask("w1s"),
            "pulse": 0,
        }
        got = await value_of(dut, register.name)
        assert got == sum(left.values()), f"{register.name} is {got:#x} after {word:#x} strobed {strobe:04b}"
        if register.mask("w1c"):
            await everything_happens(dut)
            assert await value_of(dut, register.name) == register.mask("w1c")


@on_bench(Checker)
async def outputs(checker: Checker, dut: Any) -> None:
    """Write registers with a second bus master: the outputs to the pipeline and the words read back are right."""
    master = master_of(dut)
    await master.write(OFFSET["THRESHOLD"], -5 & WORD)
    await master.write(OFFSET["OFF_THRESHOLD"], -6 & WORD)
    settings = structs.unpack("contact_settings_t", int(dut.contact_settings.value))
    assert (settings["threshold"], settings["off_threshold"]) == (-5 & WORD, -6 & WORD)
    await master.write(OFFSET["TIMEOUT"], 0x4433_2211)
    assert int(await master.read(OFFSET["TIMEOUT"])) == int(dut.timeout.value) == 0x4433_2211


@on_bench(Checker)
async def unaligned_byte_access(checker: Checker, dut: Any) -> None:
    """Write and read single bytes of a register at their addresses, as a processor does."""
    for byte in range(BYTES):
        address = OFFSET["TIMEOUT"] + byte
        assert await write_at(dut, address, (0x11 * (byte + 1)) << 8 * byte, 1 << byte) == Response.OKAY
    for byte in range(BYTES):
        assert await read(dut, OFFSET["TIMEOUT"] + byte) == (0x4433_2211, Response.OKAY)


@on_bench(Checker)
async def errors_change_nothing(checker: Checker, dut: Any) -> None:
    """Access unmapped offsets and write ro registers: the response is SLVERR, and nothing changes."""
    master = master_of(dut)
    for offset in ADDRESSES:
        register = next((r for r in MAP if r.offset == offset), None)
        before = dict(checker.model.values)
        if register is None or not register.writable:
            response = await response_of(master.write(offset, WORD))
            assert response == Response.SLVERR, f"a write to {offset:#x} was accepted"
        if not checker.model.is_port(offset):
            response = await response_of(master.read(offset))
            assert response == (Response.OKAY if register else Response.SLVERR), f"a read of {offset:#x}"
        assert checker.model.values == before


async def choose(dut: Any, table: int, index: int) -> None:
    """Set TABLE_SELECT and TABLE_INDEX."""
    await write(dut, "TABLE_SELECT", table)
    await write(dut, "TABLE_INDEX", index)


@on_bench(Checker)
@parametrize(table=list(TABLES.values()))
async def table_entries(checker: Checker, dut: Any, table: Any) -> None:
    """Write and read entries in turn, with the first after the last."""
    size, writes = checker.build.table_sizes[table], checker.model.table_writes
    await choose(dut, table, max(0, size - 2))
    assert await value_of(dut, "TABLE_SIZE") == size
    if not size:
        assert await write(dut, "TABLE_LOW", 5) == Response.SLVERR
        for name in PORTS:
            assert await read(dut, OFFSET[name]) == (0, Response.SLVERR)
        assert not writes
        return
    for n, (high, low) in enumerate([(0x8000_0000, WORD), (0x7FFF_FFFF, 0), (0, 0x8000_0000), (1, 2)]):
        index = (size - 2 + n) % size
        await write(dut, "TABLE_HIGH", high)
        assert await write(dut, "TABLE_LOW", low) == Response.OKAY
        assert writes[-1] == (table, index, high, low)
    await choose(dut, table, size - 2)
    for n in range(4):
        index = (size - 2 + n) % size
        assert await value_of(dut, "TABLE_INDEX") == index
        assert await value_of(dut, "TABLE_HIGH") == entry(table, index)[0]
        assert await value_of(dut, "TABLE_LOW") == entry(table, index)[1]
    assert await write(dut, "TABLE_LOW", 5, strobe=7) == Response.SLVERR

    # Taken in the cycle before a reset, so that it would go out in the first cycle of the reset.
    writing = cocotb.start_soon(write(dut, "TABLE_LOW", 9))
    while checker.port.write() is None:
        await RisingEdge(dut.clk)
    dut.rst.value = 1
    await RisingEdge(dut.clk)
    writing.cancel()


@on_bench(Checker)
async def a_write_beside_a_read_of_a_table(checker: Checker, dut: Any) -> None:
    """Write in each cycle of a read of a table: the write waits for its end, and the entry is the old or the new
    one."""
    table = min(table for table, size in checker.build.table_sizes.items() if size)
    for lead in range(-3, 8):
        await choose(dut, table, 1)
        await write(dut, "TABLE_HIGH", 77)

        async def writes(lead: Any = lead) -> None:
            await ClockCycles(dut.clk, max(0, lead) + 1)
            assert await write(dut, "TABLE_LOW", 8) == Response.OKAY

        writing = cocotb.start_soon(writes())
        await ClockCycles(dut.clk, max(0, -lead) + 1)
        data, response = await read(dut, OFFSET["TABLE_LOW"])
        assert response == Response.OKAY
        assert data in (entry(table, 1)[1], entry(table, 2)[1])
        await writing
        assert await value_of(dut, "TABLE_INDEX") == 3
        assert checker.model.table_writes[-1][1] in (1, 2)


@on_bench(Checker)
@parametrize(lag=[0, 7])
async def commits(checker: Checker, dut: Any, lag: int) -> None:
    """Commit: the change-over comes with the next frame start, is pending until the table follows, and closes that
    table."""
    has = tables_present(checker.build)
    for tables in range(1, 1 << len(TABLES)):
        bank = int(dut.table_bank.value)
        await write(dut, COMMIT.name, tables)
        assert await value_of(dut, COMMIT.name) == tables & has
        for table, size in checker.build.table_sizes.items():
            await choose(dut, table, 0)
            refused = not size or tables >> table & 1
            assert await write(dut, "TABLE_LOW", 1) == (Response.SLVERR if refused else Response.OKAY)
        await pulse(dut, frame_start=1)
        assert int(dut.table_bank.value) == bank ^ tables & has
        await ClockCycles(dut.clk, lag + 1)
        assert await value_of(dut, COMMIT.name) == 0

    # Frame starts around the cycle in which the write takes effect: those after it change over.
    for clocks, late in ((0, False), (1, False), (2, True), (3, True)):
        bank = int(dut.table_bank.value)
        writing = cocotb.start_soon(write(dut, COMMIT.name, has))
        await ClockCycles(dut.clk, clocks)
        await pulse(dut, frame_start=1)
        assert int(dut.table_bank.value) ^ bank == late * has, f"a frame {clocks} cycles after the write was offered"
        await writing
        await pulse(dut, frame_start=1)
        assert int(dut.table_bank.value) ^ bank == has
        await ClockCycles(dut.clk, lag + 2)


@on_bench(Checker)
async def resets_and_banks(checker: Checker, dut: Any) -> None:
    """Reset: commits that no frame has taken are dropped, and the banks stay. A cold reset clears the banks."""
    has = tables_present(checker.build)
    for cold in (1, 0, 1):
        bank = int(dut.table_bank.value)
        await write(dut, COMMIT.name, has)
        await reset(dut)
        assert await value_of(dut, COMMIT.name) == 0
        await pulse(dut, frame_start=1)
        assert int(dut.table_bank.value) == bank
        await write(dut, COMMIT.name, has)
        await pulse(dut, frame_start=1)
        dut.cold_rst.value = cold
        await reset(dut)
        dut.cold_rst.value = 0
        assert int(dut.table_bank.value) == (0 if cold else bank ^ has)
        assert await value_of(dut, COMMIT.name) == 0


@on_bench(Checker)
@parametrize(name=list(CAPTURES))
async def capture(checker: Checker, dut: Any, name: str) -> None:
    """Start a capture: the start goes out once, the table is closed while the capture is busy, and its end commits the
    table."""
    model, table, register = checker.model, TABLES[name], CAPTURES[name]
    bit, status = 1 << table, getattr(dut, f"{name}_status")
    start = register.pack(start=1, log2_frames=5)
    if not checker.build.table_sizes[table]:
        assert await write(dut, register.name, start) == Response.SLVERR
        assert await value_of(dut, register.name) == 0
        assert await write(dut, register.name, start, strobe=0b1101) == Response.OKAY
        assert await value_of(dut, register.name) == register.pack(log2_frames=5)
        assert not model.captures
        return
    assert await write(dut, register.name, start) == Response.OKAY
    assert await write(dut, register.name, WORD & ~register.field("start").mask) == Response.OKAY
    assert model.captures == [name]
    status.value = structs.pack("capture_status_t", {"busy": 1})
    assert await value_of(dut, register.name) == register.pack(log2_frames=15, busy=1)
    for other, size in checker.build.table_sizes.items():
        await choose(dut, other, 0)
        refused = other == table or not size
        assert await write(dut, "TABLE_LOW", 1) == (Response.SLVERR if refused else Response.OKAY)
    bank = int(dut.table_bank.value)
    await pulse(dut, **{f"{name}_status": structs.pack("capture_status_t", {"busy": 1, "done": 1})})
    assert await value_of(dut, COMMIT.name) == bit
    later = Response.SLVERR if name == "zero" else Response.OKAY  # its change-over follows the solver
    assert await write(dut, register.name, start) == later
    await pulse(dut, frame_start=1)
    await ClockCycles(dut.clk, 2)
    assert int(dut.table_bank.value) == bank ^ bit
    assert await write(dut, register.name, start) == Response.OKAY


@on_bench(Checker)
@parametrize(register=["STATUS", "CONTROL", "INTERRUPT_STATUS"])
async def setting_wins_over_clearing(checker: Checker, dut: Any, register: str) -> None:
    """Raise events one cycle before, in, and one cycle after the cycle in which a write clears their bits."""
    counted = dict.fromkeys(COUNTERS, 1) | {"SATURATIONS": 9}
    # A write takes effect one cycle after its address and data were taken, an event one cycle after it came.
    for lag, survives in ((-1, False), (0, True), (1, True)):
        await write(dut, "CONTROL", CONTROL.pack(clear_counters=1))
        await pulse(dut, *EVENTS, saturations=9, settle=0)
        if lag < 0:
            await pulse(dut, *EVENTS, saturations=9, settle=0)
        beats = cocotb.start_soon(write_beats(dut, OFFSET[register], WORD))
        for _ in range(lag):
            await RisingEdge(dut.clk)
        if lag >= 0:
            await pulse(dut, *EVENTS, saturations=9, settle=0)
        await beats
        assert await take(dut, "b") == Response.OKAY
        if register == "CONTROL":
            for name, count in counted.items():
                assert await value_of(dut, name) == survives * count, f"{name}, events in cycle {lag}"
        else:
            bits = REGISTERS[register].mask("w1c")
            assert await value_of(dut, register) == survives * bits, f"events in clock {lag}"
            await write(dut, register, WORD)


@on_bench(Checker)
@parametrize(event=["record_valid", "row_long"])
async def interrupts(checker: Checker, dut: Any, event: str) -> None:
    """Check irq: high while the bit of an event is set and not masked, low after a 1 is written to the bit."""
    await write(dut, "INTERRUPT_MASK", WORD)
    await pulse(dut, event, settle=3)
    assert dut.irq.value
    bit = await value_of(dut, "INTERRUPT_STATUS")
    await write(dut, "INTERRUPT_MASK", WORD & ~bit)
    assert not dut.irq.value, "masked"
    await write(dut, "INTERRUPT_MASK", bit)
    await write(dut, "INTERRUPT_STATUS", INTERRUPT_STATUS.mask() & ~bit)
    assert dut.irq.value
    await write(dut, "INTERRUPT_STATUS", bit)
    assert not dut.irq.value


@on_bench(Checker)
async def each_address_reads_its_own(checker: Checker, dut: Any) -> None:
    """Give every register its own bits, so that a wrong register, or two at once, would be seen at any address."""
    rng = random.Random(cocotb.RANDOM_SEED)
    for _ in range(2):
        for name in (*SETTINGS, "TABLE_INDEX", "TABLE_HIGH"):
            await write(dut, name, rng.getrandbits(32) & ~CONTROL.pack(clear_counters=1) & ~(1 << 8))
        await pulse(dut, first_depth_latency=rng.getrandbits(32), first_depth_latency_valid=1)
        for event in (*EVENT_COUNTERS, "record_valid"):
            for _ in range(rng.randrange(9)):
                await pulse(dut, event, saturations=rng.getrandbits(SATURATION_BITS), settle=0)
        dut.levels.value = rng.getrandbits(3)
        dut.record.value = rng.getrandbits(32 * len(RECORD))
        for table in CAPTURES:
            getattr(dut, f"{table}_status").value = structs.pack("capture_status_t", {"busy": rng.getrandbits(1)})
        await write(dut, COMMIT.name, WORD)  # from here on the tables that are not being captured are pending
        for address in ADDRESSES:
            await read(dut, address)  # the checker compares it
        for table in CAPTURES:
            getattr(dut, f"{table}_status").value = 0


@on_bench(Checker)
async def what_shows_as_it_is(checker: Checker, dut: Any) -> None:
    """Read each word of the record and each level at its address, with the value of that cycle."""
    rng = random.Random(cocotb.RANDOM_SEED)
    for _ in range(2):
        words = [rng.getrandbits(32) for _ in RECORD]
        dut.record.value = sum(word << 32 * n for n, word in enumerate(words))
        assert [await value_of(dut, name) for name in RECORD] == words
    for level in ("busy", "contact", "touching"):
        dut.levels.value = levels(**{level: 1})
        assert await value_of(dut, "STATUS") == STATUS.pack(**{level: 1})


@on_bench(Checker, lag=5)
@parametrize(pressure=[0.0, 0.6])
async def random_traffic(checker: Checker, dut: Any, pressure: float) -> None:
    """Drive random reads, writes and events; ready of the responses is low with probability `pressure`."""
    rng = random.Random(cocotb.RANDOM_SEED)
    master = master_of(dut)
    done = False
    since_start = 0
    writable = [register.offset for register in MAP if register.writable] + 24 * [OFFSET["TABLE_LOW"]]
    unmapped = [address for address in ADDRESSES if address not in OFFSET.values()]
    tables = [table for table, size in checker.build.table_sizes.items() if size]

    if tables:
        await choose(dut, rng.choice(tables), 0)  # the table of number 0 may not be there

    def any_offset() -> int:
        return rng.choice(rng.choice((writable, tuple(OFFSET.values()))) if rng.random() < 0.9 else unmapped)

    def any_data(offset: int) -> int:
        if offset == OFFSET["TABLE_SELECT"] and rng.random() < 0.7:
            return rng.choice(tables)  # tables of other numbers take no entries
        if offset == OFFSET["TABLE_INDEX"] and rng.random() < 0.7:
            return rng.getrandbits(3)
        return rng.choice((rng.getrandbits(32), 1 << rng.randrange(32), rng.getrandbits(4), WORD))

    async def writes() -> None:
        while not done:
            offset = any_offset()
            await response_of(
                master.write(
                    offset,
                    any_data(offset),
                    byte_enable=rng.choice((None, rng.getrandbits(BYTES))),
                    address_latency=rng.choice((0, 0, 1, 3)),
                    data_latency=rng.choice((0, 0, 1, 3)),
                    sync=rng.random() < 0.5,
                )
            )

    async def reads() -> None:
        while not done:
            await response_of(master.read(any_offset()))
            for _ in range(rng.choice((0, 0, 1, 5))):
                await RisingEdge(dut.clk)

    traffic = [cocotb.start_soon(writes()), cocotb.start_soon(reads())]
    for _ in range(RANDOM_CLOCKS):
        members: dict[str, int] = {event: int(rng.random() < 0.05) for event in EVENTS}
        members["saturations"] = rng.getrandbits(SATURATION_BITS) if rng.random() < 0.05 else 0
        dut.events.value = structs.pack("events_t", members)
        dut.first_depth_latency.value = rng.getrandbits(32)
        dut.first_depth_latency_valid.value = rng.random() < 0.05
        since_start = 0 if since_start > 10 and rng.random() < 0.1 else since_start + 1
        dut.frame_start.value = since_start == 0
        busy = {table: rng.random() < 0.5 for table in CAPTURES} if rng.random() < 0.1 else None
        for table in CAPTURES if busy else ():
            assert busy is not None
            flags = {"busy": int(busy[table]), "done": int(rng.random() < 0.2)}
            getattr(dut, f"{table}_status").value = structs.pack("capture_status_t", flags)
        if rng.random() < 0.1:
            dut.levels.value, dut.record.value = rng.getrandbits(3), rng.getrandbits(32 * len(RECORD))
        dut.s_axil_awprot.value, dut.s_axil_arprot.value = rng.getrandbits(3), rng.getrandbits(3)
        dut.s_axil_bready.value = rng.random() >= pressure
        dut.s_axil_rready.value = rng.random() >= pressure
        await RisingEdge(dut.clk)
    done = True
    dut.s_axil_bready.value = dut.s_axil_rready.value = 1
    await gather(*traffic)
    for kind, responses in checker.responses.items():
        counts = {response: responses.count(response) for response in Response}
        dut._log.info("%s: %s, %d table writes", kind, counts, len(checker.model.table_writes))
        assert min(counts.values()) > 10, f"the test is void: the {kind}s were not varied enough: {counts}"
    assert len(checker.model.table_writes) > 5
