# SPDX-License-Identifier: Apache-2.0
"""Tables of Markdown, aligned so that a terminal can show them too."""

from collections.abc import Sequence


def table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Return a table of Markdown with aligned columns, numbers to the right."""
    columns = list(zip(*rows, strict=True))
    widths = [max(map(len, column)) for column in zip(head, *rows, strict=True)]
    numbers = [all(cell[:1] in "+-0123456789" for cell in column) for column in columns]

    def line(cells: Sequence[str]) -> str:
        padded = (
            cell.rjust(width) if right else cell.ljust(width)
            for cell, width, right in zip(cells, widths, numbers, strict=True)
        )
        return f"| {' | '.join(padded)} |"

    rule = "|".join("-" * (width + 1) + (":" if right else "-") for width, right in zip(widths, numbers, strict=True))
    return "\n".join([line(head), f"|{rule}|", *map(line, rows)])
