# SPDX-License-Identifier: Apache-2.0
"""wide_row_pairs: RTL against the model, the order of its words."""

import numpy as np
import pytest

from tactile_depth.chip.poisson.transform.orders import mirror
from tactile_depth.chip.poisson.transform.wide_row_pairs import rows_of_bursts, up_positions, wide_row_pairs


@pytest.mark.parametrize(("size", "words"), [(16, 2), (16, 8), (64, 4), (128, 64)])
def test_a_mode_and_its_mirror_are_in_one_beat(size: int, words: int) -> None:
    order = up_positions(size, words)
    assert sorted(order.ravel()) == list(range(size))
    for beat in order:
        assert set(mirror(size)[beat]) == set(beat)


def test_a_row_alone_has_zeros_beside_it() -> None:
    bursts = np.arange(1, 65).reshape(2, 8, 4)
    rows = rows_of_bursts(bursts, np.array([True, False]))
    assert not rows[0, 1].any()
    assert rows[1, 1].all()


def test_pairs_are_the_modes_of_a_complex_row() -> None:
    a, b = np.random.default_rng(1).integers(-1000, 1000, (2, 16))
    re, im = wide_row_pairs(a, b, 27)
    complex_row = a + 1j * b
    mirrored = complex_row[mirror(16)]
    mirrored[0] = 0
    np.testing.assert_array_equal(re + 1j * im, mirrored + 1j * complex_row)


def test_sums_saturate() -> None:
    a, b = np.full(8, 127), np.full(8, -128)
    re, im = wide_row_pairs(a, b, 8)
    assert re.tolist() == [127] * 8
    assert im.tolist() == [127, *[-1] * 7]
