# SPDX-License-Identifier: Apache-2.0
"""event_registers: RTL against the model."""

from collections.abc import Callable


def test_event_registers(run_tb: Callable[..., None]) -> None:
    run_tb("event_registers")
