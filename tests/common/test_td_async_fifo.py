# SPDX-License-Identifier: Apache-2.0
"""td_async_fifo: RTL against the model."""

from collections.abc import Callable

import pytest


@pytest.mark.structures("width depth_log2", both=[(10, 4)], icarus=[(3, 2)])
def test_rtl(run_tb: Callable[..., None], width: int, depth_log2: int) -> None:
    run_tb("td_async_fifo", {"Width": width, "DepthLog2": depth_log2})
