# SPDX-License-Identifier: Apache-2.0
"""threshold_comparator: RTL against the model."""

from collections.abc import Callable

import pytest


@pytest.mark.parametrize("width", [12, 32])
def test_rtl(run_tb: Callable[..., None], width: int) -> None:
    run_tb("threshold_comparator", ["threshold_comparator.sv"], {"Width": width})
