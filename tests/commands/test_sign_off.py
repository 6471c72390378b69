# SPDX-License-Identifier: Apache-2.0
"""make sign-off: a change of what a result depends on is seen, no other; results are kept as they come."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest

from commands.common import repository
from commands.verify import fingerprint, sign_off

NO_MUTANT = dict.fromkeys(sign_off.COUNTED, 0)
PROVEN = {"failed": 0, "not ended": 0, "seconds": 3}


def test_the_page_shows_every_result() -> None:
    """The last two columns say which were of the sources of the day."""

    def recorded(page: str) -> list[str]:
        return [line.rsplit(" | ", 2)[0] for line in page.splitlines() if line.startswith("|")]

    assert recorded(sign_off.PAGE.read_text()) == recorded(sign_off.document()), "run make sign-off CHECK=1"


def test_every_result_is_of_a_core() -> None:
    assert sign_off.load().keys() <= repository.cores().keys()


FILES = {
    "hdl/top.sv": "module top;\n  part #(.N(a_pkg::N)) u_part (.*);\nendmodule\n",
    "hdl/part.sv": "module part (input logic a); // a part\nendmodule\n",
    "hdl/other.sv": "module other;\nendmodule\n",
    "hdl/a_pkg.sv": "package a_pkg;\n  localparam int N = 1;\nendpackage\n",
    "formal/fv_top.sv": "module fv_top;\n  top dut (.*);\n  shared u_shared (.*);\nendmodule\n"
    "module protocol_top;\n  assign holds = 1;\nendmodule\n",
    "formal/shared.sv": "module shared;\nendmodule\n",
    "formal/protocol_rows.sv": "module protocol_rows;\nendmodule\n",
    "models/tactile_depth/chip/top.py": "from tactile_depth.chip import scale\n\n\ndef top(word: int) -> int:\n"
    "    return scaled(word)\n\n\ndef scaled(word: int) -> int:\n    return scale.TWO * word\n\n\n"
    "def latency() -> int:\n    return 3\n",
    "models/tactile_depth/chip/scale.py": "TWO = 2\n",
    "tb/tb_top.py": '"""Top."""\n\nfrom tactile_depth.chip.top import top\nfrom tb.tests import again as again\n\n'
    'STEPS = 5\nSTRUCTURES = (Structure(mutants=True),)\nPROTOCOL = {"protocol_rows": {}}\n'
    "PROOFS = (Proof(STEPS),)\n\n\n"
    "def legal(words):\n    return words\n\n\n@cocotb.test()\nasync def words(dut):\n    assert top(1) == 2\n",
    "tb/tests.py": "@cocotb.test()\nasync def again(dut):\n    pass\n",
}


@pytest.fixture
def tree(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return the root of a repository of one core, top."""
    for name, text in FILES.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)
    bench, proof = tmp_path / "tb/tb_top.py", tmp_path / "formal/fv_top.sv"
    core = repository.Core("top", "", tmp_path / "hdl/top.sv", None, (bench,), proof)
    monkeypatch.setattr(repository, "cores", lambda: {"top": core})
    monkeypatch.setattr(fingerprint, "ROOT", tmp_path)
    return tmp_path


@pytest.mark.parametrize(
    ("file", "old", "new", "changed"),
    [
        ("hdl/top.sv", "u_part", "u_other", ["proof", "mutants"]),
        ("hdl/part.sv", "input", "output", ["proof", "mutants"]),
        ("hdl/a_pkg.sv", "1", "2", ["proof", "mutants"]),
        ("hdl/a_pkg.sv", "endpackage", "typedef logic [1:0] b_t;\nendpackage", []),
        ("hdl/part.sv", " (input logic a); // a", "(\n  input logic a\n);  // the", []),
        ("hdl/other.sv", "other", "another", []),
        ("formal/fv_top.sv", "u_shared", "u_other", ["proof"]),
        ("formal/shared.sv", ";", "(input logic a);", ["proof"]),
        ("formal/protocol_rows.sv", ";", "(input logic a);", ["proof", "mutants"]),
        ("formal/fv_top.sv", "assign holds = 1", "assign holds = 0", ["proof", "mutants"]),
        ("models/tactile_depth/chip/top.py", "TWO * word", "TWO + word", ["mutants"]),
        ("models/tactile_depth/chip/scale.py", "2", "3", ["mutants"]),
        ("models/tactile_depth/chip/top.py", "return 3", "return 4", []),
        ("models/tactile_depth/chip/top.py", "word: int) -> int:\n", "word: float):  # any\n    'Scale.'\n", []),
        ("tb/tb_top.py", "top(1) == 2", "top(2) == 4", ["mutants"]),
        ("tb/tb_top.py", "Top.", "The top.", []),
        ("tb/tb_top.py", "mutants=True", "on=BOTH, mutants=True", ["mutants"]),
        ("tb/tb_top.py", "STEPS = 5", "STEPS = 6", ["proof"]),
        ("tb/tb_top.py", "PROOFS", "NO_PROOF = 'it is a part'\nPROOFS", []),
        ("tb/tests.py", "pass", "assert dut", ["mutants"]),
    ],
)
def test_a_fingerprint_is_of_what_a_result_depends_on(
    file: str, old: str, new: str, changed: list[str], tree: Path
) -> None:
    fingerprints = []
    for text in (FILES[file], FILES[file].replace(old, new, 1)):
        (tree / file).write_text(text)
        fingerprint.rtl_files.cache_clear()
        fingerprint.read_python.cache_clear()
        fingerprint.read_rtl.cache_clear()
        fingerprints.append({kind: fingerprint.fingerprint("top", kind) for kind in fingerprint.KINDS})
    fingerprint.rtl_files.cache_clear()
    before, after = fingerprints
    assert [kind for kind in before if before[kind] != after[kind]] == changed


