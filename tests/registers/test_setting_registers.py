# SPDX-License-Identifier: Apache-2.0
"""setting_registers: RTL against the model."""

from collections.abc import Callable


def test_setting_registers(run_tb: Callable[..., None]) -> None:
    run_tb("setting_registers")
