# SPDX-License-Identifier: Apache-2.0
"""Modules of a wheel, and its description, README.md with absolute links; pyproject.toml has all else.

A wheel holds the modules that the public ones reach: those that `tactile_depth` names, the command, and each whose path
stands in README.md, in pages or in examples. The other modules model cores for testbenches and commands of the
repository.
"""

import ast
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path

from setuptools import setup
from setuptools.command.build_py import build_py

ROOT = Path(__file__).parent
MODELS = ROOT / "models"
COMMAND = "tactile_depth.cli.main"
NAMED_IN = ("README.md", "docs/**/*.md", "examples/**/*.md", "examples/**/*.py", "examples/**/*.ipynb")
(ADDRESS,) = re.findall(r'^Repository = "(.*)"$', (ROOT / "pyproject.toml").read_text(), re.MULTILINE)


def absolute(link: re.Match[str]) -> str:
    """Return a link or a picture with the address of its file in the repository."""
    return f"{link[1]}({ADDRESS}/{'raw' if link[1].startswith('!') else 'blob'}/main/{link[2]})"


def modules() -> dict[str, Path]:
    """Return each module and package of models/, by its name."""
    files = {file.relative_to(MODELS).with_suffix(""): file for file in MODELS.rglob("*.py")}
    return {".".join(path.parts).removesuffix(".__init__"): file for path, file in files.items()}


def imported(file: Path) -> Iterator[str]:
    """Yield what a module imports, in functions and for type checkers too: modules, and names of modules."""
    for node in ast.walk(ast.parse(file.read_text())):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module:
            yield node.module
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


@cache
def reached() -> set[str]:
    """Return the public modules, and those that they import, directly or through others."""
    texts = (file.read_text() for pattern in NAMED_IN for file in ROOT.glob(pattern))
    paths = [path for text in texts for path in re.findall(r"\btactile_depth(?:\.\w+)+", text)]
    known, waiting, found = modules(), ["tactile_depth", COMMAND, *paths], set()
    while waiting:
        module = waiting.pop()
        if module in known and module not in found:
            found.add(module)
            waiting += [*imported(known[module]), module.rpartition(".")[0]]
    return found


class PublicModules(build_py):
    """Step of a build that takes the modules that the public ones reach, and the files with which packages begin."""

    def find_package_modules(self, package: str, package_dir: str) -> list[tuple[str, str, str]]:
        return [
            found
            for found in super().find_package_modules(package, package_dir)
            if found[1] in ("__init__", "__main__") or f"{package}.{found[1]}" in reached()
        ]


setup(
    cmdclass={"build_py": PublicModules},
    long_description=re.sub(r"(!?\[[^]]*\])\((?!https?:)([^)]+)\)", absolute, (ROOT / "README.md").read_text()),
    long_description_content_type="text/markdown",
)
