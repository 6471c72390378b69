# SPDX-License-Identifier: Apache-2.0
"""polynomial_gradient: RTL against the model, the model against the additions that the RTL makes."""

from pathlib import Path
from typing import Any

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from tactile_depth.chip.common.td_round_saturate import Monitor
from tactile_depth.chip.gradient.polynomial_gradient import coefficients, slope_codes
from tactile_depth.chip.rom_files import write_polynomials
from tb.gradient.tb_polynomial_gradient import WORDS, any_words


@given(st.integers(0, 2**32 - 1), st.integers(2, 6), st.integers(4, 12), st.sampled_from([(6, 2), (32, 4)]))
def test_polynomials_run_along_the_raster_by_additions(seed: int, rows: int, columns: int, widths: Any) -> None:
    width, fine = widths
    words = any_words(width, seed)
    kept = coefficients(words, rows, columns, width, fine, 4)
    a, b, d, t, e, f, h, u, g, w = (words[..., n] if n in (3, 7, 8, 9) else words[..., n] << fine for n in range(10))
    total = width + fine
    for row in range(rows):
        value, step, second = a, b, d
        for column in range(columns):
            low = value % (1 << total)
            expected = (low - (low >> (total - 1) << total)) >> (total - 4)
            np.testing.assert_array_equal(kept[..., row, column], expected)
            value, step, second = value + step, step + second, second + t
        a, e, f, b, h, d = a + e, e + f, f + u, b + h, h + g, d + w


def test_a_sum_of_products_is_rounded_once_to_even_and_saturated() -> None:
    factors = np.array([[3, 1, -2], [1, 1, 1]])[..., None, None]
    deviation = np.array([[[2, 0, 0]], [[0, 1, 0]], [[3, 1, 2]], [[100, 100, -100]]])[None]
    monitor = Monitor()
    factors = np.broadcast_to(factors, (2, 3, 4, 1))
    codes = slope_codes(deviation, factors, 2, 5, monitor)
    assert codes[0, :, 0].tolist() == [[2, 0], [0, 0], [2, 2], [15, 15]]  # 6/4, 2/4; 1/4; 6/4; out of range
    assert monitor.saturations["polynomial_gradient"] == 2


def test_files_hold_every_word(tmp_path: Path) -> None:
    words = np.arange(60).reshape(WORDS) - 30
    write_polynomials(tmp_path, words, 8)
    parts = [int(line, 16) for p in range(6) for line in (tmp_path / f"polynomial_{p}.hex").read_text().split()]
    assert parts == [word % 256 for word in range(-30, 30)]
