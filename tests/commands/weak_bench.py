# SPDX-License-Identifier: Apache-2.0
"""Testbench of td_burst_counter with holes, for test_mutate.py: no pause, and no reset inside a burst."""

from typing import Any

import cocotb

from tactile_depth.chip.common.td_burst_counter import BurstCounter
from tb.lockstep import play
from tb.stream import parameters


@cocotb.test()
async def positions_without_pause(dut: Any) -> None:
    await play(dut, BurstCounter(*parameters(dut, "Words")), {"rst": 0.0, "en": [1], "start": 0.3})
