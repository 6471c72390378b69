# SPDX-License-Identifier: Apache-2.0
"""Models of the flat field and of the quadratic gradient against their formulas in double precision."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tactile_depth import reference
from tactile_depth.built_in import synthetic
from tactile_depth.common.td_node_map import node_map
from tactile_depth.common.td_round_saturate import Monitor
from tactile_depth.configuration import COLOUR_COEFFICIENT, DEVIATION, POLYNOMIAL, Configuration
from tactile_depth.errors import InputError
from tactile_depth.gradient.flat_field import (
    captured_gains,
    dark_pixels,
    deviations,
    flat_codes,
    pixel_gains,
    unit_gains,
)
from tactile_depth.gradient.polynomial_gradient import DROPPED, coefficient_map, polynomial_words, polynomial_gradient
from tactile_depth.poisson.divergence import divergence
from tactile_depth.sensor import Sensor
from tactile_depth.tactile_depth import slope_codes, slope_tables, solve

SHAPES = [
    {"columns": 16},
    {"columns": 32, "rows": 21, "solver": "tridiagonal"},
    {"columns": 128},
    {"columns": 256, "rows": 8, "solver": "tridiagonal"},
    {"columns": 64, "rows": 40, "solver": "tridiagonal", "neumann": True},
]
SEED = st.integers(0, 2**32 - 1)


def lit(config: Configuration, seed: int, count: int = 1) -> np.ndarray:
    """Return frames without contact, as unevenly lit as a real gel, and no darker than 20."""
    chance = np.random.default_rng(seed)
    y, x = np.indices((config.rows, config.columns)) / config.columns
    waves = [np.cos(3 * (x * chance.normal() + y * chance.normal()) + chance.uniform(0, 6)) for _ in range(3)]
    frame = 105 + 80 * np.stack(waves, axis=-1)
    return np.clip(np.rint(frame + chance.normal(size=(count, *frame.shape))), 20, 255).astype(np.uint8)


def quadratics(seed: int, largest: float = 0.9) -> Sensor:
    scale = np.array([1, 0.1, 0.1, 0.01, 0.01, 0.01])
    coefficients = np.random.default_rng(seed).uniform(-1, 1, (2, 3, 6)) * scale
    return Sensor("any", None, 0.1, coefficients, largest, "quadratic")


# Tables that are computed once.

MODELS = [{}, {"flat_field": True}, {"flat_field": True, "gradient_model": "quadratic"}]


@pytest.mark.parametrize("choices", MODELS, ids=str)
def test_slopes_of_prepared_tables_are_those_of_the_calibration(choices: Any) -> None:
    config = Configuration(columns=32, **choices)
    frames = lit(config, 1, 3)
    calibration = synthetic().scaled(4.0, frames[0] if choices else None)
    tables = slope_tables(calibration, config)
    for level in (0, 90):
        want = slope_codes(frames, calibration, config, dark_level=level)
        result = slope_codes(frames, calibration, config, dark_level=level, tables=tables)
        np.testing.assert_array_equal(result, want)


@pytest.mark.parametrize("choices", MODELS, ids=str)
def test_depth_of_prepared_tables_is_that_of_the_calibration_in_double_precision(choices: Any) -> None:
    config = Configuration(columns=32, **choices)
    frames = lit(config, 2, 3)
    calibration = synthetic().scaled(4.0, frames[0] if choices else None)
    tables = reference.slope_tables(calibration, config)
    want = reference.depth_of(frames, calibration, config)
    np.testing.assert_array_equal(reference.depth_of(frames, calibration, config, tables), want)


def test_gains_of_pixels_stand_for_those_of_nodes() -> None:
    config = Configuration(columns=32)
    frames = lit(config, 5, 2)
    gains = captured_gains(frames, config)
    gains[0, 3, 1] = (1 << 24) - 1  # dead
    prepared = pixel_gains(gains, config)
    assert prepared.dead.any()
    for function in (dark_pixels, flat_codes, deviations):
        np.testing.assert_array_equal(function(frames, prepared, config, 90), function(frames, gains, config, 90))


# Flat-fielding.


def test_a_capture_zeroes_the_depth_of_an_untouched_gel() -> None:
    """Capture the zero offset under Neumann: drifting lights tilt and bend it, and the capture removes both."""
    calibration = quadratics(3)
    config = Configuration(columns=64, neumann=True, gradient_limit=calibration.gradient_limit)
    words = polynomial_words(calibration, config, 15 / 64)
    before = lit(config, 4, 16)
    y, x = np.indices((64, 64)) / 64
    drifted = np.clip(np.rint(before * (0.9 + 0.1 * np.stack([x, y, x * y], axis=-1))), 0, 255).astype(np.uint8)

    def zero(frames: Any, gains: Any) -> Any:
        slopes = polynomial_gradient(deviations(frames[:1], gains, config), words, config)
        return np.std(solve(divergence(slopes, True), config)) * config.depth_lsb_px

    calibrated = zero(before, captured_gains(before, config))
    assert zero(drifted, captured_gains(before, config)) > 10 * calibrated
    assert zero(drifted, captured_gains(drifted, config)) < 2 * calibrated


@pytest.mark.parametrize("choices", SHAPES, ids=str)
def test_at_power_up_codes_are_the_pixels(choices: Any) -> None:
    config = Configuration(**choices)
    frames = np.random.default_rng(1).integers(0, 256, (2, config.rows, config.columns, 3)).astype(np.uint8)
    monitor = Monitor()
    np.testing.assert_array_equal(flat_codes(frames, unit_gains(config), config, monitor=monitor), frames)
    assert not monitor.saturations


@pytest.mark.parametrize("choices", SHAPES, ids=str)
def test_gains_are_those_of_the_reference(choices: Any) -> None:
    config = Configuration(**choices)
    frames = lit(config, 2, 4)
    result = node_map(captured_gains(frames, config), config) / 2.0**27
    want = reference.gains(frames, config)
    assert np.abs(result / want - 1).max() < 2**-19  # half a unit each of the node and of the sum, at a gain of 1/255


def test_the_reference_itself_reads_flat_where_it_is_smooth() -> None:
    config = Configuration(columns=64)
    frame = np.full((1, 64, 64, 3), (50, 100, 250), np.uint8)
    gains = captured_gains(frame, config)
    np.testing.assert_array_equal(flat_codes(frame, gains, config), 128)
    np.testing.assert_array_equal(deviations(frame, gains, config), 0)


@settings(max_examples=20)
@given(SEED, st.sampled_from(SHAPES))
def test_codes_and_deviations_are_the_ratio_rounded(seed: int, choices: Any) -> None:
    config = Configuration(**choices)
    still = lit(config, seed)
    gains = captured_gains(still, config)
    chance = np.random.default_rng(seed)
    frames = np.clip(still * chance.uniform(0, 4, (2, config.rows, config.columns, 1)), 0, 255).astype(np.uint8)
    exact = frames * (node_map(gains, config) / 2.0**27)
    monitor = Monitor()
    code = flat_codes(frames, gains, config, monitor=monitor)
    assert np.abs(code - np.minimum(128 * exact, 255)).max() <= 0.5
    assert monitor.saturations["flat_field"] == np.count_nonzero(128 * exact > 255.5)
    deviation = deviations(frames, gains, config) * DEVIATION.lsb
    assert np.abs(deviation - np.minimum(exact - 1, 2 - DEVIATION.lsb)).max() <= DEVIATION.lsb / 2


def test_a_dark_reference_gives_the_largest_gain() -> None:
    config = Configuration(columns=16)
    assert captured_gains(np.zeros((1, 16, 16, 3), np.uint8), config).min() == 2**24 - 1
    assert captured_gains(np.full((2, 16, 16, 3), 8, np.uint8), config).min() == 2**24 - 1
    assert captured_gains(np.full((1, 16, 16, 3), 9, np.uint8), config).max() == round(2**27 / 9)


def test_a_dark_pixel_takes_what_left_before_it() -> None:
    config = Configuration(columns=16)
    gains = unit_gains(config)
    chance = np.random.default_rng(3)
    frames = chance.integers(8, 256, (3, 16, 16, 3)).astype(np.uint8)
    dark = chance.random(frames.shape[:-1]) < 0.4
    frames[dark] = chance.integers(0, 8, (dark.sum(), 3))
    np.testing.assert_array_equal(dark_pixels(frames, gains, config, 8), dark)
    for held, flat in ((flat_codes(frames, gains, config, 8), 128), (deviations(frames, gains, config, 8), 0)):
        last = {"codes": flat_codes(frames, gains, config), "deviations": deviations(frames, gains, config)}
        plain = last["codes"] if flat else last["deviations"]
        for frame, row in np.ndindex(3, 16):
            before = np.full(3, flat)
            for column in range(16):
                if not dark[frame, row, column]:
                    before = plain[frame, row, column]
                np.testing.assert_array_equal(held[frame, row, column], before)


def test_a_pixel_whose_reference_is_dark_is_held() -> None:
    config = Configuration(columns=16)
    still = np.full((1, 16, 16, 3), 100, np.uint8)
    still[:, 4:8, 4:8, 1] = 15  # whole blocks, in one colour
    dark = dark_pixels(still, captured_gains(still, config), config)
    assert dark[0, 5:7, 5:7].all()
    assert not dark[0, :3].any()


# The quadratic model.


def raster(words: np.ndarray, rows: int, columns: int) -> np.ndarray:
    """Return the six-word recurrence of the registers, computed with Python's integers."""
    out = np.zeros((rows, columns), object)
    a, b, d, e, f, h = (int(word) for word in words)
    v0, dv0 = a, b
    for row in range(rows):
        v, dv = v0, dv0
        for column in range(columns):
            out[row, column] = (((v + 2**31) % 2**32) - 2**31) >> DROPPED
            v, dv = v + dv, dv + d
        v0, e, dv0 = v0 + e, e + f, dv0 + h
    return out


