# SPDX-License-Identifier: Apache-2.0
"""Cycle-accurate model of hdl/common/td_parity_rom.sv: a memory that nobody writes."""

from __future__ import annotations

from typing import Any

from tactile_depth.chip.common.td_parity_ram import ParityRam


class ParityRom(ParityRam):
    """Words of a file; with `parity` each has its parity on top."""

    def clock(self, **pins: Any) -> dict[str, int | None]:
        """Advance by one clock edge; return the outputs before it, None where one is not known."""
        out = super().clock(**pins, read_en=pins["en"], read_address=pins["address"], write_en=0)
        return {"data": out["read_data"], "flipped": out["flipped"]}
