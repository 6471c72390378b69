# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/common/td_rom.sv: a table of words."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

LATENCY = 1


def rom(words: Sequence[int], addresses: Iterable[int]) -> list[int]:
    """Return the word at each address, which leaves one cycle later."""
    return [words[address] for address in addresses]
