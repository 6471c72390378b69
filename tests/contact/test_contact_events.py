# SPDX-License-Identifier: Apache-2.0
"""contact_events: RTL against the model, and the words of a record."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.contact.contact_events import WORDS, ContactEvents, Record, Settings, record
from tactile_depth.chip.limits import COLUMNS
from tactile_depth.chip.tactile_depth import tactile_depth
from tactile_depth.pictures.frames import load_frames, on_grid
from tactile_depth.sensor.built_in import load

WORD, CODE = st.integers(0, 2**32 - 1), st.integers(-(2**31), 2**31 - 1)
PLACE = st.tuples(st.integers(0, 1023), st.integers(0, 1023))
RECORDS = st.builds(Record, WORD, WORD, WORD, CODE, PLACE, CODE, WORD, PLACE, PLACE, st.integers(0, 2**64 - 1), PLACE)


@given(RECORDS)
def test_words_are_read_as_they_were_written(sent: Record) -> None:
    assert len(sent.words) == WORDS
    assert record(sent.words) == sent


@pytest.mark.parametrize("solver", COLUMNS)
def test_a_record_tells_the_zero_of_a_frame_whose_mean_is_zero(solver: str) -> None:
    """Compute the depth at rest under Neumann, where a mean is zero: depths outside the area have -volume / rest."""
    config = Configuration(columns=32, solver=solver, neumann=True)
    frames = load_frames("bench", (32, 32))
    depths = tactile_depth(frames.pixels, on_grid(load("synthetic"), frames), config)
    for depth in depths:
        threshold = int(depth.max() // 4)
        settings = Settings(threshold, threshold, threshold, 1, 1)
        events = ContactEvents(32, 32, config.data_width, solver == "tridiagonal")
        beats = [(int(code), at == 0, at % 32 == 31, at == depth.size - 1) for at, code in enumerate(depth.ravel())]
        last = [events.beat(*beat, settings, 0) for beat in beats][-1]
        assert last is not None
        assert last.area > 0
        zero = depth[depth <= last.area_threshold].mean()
        untouched = -last.volume / (depth.size - last.area)
        assert abs(untouched - zero) <= np.abs(depth).max() * 1e-5  # measured: 5e-7, 8e-6
