# SPDX-License-Identifier: Apache-2.0
"""`make mutate`: mutants of every core in hdl/ through its own testbench, survivors settled by formal equivalence.

CORE=name,.. MUTANTS=200 SEED=1 JOBS=2 SECONDS=60 (of the solver, for each step of each survivor).

For each core: as many mutants as asked for, or all there are, in one netlist (commands/mutants.py); its own testbench on
each, up to the first failure (tb/mutants.py); for those that pass, whether anyone who keeps to the core's protocol
could tell them apart (commands/equivalence.py). One that nobody can is no mutant of the function and does
not count; one that somebody can is a hole in the tests; one that the solver leaves open counts as a hole.
And the other way round: mutants that the testbench killed must not be proven equivalent.
"""

from __future__ import annotations

import json
import os
import sys
import threading
import time
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path

from tqdm import tqdm

from commands import equivalence, mutants
from commands import simulator as simulation
from commands.equivalence import EQUIVALENT, Protocol
from models.errors import InputError

OUT = simulation.ROOT / "build" / "mutate"
LEAF, WHOLE = 100.0, 95.0  # per cent of the mutants that are not equivalent
CONTROLS = 4  # killed mutants of each structure that are also put to the solver

# Parts of protocols. `live` is high after the first reset.
LIVE = "  reg live = 1'b0;\n  always @(posedge clk) live <= live | rst;\n"


def settled(clocks: int) -> str:
    """`settled`: so many clocks with en have passed."""
    return f"  reg [7:0] passed = 8'd0;\n  always @(posedge clk) if (en & ~settled) passed <= passed + 8'd1;\n  wire settled = passed == 8'd{clocks};\n"


def axis_source(prefix: str, *fields: str) -> tuple[str, tuple[str, ...]]:
    """Registers and assumptions: what is offered stays until it is taken; nothing in reset and in the clock after."""
    payload = "{" + ", ".join(prefix + name for name in fields) + "}"
    registers = (
        f"  reg was_reset = 1'b1, waits = 1'b0;\n  reg [63:0] held_word;\n"
        f"  always @(posedge clk) begin\n    was_reset <= rst;\n    waits <= {prefix}valid & ~{prefix}ready & ~rst;\n"
        f"    held_word <= {payload};\n  end\n"
    )
    return registers, (
        f"~{prefix}valid | ~(rst | was_reset)",
        f"~waits | rst | ({prefix}valid & held_word == {payload})",
    )


def protocol_of_a_delay(parameters: Mapping[str, int]) -> Protocol:
    delay = parameters["Delay"]
    filled = f"  reg [7:0] words = 8'd0;\n  always @(posedge clk) words <= rst ? 8'd0 : words + (en & live & words != 8'd{delay});\n"
    return Protocol(LIVE + filled, (), {"out": f"words == 8'd{delay} & ~rst"})


def protocol_of_a_ram(parameters: Mapping[str, int]) -> Protocol:
    """Never a read of the word that is being written; addresses within the memory."""
    depth = parameters["Depth"]
    return Protocol(
        "",
        (
            "~(read_en & write_en & read_address == write_address)",
            f"~read_en | read_address < {depth}",
            f"~write_en | write_address < {depth}",
        ),
    )


def protocol_of_a_skid(_: Mapping[str, int]) -> Protocol:
    registers, assume = axis_source("s_", "data")
    return Protocol(LIVE + registers, assume, {"s_ready": "live", "m_valid": "live", "m_data": "live & m_valid"})


def protocol_of_the_guard(_: Mapping[str, int]) -> Protocol:
    registers, assume = axis_source("s_", "data", "last", "user")
    pixel, clock = "live & ~rst & en & out_valid", "live & ~rst"
    data = ("data", "first_row", "first_column", "last_row", "last_column")
    compare = {f"out_{name}": pixel for name in data}
    compare |= {f"out_{name}": f"{clock} & en" for name in ("valid", "frame_start", "frame_end")}
    compare |= dict.fromkeys(("s_ready", "row_short", "row_long", "start_missing", "start_early", "timed_out"), clock)
    return Protocol(LIVE + registers, assume, compare | {"out_bad": f"{pixel} & out_frame_end"})


