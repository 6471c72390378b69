# SPDX-License-Identifier: Apache-2.0
"""`make sign-off`: run the proof and the mutants of each core without results of today's sources, JOBS cores at a time.

CORE=a,b: these cores alone. CHECK=1: run nothing, write docs/generated/sign-off.md, print what is left, and end with
exit status 1 unless it is nothing.

`make formal` and `make mutate`, which it runs, put each result into docs/sign-off.json as it comes, with the
fingerprint of its sources (fingerprint.py), and write the page. The shortest cores come first.
"""

import json
import os
import statistics
import subprocess
import sys
from collections.abc import Mapping, Sequence
from concurrent.futures import as_completed
from pathlib import Path
from typing import Any

from commands.common import repository, signals, tabular, variables
from commands.common.progress import duration
from commands.common.repository import ROOT, git
from commands.verify.fingerprint import KINDS, fingerprint, words
from tactile_depth.base import files

RESULTS = ROOT / "docs" / "sign-off.json"
PAGE = repository.GENERATED / "sign-off.md"
LOGS = ROOT / "build" / "sign-off"
COUNTED = ("killed", "equivalent", "different", "open")
MUTANTS = 100  # of each structure, or all
COMMANDS = {"proof": ["formal"], "mutants": ["mutate", f"MUTANTS={MUTANTS}"]}
INTERRUPTED = "every result is kept, run it again to go on"
PROCESSORS = os.cpu_count() or 1
TEXT = """<!-- SPDX-License-Identifier: Apache-2.0 -->
<!-- written by make sign-off, make formal and make mutate -->
# Sign-off

Each row has the newest results of a core: whether its proofs hold (`make formal`, [formal.md](../formal.md)), how many
mutants its testbench kills (`make mutate`, [mutation.md](../mutation.md)), and the commit of each run, with + where
sources were not committed.

A result has a fingerprint of all that it depends on. That of a proof: the RTL of the core and of the parts below it,
what they use of packages, its bench and what that uses of `formal/`, PROOFS. That of mutants: the same RTL, the
testbench, the protocol, STRUCTURES, MUTANTS, and each definition of `tb/` and of the models that these reach: a change
of code that all testbenches use makes all mutants *changed*; comments, docstrings, type hints and layout nothing.
*Sources* compares with the day when this page was written, `make sign-off CHECK=1` with today. *Few* are less than 100
mutants of a structure that has more.

*Open* mutants, which no step settled in time, count as holes; [mutation.md](../mutation.md) lists some. The score is
killed / (mutants - equivalent). The stages of [verification.md](../verification.md) follow: V2 needs a proof that
holds, V3 a score of 100 % too, both of the same sources.

"""
HEAD = ("core", "proofs", "commit", "mutants", "score", "commit", "sources", "stage")
Result = Mapping[str, Any]


def load() -> dict[str, dict[str, Any]]:
    results: dict[str, dict[str, Any]] = json.loads(RESULTS.read_text())
    return results


def signed() -> list[str]:
    """Return the cores that have a row: all but the units, which are tested within others."""
    return [core for core in repository.cores() if core not in repository.units()]


def reason(core: str) -> str:
    """Return why a core has no proof, empty if it has one."""
    return " ".join(words(core, "NO_PROOF"))


def stale(core: str, results: Mapping[str, Result]) -> dict[str, str]:
    """Return the kinds of results that a core lacks, each with what is wrong; empty if all are of today's sources."""
    found = {}
    for kind in KINDS:
        result = results.get(kind)
        if kind == "proof" and reason(core):
            continue
        if not result:
            found[kind] = "missing"
        elif result.get("sources") != fingerprint(core, kind):
            found[kind] = "changed"
        elif kind == "mutants" and result["each"] != "all" and result["each"] < MUTANTS:
            found[kind] = "few"
    return found


def counted(result: Result) -> int:
    return sum(result[name] for name in COUNTED)


def write(file: Path, text: str) -> None:
    """Write a file as a whole or not at all."""
    with files.workspace(file.parent, guarded=False) as work:
        (work / file.name).write_text(text)
        files.replace(work, [file.name], file.parent, guarded=False)


def record(core: str, kind: str, begun: str, figures: Mapping[str, int | str]) -> None:
    """Keep a result, unless there is one of more mutants of the same sources; `begun`: the fingerprint of its run."""
    if fingerprint(core, kind) != begun:
        print(f"no result of {core} is recorded for make sign-off: its sources have changed meanwhile")
        return
    head, changes = git("rev-parse", "--short=7", "HEAD"), git("status", "--porcelain", "hdl", "formal", "models", "tb")
    commit = (head or b"").decode().strip() + "+" * bool(changes)
    with files.locked(RESULTS.parent):  # others wait
        results = load()
        before = results.setdefault(core, {}).get(kind, {})
        if kind == "mutants" and before.get("sources") == begun and counted(before) > counted(figures):
            return
        results[core][kind] = {**figures, "commit": commit, "sources": begun}
        write(RESULTS, tabular.records(dict(sorted(results.items()))) + "\n")
        write(PAGE, document())


def shown(kind: str, result: Result) -> str:
    """Return a result in words."""
    if kind == "proof":
        return "FAILED" if result["failed"] else "not all ended" if result.get("not ended") else "hold"
    each = [f"{result[name]} {name}" for name in COUNTED if result[name] or name == "killed"]
    return f"{', '.join(each)}, of {counted(result)}"


