# SPDX-License-Identifier: Apache-2.0
"""hdl/registers/axil_port.sv against models/tactile_depth/registers/axil_port.py."""

from collections.abc import Callable


def test_axil_port(run_tb: Callable[..., None]) -> None:
    run_tb("axil_port")
