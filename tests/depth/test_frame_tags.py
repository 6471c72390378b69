# SPDX-License-Identifier: Apache-2.0
"""frame_tags: RTL against the model."""

from collections.abc import Callable
from typing import Any

import pytest


# Two frames in flight, one, exactly two, four; the first again, for mutants.
@pytest.mark.structures(
    "width latency pixels",
    verilator=[(33, 37, 24)],
    icarus=[(4, 9, 16)],
    regress=[(33, 32, 16), (33, 50, 13), (4, 9, 6), (33, 37, 24)],
)
def test_rtl(run_tb: Callable[..., None], width: int, latency: Any, pixels: int) -> None:
    run_tb("frame_tags", {"Width": width, "Latency": latency, "Pixels": pixels})
