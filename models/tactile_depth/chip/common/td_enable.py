# SPDX-License-Identifier: Apache-2.0
"""Cycle-accurate model of hdl/common/td_enable.sv."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass
class Enable:
    """State of the register."""

    en: int = 0

    def clock(self, *, rst: int, en_next: int) -> dict[str, int | None]:
        """Advance by one clock edge; return the output before it."""
        before, self.en = self.en, en_next & ~rst
        return {"en": before}
