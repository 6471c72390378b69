# SPDX-License-Identifier: Apache-2.0
"""thomas_table against its model at every position of every row."""

from typing import Any

import cocotb
import numpy as np

from formal.entries import Proof
from formal.tables import thomas_roms
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.poisson.thomas_table import LATENCY, thomas_table
from tactile_depth.chip.poisson.tridiagonal_solver import solver_parameters
from tactile_depth.chip.rom_files import write_thomas
from tb.stream import configuration, drive, of_configuration, parametrize
from tb.structures import ICARUS, VERILATOR

CHOICES = {"columns": 16, "rows": 8, "solver": "tridiagonal"}


def table_parameters(config: Configuration) -> Any:
    parameters = solver_parameters(config)
    table = {"Words": parameters["DownTableWords"], "SettledWidth": parameters["DownSettledWidth"]}
    return table | {name: parameters[name] for name in ("CoeffWidth", "Rows", "Columns", "LastShiftWidth")}


built = of_configuration(table_parameters, write_thomas)


STRUCTURES = (
    built(CHOICES | {"neumann": True}, on=VERILATOR, mutants=ICARUS),
    built(CHOICES, on=ICARUS),
    built(CHOICES | {"columns": 32, "rows": 50, "neumann": True}),
)
PROTOCOL = {"holds": "32'(row) < Rows", "settled": {"Clocks": 5}, "counts": "settled"}
PROOFS = (
    Proof(
        "every row and position of a table with all its cases; contents do not matter",
        {"Rows": 6, "Columns": 4, "Words": 14},
        roms=thomas_roms(6, 4, 14, 5, 3, 2),
    ),
)


@cocotb.test
@parametrize(pause=[0.0, 0.3])
async def every_entry(dut: Any, pause: float) -> None:
    config = configuration()
    table = thomas_table(config)
    places = [(row, position) for row in range(config.rows) for position in range(config.columns)]
    stimuli = [{"row": row, "position": position} for row, position in places]
    stimuli += LATENCY * stimuli[-1:]
    pins = await drive(dut, stimuli, ["coefficient", "shift"], pause)
    coefficients = np.vstack((table.rows(config.rows - 1), table.last)).ravel()
    shifts = np.vstack((np.zeros((config.rows - 1, config.columns), np.int64), table.last_shift)).ravel()
    np.testing.assert_array_equal([v.to_signed() for v in pins["coefficient"][LATENCY:]], coefficients)
    np.testing.assert_array_equal([int(v) for v in pins["shift"][LATENCY:]], shifts)
