# SPDX-License-Identifier: Apache-2.0
"""Steps of the flow for a Nexus, `make fpga TARGET=nexus LANES=2 ..`: the Poisson solver by itself.

poisson_unit, in boards/nexus/nexus_solver.sv, is placed and routed on the largest Nexus that nextpnr knows, for the
clock that other pages assume. Products for which it has no multiplier are built of LUTs.
"""

import math
from typing import Any

from commands.common import repository
from commands.cost.cost import ECP5, cost
from tactile_depth.chip.configuration import Configuration

DEVICE = "LIFCL-40-9BG400C"  # 9 is the fastest grade
MULTIPLIERS = 56  # of 18 x 18 bits, as those of an ECP5; nextpnr says MULT18_CORE
TOP = "nexus_solver"
ROUTER = ("--router", "router1")  # the default finds no way from the clock's pin to its buffer (nextpnr's issue 1317)


def products_in_luts(config: Configuration) -> int:
    """Return the number of products of the solver for which the device has no multiplier."""
    cores = repository.cores()
    products = [each for each in cost(config).multipliers if cores[each.core].block.startswith("poisson")]
    parts = [ECP5.multipliers(each.a, each.b) for each in products]
    return max(0, math.ceil((sum(parts) - MULTIPLIERS) / min(parts)))


def steps(config: Configuration) -> list[str]:
    """Return the lines of Yosys from a design to its netlist."""
    number = products_in_luts(config)
    booth = ["flatten", "opt_clean", f"booth t:$mul %R{number}"] if number else []  # %R takes so many, at random
    return [*booth, f"synth_nexus -top {TOP}"]


def without_low_carries(module: dict[str, Any]) -> None:
    """Leave the carry inputs open that Yosys ties to 0, as nextpnr asks for (Yosys' issue 4081)."""
    cells = module["cells"].values()
    low = [cell["connections"]["Z"] for cell in cells if cell["type"] == "VLO"]
    for cell in cells:
        if cell["type"] == "CCU2" and cell["connections"].get("CIN") in low:
            del cell["connections"]["CIN"]
