# SPDX-License-Identifier: Apache-2.0
"""Testbench of td_burst_counter with holes, for test_mutate.py: no pause, and no reset inside a burst."""

from typing import Any

import cocotb

from tb.common import tb_td_burst_counter


@cocotb.test()
async def positions_without_pause(dut: Any) -> None:
    await tb_td_burst_counter.check(dut, pause=0.0, before=0)
