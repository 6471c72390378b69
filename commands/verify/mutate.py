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

import json
import os
import sys
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from functools import partial
from multiprocessing.pool import ThreadPool
from pathlib import Path

from tqdm import tqdm

from commands.common import repository, variables
from commands.common.progress import following
from commands.verify import equivalence, mutants
from commands.verify.equivalence import EQUIVALENT, settle
from commands.verify.structures import structure

OUT = repository.ROOT / "build" / "mutate"
CORE_BAR, TOTAL_BAR = 95.0, 97.0  # per cent of the mutants that are not equivalent: each core, all cores together
CONTROLS = 4  # killed mutants of each structure that the solver checks too


@dataclass(frozen=True)
class Core:
    """Settings for mutating a core.

    `structures` are positions in `structures.structures`, of small builds that together contain every relevant generate
    branch.
    """

    structures: tuple[int, ...] = (0,)
    protocol: str = ""  # formal/protocols/protocol_<protocol>.sv; by default protocol_<name>.sv, if there is one
    rows_are: str = ""  # parameter of the core that the protocol calls Rows
    columns_are: str = ""  # parameter of the core that the protocol calls Columns
    # Each simulator gets the survivors of the one before. Icarus needs no build, and sees X.
    simulators: Sequence[str] = ("icarus",)
    outside: Sequence[str] = ()  # registers of the core that its testbench writes
    repeats: int = mutants.MANY  # repetitions of rare cases; fewer if each repetition reaches every case
    flat: bool = True  # False: mutants of its own cells and of the pins of the cores inside, which have their own runs


QUICK_FIRST = ("verilator", "icarus")
CORES = {
    "td_round_saturate": Core((0, 1, 11)),
    "td_multiply": Core((2,)),
    "td_ramp": Core((2,)),
    "td_dot_product": Core((3,)),
    "td_divide": Core((1,)),
    "td_banked_table": Core((1,)),
    "td_block_sum": Core((1, 3)),
    "td_ram": Core((1,)),
    "td_rom": Core((1,)),
    "td_delay_line": Core((4, 3)),
    "td_burst_counter": Core((1,)),
    "td_axis_skid": Core(),
    "td_async_fifo": Core((1,)),
    "threshold_comparator": Core((0, 2)),
    "frame_guard": Core((1,), outside=("silence",)),
    "beat_sums": Core((1,)),
    "contact_sums": Core((1, 2)),
    "contact_debounce": Core((1,)),
    "centroid": Core((1,)),
    "record_packets": Core((1,)),
    "contact_events": Core((1,), outside=("frame",), simulators=QUICK_FIRST, flat=False),
    "depth_gate": Core(),
    "dvp_receive": Core((1,)),
    "gradient_lookup": Core((1,)),
    "quadratic_gradient": Core((1,)),
    "td_gain_map": Core(),
    "flat_field": Core((0, 2)),
    "zero_offset": Core((0, 4)),
    "td_node_map": Core((1, 3)),
    "reference_capture": Core((1,)),
    "zero_capture": Core((2, 5)),
    "thomas_table": Core(),
    "block_weights": Core((2, 3)),
    "round_divide": Core((3,), repeats=2),
    "row_sums": Core((2, 3)),
    "block_totals": Core((1, 2)),
    "area_average": Core((2, 4), repeats=2, flat=False),
    "black_level": Core((1, 2), repeats=2),
    "pixel_format": Core((2, 3, 4), repeats=2),
    "camera_setup": Core((1,), "after_reset"),
    "camera_window": Core((1, 2), repeats=2),
    "camera_front_end": Core((1, 2), repeats=2, flat=False),
    "camera_registers": Core((1,), "after_reset", outside=("dropped", "lost"), flat=False),
    "row_reorder": Core((2,), "words"),
    "corner_turn": Core((2,)),
    "divergence": Core((5,)),
    "transpose": Core((5,), "bursts", rows_are="Columns"),
    "frame_stack": Core((5, 6)),
    "spectral_divide": Core((2,), "bursts", rows_are="Columns"),
    "forward_elimination": Core((2,), "bursts"),
    "back_substitution": Core((5, 4, 6)),
    "mode_pairs": Core((4,), "bursts", columns_are="Size"),
    "sdf_butterfly": Core((2,), "bursts", columns_are="Size"),
    "twiddle_multiply": Core((6,), "bursts", columns_are="Size"),
    "sdf_fft": Core((3,), "bursts", columns_are="Size"),
    "dst_forward": Core((5,), "bursts", columns_are="Size", flat=False),
    "dst_inverse": Core((5,), "bursts", columns_are="Size", flat=False),
    "frame_output": Core((1,)),
    "frame_tags": Core((4,)),
    "axil_port": Core(protocol="axil_registers"),
    "setting_registers": Core(protocol="after_reset"),
    "event_registers": Core(protocol="after_reset", outside=("counts",)),
    "table_access": Core(),
    "table_banks": Core(),
    "axil_registers": Core((1,), simulators=QUICK_FIRST, flat=False),
    "spectral_solver": Core((2,), "words", rows_are="Columns", simulators=QUICK_FIRST, flat=False),
    "tridiagonal_solver": Core((4, 9), "words", simulators=QUICK_FIRST, flat=False),
    "tactile_depth": Core((1,), simulators=("verilator",), flat=False),
}
# Files without mutants of their own.
LEFT_OUT = {
    **dict.fromkeys(("td_register_map_pkg", "td_camera_map_pkg"), "constants, which the registers are built of"),
    "td_config_pkg": "constants",
    "td_types_pkg": "types",
    **dict.fromkeys(repository.units(), "a part of tactile_depth"),
}


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