@settings(max_examples=10)
@given(st.lists(st.integers(-(2**31), 2**31 - 1), min_size=6, max_size=6))
def test_the_map_is_the_recurrence_along_the_raster(terms: Any) -> None:
    config = Configuration(columns=16, rows=9, solver="tridiagonal")
    words = np.broadcast_to(np.array(terms), (2, 3, 6))
    result = coefficient_map(words, config)[1, 2]
    np.testing.assert_array_equal(result, raster(np.array(terms), 9, 16).astype(np.int64))


@pytest.mark.parametrize("choices", [*SHAPES, {"columns": 512}], ids=str)
def test_words_give_the_calibrations_quadratics(choices: Any) -> None:
    config = Configuration(**choices)
    calibration = quadratics(4)
    pitch = 15 / config.columns
    words = polynomial_words(calibration, config, pitch)
    unit = config.gradient_lsb * 2.0**config.gradient.fraction
    result = coefficient_map(words, config) * COLOUR_COEFFICIENT.lsb * unit
    terms = reference.quadratic_terms(config.rows, config.columns, pitch)
    want = np.einsum("ant,rct->anrc", calibration.coefficients, terms)  # type: ignore[arg-type]
    # Half a unit of the factors, and of three words of second differences, which grow by N^2 / 8.
    far = 3 / 2 * POLYNOMIAL.lsb * max(config.rows, config.columns) ** 2 / 8
    assert np.abs(result - want).max() <= (COLOUR_COEFFICIENT.lsb / 2 + far) * unit * 1.01


