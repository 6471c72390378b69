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
from tactile_depth.pictures.doubts import Doubt, doubt

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


def reference_doubts(pipeline: Pipeline, unseen: Iterable[str]) -> list[Doubt]:
    """Doubt frames of a device's camera if its reference is none that the camera gave: nobody has compared the two.

    Parameters
    ----------
    unseen : iterable of str
        Tables that come from captures whose pictures this program did not send.
    """
    if not pipeline.config.flat_field or "reference" in unseen:
        return []
    text = "the reference is not from the device's own camera: heights are wrong if that sees the gel otherwise"
    remedy = "with the gel untouched call capture_reference() and capture_zero(), or press r in tactile-depth live"
    return [doubt("reference of a camera", text, remedy=remedy)]


def require_same_pipeline(
    pipeline: Pipeline, loaded: dict[str, int], in_use: dict[str, int], unseen: Iterable[str]
) -> None:
    """Raise DeviceError if a pipeline has made captures since its tables were loaded, which the device does not have.

    Parameters
    ----------
    loaded, in_use : dict of str to int
        Signatures of its tables then, and of those that the device uses.
    unseen : iterable of str
        Tables that come from captures of the device's camera, whatever the pipeline has.
    """
    words = {name: word for name, word in signatures_of(pipeline).items() if name not in unseen}
    if differing := [name for name, word in words.items() if word not in (loaded[name], in_use[name])]:
        problem = f"the pipeline has another {' and another '.join(differing)} than was loaded"
        raise DeviceError(problem, remedy="call load()")


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
