# SPDX-License-Identifier: Apache-2.0
"""axil_port: RTL against the model."""

from collections.abc import Callable

from tb.structures import BOTH, Mutants, Structure

STRUCTURES = (Structure(on=BOTH, mutants=True),)
MUTANTS = Mutants(protocol="axil_registers")


def test_rtl(run_tb: Callable[..., None], structure: Structure) -> None:
    run_tb(structure)