@pytest.fixture
def results(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Empty results, whose page has one core."""
    path = tmp_path / "sign-off.json"
    path.write_text("{}")
    monkeypatch.setattr(sign_off, "RESULTS", path)
    monkeypatch.setattr(sign_off, "PAGE", tmp_path / "sign-off.md")
    monkeypatch.setattr(sign_off, "LOGS", tmp_path / "logs")
    monkeypatch.setattr(sign_off, "signed", lambda: ["td_ram"])
    return path


def kept(results: Path) -> Any:
    return json.loads(results.read_text())["td_ram"]


def record(kind: str, figures: Mapping[str, int | str]) -> None:
    sign_off.record("td_ram", kind, fingerprint.fingerprint("td_ram", kind), figures)


def test_a_result_is_kept_unless_there_is_one_of_more_mutants(results: Path) -> None:
    for killed in (40, 200, 100):
        record("mutants", NO_MUTANT | {"killed": killed, "each": killed, "seconds": 9})
    assert kept(results)["mutants"]["killed"] == 200
    assert sign_off.row("td_ram", kept(results))[3:] == (
        *("200 killed, of 200", "100.0 %", kept(results)["mutants"]["commit"]),
        *("proof missing", "-"),
    )
    record("proof", PROVEN)
    both = kept(results)
    assert [sign_off.row("td_ram", both)[place] for place in (1, 6, 7)] == ["hold", "same", "V3"]
    assert "| td_ram | hold |" in sign_off.PAGE.read_text()
    for figures, verdict in (({"not ended": 1}, "not all ended"), ({"not ended": 1, "failed": 1}, "FAILED")):
        assert sign_off.row("td_ram", {"proof": both["proof"] | figures})[1] == verdict


def test_no_result_of_sources_that_changed_meanwhile(results: Path, capsys: pytest.CaptureFixture[str]) -> None:
    sign_off.record("td_ram", "proof", "other", PROVEN)
    assert results.read_text() == "{}"
    assert "td_ram" in capsys.readouterr().out


def test_a_result_is_stale_if_it_is_of_other_sources_or_of_few_mutants(results: Path) -> None:
    record("proof", PROVEN)
    record("mutants", NO_MUTANT | {"killed": 40, "each": 40, "seconds": 9})
    both = kept(results)
    assert sign_off.stale("td_ram", both) == {"mutants": "few"}
    assert not sign_off.stale("td_ram", both | {"mutants": both["mutants"] | {"each": "all"}})
    assert sign_off.stale("td_ram", both | {"proof": PROVEN | {"rtl": "old"}})["proof"] == "changed"
    assert sign_off.stale("td_rom", {}) == {"mutants": "missing"}
    assert sign_off.reason("td_rom")


def test_the_shortest_come_first_and_cores_without_a_time_in_the_middle() -> None:
    timed = {core: {"mutants": {"seconds": seconds}} for core, seconds in (("a", 50), ("b", 10), ("c", 30), ("d", 90))}
    left = {core: {"mutants": "changed"} for core in "abcde"}
    assert sign_off.times(left, timed) == {"b": 10, "c": 30, "e": 45, "a": 50, "d": 90}
    assert list(sign_off.times(left, timed)) == ["b", "c", "e", "a", "d"]


def test_it_runs_what_is_left_and_resumes(
    results: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The first run is ended behind the proof."""
    ran = []

    def play(command: list[str], _: Path) -> None:
        ran.append(command[0])
        if command[0] == "formal":
            record("proof", PROVEN)
        elif len(ran) > 2:
            record("mutants", NO_MUTANT | {"killed": 100, "each": 100, "seconds": 9})

    monkeypatch.setattr(sign_off, "play", play)
    assert sign_off.main(check=True) == 1
    assert sign_off.main(jobs=1) == 1
    assert "1 of 1, td_ram: hold; no result, see " in capsys.readouterr().out
    assert sign_off.main(jobs=1) == 0
    assert ran == ["formal", "mutate", "mutate"]
    assert sign_off.main(check=True) == 0
    assert capsys.readouterr().out.endswith("sign-off: 1 of 1 cores have proof and mutants of today's sources\n")
