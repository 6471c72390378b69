# SPDX-License-Identifier: Apache-2.0
"""Bus of the tables at a core with a td_table_port, as table_access drives it; other tables are accessed meanwhile."""

import random
from collections.abc import Mapping, Sequence
from typing import Any

import cocotb
from cocotb.triggers import RisingEdge

from tactile_depth.chip.common.td_banked_table import BankedTable
from tactile_depth.chip.common.td_node_map import NodeMap
from tactile_depth.chip.common.td_table_port import INDEX_BITS, WORD_BITS, answered
from tb import pins, structs
from tb.lockstep import Pins

READ_CLOCKS = 3  # cycles from a read on the bus to the entry


def signed(word: int, width: int) -> int:
    """Return the lower `width` bits of a word, signed."""
    word &= (1 << width) - 1
    return word - (word >> width - 1 << width)


def at_power_up(words: Sequence[int]) -> Sequence[int | None]:
    """Return the words of a memory behind the first edge: pins of Verilator are random at first, and may write one."""
    return [None if cocotb.SIM_NAME == "Verilator" else word for word in words]


def choices(select: int) -> dict[str, Any]:
    """Return the choices for a bus on which the table `select` is named more often than the others; see `pack`."""
    words = dict.fromkeys(("table_high", "table_low"), range(1 << WORD_BITS))
    members = {"table_write": 1.0, "table_read": 1.0, "table_select": (select, *range(4))}
    return {"table_command": (0,), **members, "table_index": range(1 << INDEX_BITS), **words}


def pack(pins: Pins) -> None:
    """Put the members of the bus into its pin."""
    names = [name for name in pins if name.startswith("table_") and name not in ("table_command", "table_bank")]
    members = {name.removeprefix("table_"): pins.pop(name) for name in names}
    pins["table_command"] = structs.pack("table_command_t", members)


def change_over(table: BankedTable, pins: Pins, writes: bool) -> None:
    """Let table_bank change with `commit`, if no change-over is due and nothing is written now."""
    pins["table_bank"] = table.wanted ^ (pins.pop("commit") and table.settled(table.wanted) and not writes)


def node_map_pins(nodes: int, select: int) -> dict[str, Any]:
    """Return the choices for the pins of tables of so many nodes, but for the words of the capture and the data."""
    bits = ("en", "in_valid", "in_frame_start", "capture_write", "capture_read")
    pins = choices(select) | dict.fromkeys(bits, 1.0) | {"rst": 0.001, "table_bank": (0,), "commit": 0.3}
    return pins | dict.fromkeys(("capture_write_node", "capture_read_node"), range(nodes))


def legal_nodes(model: NodeMap, pins: Pins) -> None:
    """Send whole frames; write nothing that arrives in a change-over, and no entry that is read."""
    table, port, at = model.table, model.port, model.port.index // model.step
    if pins["in_valid"]:
        pins["in_frame_start"] = model.place == 0
    change_over(table, pins, bool(port.write or pins["capture_write"]))
    settled = table.settled(pins["table_bank"])
    pins["capture_write"] &= settled and not pins["rst"] and not (port.read and at == pins["capture_write_node"])
    written = pins["capture_write_node"] if pins["capture_write"] else at if port.write else None
    pins["capture_read"] &= pins["capture_read_node"] != written
    pins["table_write"] &= settled
    pins["table_read"] &= not pins["table_write"]
    pins["table_index"] %= len(table.banks[0]) * model.step
    pack(pins)


class TableBus:
    """Pins table_command and table_answer of `dut`, for the table `select` with entries of `words` words."""

    def __init__(self, dut: Any, select: int, width: int, words: int = 1, signed: bool = False) -> None:
        self.dut, self.select, self.width, self.words, self.signed = dut, select, width, words, signed
        self.chance = random.Random(cocotb.RANDOM_SEED)
        self.command: Mapping[str, int] | None = None  # in the cycle before this one
        self.read_command, self.reset = pins.unsigned(dut.table_command), pins.unsigned(dut.rst)
        self.idle()
        cocotb.start_soon(self._watch())

    def _drive(self, members: Mapping[str, int]) -> None:
        self.dut.table_command.value = structs.pack("table_command_t", members)

    def idle(self) -> None:
        """Access another table from this cycle on."""
        other = self.select ^ self.chance.randrange(1, 4)
        members = {"write": self.chance.getrandbits(1), "read": self.chance.getrandbits(1), "select": other}
        self._drive(members | {"index": 0, "high": self.chance.getrandbits(32), "low": self.chance.getrandbits(32)})

    def hold(self, index: int = 0) -> None:
        """Name the table without an access from this cycle on."""
        self._drive({"select": self.select, "index": index, "low": self.chance.getrandbits(32)})

    async def write(self, index: int, *words: int) -> None:
        """Write an entry, lower word first, in one cycle; bits above a word's width are random."""
        above = self.chance.getrandbits(32) << self.width
        low, high = ((int(word) & (1 << self.width) - 1 | above) & (1 << WORD_BITS) - 1 for word in (*words, 0)[:2])
        self._drive({"write": 1, "select": self.select, "index": int(index), "low": low, "high": high})
        await RisingEdge(self.dut.clk)
        self.idle()

    async def ask(self, index: int, then: int = 0) -> None:
        """Begin to read an entry, and name the index `then` while its answer is awaited."""
        self._drive({"read": 1, "select": self.select, "index": index})
        await RisingEdge(self.dut.clk)
        self.hold(then)

    def check(self, index: int, *words: int) -> None:
        """Compare the answer with the words of an entry, lower word first."""
        entry = sum((int(word) & (1 << self.width) - 1) << place * self.width for place, word in enumerate(words))
        got = pins.unsigned(self.dut.table_answer)()
        want = answered(entry, self.width, self.words, self.signed)
        assert got == want, f"entry {index} reads {got:#x}, not {want:#x}"

    def step(self) -> Mapping[str, int] | None:
        """Return the access that reaches the table in the cycle that a clock edge ends, None if there is none.

        To be called at each edge."""
        before = self.command
        command = structs.unpack("table_command_t", self.read_command())
        own = command["select"] == self.select and (command["write"] or command["read"])
        self.command = command if own and not self.reset() else None
        return before

    async def _watch(self) -> None:
        """Check that the table answers 0 while the bus names another."""
        named, answer, edge = self.select, pins.unsigned(self.dut.table_answer), RisingEdge(self.dut.clk)
        while True:
            await edge
            if named != self.select:
                assert answer() == 0, "an answer of a table that is not named"
            named = structs.unpack("table_command_t", self.read_command())["select"]
