# SPDX-License-Identifier: Apache-2.0
"""axil_port: RTL against the model."""

from collections.abc import Callable


def test_axil_port(run_tb: Callable[..., None]) -> None:
    run_tb("axil_port")
