# SPDX-License-Identifier: Apache-2.0
"""`make sign-off`: write docs/generated/sign-off.md from docs/sign-off.json.

`make mutate` and `make formal` add results to that file. Each has the commit of its run and a fingerprint of the core's
file without comments, so that the page tells whether its RTL has changed since.
"""

import hashlib
import json
from collections.abc import Mapping
from typing import Any

from commands.common import repository, tabular
from commands.common.repository import ROOT, git

RESULTS = ROOT / "docs" / "sign-off.json"
PAGE = repository.GENERATED / "sign-off.md"
COUNTED = ("killed", "equivalent", "different", "open")
TEXT = """<!-- SPDX-License-Identifier: Apache-2.0 -->
<!-- written by make sign-off -->
# Sign-off

Each row is the newest result of a core: whether its proofs hold (`make formal`, [formal.md](../formal.md)), how many
mutants its testbench kills (`make mutate`, [mutation.md](../mutation.md)), and at which commit. 32a97ff is version
0.1.0.

A result holds for the RTL of its commit. *changed* says that the core's file differs since, comments aside: run the
command again. Until commit f935620, which moved and renamed cores, git compared contents under the old names; its files
count as the first ones. *Open* mutants, which no step settled in time, count as holes; [mutation.md](../mutation.md)
lists some. The score is killed / (mutants - equivalent). The stages of [verification.md](../verification.md) follow: V2
needs a proof that holds, V3 a score of 100 % too, both unchanged.

"""
HEAD = ("core", "proofs", "commit", "RTL since", "mutants", "score", "commit", "RTL since", "stage")


def fingerprint(text: str) -> str:
    """Return a fingerprint of SystemVerilog that comments and white space do not change."""
    return hashlib.sha256(repository.code(text).encode()).hexdigest()[:16]


def load() -> dict[str, dict[str, Any]]:
    results: dict[str, dict[str, Any]] = json.loads(RESULTS.read_text())
    return results


def unchanged(core: str, result: Mapping[str, Any]) -> bool:
    return bool(result["rtl"] == fingerprint(repository.cores()[core].hdl.read_text()))


def record(core: str, kind: str, figures: Mapping[str, int]) -> None:
    """Write a result of a core whose RTL is committed, unless the file has one of more mutants on the same RTL."""
    file = repository.cores()[core].hdl
    commit = git("rev-parse", "--short=7", "HEAD")
    if commit is None:
        return
    tracked = git("ls-files", "--error-unmatch", "--", str(file))
    if tracked is None or git("diff", "--quiet", "HEAD", "--", str(file)) is None:
        print(f"no result is recorded for make sign-off: commit {file.relative_to(ROOT)} and run this again")
        return
    results = load()
    before = results.setdefault(core, {}).get(kind)
    more = before and kind == "mutants" and sum(before[name] for name in COUNTED) > sum(figures.values())
    if before and more and unchanged(core, before):
        return
    rtl = fingerprint(file.read_text())
    results[core][kind] = {**figures, "commit": commit.decode().strip(), "rtl": rtl}
    RESULTS.write_text(tabular.records(dict(sorted(results.items()))) + "\n")


def row(core: str, results: Mapping[str, Any]) -> tuple[str, ...]:
    """Return the row of a core."""
    proof, mutants = results.get("proof"), results.get("mutants")
    same = {kind for kind, result in results.items() if unchanged(core, result)}
    cells, proven, covered = [core], False, False
    if proof:
        verdict = "FAILED" if proof["failed"] else "not all ended" if proof.get("not ended") else "hold"
        proven = verdict == "hold" and "proof" in same
        cells += [verdict, proof["commit"], "same" if "proof" in same else "changed"]
    else:
        cells += ["-"] * 3
    if mutants:
        counted = sum(mutants[name] for name in COUNTED)
        score = 100 * mutants["killed"] / max(counted - mutants["equivalent"], 1)
        covered = score == 100 and "mutants" in same
        words = [f"{mutants[name]} {name}" for name in COUNTED if mutants[name] or name == "killed"]
        since = "same" if "mutants" in same else "changed"
        cells += [f"{', '.join(words)}, of {counted}", f"{score:.1f} %", mutants["commit"], since]
    else:
        cells += ["-"] * 4
    return *cells, ("V3" if covered else "V2") if proven else "-"


def document() -> str:
    """Return the text of `PAGE`."""
    results, units = load(), repository.units()
    rows = [row(core, results.get(core, {})) for core in repository.cores() if core not in units]
    return TEXT + tabular.Table(HEAD, rows).markdown()


def main() -> None:
    PAGE.write_text(document())
