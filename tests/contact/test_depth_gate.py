# SPDX-License-Identifier: Apache-2.0
"""depth_gate: RTL against the model."""

from collections.abc import Callable


def test_rtl(run_tb: Callable[..., None]) -> None:
    run_tb("depth_gate", {"Width": 12})
