# SPDX-License-Identifier: Apache-2.0
"""contact_debounce against its model in every clock."""

from typing import Any

import cocotb

from formal.entries import Proof
from tactile_depth.chip.contact.contact_debounce import ContactDebounce
from tb.lockstep import CLOCKS, Pins, play
from tb.structures import ICARUS, VERILATOR, of_parameters

built = of_parameters("AreaWidth")
STRUCTURES = (built(15, on=VERILATOR), built(5, on=ICARUS, mutants=ICARUS), built(21))
PROTOCOL = {"begun": {"begins": "area_valid"}, "counts": "live & ~reset", "began ended": "counts & begun"}
PROOFS = (Proof("areas are only compared; every count of frames"),)

AGAINST = 0  # area that stands for one that speaks against the last result


@cocotb.test()
async def frames(dut: Any) -> None:
    largest = (1 << len(dut.area)) - 1
    choices = {
        "area_valid": 1.0,
        "area": [AGAINST, largest, *(1 << bit for bit in range(len(dut.area)))],
        "minimum_area": [1, 0, largest, *(1 << bit for bit in range(32))],
        "debounce": [255, 254, 0, 1, 2, 3, 5, 9, 17, 33, 65, 129],
    }

    def against(model: ContactDebounce, pins: Pins) -> None:
        if pins["area"] == AGAINST and not model.touching:
            pins["area"] = largest

    await play(dut, ContactDebounce(), choices, against, clocks=3 * CLOCKS)