def row(core: str, results: Mapping[str, Result]) -> tuple[str, ...]:
    """Return the row of a core."""
    proof, mutants, left = results.get("proof"), results.get("mutants"), stale(core, results)
    cells = [core, shown("proof", proof), proof["commit"]] if proof else [core, reason(core) or "-", "-"]
    score = 0.0
    if mutants:
        score = 100 * mutants["killed"] / max(counted(mutants) - mutants["equivalent"], 1)
        cells += [shown("mutants", mutants), f"{score:.1f} %", mutants["commit"]]
    else:
        cells += ["-"] * 3
    proven = proof is not None and shown("proof", proof) == "hold" and "proof" not in left
    stage = ("V3" if score == 100 and "mutants" not in left else "V2") if proven else "-"
    whys = [f"{kind} {why}" for kind, why in left.items()]
    both = len(left) == len(KINDS) and len({*left.values()}) == 1
    return *cells, left["proof"] if both else ", ".join(whys) or "same", stage


def document() -> str:
    """Return the text of `PAGE`."""
    results = load()
    rows = [row(core, results.get(core, {})) for core in signed()]
    return TEXT + tabular.Table(HEAD, rows).markdown()


def summary() -> str:
    """Return how many rows are of today's sources."""
    results = load()
    fresh = sum(not stale(core, results.get(core, {})) for core in signed())
    return f"sign-off: {fresh} of {len(signed())} cores have proof and mutants of today's sources"


Left = Mapping[str, Mapping[str, str]]  # core to what it lacks


def times(left: Left, results: Mapping[str, Mapping[str, Result]]) -> dict[str, float]:
    """Return the processor time of what is left of each core, in the order of the runs.

    A run without a recorded time counts as the mean of its kind. The shortest come first, cores without any time in the
    middle.
    """
    known = {
        kind: {core: of[kind]["seconds"] for core, of in results.items() if "seconds" in of.get(kind, {})}
        for kind in KINDS
    }
    mean = {kind: statistics.mean(known[kind].values() or [0]) for kind in KINDS}
    seconds = {core: sum(known[kind].get(core, mean[kind]) for kind in kinds) for core, kinds in left.items()}
    timed = sorted((core for core in left if any(core in known[kind] for kind in left[core])), key=seconds.__getitem__)
    middle = len(timed) // 2
    order = [*timed[:middle], *(core for core in left if core not in timed), *timed[middle:]]
    return {core: seconds[core] for core in order}


def play(command: Sequence[str], log: Path) -> None:
    """Run a command whose output goes into a file; its exit status tells less than the result that it records."""
    with log.open("w") as stream:
        words = [sys.executable, "-m", "commands", *command]
        subprocess.run(words, cwd=ROOT, stdout=stream, stderr=subprocess.STDOUT, check=False)


def run(core: str, kinds: Sequence[str]) -> str:
    """Run what a core lacks, and return what came of it in words."""
    said = []
    for kind in kinds:
        log = LOGS / f"{core}.{kind}.log"
        play([*COMMANDS[kind], f"CORE={core}", "JOBS=1"], log)
        results = load().get(core, {})
        none = kind in stale(core, results)
        said.append(f"no result, see {os.path.relpath(log)}" if none else shown(kind, results[kind]))
    return "; ".join(said)


def remaining(seconds: Mapping[str, float], jobs: int) -> str:
    """Return the time that runs of these processor times take."""
    total = sum(seconds.values()) / jobs
    return f"{duration(total)} left" if total else "no time is recorded yet" if seconds else "none left"


def sign(left: Left, jobs: int) -> None:
    """Run what is left, and print a line for each core."""
    LOGS.mkdir(parents=True, exist_ok=True)
    waiting = dict(left)
    with signals.threads(jobs) as pool:
        runs = {pool.submit(run, core, list(left[core])): core for core in times(left, load())}
        for number, ended in enumerate(as_completed(runs), 1):
            del waiting[runs[ended]]
            then = remaining(times(waiting, load()), jobs)
            print(f"{number} of {len(left)}, {runs[ended]}: {ended.result()}; {then}", flush=True)


def main(
    cores: repository.Cores | None = None, jobs: variables.Jobs = PROCESSORS, check: variables.Flag = False
) -> int:
    wanted = signed() if cores is None else repository.tested(cores)

    def lacking(results: Mapping[str, Mapping[str, Result]]) -> Left:
        return {core: kinds for core in wanted if (kinds := stale(core, results.get(core, {})))}

    with files.locked(RESULTS.parent):  # others wait
        write(PAGE, document())
    left = lacking(load())
    seconds = times(left, load())
    for core in seconds:
        print(f"{core}: {', '.join(f'{kind} {why}' for kind, why in left[core].items())}")
    print(summary())
    if left:
        untimed = sum("seconds" not in load().get(core, {}).get(kind, {}) for core in left for kind in left[core])
        print(
            f"{len(left)} cores: {remaining(seconds, jobs)}; {untimed} runs without a time count as the mean",
            flush=True,
        )
    if left and not check:
        sign(left, jobs)
        left = lacking(load())
        print(summary())
    return variables.MISMATCH if left else variables.EQUAL
