# SPDX-License-Identifier: Apache-2.0
"""contact_events: the words of a record, and its fields by numpy alone."""

from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.contact.contact_events import WORDS, ContactEvents, Record, Settings, record
from tactile_depth.chip.contact.frame_flags import FLAG_WORDS, FrameFlags
from tactile_depth.chip.fixed_point import joined
from tactile_depth.chip.limits import COLUMNS
from tactile_depth.chip.registers.axil_registers import RECORD
from tactile_depth.chip.registers.register_map import REGISTERS
from tactile_depth.chip.tactile_depth import tactile_depth
from tactile_depth.pictures.frames import load_frames, on_grid
from tactile_depth.sensor.built_in import load
from tb.structs import unpack

WORD, CODE = st.integers(0, 2**32 - 1), st.integers(-(2**31), 2**31 - 1)
PLACE = st.tuples(st.integers(0, 1023), st.integers(0, 1023))
MARK, HALF = st.booleans(), st.integers(0, 2**16 - 1)
FLAGS = st.builds(FrameFlags, *[MARK] * 7, st.tuples(HALF, HALF, HALF), HALF, HALF, st.integers(0, 2**9 - 1))
PEAK = CODE, PLACE, CODE, WORD, PLACE, PLACE, st.integers(0, 2**64 - 1), PLACE
RECORDS = st.builds(Record, WORD, WORD, WORD, *PEAK, FLAGS)


@given(RECORDS)
def test_words_are_read_as_they_were_written(sent: Record) -> None:
    assert len(sent.words) == WORDS
    assert record(sent.words) == sent


@given(FLAGS)
def test_flags_are_where_the_registers_and_the_rtl_have_them(flags: FrameFlags) -> None:
    sent = dict(zip(RECORD, Record(0, 0, 0, flags=flags).words, strict=True))
    gains = {
        f"light_gain_{colour}": gain for colour, gain in zip(("red", "green", "blue"), flags.light_gains, strict=True)
    }
    values = {name: int(value) for name, value in flags._asdict().items() if name != "light_gains"} | gains
    shown = [REGISTERS[name].unpack(sent[name]) for name in RECORD[-FLAG_WORDS:]]
    assert {name: value for fields in shown for name, value in fields.items()} == values
    assert unpack("frame_flags_t", joined(flags.words, 32)) == values


@given(arrays(np.int64, (2, 5, 8), elements=st.integers(-32, 31)), *[st.integers(-40, 40)] * 3, MARK, FLAGS)
def test_the_fields_of_a_record(
    maps: Any, on: int, off: int, setting: int, bottom_first: bool, flags: FrameFlags
) -> None:
    """Play two frames whose rows are counted from the top; the second finds the state and the peak of the first."""
    model, touching, half_peak = ContactEvents(5, 8, 6, bottom_first), False, setting
    for number, depth in enumerate(maps):
        stream = depth[::-1] if bottom_first else depth
        beats = [(int(code), at == 0, at % 8 == 7, at == 39) for at, code in enumerate(stream.ravel())]
        found = [model.beat(*beat, Settings(on, off, setting, 2, 1), 7, flags) for beat in beats][-1]
        threshold = off if touching else on
        level = int(np.clip(max(threshold, min(setting, half_peak)), -32, 31))
        above, rows, columns = int(np.count_nonzero(depth > threshold)), *np.nonzero(depth > level)
        peak, half_peak = (int(depth.max()), int(depth.max() // 2)) if above else (0, setting)
        row, column = divmod(int(stream.argmax()), 8) if above else (0, 0)
        row = 4 - row if bottom_first and above else row
        weights = depth[rows, columns] - level
        limits, middle = ((row, column), (row, column)), [16 * row, 16 * column]
        if rows.size:
            limits = (rows.min(), columns.min()), (rows.max(), columns.max())
            moments = (int((weights * places).sum()) for places in (rows, columns))
            middle = [round(16 * Fraction(moment, int(weights.sum()))) for moment in moments]
        status = {(False, True): 3, (True, True): 1, (True, False): 4}.get((touching, above > 1), 0)
        touching = above > 1
        area = rows.size, *limits, weights.sum(), tuple(middle), flags
        assert found == (status, number + 1, 7, peak, (row, column), level, *area)


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
