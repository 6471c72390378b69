# SPDX-License-Identifier: Apache-2.0
"""frame_output: RTL against the model."""

from collections.abc import Callable

import pytest


@pytest.mark.parametrize(("width", "rows", "columns"), [(24, 4, 8), (12, 16, 2)])
def test_rtl(run_tb: Callable[..., None], width: int, rows: int, columns: int) -> None:
    parameters = {"Width": width, "Rows": rows, "Columns": columns}
    run_tb("frame_output", parameters)
