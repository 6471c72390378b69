# SPDX-License-Identifier: Apache-2.0
"""contact_events: RTL against the model, and the model's division against exact fractions."""

from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from models.contact_events import FRACTION, WORDS, Record, centroid, record

SOURCES = ["round_saturate.sv", "contact_events.sv"]
PLACE = st.tuples(st.integers(0, 1023), st.integers(0, 1023))


@pytest.mark.structures(
    "width rows columns bottom_first",
    both=[(24, 8, 16, 0)],
    icarus=[(6, 5, 8, 1), (32, 5, 16, 1), (12, 9, 4, 0)],
)
def test_rtl(run_tb, width, rows, columns, bottom_first):
    parameters = {"Width": width, "Rows": rows, "Columns": columns, "BottomFirst": bottom_first}
    run_tb("contact_events", SOURCES, parameters)


@given(st.lists(st.integers(0, 1023), min_size=1, max_size=300))
def test_centroid_is_the_nearest(places):
    mean = Fraction(sum(places), len(places))
    assert centroid(sum(places), len(places), 10) == round(mean * 2**FRACTION)  # of a Fraction: ties to even


@given(*(st.integers(0, 2**32 - 1) for _ in range(4)), st.integers(-(2**31), 2**31 - 1), PLACE, PLACE, PLACE, PLACE)
def test_words_are_read_as_they_were_written(status, frame, time, area, peak, place, least, greatest, middle):
    given = Record(status, frame, time, area, peak, place, least, greatest, area, frame, peak << 21, middle)
    assert len(given.words) == WORDS
    assert record(given.words) == given
