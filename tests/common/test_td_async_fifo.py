# SPDX-License-Identifier: Apache-2.0
"""td_async_fifo: RTL against the model."""

from tb.structures import BOTH, ICARUS, of_parameters
from tests.rtl import test_rtl as test_rtl

built = of_parameters("Width DepthLog2")
STRUCTURES = (
    built(10, 4, on=BOTH),
    built(3, 2, on=ICARUS, mutants=True),
)
REFUSED = {
    "DepthLog2=1": "DepthLog2_must_be_at_least_2",
}
