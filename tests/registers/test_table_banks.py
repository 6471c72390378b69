# SPDX-License-Identifier: Apache-2.0
"""table_banks: RTL against the model."""

from collections.abc import Callable
from typing import Any

import pytest


@pytest.mark.structures("present", both=[(15,)], icarus=[(2,), (4,), (9,)])
def test_table_banks(run_tb: Callable[..., None], present: Any) -> None:
    run_tb("table_banks", parameters={"Present": present})
