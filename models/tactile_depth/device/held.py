# SPDX-License-Identifier: Apache-2.0
"""Tables that a device holds, by their signatures, and those that a pipeline wants."""

from __future__ import annotations

from collections.abc import Iterable

from tactile_depth.chip.registers.register_map import REGISTERS
from tactile_depth.chip.registers.table_banks import CAPTURES
from tactile_depth.chip.registers.table_signatures import table_signatures
from tactile_depth.chip.table_entries import table_entries
from tactile_depth.depth.pipeline import Pipeline
from tactile_depth.device.channel import Channel
from tactile_depth.device.errors import DeviceError
from tactile_depth.device.registers import read_words, write_words
from tactile_depth.device.tables import pending, select

SELECT, SIGNATURE = "TABLE_SELECT", "TABLE_SIGNATURE"


def signatures_of(pipeline: Pipeline) -> dict[str, int]:
    """Return the signature of each table of a pipeline."""
    return table_signatures(table_entries(pipeline.sensor, pipeline.config, pipeline.zero_codes))


def read_signatures(line: Channel, names: Iterable[str]) -> dict[str, int]:
    """Return the signatures of tables that a device uses, 0 where it does not know one."""
    selected, signatures = read_words(line, [SELECT])[SELECT], {}
    for name in names:
        write_words(line, [select(name)])
        signatures[name] = read_words(line, [SIGNATURE])[SIGNATURE]
    write_words(line, [(SELECT, selected)])
    return signatures


def captured(line: Channel) -> list[str]:
    """Return the tables in use that come from a capture."""
    words = read_words(line, [register.name for register in CAPTURES.values()])
    return [name for name, each in CAPTURES.items() if words[each.name] & REGISTERS[each.name].field("held").mask]


def require_tables(line: Channel, expected: dict[str, int], is_settled: bool = True) -> None:
    """Raise DeviceError, which names what differs, unless a device uses the tables of these signatures.

    With `is_settled` none may be about to change either.
    """
    if is_settled and (changing := pending(line, True)):
        problem = f"tables of the device are about to change ({', '.join(changing)})"
        raise DeviceError(problem, remedy="call load() first")
    signatures = read_signatures(line, expected)
    if differing := [name for name, wanted in expected.items() if signatures[name] != wanted]:
        problem = f"tables of the device are not those of this program ({', '.join(differing)})"
        raise DeviceError(problem, remedy="call load() first")
