# SPDX-License-Identifier: Apache-2.0
"""axis_skid: RTL against the model."""


def test_rtl(run_tb):
    run_tb("axis_skid", ["axis_skid.sv"], {"Width": 26})
