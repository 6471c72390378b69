# SPDX-License-Identifier: Apache-2.0
"""table_access against its model in every clock."""

from typing import Any

import cocotb

from tactile_depth.chip.registers.register_map import TABLES
from tactile_depth.chip.registers.table_access import HIGH, INDEX, LOW, PORTS, SIZE, TableAccess
from tb import structs
from tb.lockstep import WORD, Pins, play
from tb.registers.bus import NAME_AT, Bus
from tb.structures import BOTH, ICARUS, Structure

ALL = {"GradientWords": 8, "CoefficientWords": 36, "ReferenceWords": 5000, "ZeroWords": 1250}
SMALL = {"GradientWords": 0, "CoefficientWords": 6, "ReferenceWords": 0, "ZeroWords": 5}
STRUCTURES = (Structure(SMALL, on=BOTH, mutants=ICARUS), Structure(ALL, on=ICARUS), Structure({"GradientWords": 4096}))
NO_PROOF = "every register and output of it is proven through the port: axil_registers"


PARAMETERS = {"gradient": "GradientWords", "coefficients": "CoefficientWords"}
PARAMETERS |= {"reference": "ReferenceWords", "zero": "ZeroWords"}


class Access:
    """The model at the pins of the core.

    Attributes
    ----------
    asked : str
        Port to a table that was read in the clock before: this clock has an access.
    accessed, select : bool, int
        Whether the clock before had an access or a reset; its table.
    low, had_entry : bool
        Whether the late word is the lower one, and whether there was an entry; None before the first.
    """

    def __init__(self, sizes: dict[int, int]) -> None:
        self.model, self.asked, self.low = TableAccess(sizes), "", False
        self.had_entry: bool | None = None
        self.accessed, self.select = True, 0

    def clock(self, **pins: int) -> dict[str, int | None]:
        """Advance by one clock edge; return the outputs before it, None where one does not count."""
        model, select, ones, mask = self.model, pins["select"], pins["write_ones"], pins["write_mask"]
        name, at = NAME_AT.get(pins["write_offset"], ""), NAME_AT.get(pins["read_offset"], "")
        refused = model.refuses(name, mask, select, pins["closed"])
        writes = bool(pins["write"]) and not refused
        reads = bool(self.asked) and model.has_entry(select)
        command = {
            "write": writes and name == LOW and not pins["rst"],
            "read": reads and not pins["rst"],
            "select": select,
        }
        command |= {"index": model.values[INDEX], "high": model.values[HIGH], "low": ones}
        shown = {INDEX: model.values[INDEX], SIZE: model.sizes[select]}
        out: dict[str, int | None] = {
            "write_refused": refused if pins["write"] else None,
            "read_data": shown.get(at, 0),
            "read_late": at in PORTS,
            "table_command": structs.pack("table_command_t", command),
        }
        if self.had_entry is not None:
            answer = structs.unpack("table_answer_t", pins["table_answer"])["low" if self.low else "high"]
            out |= {"late_refused": not self.had_entry, "late_data": answer if self.had_entry else 0}
        if self.asked:
            self.had_entry = model.read(self.asked, select) is not None
        if writes:
            model.write(name, ones, mask, select)
        self.accessed, self.select = bool(self.asked or pins["write"] or pins["rst"]), select
        self.asked = at if pins["read"] and at in PORTS else ""
        self.low = at == LOW if pins["read"] else self.low
        if pins["rst"]:
            model.reset()
            self.asked, self.had_entry = "", None
        return out


@cocotb.test
async def accesses(dut: Any) -> None:
    sizes = {code: int(getattr(dut, PARAMETERS[name]).value) for name, code in TABLES.items()}
    bus = Bus(dut, INDEX, HIGH, LOW, LOW, SIZE)
    pins = {
        **bus.choices,
        "read": 1.0,
        "select": list(TABLES.values()),
        "closed": [0, *range(16)],
        "table_answer": WORD,
    }

    def legal(access: Access, pins: Pins) -> None:
        """Access nothing in the clock before an access, and no other table."""
        bus.drive(pins)
        pins["write"] &= not (access.asked or access.accessed)
        pins["read"] &= not (access.asked or pins["write"])
        if access.asked or pins["write"]:
            pins["select"] = access.select

    await play(dut, Access(sizes), pins, legal)
