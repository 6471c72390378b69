# SPDX-License-Identifier: Apache-2.0
"""`make mutate`: mutants of every core in hdl/ in its testbench; formal proofs settle the survivors.

CORE=name,.. MUTANTS=200 SEED=1 JOBS=2 SECONDS=60 (of the solver, for each step of each survivor).

Each core gets MUTANTS mutants, or as many as exist, in one netlist (mutants.py). Its testbench runs on each mutant up
to the first failure (tb/mutants.py). A formal proof (equivalence.py) compares each survivor with the core, for every
use that the protocol of the core allows (formal/). An equivalent mutant does not count. A different mutant is a hole in
the tests, and an open one counts as a hole. To check the protocols, some killed mutants go to the solver, which must
not prove them equivalent.

Exit status: 1 if all cores together score below 97 %, or a core below 95 %.
"""

import os
import time
from dataclasses import asdict, dataclass, field
from functools import partial
from multiprocessing.pool import ThreadPool
from pathlib import Path
from typing import Annotated

from commands.common import repository, variables
from commands.common.progress import following, progress_bar
from commands.common.results import save
from commands.verify import equivalence, mutants, sign_off
from commands.verify.equivalence import EQUIVALENT, settle
from commands.verify.fingerprint import fingerprint
from tactile_depth.base.errors import InputError

OUT = repository.ROOT / "build" / "mutate"
CORE_BAR, TOTAL_BAR = 95.0, 97.0  # per cent of the mutants that are not equivalent: each core, all cores together
CONTROLS = 4  # killed mutants of each structure that the solver checks too


def score(killed: int, counted: int) -> float:
    """Return killed mutants in per cent of those that count; 100 if none counts."""
    return 100.0 * killed / counted if counted else 100.0


@dataclass
class Outcome:
    """Counts of one core over all its structures."""

    core: str
    mutants: int = 0
    killed: int = 0
    equivalent: int = 0
    different: int = 0
    open: int = 0
    settled_by: dict[str, int] = field(default_factory=dict)  # survivors by the step that settles them
    contradictions: int = 0  # killed, but proven equivalent: the protocol allows less than the testbench drives
    every: bool = True  # True: the core has no more mutants
    seconds: float = 0.0
    survivors: list[dict] = field(default_factory=list)

    @property
    def score(self) -> float:
        return score(self.killed, self.mutants - self.equivalent)

    @property
    def passed(self) -> bool:
        return self.score >= CORE_BAR and not self.contradictions


def lines_of(path: Path) -> int:
    """Return the number of complete lines of a file, 0 if there is none."""
    return path.read_bytes().count(b"\n") if path.is_file() else 0


def cores() -> list[str]:
    """Return the cores that are mutated: every core with structures. The units are parts of tactile_depth."""
    return [name for name in repository.cores() if repository.structures(name)]


