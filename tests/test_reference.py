# SPDX-License-Identifier: Apache-2.0
"""Reference in double precision: it solves its equation."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tactile_depth.chip.poisson.divergence import divergence
from tactile_depth.depth.reference import depth, eigenvalues, slopes, solve
from tactile_depth.sensor.scenes import dome, photograph
from tactile_depth.sensor.sensor import Sensor
from tactile_depth.sensor.synthetic import synthetic


def second_difference(z: np.ndarray, axis: int) -> np.ndarray:
    """Return the second difference, zero half a pixel outside: a neighbour outside is the mirrored negative."""
    first, last = np.take(z, [0], axis), np.take(z, [-1], axis)
    return np.diff(np.concatenate((-first, z, -last), axis), n=2, axis=axis)


@pytest.mark.parametrize("shape", [(16, 16), (64, 64), (128, 128), (2, 48, 16)])
def test_solve_inverts_the_five_point_laplacian(shape: Any) -> None:
    f = np.random.default_rng(1).normal(size=shape)
    z = solve(f)
    np.testing.assert_allclose(second_difference(z, -1) + second_difference(z, -2), f, atol=1e-11)


@given(st.integers(2, 6), st.integers(1, 64), st.integers(1, 64))
def test_every_mode_is_divided_by_its_eigenvalue(log2_size: Any, k: Any, m: Any) -> None:
    size = 1 << log2_size
    k, m = min(k, size), min(m, size)
    n = 2 * np.arange(size) + 1
    mode = np.outer(np.sin(np.pi * k * n / (2 * size)), np.sin(np.pi * m * n / (2 * size)))
    eigenvalue = eigenvalues(size)[k - 1] + eigenvalues(size)[m - 1]
    np.testing.assert_allclose(solve(mode), mode / eigenvalue, atol=1e-10)


@settings(max_examples=20)
@given(st.integers(0, 2**32 - 1), st.floats(-3, 3))
def test_solve_is_linear(seed: int, factor: int) -> None:
    f, g = np.random.default_rng(seed).normal(size=(2, 32, 32))
    np.testing.assert_allclose(solve(factor * f + g), factor * solve(f) + solve(g), atol=1e-10)


@pytest.mark.parametrize("bits", [1, 4, 6])
def test_slopes_are_looked_up_by_the_top_bits_of_red_green_blue(bits: int) -> None:
    bins = 1 << bits
    gradient = np.random.default_rng(2).normal(size=(bins, bins, bins, 2))
    frames = np.random.default_rng(3).integers(0, 256, (3, 5, 7, 3), dtype=np.uint8)
    result = slopes(frames, Sensor("random", gradient, 0.1))
    assert result.shape == (3, 5, 7, 2)
    assert result.dtype == np.float64
    for place in np.ndindex(3, 5, 7):
        red, green, blue = (int(c) * bins // 256 for c in frames[place])
        np.testing.assert_array_equal(result[place], gradient[red, green, blue])


def test_depth_is_the_chain_and_frames_do_not_mix() -> None:
    gradient = np.random.default_rng(4).normal(size=(4, 4, 4, 2))
    calibration = Sensor("random", gradient, 0.1)
    frames = np.random.default_rng(5).integers(0, 256, (2, 16, 16, 3), dtype=np.uint8)
    complete = depth(frames, calibration)
    for frame, z in zip(frames, complete, strict=True):
        np.testing.assert_allclose(z, solve(divergence(slopes(frame, calibration))), atol=1e-13)


# A dome of 12 pixels' peak and 31 pixels' radius whose centre lies `centre` pixels from the left edge, at N = 128:
# height kept, of the true one, by boundary. What lies outside the frame is not seen.
@pytest.mark.parametrize(("centre", "dirichlet"), [(64, 1.0), (30, 1.0), (20, 0.90), (14, 0.73), (8, 0.47), (4, 0.26)])
def test_height_of_a_contact_that_the_edge_cuts(centre: Any, dirichlet: Any) -> None:
    complete = dome(128, 12.0)
    row, column = np.unravel_index(complete.argmax(), complete.shape)
    height = np.zeros_like(complete)
    height[:, : 128 - (column - centre)] = complete[:, column - centre :]
    frame = photograph(height)
    area = np.s_[row - 1 : row + 2, centre - 1 : centre + 2]
    for neumann, kept in ((False, dirichlet), (True, 1.0)):
        z = depth(frame, synthetic(), neumann)
        top, untouched = z[area].mean(), z[:, 108:].mean()
        assert (top - untouched) / height[area].mean() == pytest.approx(kept, abs=0.02)
