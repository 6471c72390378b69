# SPDX-License-Identifier: Apache-2.0
"""dvp_receive: RTL against the model."""

from collections.abc import Callable

import pytest


@pytest.mark.structures("fifo_log2", both=[(4,)], icarus=[(3,)])
def test_rtl(run_tb: Callable[..., None], fifo_log2: int) -> None:
    run_tb("dvp_receive", {"FifoLog2": fifo_log2})
