# SPDX-License-Identifier: Apache-2.0
"""threshold_comparator: RTL against the model."""

import pytest


@pytest.mark.parametrize("width", [12, 32])
def test_rtl(run_tb, width):
    run_tb("threshold_comparator", ["threshold_comparator.sv"], {"Width": width})
