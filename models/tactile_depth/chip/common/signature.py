# SPDX-License-Identifier: Apache-2.0
"""Model of `signature_step` of hdl/td_types_pkg.sv: a signature of words, in which every changed word shows."""

from __future__ import annotations

from collections.abc import Iterable

START = 0xFFFF_FFFF
"""Signature of no words."""
POLYNOMIAL = 0xEDB8_8320


def signature_step(before: int, word: int) -> int:
    """Return the signature of the words before and one more, of which the lower 32 bits count."""
    return before >> 1 ^ (POLYNOMIAL if before & 1 else 0) ^ word & START


def signature(words: Iterable[int]) -> int:
    """Return the signature of words, as registers show it; 0 there says that it is not known."""
    result = START
    for word in words:
        result = signature_step(result, word)
    return result
