# SPDX-License-Identifier: Apache-2.0
"""The form of all SystemVerilog: licence, length, no net without a declaration, one module in a file of its name."""

import re
from pathlib import Path

import pytest

from commands.common import repository

FOLDERS = ("hdl", "formal", "tb", "boards", "examples")
FILES = sorted(path for folder in FOLDERS for path in (repository.ROOT / folder).rglob("*.sv"))
LONGEST_CORE, LONGEST_TOP = 250, 200  # lines


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_a_net_needs_a_declaration_in_every_file(path: Path) -> None:
    """The directive holds from the header on to the last line, which leaves files behind it as they would be alone."""
    text = path.read_text()
    assert text.startswith("// SPDX-License-Identifier: Apache-2.0\n")
    assert re.match(r"(//.*\n)+\n(`timescale .*\n\n)?`default_nettype none\n", text)
    assert text.endswith("\n`default_nettype wire\n")


@pytest.mark.parametrize("path", repository.sources(), ids=lambda path: path.stem)
def test_a_file_is_one_module_of_at_most_so_many_lines(path: Path) -> None:
    text = path.read_text()
    assert re.findall(r"^(?:module|package) (\w+)", text, re.MULTILINE) == [path.stem]
    assert len(text.splitlines()) <= (LONGEST_TOP if path.stem == "tactile_depth" else LONGEST_CORE)