def protocol_of_the_comparator(_: Mapping[str, int]) -> Protocol:
    """The first beat after a reset is the first of a frame."""
    begun = "  reg begun = 1'b0;\n  always @(posedge clk) begun <= ~rst & (begun | in_valid & in_user);\n"
    return Protocol(LIVE + begun, ("~in_valid | rst | begun | in_user",), {"contact": "live & ~rst"})


def protocol_of_the_lookup(_: Mapping[str, int]) -> Protocol:
    """The table is not written while a pixel is read."""
    word = "live & ~rst & en & out_valid"
    compare = {"out_gx": word, "out_gy": word, "out_place": word, "out_valid": "live & ~rst & en"}
    return Protocol(LIVE, ("~(write_en & in_valid)",), compare)


@dataclass(frozen=True)
class Core:
    """How a core is mutated.

    `structures` are places in the list of those that tests/test_<name>.py builds: small ones, that together have
    every generate branch that matters. `protocol` makes one of a structure's parameters.
    """

    protocol: Callable[[Mapping[str, int]], Protocol]
    structures: tuple[int, ...] = (0,)
    simulator: str = "verilator"
    bar: float = LEAF
    tests: str = ""  # a filter, where all would take too long
    inside: Mapping[str, str] = field(default_factory=dict)  # signals of the core that its testbench reads


def nothing_assumed(_: Mapping[str, int]) -> Protocol:
    return Protocol()


CORES = {
    "round_saturate": Core(nothing_assumed, (0, 1, 11)),
    "dot_product": Core(lambda _: Protocol(settled(4), (), {"sum": "settled"}), (3,)),
    "ram": Core(protocol_of_a_ram, (1,)),
    "rom": Core(lambda p: Protocol(settled(1), (f"address < {p['Depth']}",), {"data": "settled"}), (1,)),
    "delay_line": Core(protocol_of_a_delay, (4, 3)),
    "burst_counter": Core(lambda _: Protocol(LIVE, (), {"position": "live & active", "active": "live"}), (1,)),
    "axis_skid": Core(protocol_of_a_skid),
    "threshold_comparator": Core(protocol_of_the_comparator),
    "frame_guard": Core(protocol_of_the_guard),
    "gradient_lookup": Core(protocol_of_the_lookup, (1,)),
    "thomas_table": Core(
        lambda p: Protocol(settled(3), (f"row < {p['Rows']}",), {"coefficient": "settled", "shift": "settled"})
    ),
}
# Nothing in them to mutate.
LEFT_OUT = {"register_map_pkg": "constants, which axil_registers is built of"}


@dataclass
class Outcome:
    """Of one core, all its structures together."""

    core: str
    bar: float
    mutants: int = 0
    killed: int = 0
    equivalent: int = 0
    different: int = 0
    unknown: int = 0
    contradictions: int = 0  # killed, and proven equivalent: the protocol allows less than the testbench does
    every: bool = True  # those are all there are
    seconds: float = 0.0
    survivors: list[dict] = field(default_factory=list)

    @property
    def score(self) -> float:
        counted = self.mutants - self.equivalent
        return 100.0 * self.killed / counted if counted else 100.0

    @property
    def passed(self) -> bool:
        return self.score >= self.bar and not self.contradictions


def followed(path: Path, bar: tqdm, done: threading.Event) -> None:
    """Move a progress bar with the lines of a file."""
    while not done.wait(0.5):
        if path.is_file():
            bar.update(path.read_bytes().count(b"\n") - bar.n)


