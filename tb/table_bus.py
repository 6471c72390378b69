# SPDX-License-Identifier: Apache-2.0
"""Bus of the tables at a core with a td_table_port, as table_access drives it; other tables are accessed meanwhile."""

from collections.abc import Sequence
from typing import Any

import cocotb

from tactile_depth.chip.common.td_banked_table import BankedTable
from tactile_depth.chip.common.td_node_map import NodeMap
from tactile_depth.chip.common.td_table_port import INDEX_BITS, WORD_BITS
from tb import structs
from tb.lockstep import Pins


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
