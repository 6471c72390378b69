# SPDX-License-Identifier: Apache-2.0
"""contact_events: RTL against the model, and the model's division against exact fractions."""

from collections.abc import Callable
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tactile_depth.configuration import COLUMNS, Configuration
from tactile_depth.contact.contact_events import FRACTION, WORDS, ContactEvents, Record, Settings, centroid, record
from tactile_depth.frames import load_frames
from tactile_depth.sensor import load
from tactile_depth.tactile_depth import tactile_depth

SOURCES = ["round_saturate.sv", "contact_events.sv"]
PLACE = st.tuples(st.integers(0, 1023), st.integers(0, 1023))


@pytest.mark.structures(
    "width rows columns bottom_first",
    verilator=[(24, 5, 8, 0)],
    icarus=[(6, 5, 8, 1)],
    regress=[(24, 5, 8, 0), (32, 5, 16, 1), (12, 9, 4, 0), (24, 8, 16, 0)],
)
def test_rtl(run_tb: Callable[..., None], width: int, rows: int, columns: int, bottom_first: Any) -> None:
    parameters = {"Width": width, "Rows": rows, "Columns": columns, "BottomFirst": bottom_first}
    run_tb("contact_events", SOURCES, parameters)


@given(st.lists(st.integers(0, 1023), min_size=1, max_size=300))
def test_centroid_is_the_nearest(places: Any) -> None:
    mean = Fraction(sum(places), len(places))
    assert centroid(sum(places), len(places), 10) == round(mean * 2**FRACTION)  # of a Fraction: ties to even


@given(*(st.integers(0, 2**32 - 1) for _ in range(4)), st.integers(-(2**31), 2**31 - 1), PLACE, PLACE, PLACE, PLACE)
def test_words_are_read_as_they_were_written(
    status: Any, frame: Any, time: Any, area: Any, peak: Any, place: Any, least: Any, greatest: Any, middle: Any
) -> None:
    given = Record(status, frame, time, area, peak, place, least, greatest, area, frame, peak << 21, middle)
    assert len(given.words) == WORDS
    assert record(given.words) == given


@pytest.mark.parametrize("solver", COLUMNS)
def test_a_record_tells_the_floor_of_a_frame_whose_mean_is_zero(solver: str) -> None:
    """Neumann: what is not above has the mean -volume / (pixels - area)."""
    config = Configuration(columns=32, solver=solver, neumann=True)
    frames = load_frames("bench", (32, 32))
    depths = tactile_depth(frames.pixels, load("synthetic").on_grid(frames), config)
    for depth in depths:
        threshold = int(depth.max() // 4)
        settings = Settings(threshold, threshold, 1, 1)
        events = ContactEvents(32, 32, solver == "tridiagonal")
        beats = [(int(code), at == 0, at % 32 == 31, at == depth.size - 1) for at, code in enumerate(depth.ravel())]
        found = [events.beat(*beat, settings, 0) for beat in beats][-1]
        assert found is not None
        assert found.area > 0
        floor = depth[depth <= threshold].mean()
        told = -found.volume / (depth.size - found.area)
        assert abs(told - floor) <= np.abs(depth).max() * 1e-5  # measured: 5e-7, 8e-6
