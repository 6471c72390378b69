# SPDX-License-Identifier: Apache-2.0
"""back_substitution: RTL against the model; the model is tested with the whole solver."""

from typing import Any

from formal.entries import ROUNDING, Proof
from formal.tables import thomas_roms
from tactile_depth.configuration import Configuration
from tactile_depth.poisson.tridiagonal_solver import solver_parameters
from tactile_depth.rom_files import write_thomas
from tb.structures import ICARUS, VERILATOR, Structure
from tests.rtl import test_rtl as test_rtl

NAMES = ("Width", "CoeffWidth", "Rows", "Columns", "TableWords", "SettledWidth")
CHOICES = {"columns": 16, "rows": 8, "solver": "tridiagonal"}
LANES = {"columns": 32, "rows": 11, "solver": "tridiagonal", "lanes": 4}
MOST = CHOICES | {"lanes": 4}  # z of the row below does not wait


def built(choices: Any, **runs: Any) -> Structure:
    config = Configuration(**choices)
    parameters = solver_parameters(config)
    return Structure(
        {name: parameters[name] for name in NAMES}
        | {"InWidth": config.data_width, "Drop": -parameters["StoreDrop"], "Lanes": config.lanes},
        device={"configuration": choices},
        roms=lambda folder: write_thomas(folder, config),
        **runs,
    )


STRUCTURES = (
    built(CHOICES, on=VERILATOR),
    built(LANES, on=VERILATOR),
    built(MOST, on=VERILATOR),
    built(CHOICES | {"neumann": True}, on=ICARUS),
    built(CHOICES | {"lanes": 2}, on=ICARUS, mutants=True),
    # Few bits are dropped: ties are common.
    built(CHOICES | {"data_width": 12, "coefficient_width": 10}, mutants=True),
    built(MOST | {"data_width": 12, "coefficient_width": 10}, mutants=True),
    # Fewer rows than lanes.
    built(LANES | {"rows": 8, "columns": 128, "lanes": 16, "neumann": True}),
    built(LANES | {"rows": 11, "columns": 128, "lanes": 32, "neumann": True}),
    built(CHOICES | {"rows": 21, "data_width": 32, "coefficient_width": 24}),
)
REFUSED = {
    "Lanes=3": "Lanes_must_be_a_power_of_two_and_at_most_Columns_by_4",
    "Lanes=64": "Lanes_must_be_a_power_of_two_and_at_most_Columns_by_4",
}
PROOFS = tuple(
    Proof(
        "the recursion up an arbitrary column, from lane to lane; latency 8",
        f"z that waits in the memory, and z that goes straight on; {ROUNDING}",
        {"Rows": 3, "Columns": size, "Words": 2 * size, "Lanes": lanes},
        depth=60,
        roms=thomas_roms(3, size, 2 * size, 3, 2, 1),
    )
    for lanes, size in ((1, 8), (2, 16), (2, 8))
)
