# SPDX-License-Identifier: Apache-2.0
"""Tables of Markdown: aligned, so that a terminal can show them too, and compact, for pages."""

from collections.abc import Sequence
from pathlib import Path


def table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Return a table of Markdown with aligned columns, numbers to the right."""
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
    """Return a table of Markdown without padding."""
    lines = [head, ["---"] * len(head), *rows]
    return "".join(f"| {' | '.join(map(str, line))} |\n" for line in lines)


def with_tables(page: Path, begin: str, end: str, tables: str) -> str:
    """Return the text of a page with `tables` between its two marks, and the rest as it is."""
    before, _, after = page.read_text().partition(begin)
    return f"{before}{begin}\n\n{tables}\n{end}{after.partition(end)[2]}"
