# SPDX-License-Identifier: Apache-2.0
"""The format of a fixed-point word."""

from __future__ import annotations

import math
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
