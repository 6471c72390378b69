# SPDX-License-Identifier: Apache-2.0
"""hdl/registers/setting_registers.sv against models/tactile_depth/registers/setting_registers.py."""

from collections.abc import Callable


def test_setting_registers(run_tb: Callable[..., None]) -> None:
    run_tb("setting_registers")
