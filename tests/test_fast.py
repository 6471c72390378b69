# SPDX-License-Identifier: Apache-2.0
"""Compiled models (extra `fast`): codes and clip counts are those of the models in numpy."""

import sys
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import tactile_depth as td
from tactile_depth.chip.common.td_round_saturate import Monitor
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.gradient.light_gains import Light
from tactile_depth.chip.poisson import cores
from tactile_depth.chip.poisson.transform.transform import Transform
from tactile_depth.pictures.picture_check import Checked

fast = pytest.importorskip(
    "tactile_depth.chip.poisson.fast", reason="numba is missing: pip install .[fast]", exc_type=ImportError
)
DRAWS: dict[str, Callable[[np.random.Generator, Any], np.ndarray]] = {
    "small": lambda rng, shape: rng.integers(-1000, 1000, shape),
    "full": lambda rng, shape: rng.integers(-(2**26), 2**26, shape),
    "too large": lambda rng, shape: rng.integers(-(2**30), 2**30, shape),
    "limits": lambda rng, shape: rng.choice([-(2**26), 2**26 - 1], shape),
    "lowest": lambda _, shape: np.full(shape, -(2**26)),
}


def compare(name: str, *arguments: Any, **more: Any) -> int:
    """Check codes and clip counts of a model, and return the number of clipped words."""
    expected, counted = Monitor(), Monitor()
    codes = getattr(cores.NUMPY, name)(*arguments, monitor=expected, **more)
    np.testing.assert_array_equal(getattr(fast, name)(*arguments, monitor=counted, **more), codes)
    assert counted.saturations == expected.saturations
    np.testing.assert_array_equal(getattr(fast, name)(*arguments, **more), codes)
    return sum(expected.saturations.values())


@pytest.mark.parametrize("name", ["dst_forward", "dst_inverse", "dst_inverse_pairs"])
@pytest.mark.parametrize("alternate", [False, True])
@pytest.mark.parametrize("size", [16, 32, 64])
@pytest.mark.parametrize("draw", DRAWS)
def test_a_transform_is_that_of_the_model(name: str, alternate: bool, size: int, draw: str) -> None:
    words = DRAWS[draw](np.random.default_rng(1), (3, 47, size))  # more bursts than are transformed side by side
    clipped = 0
    for drops in ((0, 0), (-2, 5), (3, -1)):
        clipped += compare(name, words, Transform(drops[0], 27, 18, drops[1], 24, alternate))
    assert (clipped > 0) is (draw != "small")
    compare(name, words[0, :2], Transform(0, 27, 18, 0, 24))


@pytest.mark.parametrize("neumann", [False, True])
@pytest.mark.parametrize("draw", DRAWS)
def test_a_recursion_is_that_of_the_model(neumann: bool, draw: str) -> None:
    config = Configuration(columns=32, rows=24, solver="tridiagonal", neumann=neumann)
    words = DRAWS[draw](np.random.default_rng(2), (2, 3, 24, 32))
    clipped = compare("elimination", words, config) + compare("substitution", words[:, :, ::-1], config)
    assert (clipped > 0) is (draw != "small")


@pytest.mark.parametrize("seed", range(8))
def test_light_gains_of_single_pictures_are_those_of_the_model(seed: int) -> None:
    rng, light = np.random.default_rng(seed), Light(24, 32)
    level = rng.uniform(0.4, 2.5, 3) if seed % 2 else np.ones(3)
    ratios = np.rint(2**15 * rng.normal(level, rng.choice([0.01, 0.1, 0.5]), (4, 24, 32, 3)))
    ratios = ratios.clip(0, 2**17 - 1).astype(np.int64)
    ratios[:, :, : 4 * seed] = 0  # without light
    np.testing.assert_array_equal(fast.settled(ratios, light), cores.NUMPY.settled(ratios, light))


@pytest.mark.parametrize(
    "choices",
    [
        {},
        {"model": "lut", "boundary": "dirichlet"},
        {"solver": "spectral", "grid": (32, 32)},
        {"solver": "spectral", "grid": (16, 16), "boundary": "dirichlet"},
        {"data_width": 12, "coefficient_width": 10, "depth_range_mm": 0.5, "zero_offset": False},
        {"arithmetic": "float"},
    ],
    ids=lambda choices: ",".join(map(str, choices.values())) or "default",
)
def test_a_pipeline_gives_what_it_gives_without(monkeypatch: pytest.MonkeyPatch, choices: Any) -> None:
    drawn, rng = td.sample("ball"), np.random.default_rng(3)
    noise = rng.integers(0, 256, drawn.image.shape, np.uint8)
    extremes = rng.choice([np.uint8(0), np.uint8(255)], (12, 16, 3)).repeat(20, 0).repeat(20, 1)
    pictures = np.stack([drawn.image, drawn.reference, noise, extremes])
    results = []
    monkeypatch.setattr("tactile_depth.depth.pipeline.check_picture", lambda _, __, name: Checked(name, None, []))
    for used in (cores.fastest(), cores.NUMPY):
        monkeypatch.setattr("tactile_depth.depth.pipeline.fastest", lambda used=used: used)
        pipeline = td.Pipeline(drawn.sensor, drawn.reference, **choices)
        results.append((pipeline(pictures), pipeline.zero_codes))
    (compiled, zero), (expected, expected_zero) = results
    np.testing.assert_array_equal(zero, expected_zero)
    for name in ("codes", "depth_mm", "slopes", "light_gains"):
        np.testing.assert_array_equal(getattr(compiled, name), getattr(expected, name))
    assert compiled.saturations == expected.saturations
    assert compiled.records == expected.records


def test_numba_is_used_if_it_can_be(monkeypatch: pytest.MonkeyPatch) -> None:
    assert cores.fastest() != cores.NUMPY
    monkeypatch.setitem(sys.modules, "tactile_depth.chip.poisson.fast", None)  # as without numba
    monkeypatch.delattr("tactile_depth.chip.poisson.fast")
    assert cores.fastest.__wrapped__() == cores.NUMPY


def test_models_in_numpy_stay_where_numba_cannot_keep_its_code(monkeypatch: pytest.MonkeyPatch) -> None:
    def refused(**_: Any) -> None:
        raise RuntimeError("cannot cache function: no locator available")

    monkeypatch.setattr("numba.njit", refused)
    monkeypatch.delitem(sys.modules, "tactile_depth.chip.poisson.fast")
    monkeypatch.delattr("tactile_depth.chip.poisson.fast")
    assert cores.fastest.__wrapped__() == cores.NUMPY