def mutate(name: str, core: Core, count: int, seed: int, jobs: int, seconds: int) -> Outcome:
    outcome, began = Outcome(name, core.bar), time.monotonic()
    for index in core.structures:
        structure = mutants.structure(name, index)
        folder = OUT / name / str(index)
        folder.mkdir(parents=True, exist_ok=True)
        made = mutants.make(name, structure, count, seed, folder)
        outcome.every &= len(made) < count
        with tqdm(total=len(made) + 1, desc=name, leave=False, disable=None) as bar:
            done = threading.Event()
            thread = threading.Thread(target=followed, args=(folder / "results.jsonl", bar, done))
            thread.start()
            try:
                results = mutants.run(
                    name,
                    structure,
                    made,
                    folder,
                    core.simulator,
                    inside=core.inside,
                    tests=core.tests,
                    jobs=jobs,
                    seed=seed,
                )
            finally:
                done.set()
                thread.join()
        what = {mutant.number: mutant.what for mutant in made}
        killed = [result["mutant"] for result in results if result["mutant"] and result["verdict"] == "killed"]
        lived = sorted(result["mutant"] for result in results if result["mutant"] and result["verdict"] != "killed")
        outcome.mutants += len(made)
        outcome.killed += len(killed)
        graph = equivalence.graph(name, folder, core.protocol(structure.parameters))
        for number in tqdm(lived, desc=f"{name}: survivors", leave=False, disable=None):
            verdict, how = equivalence.settle(graph, number, folder, seconds)
            setattr(outcome, verdict, getattr(outcome, verdict) + 1)
            outcome.survivors.append(
                {"structure": index, "mutant": number, "what": what[number], "verdict": verdict, "how": how}
            )
        for number in killed[:: max(1, len(killed) // CONTROLS)][:CONTROLS]:
            if equivalence.settle(graph, number, folder, 1)[0] == EQUIVALENT:
                outcome.contradictions += 1
                survivor = {"structure": index, "mutant": number, "what": what[number], "verdict": "contradiction"}
                outcome.survivors.append(survivor | {"how": "killed, yet proven equivalent"})
    outcome.seconds = time.monotonic() - began
    (OUT / name / "outcome.json").write_text(json.dumps(asdict(outcome) | {"score": outcome.score}, indent=1) + "\n")
    return outcome


HEAD = f"{'core':<22}{'mutants':>8}{'killed':>8}{'equivalent':>12}{'different':>11}{'unknown':>9}{'score':>9}{'bar':>6}{'seconds':>9}"


def row(outcome: Outcome) -> str:
    counts = (
        f"{outcome.mutants:>8}{outcome.killed:>8}{outcome.equivalent:>12}{outcome.different:>11}{outcome.unknown:>9}"
    )
    notes = ", all there are" if outcome.every else ""
    notes += f", {outcome.contradictions} CONTRADICTIONS" if outcome.contradictions else ""
    notes += "" if outcome.passed else ", MISSED"
    score = f"{outcome.score:>8.1f}%{outcome.bar:>6.0f}{outcome.seconds:>9.0f}"
    return f"{outcome.core:<22}{counts}{score}  {notes.removeprefix(', ')}".rstrip()


def parse(arguments: list[str]) -> dict[str, str]:
    choices = {
        "CORE": ",".join(CORES),
        "MUTANTS": "200",
        "SEED": "1",
        "JOBS": str(os.cpu_count() or 1),
        "SECONDS": "60",
    }
    for argument in arguments:
        name, _, value = argument.partition("=")
        if name not in choices:
            raise InputError(f"{name} is unknown: accepted are {', '.join(choices)}")
        if name != "CORE" and not value.isdecimal():
            raise InputError(f"{argument}: give a number")
        choices[name] = value
    return choices


def main() -> None:
    try:
        choices = parse(sys.argv[1:])
        names = choices["CORE"].split(",")
        for name in names:
            if name not in CORES:
                raise InputError(f"CORE={name} is unknown: accepted are {', '.join(CORES)}")
        modules = {path.stem for path in simulation.sources()}
        if modules - {"later"} != CORES.keys() | LEFT_OUT.keys() and not os.environ.get("WIP"):
            raise InputError(
                f"commands/mutate.py does not list what is in hdl/: {modules ^ (CORES.keys() | LEFT_OUT.keys())}"
            )
    except InputError as error:
        print(f"make mutate: {error}", file=sys.stderr)
        sys.exit(2)
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
    print(
        f"mutate: {sum(o.mutants for o in outcomes):,} mutants of {len(outcomes)} cores"
        + (f", missed: {', '.join(missed)}" if missed else "")
    )
    sys.exit(bool(missed))


if __name__ == "__main__":
    main()
