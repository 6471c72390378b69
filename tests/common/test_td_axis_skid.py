# SPDX-License-Identifier: Apache-2.0
"""td_axis_skid: RTL against the model."""

from collections.abc import Callable

from tb.structures import BOTH, Structure

STRUCTURES = (Structure({"Width": 26}, on=BOTH, mutants=True),)


def test_rtl(run_tb: Callable[..., None], structure: Structure) -> None:
    run_tb(structure)
