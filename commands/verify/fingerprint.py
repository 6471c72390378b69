# SPDX-License-Identifier: Apache-2.0
"""Fingerprints of all that a result of a core depends on, as the files stand, committed or not.

A proof depends on the RTL of the core and of the parts below it, on the modules of its bench in formal/, on the
protocol, and on PROOFS; mutants on the same RTL and protocol, on the testbench, STRUCTURES and MUTANTS. Of packages,
and of Python in tb/, formal/ and the models, the definitions count that these reach: one that nothing reaches may
change. Comments, docstrings, type hints and white space do not count, nor do commands and tools.
"""

import ast
import hashlib
import re
from collections import defaultdict
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from commands.common import python_code, repository
from commands.common.repository import ROOT
from commands.verify import protocol

KINDS = {"proof": ("PROOFS", "PROTOCOL"), "mutants": ("STRUCTURES", "MUTANTS", "PROTOCOL")}  # and the settings of each
OTHERS = ("NO_PROOF", "REFUSED")  # settings that no result depends on
ANY, REST = "*", ""  # all definitions of a file; its statements that define no name
TOKEN = re.compile(r"[\w$`']+|[()\[\]{},;]|[^\w\s()\[\]{},;]+")
MODULE = re.compile(r"\b(\w+)(?=\s*::|\s*#|\s+\w+\s*\()")  # may be a package or a module that is instantiated
Place = tuple[Path, str]  # a file and a name in it


@dataclass(frozen=True)
class Statement:
    """Statement of Python: its code, the names that it reads, and its texts."""

    code: str
    names: frozenset[str]
    texts: frozenset[str]


@dataclass(frozen=True)
class Source:
    """Python file: the statements that define each name, and the places of names that it imports."""

    defined: Mapping[str, list[Statement]]
    imported: Mapping[str, Place]


def file_of(module: str) -> Path | None:
    """Return the file of a Python module, None for one that is not of this repository."""
    base = (ROOT / "models" if module.split(".")[0] == "tactile_depth" else ROOT).joinpath(*module.split("."))
    return next((file for file in (base.with_suffix(".py"), base / "__init__.py") if file.is_file()), None)


def imports(nodes: Iterable[ast.AST]) -> dict[str, Place]:
    """Return the places of the names that a file imports from this repository, wherever it does."""
    found = {}
    for node in nodes:
        if isinstance(node, ast.ImportFrom) and node.module:
            for each in node.names:
                if file := file_of(f"{node.module}.{each.name}"):
                    found[each.asname or each.name] = file, ANY
                elif file := file_of(node.module):
                    found[each.asname or each.name] = file, each.name
        elif isinstance(node, ast.Import):
            for each in node.names:
                if file := file_of(each.name):
                    found[each.asname or each.name.split(".")[0]] = file, ANY
    return found


def defines(statement: ast.stmt) -> list[str]:
    """Return the names that a statement of a file defines."""
    if isinstance(statement, (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)):
        return [statement.name]
    if isinstance(statement, (ast.Assign, ast.AnnAssign)):
        targets = statement.targets if isinstance(statement, ast.Assign) else [statement.target]
        return [node.id for target in targets for node in ast.walk(target) if isinstance(node, ast.Name)]
    return []


@cache
def read_python(file: Path, _: int) -> Source:
    tree = ast.parse(file.read_text())
    imported = imports(python_code.bare(tree))
    defined = defaultdict(list)
    for each in tree.body:
        if not isinstance(each, (ast.Import, ast.ImportFrom)):
            nodes = list(ast.walk(each))
            names = frozenset(
                node.id for node in nodes if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Load)
            )
            texts = [node.value for node in nodes if isinstance(node, ast.Constant) and isinstance(node.value, str)]
            for name in defines(each) or [REST]:
                defined[name].append(Statement(python_code.code(each), names, frozenset(texts)))
    return Source(defined, imported)


def read(file: Path) -> Source:
    return read_python(file, file.stat().st_mtime_ns)


def reached(places: Iterable[Place]) -> set[str]:
    """Return the code of all definitions of this repository that these places use, and the files of data they name."""
    waiting, seen, found = list(places), set(), set()
    while waiting:
        place = file, name = waiting.pop()
        if place in seen:
            continue
        seen.add(place)
        source = read(file)
        if name in source.imported and name not in source.defined:
            waiting.append(source.imported[name])
            continue
        every = name == ANY or (name not in source.defined and name != REST)
        waiting += [(file, each) for each in (source.defined if every else (REST,))]
        for statement in source.defined.get(name, ()):
            found.add(statement.code)
            waiting += [(file, each) for each in statement.names if each in source.defined or each in source.imported]
            data = [file.parent / text for text in statement.texts if re.fullmatch(r"[\w-]+\.\w+", text)]
            found |= {each.read_text() for each in data if each.is_file()}
    return found


