# SPDX-License-Identifier: Apache-2.0
"""Model of `signature_step` of hdl/td_types_pkg.sv: a signature of words, in which every changed word shows."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

START = 0xFFFF_FFFF
"""Signature of no words."""
POLYNOMIAL = 0xEDB8_8320


@dataclass(frozen=True)
class Captured:
    """Members of captured_t in hdl/td_types_pkg.sv: what a capture writes in a clock, and of whose words."""

    writes: int = 0
    starts: int = 0
    steps: int = 0
    ends: int = 0
    word: int = 0

    @property
    def bits(self) -> int:
        """The vector of the struct."""
        return self.writes << 35 | self.starts << 34 | self.steps << 33 | self.ends << 32 | self.word & START


def signature_step(before: int, word: int) -> int:
    """Return the signature of the words before and one more, of which the lower 32 bits count."""
    return before >> 1 ^ (POLYNOMIAL if before & 1 else 0) ^ word & START


def signature(words: Iterable[int], start: int = START) -> int:
    """Return the signature of words, as registers show it; 0 there says that it is not known."""
    result = start
    for word in words:
        result = signature_step(result, word)
    return result
