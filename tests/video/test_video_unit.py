# SPDX-License-Identifier: Apache-2.0
"""video_unit: parameters that it refuses. Its testbench is that of the top."""

REFUSED = {
    "Rows=1": "Rows_and_Columns_must_be_at_least_2",
    "Columns=1": "Rows_and_Columns_must_be_at_least_2",
}
