# SPDX-License-Identifier: Apache-2.0
"""axil_port against tactile_depth.chip.registers.axil_port, every output in every cycle."""

from __future__ import annotations

import random
from typing import Any

import cocotb
from cocotb.triggers import ClockCycles, RisingEdge

from formal.entries import FULL_WIDTH, Proof
from tactile_depth.chip.registers.axil_port import Response, offset_of, response, strobed_bits
from tactile_depth.chip.registers.register_map import ADDRESS_WIDTH
from tb.axil import CLIENT, present, read, take, write, write_beats
from tb.cases import on_bench
from tb.registers.axil_pins import INPUTS, PortChecker, expected, pins, reset
from tb.stream import REGRESS, parametrize
from tb.structures import BOTH, ICARUS, Structure

STRUCTURES = (Structure(on=BOTH, mutants=ICARUS),)
PROTOCOL = CLIENT | {"counts": "live"}
PROOFS = (
    Proof(
        FULL_WIDTH,
    ),
)


WORDS = ("read_data", "late_data")
FLAGS = ("write_refused", "read_refused", "read_late", "late_refused")
RANDOM_CLOCKS = 10_000 if REGRESS else 2_000
LAST = (1 << ADDRESS_WIDTH) - 4


class Checker(PortChecker):
    """Checker of axil_port.

    Attributes
    ----------
    writes : list of (offset, ones, mask)
        Writes that took effect.
    """

    inputs = (*INPUTS, *WORDS, *FLAGS)

    def __init__(self, dut: Any) -> None:
        super().__init__(dut)
        self.writes: list[tuple[int, int, int]] = []
        self.taken: dict[str, Any] = dict.fromkeys(("offset", "ones", "mask"))  # the latest; None before the first

    def step(self) -> None:
        """Compare the outputs of one cycle."""
        port = self.port
        offered, resets = pins(self.pin), bool(self.pin("rst"))
        for name, value in expected(port, resets).items():
            self.expect(name, value)
        write_now = port.write()
        self.expect("write", write_now is not None)
        self.expect("read", port.asked is not None)
        if port.asked is not None:
            self.expect("read_offset", port.asked)
        if None not in self.taken.values():
            self.expect("write_offset", self.taken["offset"])
            self.expect("write_ones", self.taken["ones"])
            self.expect("write_mask", self.taken["mask"])
        if write_now is not None:
            assert vars(write_now) == self.taken
            self.writes.append((write_now.offset, write_now.ones, write_now.mask))
        if offered.write_address is not None and port.address is None and not resets:
            self.taken["offset"] = offset_of(offered.write_address)
        if offered.write_data is not None and port.data is None and not resets:
            self.taken["mask"] = strobed_bits(offered.write_data[1])
            self.taken["ones"] = offered.write_data[0] & self.taken["mask"]
        if resets:
            port.reset()
            return
        flags = {name: bool(self.pin(name)) for name in FLAGS}
        answers = {name: self.pin(name) for name in WORDS}
        port.clock(
            offered,
            flags["write_refused"],
            (answers["read_data"], response(flags["read_refused"])),
            flags["read_late"],
            (answers["late_data"], response(flags["late_refused"])),
        )


def settle(dut: Any, rng: random.Random) -> None:
    """Drive the answers of the registers with random values."""
    for name in WORDS:
        getattr(dut, name).value = rng.getrandbits(32)
    for name in FLAGS:
        getattr(dut, name).value = rng.random() < 0.4


@on_bench(Checker)
async def bytes_of_a_write(checker: Checker, dut: Any) -> None:
    """Write with every strobe, at the first and the last register, and at addresses inside a register."""
    for strobe in range(16):
        for address in (0, LAST, LAST + strobe % 4, 4 << strobe % 8):
            assert await write(dut, address, 0x9ABC_DEF1, strobe) == Response.OKAY
            mask = sum(0xFF << 8 * byte for byte in range(4) if strobe >> byte & 1)
            assert checker.writes.pop() == (address & ~3, 0x9ABC_DEF1 & mask, mask)


@on_bench(Checker)
async def address_and_data_in_either_order(checker: Checker, dut: Any) -> None:
    """Send address and data in either order: neither is lost, and no response comes before both were taken."""
    address = {"channel": "aw", "awaddr": 0x18}
    for gap in range(4):
        for address_first in (True, False):
            word = 0x100 * gap + address_first
            data: dict[str, Any] = {"channel": "w", "wdata": word, "wstrb": 0xF}
            first, second = (address, data) if address_first else (data, address)
            await present(dut, **first)
            for _ in range(gap):
                assert not dut.s_axil_bvalid.value
                await RisingEdge(dut.clk)
            await present(dut, **second)
            assert await take(dut, "b") == Response.OKAY
            assert checker.writes.pop()[:2] == (0x18, word)


@on_bench(Checker)
@parametrize(ahead=["aw", "w"])
async def the_next_waits_for_this(checker: Checker, dut: Any, ahead: Any) -> None:
    """Offer an address or a word while the previous one waits for its other half: it is not taken."""
    writes = [(0x18, 0x1234), (0x60, 0xABCD_EF01)]
    addresses: list[dict[str, Any]] = [{"channel": "aw", "awaddr": address} for address, _ in writes]
    words: list[dict[str, Any]] = [{"channel": "w", "wdata": word, "wstrb": 0xF} for _, word in writes]
    first, second = (addresses, words) if ahead == "aw" else (words, addresses)
    await present(dut, **first[0])
    following = cocotb.start_soon(present(dut, **first[1]))
    await ClockCycles(dut.clk, 4)
    for half in second:
        await present(dut, **half)
        assert await take(dut, "b") == Response.OKAY
    await following
    assert [done[:2] for done in checker.writes] == writes


