# SPDX-License-Identifier: Apache-2.0
"""docs/figures.json: figures of runs that take minutes, each under its command line with its commit and sources.

A command whose line is a key of that file writes its figures there; `make figures` makes the tables of pages from it.
To record one more run, add its line with `{}` and run it.
"""

import hashlib
import importlib
import json
import sys
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from commands.common import python_code, repository
from commands.common.repository import ROOT, git

RESULTS = ROOT / "docs" / "figures.json"
SOURCES = ("hdl", "models", "boards", "commands", "constraints")


def load() -> dict[str, dict[str, Any]]:
    results: dict[str, dict[str, Any]] = json.loads(RESULTS.read_text())
    return results


def latest(command: str) -> dict[str, Any] | None:
    """Return the last entry with figures among the lines of a command, as `presses`; None without any."""
    lines = [entry for line, entry in sorted(load().items()) if line.split()[1] == command and "figures" in entry]
    return lines[-1] if lines else None


def save(results: Mapping[str, Any]) -> None:
    """Write the file, a line for each run."""
    lines = (f"{json.dumps(line)}: {json.dumps(entry)}" for line, entry in sorted(results.items()))
    RESULTS.write_text("{\n" + ",\n".join(lines) + "\n}\n")


def command_line(command: str, arguments: Sequence[str]) -> str:
    """Return a command as it is written in the file, variables in the order of their names."""
    return " ".join(["make", command, *sorted(arguments)])


def digest(sources: Iterable[Path], values: object = None) -> str:
    """Return a digest of files and of values; comments and layout of SystemVerilog and of Python do not count."""
    codes = {".sv": repository.code, ".py": python_code.code_of}
    texts = {file.name: codes.get(file.suffix, str)(file.read_text()) for file in sources}
    return hashlib.sha256(repr((sorted(texts.items()), values)).encode()).hexdigest()[:16]


def sources(line: str) -> str:
    """Return the digest of the sources of a run, as its command computes it from its variables."""
    from commands.__main__ import COMMANDS  # needs psutil, which the generator of FuseSoC does without

    _, command, *arguments = line.split()
    digest: str = importlib.import_module(f"commands.{COMMANDS[command]}.{command}").sources(arguments)
    return digest


def since(line: str, entry: Mapping[str, Any]) -> str:
    """Return whether the sources of a run are those of its commit: "same" or "changed"."""
    return "same" if entry.get("sources") == sources(line) else "changed"


def rounded(value: Any) -> Any:
    """Return a document with five digits of each number."""
    if isinstance(value, dict):
        return {name: rounded(each) for name, each in value.items()}
    if isinstance(value, list | tuple):
        return [rounded(each) for each in value]
    return float(f"{value:.5g}") if isinstance(value, float) else value


def record(figures: Any) -> None:
    """Write the figures of this run if its line is in the file and its sources are committed."""
    results, line = load(), command_line(sys.argv[0], sys.argv[1:])
    if line not in results:
        return
    commit = git("rev-parse", "--short=7", "HEAD")
    if commit is None or git("diff", "--quiet", "HEAD", "--", *SOURCES) is None:
        print(f"no figures are recorded for make figures: commit {', '.join(SOURCES)} and run this again")
        return
    results[line] |= {"commit": commit.decode().strip(), "sources": sources(line), "figures": figures}
    save(results)
    print(f"recorded in {RESULTS.relative_to(ROOT)}: run make figures")