def mutate(name: str, core: Core, count: int, seed: int, jobs: int, seconds: int) -> Outcome:
    outcome, began = Outcome(name), time.monotonic()
    for index in core.structures:
        built = structure(name, index)
        folder = OUT / name / str(index)
        folder.mkdir(parents=True, exist_ok=True)
        made, every = mutants.make(name, built, count, seed, folder, core.outside, core.flat)
        outcome.every &= every
        lived, killed = made, []
        for simulator in core.simulators:
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
        called = {"Rows": core.rows_are, "Columns": core.columns_are}
        parameters = {**built.parameters, **{name: built.parameters[own] for name, own in called.items() if own}}
        graph = equivalence.graph(name, folder, core.protocol or name, parameters)
        numbers = [mutant.number for mutant in lived]
        with ThreadPool(jobs) as pool:
            verdicts = pool.imap(partial(settle, graph, folder=folder, seconds=seconds), numbers)
            shown = tqdm(verdicts, f"{name}, survivors", len(numbers), leave=False, disable=None)
            for number, (verdict, how) in zip(numbers, shown, strict=True):
                setattr(outcome, verdict, getattr(outcome, verdict) + 1)
                outcome.settled_by[how] = outcome.settled_by.get(how, 0) + 1
                survivor = {"structure": index, "mutant": number, "what": what[number], "verdict": verdict, "how": how}
                outcome.survivors.append(survivor)
        for number in sorted(killed)[:: max(1, len(killed) // CONTROLS)][:CONTROLS]:
            if settle(graph, number, folder, 1)[0] == EQUIVALENT:
                outcome.contradictions += 1
                survivor = {"structure": index, "mutant": number, "what": what[number], "verdict": "contradiction"}
                outcome.survivors.append(survivor | {"how": "killed, but proven equivalent"})
    outcome.seconds = time.monotonic() - began
    (OUT / name / "outcome.json").write_text(json.dumps(asdict(outcome) | {"score": outcome.score}, indent=1) + "\n")
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


RANGES = {"MUTANTS": (1, 100_000), "SEED": (0, 10**9), "JOBS": (1, 1000), "SECONDS": (1, 86_400)}


def parse(arguments: list[str]) -> dict[str, str]:
    choices = {"MUTANTS": "200", "SEED": "1", "JOBS": str(os.cpu_count() or 1), "SECONDS": "60"}
    choices["CORE"] = ",".join(CORES)
    choices |= variables.given(arguments, choices)
    for name, (low, high) in RANGES.items():
        variables.number(choices, name, None, low, high)
    return choices


def main() -> None:
    with variables.reported("mutate"):
        choices = parse(sys.argv[1:])
        names = repository.tested(repository.chosen(choices["CORE"]))
        modules = {path.stem for path in repository.sources()}
        if modules != CORES.keys() | LEFT_OUT.keys():
            raise variables.Mismatch(
                f"commands/verify/mutate.py does not list what is in hdl/: {modules ^ (CORES.keys() | LEFT_OUT.keys())}"
            )
        sys.exit(run(names, choices))


def run(names: list[str], choices: dict[str, str]) -> int:
    """Mutate each core and print its row; return the exit status."""
    OUT.mkdir(parents=True, exist_ok=True)
    numbers = {name.lower(): int(choices[name]) for name in ("SEED", "JOBS", "SECONDS")}
    outcomes = []
    print(HEAD)
    for name in names:
        outcomes.append(mutate(name, CORES[name], int(choices["MUTANTS"]), **numbers))
        print(row(outcomes[-1]), flush=True)
        for survivor in outcomes[-1].survivors:
            if survivor["verdict"] != EQUIVALENT:
                print("    {structure}/{mutant} {verdict} {how}: {what}".format(**survivor), flush=True)
    (OUT / "results.json").write_text(json.dumps([asdict(o) | {"score": o.score} for o in outcomes], indent=1) + "\n")
    missed = [outcome.core for outcome in outcomes if not outcome.passed]
    total = score(sum(o.killed for o in outcomes), sum(o.mutants - o.equivalent for o in outcomes))
    print(
        f"mutate: {total:.1f}% (bar {TOTAL_BAR:.0f}%; each core {CORE_BAR:.0f}%), "
        f"{sum(o.mutants for o in outcomes):,} mutants of {len(outcomes)} cores"
        + (f", missed: {', '.join(missed)}" if missed else "")
    )
    return variables.MISMATCH if missed or total < TOTAL_BAR else variables.EQUAL