@on_bench(Checker)
async def responses_wait(checker: Checker, dut: Any) -> None:
    """Refuse responses: each stays unchanged until it is taken, and delays the next transaction of its kind only."""
    dut.write_refused.value = 1
    cocotb.start_soon(write_beats(dut, 0x18, 8))
    while not dut.s_axil_bvalid.value:
        await RisingEdge(dut.clk)
    dut.write_refused.value, dut.read_data.value = 0, 77
    second = cocotb.start_soon(write_beats(dut, 0x18, 9))
    assert await read(dut, 0x18) == (77, Response.OKAY)  # reads go on
    assert await take(dut, "b", stall=10) == Response.SLVERR
    await second
    assert await take(dut, "b", stall=3) == Response.OKAY

    await present(dut, "ar", araddr=0x18)
    await RisingEdge(dut.clk)
    following = cocotb.start_soon(present(dut, "ar", araddr=0))
    dut.read_data.value, dut.read_refused.value = 78, 1
    assert await write(dut, 0x18, 10) == Response.OKAY  # writes go on
    assert checker.pin("s_axil_rdata") == 77
    assert await take(dut, "r", stall=10) == Response.OKAY
    await following
    await ClockCycles(dut.clk, 2)
    assert checker.pin("s_axil_rdata") == 78
    assert await take(dut, "r", stall=3) == Response.SLVERR


@on_bench(Checker)
async def reset_inside_transactions(checker: Checker, dut: Any) -> None:
    """Reset at every point of a write and a read: nothing of the transaction remains."""
    for late in (0, 1):
        for clocks in range(8):
            dut.read_late.value = late
            dut.s_axil_bready.value = dut.s_axil_rready.value = clocks & 1
            tasks = [
                cocotb.start_soon(present(dut, "aw", awaddr=0x18)),
                cocotb.start_soon(present(dut, "ar", araddr=0x18)),
            ]
            if clocks % 3:
                tasks.append(cocotb.start_soon(present(dut, "w", wdata=0x66, wstrb=0xF)))
            await ClockCycles(dut.clk, clocks)
            for task in tasks:
                task.cancel()
            for name in ("awvalid", "wvalid", "arvalid", "bready", "rready"):
                getattr(dut, f"s_axil_{name}").value = 0
            await reset(dut)
            await RisingEdge(dut.clk)
            for name in ("awready", "wready", "arready"):
                assert checker.pin(f"s_axil_{name}"), f"{name} is low after reset"
            assert checker.pin("s_axil_bvalid") == checker.pin("s_axil_rvalid") == 0
            checker.writes.clear()
            assert await write(dut, 0x20, 0x77) == Response.OKAY
            assert [done[:2] for done in checker.writes] == [(0x20, 0x77)]


@on_bench(Checker)
async def offered_in_reset(checker: Checker, dut: Any) -> None:
    """Offer accesses in a reset and keep them up: none is taken before its end, then each is answered once."""
    dut.rst.value = 1
    tasks = [
        cocotb.start_soon(write_beats(dut, 0x18, 0x55)),
        cocotb.start_soon(present(dut, "ar", araddr=0x18)),
    ]
    for _ in range(3):
        await RisingEdge(dut.clk)
        assert not any(checker.pin(f"s_axil_{channel}ready") for channel in ("aw", "w", "ar"))
    dut.rst.value = 0
    assert await take(dut, "b") == await take(dut, "r") == Response.OKAY
    for task in tasks:
        await task
    assert [done[:2] for done in checker.writes] == [(0x18, 0x55)]
    await ClockCycles(dut.clk, 4)
    assert checker.pin("s_axil_bvalid") == checker.pin("s_axil_rvalid") == 0


@on_bench(Checker)
@parametrize(pressure=[0.0, 0.6])
async def random_traffic(checker: Checker, dut: Any, pressure: float) -> None:
    """Drive random beats, answers and resets; ready of the responses is low with probability `pressure`."""
    rng = random.Random(cocotb.RANDOM_SEED)
    valid = {channel: getattr(dut, f"s_axil_{channel}valid") for channel in ("aw", "w", "ar")}
    for _ in range(RANDOM_CLOCKS):
        settle(dut, rng)
        for channel, wire in valid.items():
            if not wire.value or checker.pin(f"s_axil_{channel}ready") or dut.rst.value:
                wire.value = rng.random() < 0.6
                for name in {"aw": ("awaddr",), "w": ("wdata", "wstrb"), "ar": ("araddr",)}[channel]:
                    handle = getattr(dut, f"s_axil_{name}")
                    handle.value = rng.getrandbits(len(handle))
        dut.rst.value = rng.random() < 0.01
        dut.s_axil_bready.value, dut.s_axil_rready.value = (rng.random() >= pressure for _ in range(2))
        await RisingEdge(dut.clk)
    dut.rst.value = 0
    assert len(checker.writes) > RANDOM_CLOCKS // 20
