# SPDX-License-Identifier: Apache-2.0
"""table_banks: RTL against the model."""

from collections.abc import Callable

from formal.entries import Proof
from tb.structures import BOTH, ICARUS, Structure, of_parameters

built = of_parameters("Present")
STRUCTURES = (
    built(15, on=BOTH, mutants=True),
    built(2, on=ICARUS),
    built(4, on=ICARUS),
    built(9, on=ICARUS),
)
PROOFS = tuple(
    Proof(
        "the bank of an arbitrary table changes with a frame alone, after a commit or a capture; closed until then",
        "all tables, and a build without some",
        {"Present": present},
    )
    for present in (15, 8)
)


def test_table_banks(run_tb: Callable[..., None], structure: Structure) -> None:
    run_tb(structure)
