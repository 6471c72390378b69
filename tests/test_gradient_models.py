# SPDX-License-Identifier: Apache-2.0
"""Models of the flat field and of the polynomial gradient against their formulas in double precision."""

import itertools
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tactile_depth.base.errors import InputError
from tactile_depth.chip.common.td_node_map import node_map
from tactile_depth.chip.common.td_round_saturate import Monitor
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.gradient.flat_field import (
    captured_gains,
    pixel_gains,
    unit_gains,
)
from tactile_depth.chip.gradient.polynomial_gradient import (
    UNIT_BITS,
    coefficient_map,
    correction_codes,
    correction_entries,
    correction_unit,
    correction_units,
    fine_bits,
    gradient_parameters,
    polynomial_gradient,
    polynomial_words,
)
from tactile_depth.chip.limits import COLOUR_COEFFICIENT, DEVIATION, POLYNOMIAL
from tactile_depth.chip.poisson.divergence import divergence
from tactile_depth.chip.tactile_depth import slope_tables, solve, tactile_depth
from tactile_depth.depth import reference
from tactile_depth.sensor.sensor import CORRECTIONS, Sensor
from tactile_depth.sensor.synthetic import synthetic

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


def polynomials(seed: int, largest: float = 0.9, model: str = "cubic") -> Sensor:
    """Return a sensor with one model, whose coefficients fall with their degree, and corrections."""
    scale = np.array([1, 0.1, 0.1, 0.01, 0.01, 0.01, 1e-3, 1e-3, 1e-3, 1e-3])
    coefficients = np.random.default_rng(seed).uniform(-1, 1, (2, 3, 10)) * scale
    if model == "quadratic":
        return Sensor("any", None, 0.1, coefficients[..., :6], largest, model)
    corrections = np.random.default_rng(seed).uniform(-largest / 2, largest / 2, CORRECTIONS)
    return Sensor("any", None, 0.1, None, largest, model, cubic=coefficients, corrections=corrections)


# Tables that are computed once.

POLYNOMIALS: dict[str, Any] = {"flat_field": True, "gradient_model": "cubic"}
MODELS = [{}, {"flat_field": True}, POLYNOMIALS | {"gradient_model": "quadratic"}, POLYNOMIALS]


@pytest.mark.parametrize("choices", MODELS, ids=str)
def test_depth_of_prepared_tables_is_that_of_the_calibration(choices: Any) -> None:
    config = Configuration(columns=32, **choices)
    frames = lit(config, 1, 3)
    calibration = polynomials(2) if choices == POLYNOMIALS else synthetic()
    calibration = calibration.scaled(4.0, frames[0] if choices else None)
    tables = slope_tables(calibration, config)
    for level in (0, 90):
        want = tactile_depth(frames, calibration, config, dark_level=level)
        result = tactile_depth(frames, calibration, config, dark_level=level, tables=tables)
        np.testing.assert_array_equal(result, want)


@pytest.mark.parametrize("choices", MODELS, ids=str)
def test_slopes_of_prepared_tables_are_those_of_the_calibration_in_double_precision(choices: Any) -> None:
    config = Configuration(columns=32, **choices)
    frames = lit(config, 2, 3)
    calibration = polynomials(2) if choices == POLYNOMIALS else synthetic()
    calibration = calibration.scaled(4.0, frames[0] if choices else None)
    tables = reference.slope_tables(calibration, config)
    want = reference.slopes_of(frames, calibration, config)
    np.testing.assert_array_equal(reference.slopes_of(frames, calibration, config, tables), want)


# Flat-fielding.


def test_a_capture_zeroes_the_depth_of_an_untouched_gel() -> None:
    """Capture the zero offset under Neumann: drifting lights tilt and bend it, and the capture removes both."""
    calibration = polynomials(3)
    config = Configuration(columns=64, neumann=True, gradient_limit=calibration.gradient_limit, **POLYNOMIALS)
    words = polynomial_words(replace(calibration, pixel_pitch_mm=15 / 64), config)
    before = lit(config, 4, 16)
    y, x = np.indices((64, 64)) / 64
    drifted = np.clip(np.rint(before * (0.9 + 0.1 * np.stack([x, y, x * y], axis=-1))), 0, 255).astype(np.uint8)

    def zero(frames: Any, gains: Any) -> Any:
        slopes = polynomial_gradient(pixel_gains(gains, config).deviations(frames[:1]), words, config)
        return np.std(solve(divergence(slopes, True), config)) * config.depth_lsb_px

    calibrated = zero(before, captured_gains(before, config))
    assert zero(drifted, captured_gains(before, config)) > 10 * calibrated
    assert zero(drifted, captured_gains(drifted, config)) < 2 * calibrated


