# SPDX-License-Identifier: Apache-2.0
"""Tables of results, declared once with the fields of a result, and written for a terminal, a page or HTML.

@dataclass(frozen=True)
class Row:
    grid: Annotated[str, Column("grid")]
    rms: Annotated[float, Column("RMS, codes", ",.1f")]

print(shown(Row, rows))
"""

import html
import json
import textwrap
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

from tactile_depth.base.declared import declared


@dataclass(frozen=True)
class Column:
    """Column of a table: its head, and a format or a function that shows a value; None shows as -."""

    head: str
    show: str | Callable[[Any], str] = ""

    def cell(self, value: Any) -> str:
        if value is None:
            return "-"
        return format(value, self.show) if isinstance(self.show, str) else self.show(value)


class Table(NamedTuple):
    """Head and rows of a table, and a title or a sentence for above it."""

    head: Sequence[str]
    rows: Sequence[Sequence[object]]
    title: str = ""

    def __str__(self) -> str:
        """Return Markdown with aligned columns, numbers to the right, that a terminal can show too."""
        columns = [list(map(str, column)) for column in zip(self.head, *self.rows, strict=True)]
        numbers = [all(cell[:1] in "+-0123456789" for cell in column[1:]) for column in columns]
        widths = [max(map(len, column)) for column in columns]
        padded = [
            [cell.rjust(width) if right else cell.ljust(width) for cell in column]
            for column, width, right in zip(columns, widths, numbers, strict=True)
        ]
        head, *lines = (f"| {' | '.join(line)} |" for line in zip(*padded, strict=True))
        ends = ("-" * (width + 1) + (":" if right else "-") for width, right in zip(widths, numbers, strict=True))
        above = f"{self.title}\n\n" if self.title else ""
        return above + "\n".join([head, f"|{'|'.join(ends)}|", *lines])

    def markdown(self) -> str:
        """Return Markdown without padding, for a page."""
        lines = [self.head, ["---"] * len(self.head), *self.rows]
        above = f"{textwrap.fill(self.title, 120)}\n\n" if self.title else ""
        return above + "".join(f"| {' | '.join(map(str, line))} |\n" for line in lines)

    def html(self) -> str:
        """Return HTML; a table that is wider than the page scrolls inside itself."""

        def line(cells: Sequence[object], tag: str) -> str:
            return "<tr>" + "".join(f"<{tag}>{html.escape(str(cell))}</{tag}>" for cell in cells) + "</tr>"

        above = f"<h3>{html.escape(self.title)}</h3>" if self.title else ""
        lines = f"{line(self.head, 'th')}{''.join(line(row, 'td') for row in self.rows)}"
        return f"{above}<div class='scroll' tabindex='0'><table>{lines}</table></div>"


def shown(kind: type, rows: Sequence[Any]) -> Table:
    """Return the table of results, objects or documents: the columns that their dataclass declares."""
    stated = declared(kind, Column)
    values = [row if isinstance(row, Mapping) else vars(row) for row in rows]
    cells = [[column.cell(row[name]) for name, column in stated.items()] for row in values]
    return Table([column.head for column in stated.values()], cells)


def span(values: Iterable[float], form: str) -> str:
    """Return the least and the greatest value as text."""
    each = list(values)
    return f"{min(each):{form}} to {max(each):{form}}"


def counts(of: Mapping[str, int]) -> str:
    """Return numbers by name as text."""
    return ", ".join(f"{name} {count:,}" for name, count in of.items()) or "-"


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
