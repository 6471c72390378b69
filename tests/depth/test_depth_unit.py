# SPDX-License-Identifier: Apache-2.0
"""depth_unit: parameters that it refuses. Its testbench is that of the top."""

REFUSED = {
    "ZeroOffset=2": "ZeroOffset_is_0_or_1",
    "FrameLatency=1": "FrameLatency_must_be_at_least_2",
    "ZeroOffset=1 BlockLog2=0": "BlockLog2_must_be_at_least_1",
    "Columns=12": "Columns_must_be_a_power_of_two_at_least_2",
}
