# SPDX-License-Identifier: Apache-2.0
"""make formal: every core has a proof or a reason, two quick proofs hold, and the proof of a wrong core fails."""

import re
from pathlib import Path
from typing import Any

import pytest

from commands.common.repository import cores, sources
from commands.verify import formal, mutate
from formal import proofs

QUICK = ("td_axis_skid", "td_burst_counter")
CORES = list(cores())


def proof(core: str) -> Any:
    return next(proof for proof in proofs.PROOFS if proof.core == core)


ENTRIES: tuple[Any, ...] = (*proofs.PROOFS, *proofs.STRUCTURES)


@pytest.mark.parametrize("core", CORES)
def test_every_core_is_proven_or_says_why_not(core: Any) -> None:
    proven = any(core == entry.core for entry in ENTRIES)
    assert proven != (core in proofs.WITHOUT_CONTROL), f"{core}: a bench in formal/ or a reason in WITHOUT_CONTROL"


def test_names_are_those_of_cores_and_benches() -> None:
    assert {entry.core for entry in ENTRIES} | set(proofs.WITHOUT_CONTROL) == set(CORES)
    benches = {f"fv_{entry.core}" for entry in proofs.PROOFS} | set(formal.HELPERS)
    assert {path.stem for path in formal.BENCHES.glob("*.sv")} == set(formal.HELPERS) | {"protocol_tactile_depth"}
    assert {path.stem for path in formal.BENCHES.rglob("fv_*.sv")} | set(formal.HELPERS) == benches
    names = [entry.name for entry in ENTRIES]
    assert len(set(names)) == len(names)


def test_every_protocol_belongs_to_a_core() -> None:
    used = {f"protocol_{core.protocol or name}" for name, core in mutate.CORES.items()}
    files = {path.stem for path in formal.BENCHES.rglob("protocol_*.sv")}
    assert files <= used
    assert used - files == {"protocol_td_round_saturate"}, "any input is allowed, and the output always counts"


def test_document_is_up_to_date() -> None:
    assert formal.DOCUMENT.read_text() == formal.document(), "run python -m commands.verify.formal --document"


@pytest.mark.parametrize("path", sorted(formal.BENCHES.rglob("fv_*.sv")), ids=lambda path: path.stem)
def test_every_bench_asserts_and_covers(path: Path) -> None:
    text = path.read_text()
    shared = [file for file in formal.BENCHES.glob("*.sv") if re.search(rf"^ +{file.stem} #", text, re.MULTILINE)]
    nested = [file for file in formal.BENCHES.glob("*.sv") if any(f" {file.stem} #" in f.read_text() for f in shared)]
    text += "".join(file.read_text() for file in {*shared, *nested})
    assert re.search(r"\bassert \(", text)
    assert re.search(r"\bcover \(", text)


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
