# SPDX-License-Identifier: Apache-2.0
"""Cycle-accurate model of hdl/link/depth_value.sv."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tactile_depth.chip.common.td_round_saturate import round_saturate
from tactile_depth.chip.fixed_point import codes
from tactile_depth.chip.link.depth_formats import SHORT_BITS


@dataclass
class DepthValue:
    """Sum of the codes of a value, the rounded one, and the value; None before the first code."""

    width: int
    sum: int | None = None
    rounded: int | None = None
    value: int | None = None

    def clock(self, *, average: int, shift: int, in_valid: int, in_first: int, in_code: int) -> dict[str, int | None]:
        """Advance by one clock edge; return the outputs before it, None where one does not count."""
        out = {"value": self.value}
        self.value, self.rounded = self.rounded, None
        if self.sum is not None:
            self.rounded = int(round_saturate(np.array(self.sum), shift + 2, SHORT_BITS))
        if in_valid and (in_first or self.sum is not None):
            (code,) = codes(in_code, 1, self.width)
            total = (0 if in_first else self.sum or 0) + (code if average else 4 * code)
            (self.sum,) = codes(total, 1, self.width + 2)
        return out
