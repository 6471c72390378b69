# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/rom.sv: an array."""

from __future__ import annotations

from collections.abc import Iterable, Sequence


def rom(words: Sequence[int], addresses: Iterable[int]) -> list[int]:
    """What each address reads, one clock later."""
    return [words[address] for address in addresses]
