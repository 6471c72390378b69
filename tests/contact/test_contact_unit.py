# SPDX-License-Identifier: Apache-2.0
"""contact_unit: parameters that it refuses. Its testbench is that of the top."""

REFUSED = {
    "DataWidth=33": "Width_must_be_2_to_32",
    "Rows=1025": "Rows_must_be_2_to_1024",
    "Columns=1025": "Columns_must_be_2_to_1024",
    "Lanes=128": "Lanes_must_be_a_power_of_two_up_to_64_that_divides_Columns",
    "Rows=4 Columns=4": "a_frame_must_take_at_least_Latency_cycles",
}
