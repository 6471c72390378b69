# SPDX-License-Identifier: Apache-2.0
"""A sample of the soft errors that `make upsets` counts: no hang, and the frames sent after one are right."""

import pytest
from stream import REGRESS

from commands.upsets import CASES, run


@pytest.mark.parametrize("case", CASES if REGRESS else list(CASES)[-1:])
def test_sample(case, tmp_path):
    upsets = 3 if REGRESS else 1  # a module
    results = run(case, upsets=upsets, seed=1, folder=tmp_path)
    assert len(results) > 20 * upsets
    for result in results:
        assert result["setting"] or result["outcome"] not in ("hang", "stays wrong"), result
