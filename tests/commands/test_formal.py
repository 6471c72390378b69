# SPDX-License-Identifier: Apache-2.0
"""make formal: every core has a proof or a reason, two quick proofs hold, and the proof of a wrong core fails."""

import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from commands.common import repository
from commands.common.repository import cores, packages, sources
from commands.verify import formal, mutate, protocol
from commands.verify.mutants import yosys
from formal.entries import Proof
from tactile_depth.base.errors import InputError

QUICK = ("td_axis_skid", "td_burst_counter")
CORES = list(cores())


ENTRIES = formal.selected("")
REASONS = formal.reasons()


def proof(core: str) -> Any:
    return next(entry for entry in ENTRIES if entry.core == core)


def test_every_core_is_proven_or_says_why_not() -> None:
    proven = {entry.core for entry in ENTRIES}
    both_or_none = [core for core in CORES if (core in proven) == (core in REASONS)]
    assert both_or_none == [], "each has PROOFS or NO_PROOF in its test"


def test_names_are_those_of_cores_and_benches() -> None:
    assert {entry.core for entry in ENTRIES} | REASONS.keys() == set(CORES)
    assert {path.stem for path in protocol.FORMAL.rglob("fv_*.sv")} == {
        f"fv_{entry.core}" for entry in ENTRIES if isinstance(entry, Proof)
    }
    names = [entry.name for entry in ENTRIES]
    assert len(set(names)) == len(names)


def test_every_protocol_belongs_to_a_core() -> None:
    bodies = {name: protocol.body(name) for name in CORES}
    rows = {name: protocol.stated(name) for name in CORES}
    assert [name for name in CORES if rows[name] and bodies[name]] == []
    texts = "".join(path.read_text() for path in protocol.FORMAL.rglob("*.sv"))
    assert dict(protocol.BODY.findall(texts)) == {name: text for name, text in bodies.items() if text}
    used = {part for row in rows.values() for part in row}
    assert {part for part in protocol.PARTS if not re.search(rf"^ +{part} ", texts, re.M)} <= used | {"offer_stays"}


def test_every_protocol_is_read(tmp_path: Path) -> None:
    for name in CORES:
        (tmp_path / f"protocol_{name}.sv").write_text(protocol.module(name))
    tops = " ".join(f"--top protocol_{name}" for name in CORES)
    files = " ".join(map(str, [*packages(), *protocol.PARTS.values(), *sorted(tmp_path.glob("*.sv"))]))
    yosys(f"read_slang --threads 1 {tops} {files}\n", tmp_path, "read")


def test_the_list_names_every_core() -> None:
    listing = formal.listing(ENTRIES, REASONS)
    assert {line.split(" | ")[0].removeprefix("| ") for line in listing.splitlines() if line} >= set(CORES)


@pytest.mark.parametrize("core", QUICK)
@pytest.mark.parametrize("mode", formal.MODES)
def test_holds(core: str, mode: Any) -> None:
    assert formal.run(proof(core), mode).status == "PASS"


def test_a_wrong_core_is_found_out(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    wrong = tmp_path / "td_axis_skid.sv"
    text = cores()["td_axis_skid"].hdl.read_text()
    assert "m_data <= s_ready ? s_data : waiting;" in text
    wrong.write_text(text.replace("m_data <= s_ready ? s_data : waiting;", "m_data <= s_data;"))
    files = [wrong if path.name == wrong.name else path for path in sources()]
    monkeypatch.setattr(formal, "sources", lambda: files)
    monkeypatch.setattr(formal, "BUILD", tmp_path / "build")
    assert formal.run(proof("td_axis_skid"), "prove").status == "FAIL"
    assert formal.combined({"prove": formal.Outcome("FAIL", 0.0)}) != "PASS"
    (reason,) = formal.why(formal.BUILD / proof("td_axis_skid").name)
    assert re.match(r"fails: fv_td_axis_skid\.\w+ at formal/common/fv_td_axis_skid\.sv:\d+", reason)


def without(monkeypatch: pytest.MonkeyPatch, name: str) -> None:
    """Let no testbench state this."""
    stated = repository.stated
    for module in (repository, formal):
        monkeypatch.setattr(module, "stated", lambda core, wanted: None if wanted == name else stated(core, wanted))


def test_a_core_without_a_proof_or_a_reason_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    without(monkeypatch, "PROOFS")
    with pytest.raises(InputError, match="td_axis_skid: its testbench states neither PROOFS nor NO_PROOF"):
        formal.selected("td_axis_skid")


def test_a_core_without_mutants_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    without(monkeypatch, "STRUCTURES")
    with pytest.raises(InputError, match="td_axis_skid: no structure of its testbench has mutants="):
        mutate.main(chosen=["td_axis_skid"])


def test_a_core_without_a_testbench_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    bare = replace(cores()["td_axis_skid"], benches=())
    monkeypatch.setattr(repository, "cores", lambda: {bare.name: bare})
    with pytest.raises(InputError, match="td_axis_skid has no testbench tb/common/tb_td_axis_skid"):
        repository.tested([bare.name])
