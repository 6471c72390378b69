# SPDX-License-Identifier: Apache-2.0
"""Model of hdl/registers/table_signatures.sv: which tables are in use, by a signature of the words of each."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from tactile_depth.chip.common.signature import START, Captured, signature, signature_step
from tactile_depth.chip.registers.register_map import REGISTERS, TABLES, WORD
from tactile_depth.chip.registers.table_banks import CAPTURES
from tactile_depth.chip.table_entries import ONE_WORD

GRADIENT, REFERENCE, ZERO = (TABLES[name] for name in ("gradient", "reference", "zero"))
OFFSETS = {name: REGISTERS[name].offset for name in ("TABLE_INDEX", "TABLE_HIGH")}
NOT_KNOWN = 0


def table_signatures(entries: Mapping[str, np.ndarray]) -> dict[str, int]:
    """Return the signature of each table of `table_entries`."""
    return {
        name: signature((words[:, :1] if name in ONE_WORD else words[:, ::-1]).ravel().tolist())
        for name, words in entries.items()
    }


def power_up_words(entries: Mapping[str, np.ndarray]) -> list[int]:
    """Return the words of `signatures.hex`: those of both banks of each table."""
    signatures = table_signatures(entries)
    return [signatures.get(name, NOT_KNOWN) for name in TABLES for _ in range(2)]


@dataclass(frozen=True)
class Host:
    """Access of the host in a clock: its table, whether the entry is the first, the word, and what is accessed.

    Attributes
    ----------
    lower, upper, whole : bool
        An entry is written; its upper word is, with all bytes.
    disturbs : bool
        An entry is read, or TABLE_INDEX is written.
    """

    table: int = 0
    first: bool = False
    word: int = 0
    lower: bool = False
    upper: bool = False
    whole: bool = False
    disturbs: bool = False


@dataclass
class TableSignatures:
    """State of the core.

    Attributes
    ----------
    signatures : sequence of int
        Of bank 0 and bank 1 of each table; at first those of power-up.
    side : int
        Words of the zero offset in a step of its capture.
    shown : int
        TABLE_SIGNATURE.
    """

    signatures: Sequence[int] = (NOT_KNOWN,) * 2 * len(TABLES)
    side: int = 1
    shown: int = NOT_KNOWN
    _held: list[bool] = field(default_factory=lambda: [False] * 2 * len(TABLES))  # by capture
    _run: tuple[int, int] | None = None  # table and bank of words that follow one another
    _signature: int = START  # of the words of the run
    _finished: int | None = None  # bank of the run that has ended
    _has_upper: bool = False  # the upper word of the entry has come
    _bus: Host = Host()  # of the clock before
    _host: tuple[int, int, bool] | None = None  # table and word of the one before it, and whether an entry was written

    def __post_init__(self) -> None:
        self.signatures = list(self.signatures)

    def held(self, in_use: int) -> frozenset[str]:
        """Return the tables whose bank in use comes from a capture."""
        return frozenset(name for name in CAPTURES if self._held[_bank(TABLES[name], in_use)])

    def clock(
        self,
        command: Mapping[str, int],
        in_use: int,
        captured: Mapping[int, Captured],
        write_offset: int | None = None,
        write_mask: int = WORD,
        rst: int = 0,
        cold_rst: int = 0,
    ) -> None:
        """Advance by one clock edge.

        Parameters
        ----------
        command : mapping of str to int
            Members of table_command_t.
        in_use : int
            Bank in use of each table, bit by bit.
        captured : mapping of int to Captured
            By table.
        write_offset : int, optional
            Of the register that is written; None without a write.
        """
        table, first, lower, upper = self._bus.table, self._bus.first, self._bus.lower, self._bus.upper
        of_entry = lower or (upper and table == GRADIENT)
        if lower:
            in_order = self._has_upper == (table == GRADIENT)
        else:
            in_order = of_entry and not self._has_upper and self._bus.whole
        starts = [table] * (in_order and first and not self._has_upper and not rst)
        starts += [each for each in captured if captured[each].starts]
        disturbed = (of_entry and not in_order) or self._bus.disturbs or rst

        finished, signatures = self._finished, list(self.signatures)
        if finished is None:
            self.shown = signatures[_bank(command["select"], in_use)]
        else:
            signatures[finished] = self._signature
        self._finished = self._step(captured, in_use, first, bool(disturbed), not starts)
        if starts:
            self._run, self._signature = (starts[0], ~in_use >> starts[0] & 1), START
        self._run = None if rst else self._run
        self._host = (table, self._bus.word, lower) if in_order and not rst else None
        self._has_upper = not rst and (upper and in_order if upper or lower else self._has_upper)

        writers = [(table, False)] * lower + [(each, True) for each in captured if captured[each].writes]
        for each, captures in writers:
            free = _bank(each, ~in_use)
            signatures[free], self._held[free] = NOT_KNOWN, captures
        if cold_rst:
            signatures, self._held = [NOT_KNOWN] * len(signatures), [False] * len(signatures)
        self.signatures = signatures
        is_upper, moves = (write_offset == OFFSETS[name] for name in ("TABLE_HIGH", "TABLE_INDEX"))
        accesses = bool(command["write"]), is_upper, write_mask == WORD, bool(command["read"] or moves)
        self._bus = Host(command["select"], not command["index"], command["low"], *(() if rst else accesses))

    def _step(
        self, captured: Mapping[int, Captured], in_use: int, first: bool, disturbed: bool, stays: bool
    ) -> int | None:
        """Take the words of a cycle; return the bank whose run they end."""
        steps = {each: (word.word, word.ends) for each, word in captured.items() if word.steps}
        if self._host is not None:
            table, word, lower = self._host
            other, ends = steps.get(table, (0, 0))
            steps[table] = word | other, ends or (lower and first)
        if not steps:
            self._run = None if disturbed or self._run is None or self._lost(in_use) else self._run
            return None
        for _ in range(self.side - 1 if captured[ZERO].steps else 0):
            self._signature = signature_step(self._signature, 0)
        words = 0
        for word, _ in steps.values():
            words |= word
        self._signature = signature_step(self._signature, words)
        run, ended = self._run, any(end for _, end in steps.values())
        if run is None or disturbed or self._lost(in_use) or {run[0]} != steps.keys():
            self._run = None
            return None
        self._run = None if ended else run
        return 2 * run[0] + run[1] if ended and stays else None

    def _lost(self, in_use: int) -> bool:
        """Return True if frames use the bank of the run."""
        assert self._run is not None
        table, bank = self._run
        return in_use >> table & 1 == bank


def _bank(table: int, banks: int) -> int:
    return 2 * table + (banks >> table & 1)