@settings(max_examples=20)
@given(SEED, st.sampled_from(SHAPES))
def test_slopes_are_near_double_precision(seed: int, choices: Any) -> None:
    calibration = quadratics(seed, largest=7.9)
    config = Configuration(**choices, gradient_limit=calibration.gradient_limit)
    pitch = 15 / config.columns
    codes = np.random.default_rng(seed).integers(-4096, 4096, (2, config.rows, config.columns, 3))
    monitor = Monitor()
    result = polynomial_gradient(codes, polynomial_words(calibration, config, pitch), config, monitor)
    coefficients = reference.quadratic_coefficients(config.rows, config.columns, calibration, pitch)
    want = reference.weighted(codes * DEVIATION.lsb, coefficients)
    assert not monitor.saturations
    assert np.abs(result * config.gradient_lsb - want).max() < 3 * COLOUR_COEFFICIENT.lsb + config.gradient_lsb


def test_slopes_saturate_and_are_counted() -> None:
    calibration = quadratics(5, largest=0.1)
    config = Configuration(columns=16, gradient_limit=calibration.gradient_limit)
    monitor = Monitor()
    codes = np.full((1, 16, 16, 3), 8191)
    result = polynomial_gradient(codes, polynomial_words(calibration, config, 1.0), config, monitor)
    limit = 2 ** (config.gradient.width - 1)
    assert set(np.unique(np.abs(result))) & {limit, limit - 1}
    assert monitor.saturations["polynomial_gradient"] == np.count_nonzero((result == -limit) | (result == limit - 1))


def test_coefficients_beyond_the_words_are_named() -> None:
    config = Configuration(columns=16)
    steep = Sensor("steep", None, 0.1, np.full((2, 3, 6), 9.0), 0.9, "quadratic")
    with pytest.raises(InputError, match=r"steep: `coefficients` reach .* accepted is less than 8"):
        polynomial_words(steep, config, 0.1)
    with pytest.raises(InputError, match="no `coefficients`"):
        polynomial_words(Sensor("table", np.zeros((2, 2, 2, 2)), 0.1), config, 0.1)
