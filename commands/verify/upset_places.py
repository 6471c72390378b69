# SPDX-License-Identifier: Apache-2.0
"""Bits of a pipeline that may flip, by the populations that `make upsets` counts apart.

A place is a register, or the words of a memory. A register that changes as frames stream through, but has the same
values with other pixels and words of tables, is of control, as these reach no handshake and no counter
(docs/verification.md); of those that do not change, what a reset clears.
"""

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np

from commands.common.repository import cores

CONTROL, SOLVER, DATA = "control", "data in the solver", "other data"
MEMORIES, TABLES, SETTINGS = "frame store and line memories", "tables and gains", "settings"
POPULATIONS = (CONTROL, SOLVER, DATA, MEMORIES, TABLES, SETTINGS)

MEMORY = "words"  # name of the words of `td_ram` and `td_rom`
RAM, ROM, TABLE = "td_ram", "td_rom", "td_banked_table"
IN_SOLVER = "u_solver."
OF_SOFTWARE = ("setting_registers", "table_access", "table_banks")  # hold what software has written
ASSIGNED = re.compile(r"(?:^|[;):]|begin|else)\s*(\w+)(?:\[[^\]]*\]|\.\w+)*\s*<=", re.MULTILINE)
JOINED = re.compile(r"\{([\w, .\[\]]+)\}\s*<=")


@dataclass(frozen=True)
class Place:
    """A register, or a memory.

    Attributes
    ----------
    number : int
        Line in the list of tb/upsets_main.cpp.
    path : str
        Names of the instances and blocks around it, below the top, and its own name.
    modules : tuple of str
        Cores around it, the innermost last.
    bits, size, words : int
        Bits of a word, bytes that it takes in the model, words.
    """

    number: int
    path: str
    modules: tuple[str, ...]
    bits: int
    size: int
    words: int

    @property
    def is_memory(self) -> bool:
        return self.modules[-1] in (RAM, ROM) and self.path.endswith(f".{MEMORY}")

    @property
    def is_table(self) -> bool:
        return self.is_memory and (self.modules[-1] == ROM or TABLE in self.modules)


Population = list[tuple[Place, np.ndarray]]  # places with their bits, numbered through all words


@cache
def source(module: str) -> str:
    """Return the source of a module from its first clocked block on, without comments."""
    return re.sub(r"//.*", "", cores()[module].hdl.read_text()).partition("always_ff")[2]


def assigned(text: str) -> frozenset[str]:
    """Return the names to which clocked statements assign."""
    joined = (re.split(r"[.\[]", name.strip())[0] for group in JOINED.findall(text) for name in group.split(","))
    return frozenset((*ASSIGNED.findall(text), *joined))


@cache
def registers_of(module: str) -> frozenset[str]:
    """Return the names to which the clocked blocks of a module assign: registers, and the words of a memory."""
    return assigned(source(module)) | {MEMORY for memory in (RAM, ROM) if module == memory}


@cache
def reset_in(module: str) -> frozenset[str]:
    """Return the registers that a reset clears."""
    blocks = re.findall(r"if \((?:cold_)?rst[^)]*\)\s*(begin.*?\bend\b|[^;]*;)", source(module), re.DOTALL)
    chosen = re.findall(r"\w+\s*<=(?=\s*(?:cold_)?rst \?)", source(module))
    return frozenset().union(*(assigned(f";{block}") for block in (*blocks, *chosen)))


def visible() -> str:
    """Return the configuration of Verilator that keeps the registers and memories of every core, by their names.

    Cores are not joined with those around them, or an output would be a copy of the register outside.
    """
    lines = ["`verilator_config", "lint_off -rule SYMRSVDWORD"]  # of C++, where a core stays a scope of its own
    for core in cores():
        lines.append(f'no_inline -module "{core}"')
        lines += (f'public_flat_rd -module "{core}" -var "{name}"' for name in sorted(registers_of(core)))
    return "\n".join((*lines, ""))


def places(lines: Iterable[str]) -> list[Place]:
    """Return the registers and memories in the list of tb/upsets_main.cpp, without what only has the name of one."""
    rows = [line.split() for line in lines]
    module_of = {scope: module for scope, module, *_ in rows}
    found = []
    for number, (scope, _, name, *numbers, stays) in enumerate(rows):
        inner = scope.split(".")
        above = (module_of.get(".".join(inner[: length + 1]), "") for length in range(len(inner)))
        modules = tuple(module for module in above if module in cores())
        if stays == "1" and modules and name in registers_of(modules[-1]):
            found.append(Place(number, f"{scope.partition('.')[2]}.{name}", modules, *map(int, numbers)))
    return found


def populations(every: Sequence[Place], history: np.ndarray, other: np.ndarray) -> dict[str, Population]:
    """Return the bits of each population.

    Parameters
    ----------
    history, other : uint8 arrays (clocks, bytes)
        Values of all registers while a frame enters, and those with other pixels and tables.
    """
    changes, depends = (np.bitwise_or.reduce(history ^ values, axis=0) for values in (history[0], other))
    found: dict[str, Population] = {name: [] for name in POPULATIONS}
    first = 0
    for place in every:
        if place.is_memory:
            found[TABLES if place.is_table else MEMORIES].append((place, np.arange(place.words * place.bits)))
            continue
        last = first + place.words * place.size
        moves, is_data = (
            np.unpackbits(each[first:last].reshape(place.words, -1), axis=1, bitorder="little")[:, : place.bits].ravel()
            for each in (changes, depends)
        )
        first = last
        if place.modules[-1] in OF_SOFTWARE:
            found[SETTINGS].append((place, np.arange(len(moves))))
            continue
        # A constant bit is of the kind of its register.
        resets = moves.any() or place.path.rpartition(".")[2] in reset_in(place.modules[-1])
        is_control = (is_data == 0) & ((moves != 0) | (resets and not is_data.any()))
        data = SOLVER if IN_SOLVER in place.path else DATA
        for name, bits in ((CONTROL, is_control), (data, ~is_control)):
            found[name].append((place, np.flatnonzero(bits)))
    return {name: [(place, bits) for place, bits in each if len(bits)] for name, each in found.items()}
