# SPDX-License-Identifier: Apache-2.0
"""column_mean: RTL against the model."""

from typing import Any

from formal.entries import ROUNDING, Proof
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.poisson.tridiagonal_solver import solver_parameters
from tb.structures import ICARUS, VERILATOR, Structure
from tests.rtl import test_rtl as test_rtl

CHOICES = {"columns": 16, "rows": 8, "solver": "tridiagonal", "neumann": True}
NAMES = ("Width", "CoeffWidth", "Rows", "MomentDrop", "MeanReciprocal", "MeanDrop")


def built(choices: Any, **runs: Any) -> Structure:
    parameters = solver_parameters(Configuration(**choices))
    return Structure({name: parameters[name] for name in NAMES}, device={"configuration": choices}, **runs)


STRUCTURES = (
    built(CHOICES, on=VERILATOR),
    built(CHOICES | {"rows": 9}, on=ICARUS),
    # Few bits are dropped: ties are common.
    built(CHOICES | {"rows": 21, "data_width": 12, "coefficient_width": 10}, on=ICARUS, mutants=True),
)
REFUSED = {"Rows=1": "Rows_must_be_at_least_2"}
PROOFS = (
    Proof(
        "minus the mean of a column, 6 clocks behind its row before the last; a frame begins afresh",
        f"rows are only counted; {ROUNDING}",
        {"Rows": 4},
        depth=40,
    ),
)
