# SPDX-License-Identifier: Apache-2.0
"""Lint by slang: it elaborates and analyses SystemVerilog with every warning on, and leaves out waived findings.

    python -m commands.verify.slang_lint TOP[,TOP..] [-GName=Value ..] FILE..

prints the findings; exit status 1 if there are any.
"""

import math
import re
import sys
from collections import Counter
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

from pyslang import DiagnosticSeverity, driver
from pyslang.ast import Compilation, InstanceSymbol


@dataclass(frozen=True)
class Finding:
    """Diagnostic of slang."""

    option: str  # name of the warning; empty for an error without a name
    place: str
    text: str
    source: str  # text from the position to the end of its line
    types: tuple[str, ...]  # names and types in the message

    def __str__(self) -> str:
        return f"{self.place}: {self.text}" + (f" [-W{self.option}]" if self.option else "")


def width(name: str) -> int | None:
    """Return the bits of a packed type by its name; None for other types."""
    if match := re.fullmatch(r"(?:logic|bit|reg)(?: signed)?((?:\[-?\d+:-?\d+\])*)", name):
        return math.prod(abs(int(a) - int(b)) + 1 for a, b in re.findall(r"(-?\d+):(-?\d+)", match[1]))
    return {"int": 32, "integer": 32}.get(name)


def signed(name: str) -> bool:
    return " signed" in name or name in ("int", "integer")


def same_width(finding: Finding) -> bool:
    return len(finding.types) == 2 and width(finding.types[0]) == width(finding.types[1])


@dataclass(frozen=True)
class Waiver:
    """Findings that are left out, and the reason."""

    option: str
    holds: Callable[[Finding], bool]
    reason: str


WAIVERS = (
    Waiver(
        "sign-conversion",
        same_width,
        "as many bits on both sides: none changes. Memories and concatenations have no sign",
    ),
    Waiver(
        "sign-compare",
        lambda f: same_width(f) and f.source.startswith(("==", "!=")),
        "equality of words of one width compares bits",
    ),
    Waiver("packed-array-conv", same_width, "a delay line of words takes the concatenation of its words, as many bits"),
    Waiver("case-type", same_width, "equality of words of one width compares bits"),
    Waiver(
        "arith-op-mismatch",
        lambda f: same_width(f) and f.source.startswith(("+", "-")),
        "sums and differences of words of one width, kept to that width, are the same whatever the sign",
    ),
    Waiver(
        "arith-op-mismatch",
        lambda f: len(f.types) == 2 and all(map(signed, f.types)),
        "both are signed, so both are extended by their sign: the factors of a product differ in width",
    ),
    Waiver(
        "useless-cast", lambda f: True, "widths are parameters: what changes nothing here does in another structure"
    ),
    Waiver(
        "unused-but-set-variable",
        lambda f: re.search(r"'unused_\w+'", f.text) is not None,
        "named so: it takes up what a port or a slice has too much",
    ),
    Waiver(
        "unused-port",
        lambda f: re.search(r"'s_axi(s_tlast|l_a[rw]prot)'", f.text) is not None,
        "a bus has all its pins",
    ),
    Waiver(
        "unused-package-subroutine",
        lambda f: "td_check_pkg" in f.place,
        "of cores that a board has in some configurations",
    ),
    Waiver("empty-output-connection", lambda f: True, "an output that nothing reads is connected to nothing"),
    Waiver(
        "unused-package-parameter",
        lambda f: "_map_pkg" in f.place,
        "a register map is generated whole; no core uses every reset value and bit",
    ),
)

# Only for one structure or one core, which does not use other cores and all constants of the packages.
NOT_IN_A_STRUCTURE = ("unused-def", *(f"unused-package-{kind}" for kind in ("parameter", "subroutine", "typedef")))


def compiled(
    tops: Iterable[str], files: Iterable[Path], parameters: Mapping[str, str] | None = None
) -> tuple[driver.Driver, Compilation, bool]:
    """Return slang's driver, what it compiled from the files, and whether it could read them.

    Raises ValueError if slang does not take the arguments.
    """
    engine_driver = driver.Driver()
    engine_driver.addStandardArgs()
    arguments = [
        "slang",
        "-Weverything",
        "--error-limit=0",
        "--allow-dup-initial-drivers",  # $readmemh in an initial gives a memory its contents at power-up
        *(f"--top={top}" for top in tops),
        *(f'"-G{name}={value}"' for name, value in (parameters or {}).items()),  # a number may have a quote
        *((f"-Wno-{option}" for option in NOT_IN_A_STRUCTURE) if parameters else ()),
        *map(str, files),
    ]
    taken = engine_driver.parseCommandLine(" ".join(arguments), driver.CommandLineOptions())
    if not (taken and engine_driver.processOptions()):
        raise ValueError(f"slang does not take: {' '.join(arguments)}")
    parsed = engine_driver.parseAllSources()
    return engine_driver, engine_driver.createCompilation(), parsed


def instantiated(tops: Iterable[str], files: Iterable[Path], parameters: Mapping[str, str]) -> set[str]:
    """Return the names of the modules that tops with parameters consist of, the tops too."""
    names = set()

    def visit(symbol: object) -> None:
        if isinstance(symbol, InstanceSymbol):
            names.add(symbol.definition.name)

    compiled(tops, files, parameters)[1].getRoot().visit(visit)
    return names


def findings(tops: Iterable[str], files: Iterable[Path], parameters: Mapping[str, str] | None = None) -> list[Finding]:
    """Return all findings of slang, waived or not."""
    engine_driver, compilation, parsed = compiled(tops, files, parameters)
    diagnostics = [*compilation.getAllDiagnostics()]
    engine_driver.diagEngine.clearClients()  # they would print waived findings
    if parsed and not any(diagnostic.isError() for diagnostic in diagnostics):
        diagnostics += engine_driver.runAnalysis(compilation).getDiagnostics()
    engine, manager = engine_driver.diagEngine, engine_driver.sourceManager
    reported = []
    for diagnostic in diagnostics:
        if engine.getSeverity(diagnostic.code, diagnostic.location) == DiagnosticSeverity.Ignored:
            continue
        location = manager.getFullyOriginalLoc(diagnostic.location)
        source = manager.getSourceText(location.buffer)[location.offset :].split("\n", 1)[0]
        place = f"{manager.getFileName(location)}:{manager.getLineNumber(location)}:{manager.getColumnNumber(location)}"
        text = engine.formatMessage(diagnostic)
        types = tuple(name for name in re.findall(r"'([^']+)'", text) if width(name) is not None)
        reported.append(Finding(engine.getOptionName(diagnostic.code), place, text, source, types))
    return reported


def waiver(finding: Finding) -> Waiver | None:
    """Return the waiver that leaves a finding out, if any."""
    return next((w for w in WAIVERS if w.option == finding.option and w.holds(finding)), None)


def main() -> None:
    tops, *words = sys.argv[1:]
    parameters = dict(word[2:].split("=") for word in words if word.startswith("-G"))
    files = [Path(word) for word in words if not word.startswith("-G")]
    left = Counter(str(f) for f in findings(tops.split(","), files, parameters) if waiver(f) is None)
    for line, count in left.items():
        print(line + (f" ({count} times)" if count > 1 else ""))
    sys.exit(bool(left))


if __name__ == "__main__":
    main()