@pytest.mark.parametrize("choices", SHAPES, ids=str)
def test_at_power_up_codes_are_the_pixels(choices: Any) -> None:
    config = Configuration(**choices)
    frames = np.random.default_rng(1).integers(0, 256, (2, config.rows, config.columns, 3)).astype(np.uint8)
    monitor = Monitor()
    np.testing.assert_array_equal(pixel_gains(unit_gains(config), config).codes(frames, monitor=monitor), frames)
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
    np.testing.assert_array_equal(pixel_gains(gains, config).codes(frame), 128)
    np.testing.assert_array_equal(pixel_gains(gains, config).deviations(frame), 0)


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
    code = pixel_gains(gains, config).codes(frames, monitor=monitor)
    assert np.abs(code - np.minimum(128 * exact, 255)).max() <= 0.5
    assert monitor.saturations["flat_field"] == np.count_nonzero(np.rint(128 * exact) > 255)  # a tie clips
    deviation = pixel_gains(gains, config).deviations(frames) * DEVIATION.lsb
    assert np.abs(deviation - np.minimum(exact - 1, 2 - DEVIATION.lsb)).max() <= DEVIATION.lsb / 2


def test_a_dark_reference_gives_the_largest_gain() -> None:
    config = Configuration(columns=16)
    assert captured_gains(np.zeros((1, 16, 16, 3), np.uint8), config).min() == 2**24 - 1
    assert captured_gains(np.full((2, 16, 16, 3), 8, np.uint8), config).min() == 2**24 - 1
    assert captured_gains(np.full((1, 16, 16, 3), 9, np.uint8), config).max() == round(2**27 / 9)


def test_a_dark_pixel_takes_what_left_before_it() -> None:
    config = Configuration(columns=16)
    field = pixel_gains(unit_gains(config), config)
    chance = np.random.default_rng(3)
    frames = chance.integers(8, 256, (3, 16, 16, 3)).astype(np.uint8)
    dark = chance.random(frames.shape[:-1]) < 0.4
    frames[dark] = chance.integers(0, 8, (dark.sum(), 3))
    np.testing.assert_array_equal(field.dark(frames, 8), dark)
    for model, flat in ((field.codes, 128), (field.deviations, 0)):
        held, plain = model(frames, 8), model(frames)
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
    dark = pixel_gains(captured_gains(still, config), config).dark(still)
    assert dark[0, 5:7, 5:7].all()
    assert not dark[0, :3].any()


# The models of polynomials.


@pytest.mark.parametrize("model", ["quadratic", "cubic"])
@pytest.mark.parametrize("choices", [*SHAPES, {"columns": 512}], ids=str)
def test_words_give_the_calibrations_polynomials(choices: Any, model: Any) -> None:
    config = Configuration(**choices, flat_field=True, gradient_model=model)
    calibration = polynomials(4, model=model)
    pitch = 15 / config.columns
    words = polynomial_words(replace(calibration, pixel_pitch_mm=pitch), config)
    unit = config.gradient_lsb * 2.0**config.gradient.fraction
    result = coefficient_map(words, config) * COLOUR_COEFFICIENT.lsb * unit
    want = reference.polynomials_at_pixels(config.rows, config.columns, calibration.polynomials(model), pitch)
    # Half a unit of the factors, of three words of second differences, which grow by N^2 / 8, and of four of third
    # ones, of which lower degrees leave N^3 / 192 (along one axis) and N^3 / 32 (along two).
    side = max(config.rows, config.columns)
    far = 3 / 2 * POLYNOMIAL.lsb * side**2 / 8
    if model == "cubic":
        far += 2 ** -fine_bits(config) / 2 * POLYNOMIAL.lsb * side**3 * (2 / 192 + 2 / 32)
    assert np.abs(result - want).max() <= (COLOUR_COEFFICIENT.lsb / 2 + far) * unit * 1.01


@settings(max_examples=20)
@given(SEED, st.sampled_from(SHAPES))
def test_slopes_are_near_double_precision(seed: int, choices: Any) -> None:
    calibration = polynomials(seed, largest=7.9)
    config = Configuration(**choices, gradient_limit=calibration.gradient_limit, **POLYNOMIALS)
    pitch = 15 / config.columns
    codes = np.random.default_rng(seed).integers(-4096, 4096, (2, config.rows, config.columns, 3))
    monitor = Monitor()
    result = polynomial_gradient(
        codes, polynomial_words(replace(calibration, pixel_pitch_mm=pitch), config), config, monitor
    )
    coefficients = reference.polynomials_at_pixels(config.rows, config.columns, calibration.cubic, pitch)  # type: ignore[arg-type]
    want = reference.weighted(codes * DEVIATION.lsb, coefficients)
    assert not monitor.saturations
    assert np.abs(result * config.gradient_lsb - want).max() < 3 * COLOUR_COEFFICIENT.lsb + config.gradient_lsb


