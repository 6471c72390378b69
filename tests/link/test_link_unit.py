# SPDX-License-Identifier: Apache-2.0
"""link_unit: RTL against the model of the device."""

from tb.structures import ICARUS, VERILATOR, of_parameters
from tests.rtl import test_rtl as test_rtl

built = of_parameters("Rows Columns DataWidth Lanes BottomFirst")
STRUCTURES = (
    built(6, 16, 24, 1, 1, on=ICARUS),
    built(5, 32, 15, 4, 0, on=VERILATOR),
    built(32, 16, 18, 2, 1),
)
