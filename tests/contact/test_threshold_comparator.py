# SPDX-License-Identifier: Apache-2.0
"""threshold_comparator: RTL against the model."""

from collections.abc import Callable

import pytest


@pytest.mark.structures(
    "width lanes", both=[(12, 1)], icarus=[(12, 4)], verilator=[(32, 1)], regress=[(32, 1), (24, 32), (32, 2)]
)
def test_rtl(run_tb: Callable[..., None], width: int, lanes: int) -> None:
    run_tb("threshold_comparator", {"Width": width, "Lanes": lanes})
