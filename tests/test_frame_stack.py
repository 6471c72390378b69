# SPDX-License-Identifier: Apache-2.0
"""frame_stack: RTL against the model."""

import pytest

SOURCES = ["burst_counter.sv", "ram.sv", "frame_stack.sv"]


@pytest.mark.structures("size width rows", both=[(16, 24, 8)], icarus=[(8, 16, 2), (8, 16, 3), (16, 16, 17), (4, 4, 3)])
def test_rtl(run_tb, size, width, rows):
    run_tb("frame_stack", SOURCES, {"Size": size, "Width": width, "Rows": rows})
