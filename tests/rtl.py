# SPDX-License-Identifier: Apache-2.0
"""The test that every core has: its testbench on each of the STRUCTURES of the file that imports it."""

from collections.abc import Callable

from tb.structures import Structure


def test_rtl(run_tb: Callable[..., None], structure: Structure) -> None:
    run_tb(structure)
