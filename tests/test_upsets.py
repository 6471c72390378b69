# SPDX-License-Identifier: Apache-2.0
"""A sample of the soft errors that `make upsets` counts: no hang, and the frames sent after one are right."""

import pytest

from commands.upsets import CASES, run


@pytest.mark.parametrize("case", CASES)
def test_sample(case, tmp_path):
    results = run(case, upsets=3, seed=1, folder=tmp_path)
    assert len(results) > 60
    for result in results:
        assert result["setting"] or result["outcome"] not in ("hang", "stays wrong"), result
