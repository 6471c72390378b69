# SPDX-License-Identifier: Apache-2.0
"""Test of the wiring of parity in cores of cores."""

from typing import Any

import cocotb

from tb.stream import drive


@cocotb.test
async def no_flips(dut: Any) -> None:
    """Without parity no bit counts as flipped."""
    pins = await drive(dut, [{"en": 1}] * 4, ["flipped"])
    assert not any(map(int, pins["flipped"]))
