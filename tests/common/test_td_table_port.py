# SPDX-License-Identifier: Apache-2.0
"""td_table_port: RTL against the model; the model's answers."""

from typing import Any

from formal.entries import Proof
from tactile_depth.chip.common.td_table_port import answered
from tb.structures import ICARUS, VERILATOR, Structure
from tests.rtl import test_rtl as test_rtl


def built(select: int, index: int, width: int, words: int, signed: int, entries: int = 1, **runs: Any) -> Structure:
    numbers = {"Select": select, "IndexWidth": index, "Width": width, "Words": words, "Signed": signed}
    return Structure({**numbers, "Entries": entries}, **runs)


STRUCTURES = (
    built(3, 8, 24, 1, 1, on=VERILATOR),
    built(0, 3, 2, 2, 1, on=ICARUS, mutants=True),
    built(2, 5, 3, 1, 0, on=ICARUS, mutants=True),
    built(1, 6, 32, 1, 1),
    built(2, 10, 24, 1, 0),
    built(0, 12, 21, 2, 1),
    built(2, 4, 5, 1, 1, entries=3, on=ICARUS, mutants=True),
    built(3, 6, 24, 1, 0, entries=4, on=VERILATOR),
)
REFUSED = dict.fromkeys(("Width=33", "Words=3"), "an_entry_is_1_or_2_words_of_at_most_32_bits")
PROOFS = tuple(
    Proof(
        "an access of its own table one clock later, of no other; the entry read, extended, while it is named",
        "words are only copied and extended; of one word, and of two; one entry, two and three side by side",
        {"Signed": signed, "Words": words, "Entries": entries},
    )
    for signed, words, entries in ((1, 2, 1), (0, 1, 3), (1, 2, 2))
)


def test_an_answer_is_extended_to_32_bits() -> None:
    assert answered(0b1_0111, 4) == {"high": 0, "low": 7}
    assert answered(0b1010_0111, 4, words=2, signed=True) == {"high": 0xFFFF_FFFA, "low": 7}
    assert answered(0b1010_0111, 4, words=2) == {"high": 0xA, "low": 7}
