# SPDX-License-Identifier: Apache-2.0
"""depth_gate: RTL against the model."""

from collections.abc import Callable

from tb.structures import BOTH, Structure

STRUCTURES = (Structure({"Width": 12}, on=BOTH, mutants=True),)


def test_rtl(run_tb: Callable[..., None], structure: Structure) -> None:
    run_tb(structure)
