# SPDX-License-Identifier: Apache-2.0
"""td_round_saturate against tactile_depth.chip.common.td_round_saturate: every input."""

from typing import Any

import cocotb
import numpy as np
from cocotb.triggers import Timer

from tactile_depth.chip.common.td_round_saturate import Monitor, round_half_even, round_saturate
from tb.stream import parameters


@cocotb.test()
async def every_input(dut: Any) -> None:
    in_width, drop, out_width = parameters(dut, "InWidth", "Drop", "OutWidth")
    x = np.arange(-(1 << (in_width - 1)), 1 << (in_width - 1))
    rounded, flags = [], []
    for value in x.tolist():
        getattr(dut, "in").value = value
        await Timer(1, "ns")
        rounded.append(dut.out.value.to_signed())
        flags.append(int(dut.clipped.value))
    monitor = Monitor()
    expected = round_saturate(x, drop, out_width, monitor, "node")
    np.testing.assert_array_equal(rounded, expected)
    np.testing.assert_array_equal(flags, expected != round_half_even(x, drop))
    assert sum(flags) == monitor.saturations["node"]
