# SPDX-License-Identifier: Apache-2.0
"""td_axis_skid: RTL against the model."""

from collections.abc import Callable


def test_rtl(run_tb: Callable[..., None]) -> None:
    run_tb("td_axis_skid", {"Width": 26})
