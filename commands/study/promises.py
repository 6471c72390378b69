# SPDX-License-Identifier: Apache-2.0
"""docs/promises.json: promises of README.md and of pages in docs/, each with what holds it.

A promise is a part of a sentence, quoted as it stands in its page. What holds it is a test or a function of a
testbench, as `tests/test_x.py::test_y`, or a command of make; `make formal CORE=a,b` runs the proofs of these cores.
`make figures` writes the table docs/generated/promises.md; tests/test_promises.py checks that nothing is missing.
"""

import json
import os
import re
from collections.abc import Iterator
from pathlib import Path

from commands.common.repository import GENERATED, ROOT
from commands.common.tabular import Table

SOURCE = ROOT / "docs" / "promises.json"
PAGE = GENERATED / "promises.md"
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
TEXT = """<!-- SPDX-License-Identifier: Apache-2.0 -->
<!-- written by make figures from docs/promises.json -->
# Promises

{number} promises of the README and of the pages, and what holds each: a test (below `tests/`), a testbench (below
`tb/`), or a command; `make formal` runs proofs. `tests/test_promises.py` fails if a promise no longer stands in its
page, if a check does not exist, or if a sentence with a word such as *never* is not listed here.

"""
FIGURES = r"^<!-- figures:.*?^<!-- end of figures -->$"
CODE = r"^```.*?^```$|^    [^\n]*$"
COMMENT = r"^<!--.*?-->$"
NO_TEXT = re.compile(f"{FIGURES}|{CODE}|{COMMENT}", re.MULTILINE | re.DOTALL)
BLOCK = re.compile(r"\n\n|\n(?=\s*(?:[-*|#]|\d+\.) )")  # before a paragraph, an item, a row of a table, a heading
SENTENCE = re.compile(r"(?<=[.?!])\s+(?=[A-Z`*\[])")


def load() -> dict[str, dict[str, list[str]]]:
    """Return by page, named from the root, each promise with what holds it."""
    promises: dict[str, dict[str, list[str]]] = json.loads(SOURCE.read_text())
    return promises


def sentences(page: Path) -> Iterator[str]:
    """Yield each sentence of a page, and each row of its tables but those of figures, on one line."""
    for block in BLOCK.split(NO_TEXT.sub("", page.read_text())):
        yield from SENTENCE.split(" ".join(block.split()))


def link(page: str) -> str:
    """Return the link from `PAGE` to a page."""
    return f"[{Path(page).name}]({os.path.relpath(ROOT / page, GENERATED)})"


def document() -> str:
    """Return the text of `PAGE`."""
    rows = [
        (link(page), text, ", ".join(f"`{check}`" for check in checks))
        for page, listed in load().items()
        for text, checks in listed.items()
    ]
    return TEXT.format(number=len(rows)) + Table(("page", "promise", "held by"), rows).markdown()
