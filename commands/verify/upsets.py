# SPDX-License-Identifier: Apache-2.0
"""`make upsets`: flips bits of registers and memories while frames stream through, and measures what becomes of depth.

Every flip is an experiment of its own in the compiled pipeline. Its row is appended to a table of the configuration in
build/upsets; a later run with the same sources and seed goes on where this one ended.
"""

import csv
import os
from collections.abc import Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from statistics import median

from commands.common import recorded, repository, tabular, variables
from commands.common.progress import progress_bar
from commands.verify.upset_model import Model, Outcome, prepare
from commands.verify.upset_places import CONTROL, DATA, MEMORIES, POPULATIONS, SETTINGS, SOLVER
from tactile_depth.base import files

INTERRUPTED = "every flip is kept, run it again to go on"
CHECKS = {"PARITY": "1", "SELF_CHECK": "1"}
CASES = {
    "chip": {"PRESET": "chip", "ROWS": "24", "COLS": "32"},
    "24 bits": {"PRESET": "sensor", "ROWS": "16", "COLS": "32", "BOUNDARY": "dirichlet", **CHECKS},
    "24 bits, 8 values a clock": {"PRESET": "sensor", "ROWS": "16", "COLS": "64", "LANES": "8", **CHECKS},
    "24 bits, spectral": {"PRESET": "sensor", "N": "32", "SOLVER": "spectral", "BOUNDARY": "dirichlet", **CHECKS},
}
FOLDER = repository.ROOT / "build" / "upsets"
PROCESSORS = os.cpu_count() or 1
AT_ONCE = 500  # flips of one process
MOST, MOST_OF_A_BIT = 50, 20  # flips for each that is wanted, and for each bit, where few do harm
LIMITS = (0.5, 3.0)  # % of the peak: a larger change, or a frame that does not come, is harm
PASSING = (CONTROL, SOLVER, DATA, MEMORIES)  # what holds a value for no longer than its frame
REGISTERS = (CONTROL, SOLVER, DATA, SETTINGS)
HEADER = (
    *("population", "number", "path", "bit", "clock", "codes", "percent", "lost", "next_codes", "next_percent"),
    *("next_lost", "later_codes", "later_percent", "later_lost", "marks", "status"),
)
OUTCOME = HEADER.index("codes")
Outcomes = dict[str, list[Outcome]]


def harms(outcome: Outcome, limit: float = LIMITS[0]) -> bool:
    """Return whether a depth changes by more than `limit`, or a frame does not come."""
    return outcome.percent > limit or any(outcome.lost)


def hangs(outcome: Outcome) -> bool:
    """Return whether the registers do not answer, or the frame does not come that is the second after the flip."""
    return not outcome.answers or outcome.lost[-1]


def kept(path: Path) -> Outcomes:
    """Return the outcomes in a table by population, in the order of their numbers; drop a line that was cut off."""
    outcomes: Outcomes = {name: [] for name in POPULATIONS}
    if path.exists():
        text = path.read_text()
        whole = text[: text.rfind("\n") + 1]
        if whole != text:
            path.write_text(whole)
        for cells in csv.reader(whole.splitlines()[1:]):
            outcomes[cells[0]].append(Outcome.of(cells[OUTCOME:]))
    return outcomes


def rows(model: Model, name: str, numbers: range, seed: int) -> list[list[str]]:
    """Return the rows of the table of flips of a population."""
    flips = [model.flip(name, number, seed) for number in numbers]
    return [
        [name, str(number), place.path, str(bit), str(clock), *line.split()]
        for number, (place, bit, clock), line in zip(numbers, flips, model.run(flips), strict=True)
    ]


def measure(model: Model, path: Path, wanted: int, seed: int, jobs: int) -> Outcomes:
    """Flip bits until in each population `wanted` of them do harm; return all outcomes, those in the table too.

    A population ends too after `MOST` times as many flips, or `MOST_OF_A_BIT` for each of its bits.
    """
    outcomes = kept(path)
    if not path.exists() or not path.read_text():
        path.write_text(",".join(HEADER) + "\n")
    shape = "{percentage:3.0f}%|{bar}| {n_fmt} of {total_fmt} {postfix} [{elapsed}]"
    with path.open("a", newline="") as file, progress_bar(total=wanted * len(POPULATIONS), bar_format=shape) as bar:
        for position, name in enumerate(POPULATIONS):
            bar.set_postfix_str(name)
            done = outcomes[name]
            for batch in batches(model, name, done, wanted, seed, jobs):
                csv.writer(file, lineterminator="\n").writerows(batch)
                file.flush()
                done += [Outcome.of(cells[OUTCOME:]) for cells in batch]
                bar.update(position * wanted + min(wanted, sum(map(harms, done))) - bar.n)
    return outcomes


