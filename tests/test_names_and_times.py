# SPDX-License-Identifier: Apache-2.0
"""Names of what the package brings, and the times of captures in results."""

from typing import Any

import numpy as np
import pytest

import tactile_depth as td


def test_names_are_those_that_sample_and_load_take() -> None:
    assert "ball" in td.samples()
    assert all(td.load(name).name for name in td.calibrations())
    assert td.sample(td.samples()[-1]).image.shape == (240, 320, 3)


def test_the_time_of_a_capture_is_in_the_result() -> None:
    sample = td.sample()
    pipeline = td.Pipeline(sample.sensor, sample.reference, grid=(24, 32))
    single, pair = pipeline(sample.image, captured_at=1.5), np.stack([sample.image] * 2)
    assert (single.captured_at, pipeline(sample.image).captured_at) == (1.5, None)
    batch = pipeline(pair, captured_at=[1.5, 2.5])
    assert [batch[1].captured_at, *batch[0:1].captured_at] == [2.5, 1.5]  # type: ignore[misc]
    assert [each.captured_at for each in pipeline(pair, captured_at=3)] == [3, 3]
    mixed = pipeline.stream([(sample.image, 7.25), sample.image])
    assert [each.captured_at for each in mixed] == [7.25, None]


@pytest.mark.parametrize("times", [[1.0], "now", [1.0, 2.0, 3.0], [True, False], [1.0, np.nan], np.inf])
def test_times_that_are_none_are_refused(times: Any) -> None:
    sample = td.sample()
    pipeline = td.Pipeline(sample.sensor, sample.reference, grid=(24, 32))
    with pytest.raises(td.InputError, match=r"captured_at=.*: accepted is seconds since the epoch"):
        pipeline(np.stack([sample.image] * 2), captured_at=times)
    for time in ("now", np.nan):
        with pytest.raises(td.InputError, match="pictures have a tuple"):
            next(pipeline.stream([(sample.image, time)]))  # type: ignore[list-item]
