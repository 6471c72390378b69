# SPDX-License-Identifier: Apache-2.0
"""hdl/registers/event_registers.sv against models/tactile_depth/registers/event_registers.py."""

from collections.abc import Callable


def test_event_registers(run_tb: Callable[..., None]) -> None:
    run_tb("event_registers")
