# SPDX-License-Identifier: Apache-2.0
"""frame_tags: RTL against the model."""


def test_rtl(run_tb):
    run_tb("frame_tags", ["frame_tags.sv"], {"Width": 33})
