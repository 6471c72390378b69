# SPDX-License-Identifier: Apache-2.0
"""table_access: RTL against the model."""

from collections.abc import Callable

from tb.structures import BOTH, ICARUS, VERILATOR, Structure

ALL = {"GradientWords": 8, "CoefficientWords": 36, "ReferenceWords": 5000, "ZeroWords": 1250}
SMALL = {"GradientWords": 0, "CoefficientWords": 6, "ReferenceWords": 0, "ZeroWords": 5}
STRUCTURES = (
    Structure(SMALL, on=BOTH, mutants=True),
    Structure(ALL, on=ICARUS, late=VERILATOR),
    Structure({"GradientWords": 4096}),
)
NO_PROOF = "every register and output of it is proven through the port: axil_registers"


def test_table_access(run_tb: Callable[..., None], structure: Structure) -> None:
    run_tb(structure)
