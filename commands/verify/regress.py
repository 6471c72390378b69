# SPDX-License-Identifier: Apache-2.0
"""`make regress`: all tests that `make test` samples, and a table of them. Exit status 1 if anything failed.

Parts, chosen with PARTS=a,b: `faults` (tests/test_faults.py, the full product), `codes` (tests/test_codes.py: RTL
against model in bulk), `power_ups` (the quick tests of every core and of the top from 100 random states), `seeds`
(every test of RTL with another seed, in full on Verilator, and all tests that are too long for `make test`). JOBS is
the number of processes, 2 by default.
"""

import resource
import time
from collections import Counter
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from typing import Annotated, Any

import numpy as np

from commands.common import repository, tabular, variables
from commands.common.results import save
from commands.verify import items
from tactile_depth.base.errors import Argument, InputError
from tb.settings import RunSettings

POWER_UPS = 100
SEED = 2  # the other seed
# Tests, marks of conftest.py, and settings of each part.
PARTS: dict[str, tuple[list[str], str, RunSettings]] = {
    "faults": (["tests/test_faults.py"], "", RunSettings(full=True)),
    "codes": (["tests/test_codes.py"], "codes", RunSettings(full=True)),
    "power_ups": (["tests", "tb"], "power_ups", RunSettings(power_ups=POWER_UPS)),
    "seeds": (["tests", "tb", "--ignore=tests/test_faults.py"], "seeds or regress", RunSettings(full=True)),
}


@dataclass
class Part:
    """Result of a part."""

    name: str
    lines: list[dict[str, Any]] = field(default_factory=list)
    failures: list[str] = field(default_factory=list)
    seconds: float = 0.0


def played(name: str, jobs: int) -> Part:
    """Run the tests of a part; what they record becomes its lines."""
    tests, marks, settings = PARTS[name]
    seeds = {"SEED": str(SEED)} if name == "seeds" else {}
    began = time.monotonic()
    _, outcomes = items.run(tests, lambda _: "", marks=marks, workers=jobs, verbose=True, settings=settings, **seeds)
    part = Part(name, seconds=time.monotonic() - began)
    part.failures = [f"{item.name}: {item.failure}" for item in outcomes if item.failure]
    for item in outcomes:
        part.lines += item.recorded.get("records", [])
    if seeds:
        line = {"part": name, "what": f"SEED={SEED}", "simulator": "both", "runs": 1, "failed": len(part.failures)}
        part.lines.append(line | {"seconds": part.seconds})
    return part


def lines_of(parts: list[Part]) -> str:
    """Return a table with a row for each line of a part, and the sum of the part below."""
    rows, failures = [], []
    for part in parts:
        sums = np.zeros(3, int)
        for line in part.lines:
            runs = line.get("cases", line.get("runs", line.get("frames", 1)))
            figures = np.array([runs, line.get("codes", 0), line.get("different", 0)])
            sums += figures
            cells = (*(f"{figure:,}" for figure in figures), f"{line['seconds']:.0f}")
            rows.append((part.name, line["what"], line["simulator"], *cells))
        verdict = f"= {len(part.failures)} FAILED" if part.failures else "= all passed"
        rows.append((part.name, verdict, "", *(f"{figure:,}" for figure in sums), f"{part.seconds:.0f}"))
        failures += [f"    {part.name}: {failure}" for failure in part.failures]
    head = ("part", "what", "simulator", "runs", "codes", "different", "seconds")
    return "\n".join([str(tabular.Table(head, rows)), *failures])


def faults_by_device(part: Part) -> tabular.Table:
    """Return the table of the number of faults of each kind on each device."""
    counts: dict[str, Counter[str]] = {}
    for line in part.lines:
        for kind, number in line.get("kinds", {}).items():
            counts.setdefault(kind, Counter())[f"{line['grid']} {line['simulator']}"] += number
    devices = sorted({device for row in counts.values() for device in row})
    rows = [(device, *(f"{row[device]:,}" for row in counts.values())) for device in devices]
    return tabular.Table(("device", *counts), rows)


def _parts(argument: Argument) -> list[str]:
    names: list[str] = argument.value.split(",")
    if not PARTS.keys() >= set(names):
        raise InputError(argument, f": accepted are {', '.join(PARTS)}")
    return names


def main(names: Annotated[Sequence[str], _parts, "PARTS"] = tuple(PARTS), jobs: variables.Jobs = 2) -> int:
    """Run the parts and print their table; return the exit status."""
    parts = []
    for name in names:
        parts.append(played(name, jobs))
        print(f"{name}: {parts[-1].seconds:.0f} s, {len(parts[-1].failures) or 'nothing'} failed", flush=True)
    report = repository.ROOT / "build" / "regress.json"
    report.parent.mkdir(exist_ok=True)
    save(report, [asdict(part) for part in parts])
    print(f"\n{lines_of(parts)}")
    for part in parts:
        if part.name == "faults":
            print(f"\n{faults_by_device(part)}")
    compared = sum(line.get("codes", 0) for part in parts for line in part.lines)
    used = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    failed = sum(len(part.failures) for part in parts)
    total = sum(part.seconds for part in parts)
    print(f"\n{compared:,} codes compared; {total / 60:.1f} minutes, {used / 60:.1f} of processor; {failed} failed")
    return variables.MISMATCH if failed else variables.EQUAL
