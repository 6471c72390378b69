# SPDX-License-Identifier: Apache-2.0
"""Modules import in one direction."""

import ast
import graphlib

from commands.common.repository import ROOT


def test_no_module_imports_itself_through_others() -> None:
    """Circles are also refused inside functions and under TYPE_CHECKING; packages load public names on first use."""
    paths = [(folder, path) for folder in ("models", "commands") for path in (ROOT / folder).rglob("*.py")]
    modules = {
        ".".join(path.relative_to(ROOT / folder.replace("commands", "")).with_suffix("").parts): path
        for folder, path in paths
    }
    imported = {}
    for module, path in modules.items():
        nodes = list(ast.walk(ast.parse(path.read_text())))
        names = {name.name for node in nodes if isinstance(node, ast.Import) for name in node.names}
        for node in nodes:
            if isinstance(node, ast.ImportFrom):
                names |= {str(node.module), *(f"{node.module}.{name.name}" for name in node.names)}
        imported[module] = names & set(modules)
    assert len(imported) > 100
    graphlib.TopologicalSorter(imported).prepare()
