# SPDX-License-Identifier: Apache-2.0
"""uart_receive: RTL against the model."""

from collections.abc import Callable
from typing import Any

import pytest

from commands.common.repository import ROOT


@pytest.mark.structures("divider", verilator=[(4,)], icarus=[(4,)], regress=[(33,)], regress_verilator=[(33,)])
def test_rtl(run_tb: Callable[..., None], divider: Any) -> None:
    run_tb("uart_receive", {"Divider": divider}, files=[ROOT / "boards" / "ulx3s" / "uart_receive.sv"])
