# SPDX-License-Identifier: Apache-2.0
"""Drawings and lines of `tactile-depth depth`: mesh, colours, the line of a picture, overview."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import tactile_depth as td
from tactile_depth.cli.depth import summary
from tactile_depth.cli.drawing import DARK, OUTSIDE, Scale, round_number
from tactile_depth.cli.overview import draw_overview
from tactile_depth.cli.ply import triangles

SAMPLE = td.sample("ball")


@pytest.fixture
def result() -> td.Result:
    return td.Pipeline(SAMPLE.sensor, SAMPLE.reference, grid=(24, 32))(SAMPLE.image)


def test_triangles_face_up() -> None:
    index = triangles(3, 4)
    y, x = np.divmod(np.arange(12), 4)
    points = np.stack([x, -y, np.zeros(12)], axis=-1).astype(float)
    a, b, c = (points[index[:, corner]] for corner in range(3))
    np.testing.assert_array_equal(np.cross(b - a, c - a)[:, 2], np.ones(12))
    assert sorted({*index.ravel().tolist()}) == list(range(12))


def test_colours_run_from_dark_blue_to_yellow() -> None:
    np.testing.assert_array_equal(Scale(0, 2).colours(np.array([-1.0, 0.0, 2.0, 3.0]))[:, 0], [68, 68, 253, 253])
    for limit, step in ((0.99, 0.5), (1.0, 1.0), (4.9, 2.0), (70, 50), (0.021, 0.02)):
        assert round_number(limit) == pytest.approx(step)


@pytest.mark.parametrize(("count", "pixels"), [(1, "1 pixel"), (2, "2 pixels")])
def test_the_line_on_a_picture_counts_doubtful_pixels(result: Any, count: int, pixels: str) -> None:
    result = replace(result, fitted_slope=np.inf, saturations={"depth": count})
    dark = np.arange(result.dark.size).reshape(result.dark.shape) < count
    line = summary(replace(result, dark=dark))
    assert line.endswith(f"; {pixels} without light; {pixels.replace('pixel', 'value')} clipped")


def test_doubtful_pixels_are_marked_in_the_overview(result: Any) -> None:

    def marked(result: Any, colour: Any) -> Any:
        return (np.array(draw_overview(SAMPLE.image, result, "")) == colour).all(axis=-1)[:400].sum()

    dark = np.zeros_like(result.dark)
    dark[2, 3] = True
    cell = (480 // 32) ** 2
    assert [marked(result, colour) for colour in (OUTSIDE, DARK)] == [0, 0]
    assert marked(replace(result, dark=dark), DARK) == cell
    steep = replace(result, fitted_slope=0.4)
    assert marked(steep, OUTSIDE) == cell * steep.outside.sum() > 0
