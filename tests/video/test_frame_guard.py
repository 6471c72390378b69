# SPDX-License-Identifier: Apache-2.0
"""frame_guard: the model against the table of faults in its header."""

from typing import Any

import pytest

from tactile_depth.chip.video.frame_guard import frame_guard
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
