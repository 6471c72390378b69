# SPDX-License-Identifier: Apache-2.0
"""td_table_port: RTL against the model; the model's answers."""

from tactile_depth.chip.common.td_table_port import answered


def test_an_answer_is_extended_to_32_bits() -> None:
    assert answered(0b1_0111, 4) == {"high": 0, "low": 7}
    assert answered(0b1010_0111, 4, words=2, signed=True) == {"high": 0xFFFF_FFFA, "low": 7}
    assert answered(0b1010_0111, 4, words=2) == {"high": 0xA, "low": 7}