def batches(
    model: Model, name: str, done: list[Outcome], wanted: int, seed: int, jobs: int
) -> Iterator[list[list[str]]]:
    """Yield rows of a population, whose outcomes the caller adds to `done`, until that has all that is wanted."""
    most = min(MOST * wanted, MOST_OF_A_BIT * model.bits(name))
    size = min(AT_ONCE, most)
    with ThreadPoolExecutor(jobs) as pool:
        while sum(map(harms, done)) < wanted and len(done) < most:
            starts = range(len(done), len(done) + jobs * size, size)
            yield from pool.map(lambda first: rows(model, name, range(first, first + size), seed), starts)


def shares(outcomes: list[Outcome], limit: float) -> list[str]:
    """Return how many of the outcomes do harm, and what % of these is flagged, dropped without a flag, or unseen."""
    harm = [each for each in outcomes if harms(each, limit)]
    unflagged = [each for each in harm if not each.is_flagged]
    unseen = sum(each.percent > limit for each in unflagged)
    parts = (len(harm) - len(unflagged), len(unflagged) - unseen, unseen)
    return [str(len(harm)), *(f"{100 * part / len(harm):.1f}" if harm else "-" for part in parts)]


def table(model: Model, outcomes: Outcomes) -> tabular.Table:
    """Return a table with a row per population."""
    of_limits = [name for limit in LIMITS for name in (f"> {limit:g} %", "flagged", "dropped", "unseen")]
    cells = []
    for name, every in outcomes.items():
        mm = [max(each.codes) * model.lsb_mm for each in every if harms(each)] or [0.0]
        wrong = sum(each.percents[-1] > LIMITS[0] or each.lost[-1] for each in every)
        of_damage = (*shares(every, LIMITS[0]), *shares(every, LIMITS[1]), f"{median(mm):.2g}", f"{max(mm):.2g}")
        cells.append(
            (name, str(model.bits(name)), str(len(every)), *of_damage, str(wrong), str(sum(map(hangs, every))))
        )
    last = ("median, mm", "largest, mm", "wrong two frames later", "hangs")
    return tabular.Table(("population", "bits", "flips", *of_limits, *last), cells)


def harmless(model: Model, outcomes: Outcomes, names: Iterable[str]) -> float:
    """Return the share in % of flips over all bits of these populations that do no harm, are flagged or dropped."""
    bits, good = 0, 0.0
    for name in names:
        if every := outcomes[name]:
            unseen = sum(each.percent > LIMITS[0] and not each.is_flagged for each in every)
            bits += model.bits(name)
            good += model.bits(name) * (1 - unseen / len(every))
    return 100 * good / bits


def main(upsets: variables.Count = 60, seed: variables.Seed = 1, jobs: variables.Jobs = PROCESSORS) -> int:
    """Flip bits in every case and print tables of the outcomes; return the exit status."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    print(f"flips until {upsets} of each population change a depth by more than {LIMITS[0]} % of the peak, or lose it")
    hang = False
    for name, values in CASES.items():
        with files.temporary() as folder:
            model = prepare(values, folder)
            state = recorded.digest(folder.glob("*.hex"), [model.built.name, model.start, seed])
            path = FOLDER / f"{state}.csv"
            outcomes = measure(model, path, upsets, seed, jobs)
        grid = " ".join(f"{variable}={value}" for variable, value in values.items())
        print(f"\n{name}: {grid} ({os.path.relpath(path)})\n\n{table(model, outcomes)}\n")
        every, registers = (harmless(model, outcomes, names) for names in (POPULATIONS, REGISTERS))
        print(f"harmless, flagged or dropped: {every:.2f} % of flips over all bits, {registers:.2f} % over registers")
        hang |= any(hangs(each) for passing in PASSING for each in outcomes[passing])
    return variables.MISMATCH if hang else variables.EQUAL
