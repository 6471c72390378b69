# SPDX-License-Identifier: Apache-2.0
"""Members by name of the packed structs in hdl/td_types_pkg.sv, which a simulator shows as vectors."""

from __future__ import annotations

import re
from collections.abc import Mapping
from functools import cache, lru_cache
from typing import Any

from commands.common.repository import HDL

SOURCE = HDL / "td_types_pkg.sv"
STRUCT = re.compile(r"typedef struct packed \{(.*?)\} (\w+);", re.DOTALL)
MEMBER = re.compile(r"^ +(\w+) +(?:\[(\d+):0\] +)?(\w+);", re.MULTILINE)


@cache
def members(name: str) -> dict[str, tuple[int, int]]:
    """Return the members of a struct and of the structs inside it: name to lowest bit and width.

    Raises
    ------
    KeyError
        The package has no such struct.
    """
    structs = {struct: MEMBER.findall(body) for body, struct in STRUCT.findall(SOURCE.read_text())}
    places: dict[str, tuple[int, int]] = {}
    low = 0
    for kind, top, member in reversed(structs[name]):
        inner = members(kind) if kind in structs else {}
        width = sum(bits for _, bits in inner.values()) if inner else int(top or 0) + 1
        places |= {part: (low + place, bits) for part, (place, bits) in inner.items()} or {member: (low, width)}
        low += width
    return places


def pack(name: str, values: Mapping[str, int]) -> int:
    """Return the vector of a struct with these members, all others 0.

    Raises
    ------
    ValueError
        A value does not fit its member.
    """
    word = 0
    for member, value in values.items():
        low, width = members(name)[member]
        if not 0 <= value < 1 << width:
            raise ValueError(f"{name}.{member}={value} does not fit {width} bits")
        word |= value << low
    return word


def unpack(name: str, word: int) -> dict[str, int]:
    """Return the members of a vector, unsigned."""
    return dict(_unpacked(name, word))


@lru_cache(maxsize=1024)
def _unpacked(name: str, word: int) -> dict[str, int]:
    return {member: word >> low & (1 << width) - 1 for member, (low, width) in members(name).items()}


def of(handle: Any, name: str) -> dict[str, int | None]:
    """Return the members of a signal, unsigned; None where a bit is unknown."""
    return dict(_shown(name, handle._handle.get_signal_val_binstr()))


@lru_cache(maxsize=1024)
def _shown(name: str, bits: str) -> dict[str, int | None]:
    """Return the members of a vector of which bits may be unknown."""
    places = {member: (len(bits) - low - width, len(bits) - low) for member, (low, width) in members(name).items()}
    words = {member: bits[begin:end] for member, (begin, end) in places.items()}
    return {member: int(word, 2) if set(word) <= {"0", "1"} else None for member, word in words.items()}
