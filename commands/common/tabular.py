# SPDX-License-Identifier: Apache-2.0
"""Tables of results, declared once with the fields of a result, and written for a terminal, a page, HTML or CSV.

@dataclass(frozen=True)
class Row:
    grid: Annotated[str, Column("grid")]
    rms: Annotated[float, Column("RMS, codes", ",.1f")]

print(table_of(Row, rows))
"""

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, get_type_hints


@dataclass(frozen=True)
class Column:
    """Column of a table: its head, and a format or a function that shows a value; None shows as -."""

    head: str
    show: str | Callable[[Any], str] = ""

    def cell(self, value: Any) -> str:
        if value is None:
            return "-"
        return format(value, self.show) if isinstance(self.show, str) else self.show(value)


@cache
def columns(kind: type) -> Mapping[str, Column]:
    """Return the columns that a dataclass declares, by field, in their order."""
    hints = get_type_hints(kind, include_extras=True)
    stated = {name: getattr(hint, "__metadata__", ()) for name, hint in hints.items()}
    return {name: each for name, extras in stated.items() for each in extras if isinstance(each, Column)}


def shown(kind: type, rows: Sequence[Any]) -> tuple[list[str], list[list[str]]]:
    """Return head and rows of results, objects or documents, as text: the columns that their dataclass declares."""
    stated = columns(kind)
    values = [row if isinstance(row, Mapping) else vars(row) for row in rows]
    cells = [[column.cell(row[name]) for name, column in stated.items()] for row in values]
    return [column.head for column in stated.values()], cells


def table_of(kind: type, rows: Sequence[Any]) -> str:
    """Return the table of results for a terminal; see `shown`."""
    return table(*shown(kind, rows))


def counts(of: Mapping[str, int]) -> str:
    """Return numbers by name as text."""
    return ", ".join(f"{name} {count:,}" for name, count in of.items()) or "-"


def table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Return a table of Markdown with aligned columns, numbers to the right, that a terminal can show too."""
    columns = list(zip(head, *rows, strict=True))
    widths = [max(map(len, column)) for column in columns]
    numbers = [all(cell[:1] in "+-0123456789" for cell in column[1:]) for column in columns]

    def line(cells: Sequence[str]) -> str:
        padded = (
            cell.rjust(width) if right else cell.ljust(width)
            for cell, width, right in zip(cells, widths, numbers, strict=True)
        )
        return f"| {' | '.join(padded)} |"

    rule = "|".join("-" * (width + 1) + (":" if right else "-") for width, right in zip(widths, numbers, strict=True))
    return "\n".join([line(head), f"|{rule}|", *map(line, rows)])


def compact(head: Sequence[str], rows: Sequence[Sequence[object]]) -> str:
    """Return a table of Markdown without padding, for a page."""
    lines = [head, ["---"] * len(head), *rows]
    return "".join(f"| {' | '.join(map(str, line))} |\n" for line in lines)


def with_tables(page: Path, begin: str, end: str, tables: str) -> str:
    """Return the text of a page with `tables` between its two marks, and the rest as it is."""
    before, _, after = page.read_text().partition(begin)
    return f"{before}{begin}\n\n{tables}\n{end}{after.partition(end)[2]}"


def records(document: Any, indent: str = "") -> str:
    """Return a document as JSON that a repository keeps: each innermost record has a line of its own."""
    named = isinstance(document, dict)
    if named:
        held = [(f"{json.dumps(key)}: ", value) for key, value in document.items()]
    else:
        held = [("", value) for value in document] if isinstance(document, list) else []
    if not any(value and isinstance(value, (dict, list)) for _, value in held):
        return json.dumps(document)
    lines = ",\n".join(f"{indent} {key}{records(value, indent + ' ')}" for key, value in held)
    begin, end = "{}" if named else "[]"
    return f"{begin}\n{lines}\n{indent}{end}"