def mutate(name: str, count: int, seed: int, jobs: int, seconds: int) -> Outcome:
    """Mutate each structure of a core, run the mutants, and settle the survivors."""
    outcome, began = Outcome(name), time.monotonic()
    core = repository.mutants(name)
    for built in repository.structures(name):
        folder = OUT / name / built.label
        folder.mkdir(parents=True, exist_ok=True)
        made, every = mutants.make(name, built, count, seed, folder, core.outside, core.flat)
        outcome.every &= every
        lived, killed = made, []
        for simulator in built.mutants:
            done = partial(lines_of, folder / f"{simulator}.jsonl")
            with following(f"{name}, {simulator}", len(lived) + 1, "mutant", done):
                results = mutants.run(name, built, lived, folder, simulator, jobs, seed, core.repeats)
            killed += [result["mutant"] for result in results if result["verdict"] == "killed"]
            lived = [mutant for mutant in lived if mutant.number not in killed]
            if not lived:
                break
        what = {mutant.number: mutant.what for mutant in made}
        outcome.mutants += len(made)
        outcome.killed += len(killed)
        graph = equivalence.graph(name, folder, built.parameters)

        def survived(number: int, verdict: str, how: str, label: str = built.label, what: dict = what) -> None:
            found = {"structure": label, "mutant": number, "what": what[number], "verdict": verdict, "how": how}
            outcome.survivors.append(found)

        numbers = [mutant.number for mutant in lived]
        with ThreadPool(jobs) as pool:
            verdicts = pool.imap(partial(settle, graph, folder=folder, seconds=seconds), numbers)
            shown = progress_bar(verdicts, f"{name}, survivors", len(numbers))
            for number, (verdict, how) in zip(numbers, shown, strict=True):
                setattr(outcome, verdict, getattr(outcome, verdict) + 1)
                outcome.settled_by[how] = outcome.settled_by.get(how, 0) + 1
                survived(number, verdict, how)
        for number in sorted(killed)[:: max(1, len(killed) // CONTROLS)][:CONTROLS]:
            if settle(graph, number, folder, 1)[0] == EQUIVALENT:
                outcome.contradictions += 1
                survived(number, "contradiction", "killed, but proven equivalent")
    outcome.seconds = time.monotonic() - began
    save(OUT / name / "outcome.json", asdict(outcome) | {"score": outcome.score})
    return outcome


COLUMNS = {"mutants": 8, "killed": 8, "equivalent": 12, "different": 11, "open": 7, "score": 9, "seconds": 9}
HEAD = f"{'core':<22}" + "".join(f"{name:>{width}}" for name, width in COLUMNS.items())


def row(outcome: Outcome) -> str:
    values = {name: f"{getattr(outcome, name):.0f}" for name in COLUMNS} | {"score": f"{outcome.score:.1f}%"}
    notes = ["all mutants"] if outcome.every else []
    notes += [f"{outcome.contradictions} CONTRADICTIONS"] if outcome.contradictions else []
    notes += [] if outcome.passed else ["MISSED"]
    cells = "".join(f"{values[name]:>{width}}" for name, width in COLUMNS.items())
    return f"{outcome.core:<22}{cells}  {', '.join(notes)}".rstrip()


PROCESSORS = os.cpu_count() or 1


def main(
    mutants: variables.Count = 200,
    seed: variables.Seed = 1,
    jobs: variables.Jobs = PROCESSORS,
    seconds: Annotated[int, variables.whole(1, 86_400)] = 60,
    chosen: repository.Cores | None = None,
) -> int:
    """Mutate each core and print its row; return the exit status."""
    OUT.mkdir(parents=True, exist_ok=True)
    outcomes, used = [], 0.0  # processor time, the start of this command included
    print(HEAD)
    for name in repository.tested(cores() if chosen is None else chosen):
        if not repository.structures(name):
            raise InputError(f"CORE={name}: no structure of its testbench has mutants=, so none is made")
        sources = fingerprint(name, "mutants")
        outcomes.append(mutate(name, mutants, seed, jobs, seconds))
        print(row(outcomes[-1]), flush=True)
        figures = {kind: getattr(outcomes[-1], kind) for kind in sign_off.COUNTED}
        figures |= {"each": "all" if outcomes[-1].every else mutants, "seconds": round(sum(os.times()[:4]) - used)}
        used = sum(os.times()[:4])
        sign_off.record(name, "mutants", sources, figures)
        for survivor in outcomes[-1].survivors:
            if survivor["verdict"] != EQUIVALENT:
                print("    {structure}/{mutant} {verdict} {how}: {what}".format(**survivor), flush=True)
    save(OUT / "results.json", [asdict(o) | {"score": o.score} for o in outcomes])
    missed = [outcome.core for outcome in outcomes if not outcome.passed]
    total = score(sum(o.killed for o in outcomes), sum(o.mutants - o.equivalent for o in outcomes))
    print(
        f"mutate: {total:.1f}% (bar {TOTAL_BAR:.0f}%; each core {CORE_BAR:.0f}%), "
        f"{sum(o.mutants for o in outcomes):,} mutants of {len(outcomes)} cores"
        + (f", missed: {', '.join(missed)}" if missed else "")
    )
    return variables.MISMATCH if missed or total < TOTAL_BAR else variables.EQUAL
