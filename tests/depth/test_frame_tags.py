# SPDX-License-Identifier: Apache-2.0
"""frame_tags: RTL against the model."""

from tb.structures import ICARUS, VERILATOR, of_parameters
from tests.rtl import test_rtl as test_rtl

# Two frames in flight, one, exactly two, four; the first again, for mutants.
built = of_parameters("Width Latency Pixels")
STRUCTURES = (
    built(33, 37, 24, on=VERILATOR),
    built(4, 9, 16, on=ICARUS),
    built(33, 32, 16),
    built(33, 50, 13),
    built(4, 9, 6, mutants=True),
)