def tests_in(file: Path) -> list[Place]:
    """Return the places of a testbench but for settings that mutants do not depend on, and what these alone use."""
    source = read(file)
    left_out = {*KINDS["proof"], *OTHERS}

    def used(names: Iterable[str]) -> set[str]:
        return {used for name in names for each in source.defined.get(name, ()) for used in each.names}

    alone = used(left_out) - used(source.defined.keys() - left_out)
    return [(file, name) for name in (source.defined.keys() | source.imported.keys()) - left_out - alone]


@cache
def read_rtl(file: Path, _: int) -> tuple[str, frozenset[str]]:
    code = repository.code(file.read_text())
    return " ".join(TOKEN.findall(code)), frozenset(MODULE.findall(code))


def items(package: str) -> list[str]:
    """Cut the tokens of a package behind each definition."""
    cut, item, depth = [], [], 0
    for token in package.split():
        item.append(token)
        depth += (token in "([{") - (token in ")]}")
        if token == "endfunction" or (token == ";" and not depth and "function" not in item):
            cut.append(" ".join(item))
            item = []
    return [*cut, " ".join(item)]


def defined_by(item: str) -> set[str]:
    """Return the names that a definition of a package is reached by; none for one that always counts."""
    if function := re.search(r"\bfunction\b.*?(\w+) \(", item):
        return {function[1]}
    if re.search(r"\btypedef\b", item):
        return {item.split()[-2], *(re.findall(r"\w+", item) if "enum" in item else ())}
    constant = re.search(r"\blocalparam\b[^=]*?(\w+) (\[[^=]*)?=", item)
    return {constant[1]} if constant else set()


def with_packages(texts: set[str]) -> set[str]:
    """Return texts of SystemVerilog, of their packages the definitions alone that the others reach."""
    packages = {text for text in texts if re.search(r"\bpackage \w+ ;", text)}
    found = texts - packages
    waiting = {item: defined_by(item) for package in packages for item in items(package)}
    known: set[str] = set()
    new = set(found)
    while new:
        known |= {word for text in new for word in re.findall(r"\w+", text)}
        new = {item for item, names in waiting.items() if not names or names & known}
        found |= new
        waiting = {item: names for item, names in waiting.items() if item not in new}
    return found


def rtl_below(tops: Iterable[Path]) -> set[str]:
    """Return the tokens of files of SystemVerilog, of those whose modules and packages they use, and so on."""
    waiting, found = list(tops), {}
    while waiting:
        file = waiting.pop()
        if file not in found:
            found[file], names = read_rtl(file, file.stat().st_mtime_ns)
            waiting += [rtl_files()[name] for name in names & rtl_files().keys()]
    return with_packages(set(found.values()))


@cache
def rtl_files() -> dict[str, Path]:
    return {file.stem: file for folder in ("hdl", "formal") for file in (ROOT / folder).rglob("*.sv")}


def words(core: str, name: str) -> set[str]:
    """Return the texts in a setting of a core."""
    settings = repository.cores()[core].settings
    stated = read(settings).defined.get(name, ()) if settings else ()
    return {text for each in stated for text in each.texts}


def fingerprint(core: str, kind: str) -> str:
    """Return a fingerprint of what a result of a core depends on; `kind` is one of KINDS."""
    files = repository.cores()[core]
    settings = files.settings
    own = [(settings, name) for name in KINDS[kind] if settings and name in read(settings).defined]
    body = repository.code(protocol.body(core))
    parts = [rtl_files().get(name) for name in ("offer_stays", *words(core, "PROTOCOL"), *MODULE.findall(body))]
    if kind == "proof":
        below, python = [files.proof, rtl_files().get("assumed")], own
    else:
        below, python = [], own + [place for bench in files.benches for place in tests_in(bench)]
    texts = rtl_below([files.hdl, *filter(None, parts + below)]) | reached(python) | {" ".join(TOKEN.findall(body))}
    return hashlib.sha256("\0".join(sorted(texts)).encode()).hexdigest()[:16]