def test_slopes_saturate_and_are_counted() -> None:
    calibration = polynomials(5, largest=0.1)
    config = Configuration(columns=16, gradient_limit=calibration.gradient_limit, **POLYNOMIALS)
    monitor = Monitor()
    codes = np.full((1, 16, 16, 3), 8191)
    result = polynomial_gradient(
        codes, polynomial_words(replace(calibration, pixel_pitch_mm=1.0), config), config, monitor
    )
    limit = 2 ** (config.gradient.width - 1)
    assert set(np.unique(np.abs(result))) & {limit, limit - 1}
    assert monitor.saturations["polynomial_gradient"] == np.count_nonzero((result == -limit) | (result == limit - 1))


def test_coefficients_beyond_the_words_are_named() -> None:
    config = Configuration(columns=16, **POLYNOMIALS)
    steep = replace(polynomials(1), name="steep", cubic=np.full((2, 3, 10), 9.0))
    with pytest.raises(InputError, match=r"steep: the coefficients of cubic reach .* accepted is less than 8"):
        polynomial_words(steep, config)
    with pytest.raises(InputError, match="gradient_model=cubic: table holds only lut"):
        polynomial_words(Sensor("table", np.zeros((2, 2, 2, 2)), 0.1), config)


@pytest.mark.parametrize("factor", [1, 11, 200])
def test_faint_colours_have_coefficients_with_fewer_fraction_bits(factor: int) -> None:
    """Faint colours change `factor` times less with the slope."""
    bright = replace(polynomials(6), corrections=np.zeros(CORRECTIONS), pixel_pitch_mm=0.15)
    faint = replace(bright, cubic=factor * bright.polynomials("cubic"))
    no_contact = np.full((16, 16, 3), 100, np.uint8)
    config = replace(faint, reference=no_contact).configuration(columns=16)
    assert config.coefficient_limit == (8 if factor == 1 else 2.0 ** np.ceil(np.log2(1.2 * factor)))
    deviation = np.random.default_rng(1).integers(-3000, 3000, (1, 16, 16, 3)) // factor
    result = polynomial_gradient(deviation, polynomial_words(faint, config), config)
    coefficients = reference.polynomials_at_pixels(16, 16, faint.polynomials("cubic"), 0.15)
    want = reference.weighted(deviation * DEVIATION.lsb, coefficients)
    near = 3 * config.colour_coefficient.lsb * 0.1 / factor + config.gradient_lsb
    assert np.abs(result * config.gradient_lsb - want).max() < near


def test_corrections_are_scaled_at_the_ends_of_the_ranges() -> None:
    for limit, coefficient_limit in itertools.product((2.0**-6, 32.0), (8.0, 256.0)):
        config = Configuration(columns=16, gradient_limit=limit, coefficient_limit=coefficient_limit, **POLYNOMIALS)
        parameters = gradient_parameters(config)
        want = correction_unit(limit) / config.gradient_lsb * 2.0 ** parameters["Drop"]
        assert parameters["CorrectionUnit"] == pytest.approx(want, rel=2.0 ** (1 - UNIT_BITS))


def test_colours_that_show_no_slope_are_refused() -> None:
    nothing = replace(polynomials(6), cubic=np.full((2, 3, 10), 400.0), reference=np.full((16, 16, 3), 100, np.uint8))
    with pytest.raises(InputError, match="accepted are up to 256: colours that change so little"):
        nothing.configuration(columns=16)


# Corrections by colour.


def test_the_entry_of_a_colour_is_the_nearest() -> None:
    deviation = np.array([-1, -0.9999, -15 / 16, -1 / 16, 0, 0.06, 1 / 16, 0.9, 1.99]) / DEVIATION.lsb
    codes = correction_codes(deviation.astype(np.int64))
    assert (codes >> 4).tolist() == [0, 0, 1, 8, 8, 8, 9, 15, 15]


@settings(max_examples=20)
@given(SEED)
def test_corrections_are_added_to_slopes_in_whole_units(seed: int) -> None:
    calibration: Any = polynomials(seed)
    config = Configuration(columns=16, gradient_limit=calibration.gradient_limit, **POLYNOMIALS)
    words, table = polynomial_words(calibration, config), correction_entries(calibration, config)
    deviation = np.random.default_rng(seed).integers(-3000, 3000, (1, 16, 16, 3))
    plain, corrected = (polynomial_gradient(deviation, words, config, table=added) for added in (None, table))
    red, green, blue = np.moveaxis(np.floor(8 * (deviation * DEVIATION.lsb + 1) + 0.5).astype(int), -1, 0)
    want = calibration.corrections[red, green, blue]
    want = correction_units(want, config.gradient_limit) * correction_unit(config.gradient_limit)
    near = np.abs(want) * 2.0**-UNIT_BITS + config.gradient_lsb
    assert (np.abs((corrected - plain) * config.gradient_lsb - want) <= near).all()
