# SPDX-License-Identifier: Apache-2.0
"""uart_receive: RTL against the model."""

from collections.abc import Callable

from commands.common.repository import ROOT
from tb.structures import BOTH, Structure

STRUCTURES = (Structure({"Divider": 4}, on=BOTH), Structure({"Divider": 33}, late=BOTH))


def test_rtl(run_tb: Callable[..., None], structure: Structure) -> None:
    run_tb(structure, files=[ROOT / "boards" / "ulx3s" / "uart_receive.sv"])
