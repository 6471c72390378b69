# SPDX-License-Identifier: Apache-2.0
"""td_round_saturate against tactile_depth.chip.common.td_round_saturate: every input."""

from typing import Any

import cocotb
import numpy as np
from cocotb.triggers import Timer

from formal.entries import FULL_WIDTH, Proof
from tactile_depth.chip.common.td_round_saturate import Monitor, round_half_even, round_saturate
from tb.stream import parameters
from tb.structures import ICARUS, VERILATOR, of_parameters

built = of_parameters("InWidth Drop OutWidth")
STRUCTURES = (
    built(10, 4, 5, on=VERILATOR, mutants=ICARUS),
    built(8, 1, 6, on=ICARUS, mutants=ICARUS),  # only ties are dropped; overflow both ways
    built(8, 1, 7, on=ICARUS),  # only the carry out of the top overflows
    built(8, 1, 8, on=ICARUS),  # the carry fits
    built(8, 2, 5, on=ICARUS),
    built(8, 3, 4, on=ICARUS),
    built(8, 3, 10, on=ICARUS),  # wider than what is left
    built(8, 7, 2, on=ICARUS),
    built(8, 0, 8, on=ICARUS),
    built(8, 0, 5, on=ICARUS),
    built(8, -2, 10, on=ICARUS),
    built(8, -3, 9, on=ICARUS, mutants=ICARUS),
    built(8, -3, 14, on=ICARUS),
)
REFUSED = {"Drop_must_leave_a_bit_of_the_input": "Drop=46", "OutWidth_must_be_at_least_2": "OutWidth=1"}
PROOFS = tuple(
    Proof(FULL_WIDTH, {"InWidth": in_width, "Drop": drop, "OutWidth": out_width})
    for in_width, drop, out_width in ((48, 17, 27), (29, 1, 27), (28, 0, 27), (24, -3, 27), (27, -3, 24), (12, 9, 8))
)


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
