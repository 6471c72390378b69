# SPDX-License-Identifier: Apache-2.0
"""table_banks against its model in every clock."""

from typing import Any

import cocotb

from formal.entries import Proof
from tactile_depth.chip.registers.table_banks import CAPTURES, COMMIT, TableBanks
from tb import structs
from tb.lockstep import Pins, play
from tb.registers.bus import NAME_AT, Bus, begin_low
from tb.structures import BOTH, ICARUS, of_parameters

built = of_parameters("Present")
STRUCTURES = (built(15, on=BOTH, mutants=ICARUS), built(2, on=ICARUS), built(4, on=ICARUS), built(9, on=ICARUS))
PROTOCOL = {"counts": "live"}
PROOFS = tuple(Proof("all tables, and a build without some", {"Present": present}) for present in (15, 8))


class Banks:
    """The model at the pins of the core."""

    def __init__(self, present: int) -> None:
        self.model = TableBanks(present)
        self.in_use = 0  # a cycle ago

    def clock(self, **pins: int) -> dict[str, int]:
        """Advance by one clock edge; return the outputs before it."""
        model, name, ones = self.model, NAME_AT.get(pins["write_offset"], ""), pins["write_ones"]
        status = {table: structs.unpack("capture_status_t", pins[f"{table}_status"]) for table in CAPTURES}
        busy, done = ([table for table in CAPTURES if status[table][flag]] for flag in ("busy", "done"))
        in_use, starts = self.in_use, bool(pins["frame_start"] and not pins["rst"])
        shown = {register.name: register.pack(busy=status[table]["busy"]) for table, register in CAPTURES.items()}
        shown[COMMIT.name] = model.pending(in_use)
        refused = model.refuses(name, ones, in_use, done)
        started = model.started(name, ones) if pins["write"] and not refused else None
        out = {
            "write_refused": refused,
            "read_data": shown.get(NAME_AT.get(pins["read_offset"], ""), 0),
            "table_bank": model.wanted(starts),
            "closed": model.closed(in_use, busy),
            **{f"{table}_request": table == started and not pins["rst"] for table in CAPTURES},
        }
        if pins["write"]:
            model.write(name, ones, in_use, busy)
        model.clock(starts, done)
        self.in_use = pins["table_in_use"]
        if pins["rst"]:
            model.reset()
        if pins["cold_rst"]:
            model.bank = 0
        return out


@cocotb.test
async def banks(dut: Any) -> None:
    bus = Bus(dut, COMMIT.name, *(register.name for register in CAPTURES.values()))
    status = [structs.pack("capture_status_t", {"busy": busy, "done": done}) for busy, done in ((0, 0), (1, 0), (1, 1))]
    pins = {
        **bus.choices,
        "frame_start": 1.0,
        "cold_rst": 0.1,
        "table_in_use": [0, 15, 1, 2, 4, 8],
        **{f"{table}_status": status for table in CAPTURES},
    }

    def legal(banks: Banks, pins: Pins) -> None:
        """Let what stands for the bank in use be where it differs from the next one."""
        bus.drive(pins)
        pins["table_in_use"] ^= banks.model.bank

    begin_low(dut)
    await play(dut, Banks(int(dut.Present.value)), pins, legal)
