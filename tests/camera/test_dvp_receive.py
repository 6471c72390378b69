# SPDX-License-Identifier: Apache-2.0
"""dvp_receive: RTL against the model."""

from tb.structures import BOTH, ICARUS, of_parameters
from tests.rtl import test_rtl as test_rtl

built = of_parameters("FifoLog2")
STRUCTURES = (
    built(4, on=BOTH),
    built(3, on=ICARUS, mutants=True),
)
REFUSED = {
    "FifoLog2=2": "FifoLog2_must_be_at_least_3_or_nearly_equal_clocks_lose_every_frame",
}
