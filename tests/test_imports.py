# SPDX-License-Identifier: Apache-2.0
"""Modules import in one direction."""

import ast
import graphlib
import importlib
import importlib.util
import re

import pytest

import tactile_depth as td
from commands.common.repository import HDL, ROOT
from tactile_depth.base import moved

UNITS = [path.name for path in HDL.iterdir() if path.is_dir()]


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


@pytest.mark.parametrize("old", [*moved.NEW, *moved.GONE])
def test_an_old_path_names_the_new_one(old: str) -> None:
    """A room with the name of an old module names it for what that module held."""
    name = f"tactile_depth.{old}.something" if old in moved.ROOMS else f"tactile_depth.{old}"
    with pytest.raises(ImportError, match=moved.NEW.get(old, "commands/")):
        importlib.import_module(name)
    assert old in moved.GONE or importlib.util.find_spec(f"tactile_depth.{moved.NEW[old]}")


def test_the_package_shows_public_names_alone() -> None:
    importlib.import_module("tactile_depth.depth.pipeline")
    assert dir(td) == sorted([*td.__all__, "__version__"])


def test_rooms_import_in_one_direction() -> None:
    """Rooms are the first folders of the package, and inside chip/ the folders of hdl/."""
    package = ROOT / "models" / "tactile_depth"
    for folder, rooms in ((package, [*moved.ROOMS, "device", "cli"]), (package / "chip", UNITS)):
        prefix = ".".join(folder.relative_to(ROOT / "models").parts)
        arrows = {
            room: {
                name
                for path in (folder / room).rglob("*.py")
                for name in re.findall(rf"^ *(?:from|import) {prefix}\.(\w+)", path.read_text(), re.MULTILINE)
                if name in rooms and name != room
            }
            for room in rooms
            if "." not in room
        }
        graphlib.TopologicalSorter(arrows).prepare()
