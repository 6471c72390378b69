# SPDX-License-Identifier: Apache-2.0
"""wide_substitution: RTL against the model; the model is tested with the whole solver."""

from typing import Any

from formal.entries import ROUNDING, Proof
from formal.tables import wide_up_roms
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.poisson.wide_solver import solver_parameters
from tactile_depth.chip.rom_files import write_wide_thomas
from tb.structures import ICARUS, VERILATOR, Mutants, Structure
from tests.rtl import test_rtl as test_rtl

CHOICES = {"columns": 16, "rows": 8, "solver": "tridiagonal", "lanes": 4}


def built(choices: Any, **runs: Any) -> Structure:
    config = Configuration(**choices)
    parameters = solver_parameters(config)
    return Structure(
        {name: parameters[name] for name in ("Width", "CoeffWidth", "Rows", "Columns")}
        | {"InWidth": config.data_width, "Drop": -parameters["StoreDrop"], "Words": config.lanes}
        | {"TableWords": parameters["UpTableWords"], "SettledWidth": parameters["UpSettledWidth"]},
        device={"configuration": choices},
        roms=lambda folder: write_wide_thomas(folder, config),
        **runs,
    )


STRUCTURES = (
    built(CHOICES | {"rows": 9}, on=VERILATOR),
    built(CHOICES | {"lanes": 8, "neumann": True}, on=ICARUS),  # z goes straight into the next product
    built(CHOICES | {"rows": 11, "lanes": 2}, on=ICARUS),
    # Few bits are dropped: ties are common.
    built(CHOICES | {"data_width": 12, "coefficient_width": 10}, mutants=True, on=ICARUS),
    built(CHOICES | {"rows": 9, "data_width": 12, "coefficient_width": 10, "lanes": 8}, mutants=True),
    built(CHOICES | {"rows": 21, "data_width": 32, "coefficient_width": 24}),
    built(CHOICES | {"columns": 64, "lanes": 32}),
)
RULE = "Words_and_Columns_must_be_powers_of_two_and_Words_2_to_half_of_Columns"
REFUSED = {"Words=1": RULE, "Words=3": RULE, "Words=128": RULE, "Columns=96": RULE, "Rows=2": "Rows_must_be_at_least_3"}
MUTANTS = Mutants("wide_pairs")
PROOFS = tuple(
    Proof(
        "the recursion up an arbitrary column, in both rows of a pair, and the clips; latency 2",
        "z that goes straight into the next product, and z that waits; an even and an odd number of rows; three pairs, "
        f"so that a product follows a product; each of two words; {ROUNDING}",
        {"Rows": rows, "Columns": columns, "Words": 2, "Word": word, "TableWords": 16},
        depth=60,
        roms=wide_up_roms(rows, columns // 2),
    )
    for rows, columns, word in ((5, 4, 0), (4, 4, 1), (5, 8, 1))
)
