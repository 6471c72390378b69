# SPDX-License-Identifier: Apache-2.0
"""camera_window: RTL against the model, the model against the table of its header."""

import pytest

from tactile_depth.chip.camera.camera_window import Settings, Watched, camera_window
from tactile_depth.chip.video.frame_guard import Word
from tb.axis import BREAKS, SILENT, WITHOUT_START, broken, positions, video

PICTURE, WINDOW = Settings(8, 6, 2, 1), (4, 3)
KINDS = [kind for kind in BREAKS if kind not in SILENT]


def picture(start: int) -> list[Word]:
    return video(range(start, start + PICTURE.columns * PICTURE.rows), PICTURE.columns)


def watch(words: list[Word], settings: Settings = PICTURE) -> Watched:
    return camera_window([(word, settings) for word in words], WINDOW)


def inside(watched: Watched) -> list[int | None]:
    """Return the pixels of the window, and None for each break."""
    return [None if pixel is None else pixel.data for _, pixel in watched.out if pixel is None or pixel.inside]


def window_of(start: int) -> list[int | None]:
    return [start + row * PICTURE.columns + column for row in range(1, 4) for column in range(2, 6)]


def test_the_window_of_a_whole_picture() -> None:
    watched = watch(picture(100))
    assert inside(watched) == window_of(100)
    assert len(watched.out) == PICTURE.columns * PICTURE.rows
    starts = [pixel.data for _, pixel in watched.out if pixel and pixel.inside and pixel.row_start]
    assert starts == [110, 118, 126]
    assert [pixel.data for _, pixel in watched.out if pixel and pixel.frame_start] == [110]


@pytest.mark.parametrize("kind", KINDS)
def test_a_broken_picture_breaks_once_and_the_next_is_right(kind: str) -> None:
    last = 3 * PICTURE.columns + 5  # pixel of the window
    for position in positions(kind, PICTURE.rows, PICTURE.columns):
        wrong = [word for word in broken(picture(200), kind, position, PICTURE.columns) if word]
        watched = watch([*picture(100), *wrong, *picture(300)])
        got = inside(watched)
        assert got[: len(window_of(0))] == window_of(100)
        assert got[-len(window_of(0)) :] == window_of(300)
        between = got[len(window_of(0)) : -len(window_of(0))]
        if kind == "whole" or (position > last and kind not in (*WITHOUT_START, "start_extra")):
            assert between == window_of(200), position
            assert not watched.faults
            continue
        assert None in between, position
        assert between.count(None) == len(watched.faults)
        if kind not in ("start_late", "start_extra"):  # these begin a second picture, which is broken too
            assert between[-1] is None, position


def test_a_window_outside_is_flagged_once_a_picture() -> None:
    for settings in (Settings(8, 6, 5, 1), Settings(8, 6, 2, 4), Settings(5, 6, 2, 1), Settings(8, 3, 2, 1)):
        watched = watch([*picture(100), *picture(200)], settings)
        assert [name for _, name in watched.faults] == ["window_outside"] * 2
        assert inside(watched) == [None, None]
    for settings in (Settings(8, 6, 4, 1), Settings(8, 6, 2, 3)):
        assert not watch(picture(100), settings).faults


def test_bytes_make_pixels_and_an_odd_byte_breaks_the_row() -> None:
    words = video(range(2 * PICTURE.columns * PICTURE.rows), 2 * PICTURE.columns)
    watched = camera_window([(word, PICTURE) for word in words], WINDOW, words_per_pixel=2)
    assert inside(watched)[0] == 20 | 21 << 8
    assert not watched.faults
    watched = camera_window([(word, PICTURE) for word in words[1:]], WINDOW, words_per_pixel=2)
    assert [name for _, name in watched.faults] == ["start_missing"]
    short = [word for place, word in enumerate(words) if place != 3]
    watched = camera_window([(word, PICTURE) for word in short], WINDOW, words_per_pixel=2)
    assert [name for _, name in watched.faults] == ["row_short"]


def test_the_other_pixel_of_a_pair_is_needed() -> None:
    settings = PICTURE._replace(x=1)  # the window ends with column 4, the pair with column 5
    words = picture(0)
    last = 3 * PICTURE.columns + 4
    words[last + 1] = words[last + 1]._replace(last=1)
    stream = [(word, settings) for word in words]
    assert not camera_window(stream, WINDOW).faults
    assert [name for _, name in camera_window(stream, WINDOW, pixel_pairs=True).faults] == ["row_short"]
