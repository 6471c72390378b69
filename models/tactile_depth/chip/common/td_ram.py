# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/common/td_ram.sv: an array that is read, then written, in each clock."""

from __future__ import annotations

from collections.abc import Iterable


def ram(
    words: list[int | None], clocks: Iterable[tuple[bool, int, int, bool, int]]
) -> tuple[list[int | None], list[int | None]]:
    """Return the contents after all cycles, and read_data after each cycle.

    Each of `clocks` is (write_en, write_address, write_data, read_en, read_address).

    None stands for an unknown value: a word never written, or read_data before the first read.
    """
    words, read_data, out = list(words), None, []
    for write_en, write_address, write_data, read_en, read_address in clocks:
        read_data = words[read_address] if read_en else read_data
        if write_en:
            words[write_address] = write_data
        out.append(read_data)
    return words, out
