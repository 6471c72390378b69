# SPDX-License-Identifier: Apache-2.0
"""frame_guard: RTL against the model, the model against the table of its header."""

from typing import Any

import pytest

from tactile_depth.chip.video.frame_guard import Word, frame_guard
from tb.axis import BREAKS, WITHOUT_START, broken, faults_of, positions, video

TIMEOUT = 5
ROWS, COLUMNS = 4, 8  # of the model's frames


def frame(start: Any) -> Any:
    return video(range(start, start + ROWS * COLUMNS), COLUMNS)


@pytest.mark.parametrize("kind", BREAKS)
def test_model_flags_a_broken_frame_once_and_the_next_is_right(kind: str) -> None:
    first, next_one = (frame(start) for start in (100, 300))
    for position in positions(kind, ROWS, COLUMNS):
        wrong = broken(frame(200), kind, position, COLUMNS, TIMEOUT + (kind != "waited"))
        out = frame_guard([*first, *wrong, *next_one], ROWS, COLUMNS, TIMEOUT)
        assert out.faults == list(faults_of(kind, position, COLUMNS)), position
        sent = [first, frame(200), next_one] if kind in ("whole", "waited") else [first, next_one]
        good = [list(f.pixels) for f in out.frames if not f.bad]
        assert good == [[word.data for word in words] for words in sent], position
        bad = [f for f in out.frames if f.bad]
        assert len(bad) == len([fault for fault in out.faults if fault != "start_missing"]), position
        if bad and kind not in WITHOUT_START:  # right up to the fault, then the last pixel repeated
            kept = position + (kind in ("row_short", "end_extra", "row_long", "end_missing"))
            pixels = list(range(200, 200 + kept))
            assert bad[0].pixels == (*pixels, *[pixels[-1]] * (ROWS * COLUMNS - kept)), position
        assert not out.open


@pytest.mark.parametrize("count", range(1, 20))
def test_model_drops_words_before_the_first_frame(count: int) -> None:
    before = [word._replace(user=0) for word in frame(0)[:count]]
    out = frame_guard([*before, *frame(100)], ROWS, COLUMNS)
    assert out.faults == ["start_missing"]
    assert [(f.pixels[0], f.bad, f.first, f.last) for f in out.frames] == [(100, False, count, count + 31)]


@pytest.mark.parametrize(("timeout", "clocks", "given_up"), [(0, 99, 0), (5, 5, 0), (5, 6, 1), (1, 2, 1)])
def test_model_waits_for_as_long_as_the_timeout(timeout: int, clocks: int, given_up: Any) -> None:
    words = frame(0)
    for position in range(1, ROWS * COLUMNS):
        stream = [*words[:position], *[None] * clocks, *words[position:], *[None] * 50]
        out = frame_guard(stream, ROWS, COLUMNS, timeout)
        assert out.faults == ["timed_out"] * given_up
        assert [f.bad for f in out.frames] == [bool(given_up)]


def test_model_keeps_a_frame_that_starts_early() -> None:
    early = [Word(1, 0, 1), Word(2, 0, 1), Word(3, 1, 0), Word(4, 0, 0), Word(5, 1, 0)]
    out = frame_guard(early, 2, 2)
    assert [(f.pixels, f.bad) for f in out.frames] == [((1, 1, 1, 1), True), ((2, 3, 4, 5), False)]


def test_model_says_what_is_open() -> None:
    assert frame_guard([Word(7, 0, 1), Word(8, 1, 0), Word(9, 0, 0)], 2, 2).open == [7, 8, 9]
