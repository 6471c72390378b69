# SPDX-License-Identifier: Apache-2.0
"""polynomial_gradient: RTL against the model, the model against the additions that the RTL makes."""

from pathlib import Path
from typing import Any

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from formal.entries import ROUNDING, Proof
from formal.tables import quadratic_roms
from tactile_depth.common.td_round_saturate import Monitor
from tactile_depth.configuration import Configuration
from tactile_depth.gradient.polynomial_gradient import coefficients, gradient_parameters, slope_codes
from tactile_depth.rom_files import write_quadratic
from tb.structures import ICARUS, VERILATOR, Structure
from tests.rtl import test_rtl as test_rtl

WORDS = (2, 3, 6)


def any_words(width: int, seed: int = 1) -> Any:
    return np.random.default_rng(seed).integers(-(1 << width - 1), 1 << width - 1, WORDS)


def built(width: int, deviation: Any, coefficient: Any, word: Any, drop: int, **runs: Any) -> Structure:
    return Structure(
        {"Width": width, "DeviationWidth": deviation, "CoeffWidth": coefficient, "WordWidth": word, "Drop": drop},
        roms=lambda folder: write_quadratic(folder, any_words(word), word),
        **runs,
    )


STRUCTURES = (
    built(*gradient_parameters(Configuration(columns=16)).values(), on=VERILATOR),
    built(3, 3, 3, 5, 3, on=ICARUS, late=VERILATOR, mutants=True),
    built(*gradient_parameters(Configuration(columns=16, data_width=12, coefficient_width=10)).values()),
    built(14, 4, 5, 9, 0),
    built(*gradient_parameters(Configuration(columns=16, data_width=32, gradient_limit=2.0**-6)).values()),
    built(6, 4, 4, 4, 1),
    built(10, 4, 5, 9, -2),
    built(12, 4, 5, 9, -2),
)
PROOFS = tuple(
    Proof(
        "the coefficient of the pixel's own place, words written or from power-up; latency 11",
        f"additions are exact at any width; the shortest rows; each colour, both axes; {ROUNDING}",
        {"Polynomial": polynomial},
        depth=30,
        roms=quadratic_roms,
    )
    for polynomial in (0, 4, 2)
)


@given(st.integers(0, 2**32 - 1), st.integers(2, 6), st.integers(4, 7), st.sampled_from([6, 32]))
def test_polynomials_run_along_the_raster_by_additions(seed: int, rows: int, columns: int, width: int) -> None:
    words = any_words(width, seed)
    kept = coefficients(words, rows, columns, width, 4)
    a, b, d, e, f, h = (words[..., term] for term in range(6))
    for row in range(rows):
        value, step = a, b
        for column in range(columns):
            low = value % (1 << width)
            expected = (low - (low >> (width - 1) << width)) >> (width - 4)
            np.testing.assert_array_equal(kept[..., row, column], expected)
            value, step = value + step, step + d
        a, e, b = a + e, e + f, b + h


def test_a_sum_of_products_is_rounded_once_to_even_and_saturated() -> None:
    factors = np.array([[3, 1, -2], [1, 1, 1]])[..., None, None]
    deviation = np.array([[[2, 0, 0]], [[0, 1, 0]], [[3, 1, 2]], [[100, 100, -100]]])[None]
    monitor = Monitor()
    factors = np.broadcast_to(factors, (2, 3, 4, 1))
    codes = slope_codes(deviation, factors, 2, 5, monitor)
    assert codes[0, :, 0].tolist() == [[2, 0], [0, 0], [2, 2], [15, 15]]  # 6/4, 2/4; 1/4; 6/4; out of range
    assert monitor.saturations["polynomial_gradient"] == 2


def test_files_hold_every_word(tmp_path: Path) -> None:
    words = np.arange(36).reshape(WORDS) - 18
    write_quadratic(tmp_path, words, 8)
    parts = [int(line, 16) for p in range(6) for line in (tmp_path / f"quadratic_{p}.hex").read_text().split()]
    assert parts == [word % 256 for word in range(-18, 18)]
