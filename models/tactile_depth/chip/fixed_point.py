# SPDX-License-Identifier: Apache-2.0
"""The format of a fixed-point word."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(frozen=True)
class Format:
    """A signed fixed-point word: value = code * 2**-fraction."""

    width: int
    fraction: int

    @classmethod
    def holding(cls, bound: float, width: int) -> Format:
        """Return the finest format of `width` bits that holds every magnitude up to `bound`."""
        return cls(width, width - 1 - math.ceil(math.log2(bound * (1 + 2.0 ** (2 - width)))))

    @property
    def limit(self) -> float:
        """Full scale, exclusive."""
        return 2.0 ** (self.width - 1 - self.fraction)

    @property
    def lsb(self) -> float:
        return 2.0**-self.fraction


def split(entry: int, words: int, width: int) -> list[int]:
    """Return the words in a number, the first in the lowest bits."""
    return [entry >> width * place & (1 << width) - 1 for place in range(words)]


def codes(entry: int, words: int, width: int) -> list[int]:
    """Return the signed words in a number, the first in the lowest bits."""
    sign = 1 << width - 1
    return [(word ^ sign) - sign for word in split(entry, words, width)]


def joined(words: Sequence[int], width: int) -> int:
    """Return the number with these words in it."""
    return sum((word & (1 << width) - 1) << width * place for place, word in enumerate(words))
