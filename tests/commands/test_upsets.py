# SPDX-License-Identifier: Apache-2.0
"""Sample of the soft errors that `make upsets` counts: no hang, and frames sent after an upset are right."""

from pathlib import Path
from typing import Any

import pytest

from commands.verify.upsets import CASES, run
from conftest import SEED


@pytest.mark.regress
@pytest.mark.parametrize("case", CASES)
def test_sample(case: Any, tmp_path: Path) -> None:
    results = run(case, upsets=1, seed=SEED, folder=tmp_path)  # of each module
    assert len(results) > 20
    for result in results:
        assert result["setting"] or result["outcome"] not in ("hang", "stays wrong"), result
