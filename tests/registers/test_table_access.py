# SPDX-License-Identifier: Apache-2.0
"""table_access: RTL against the model."""

from collections.abc import Callable
from typing import Any

import pytest

ALL = {"GradientWords": 8, "CoefficientWords": 36, "ReferenceWords": 5000, "ZeroWords": 1250}
SMALL = {"GradientWords": 0, "CoefficientWords": 6, "ReferenceWords": 0, "ZeroWords": 5}
WORDS = {"all": ALL, "small": SMALL, "lookup": {"GradientWords": 4096}}


@pytest.mark.structures(
    "words", both=[("small",)], icarus=[("all",)], regress=[("lookup",)], regress_verilator=[("all",)]
)
def test_table_access(run_tb: Callable[..., None], words: Any) -> None:
    run_tb("table_access", parameters=WORDS[words])
