# SPDX-License-Identifier: Apache-2.0
"""make sign-off: the page is that of the results; a result is kept with its commit, and a change of RTL is seen."""

import json
from pathlib import Path

import pytest

from commands.common import repository
from commands.verify import sign_off


def test_the_page_is_current() -> None:
    assert sign_off.PAGE.read_text() == sign_off.document(), "run make sign-off"


def test_every_result_is_of_a_core() -> None:
    assert sign_off.load().keys() <= repository.cores().keys()


def test_comments_and_white_space_are_no_change() -> None:
    text = "module a; // old\n  wire b;\nendmodule\n"
    assert sign_off.fingerprint(text) == sign_off.fingerprint("module a;\n wire b; /* new */ endmodule")
    assert sign_off.fingerprint(text) != sign_off.fingerprint(text.replace("b", "c"))


@pytest.mark.parametrize("refuses", ["ls-files", "diff"])
def test_no_result_of_rtl_that_is_not_committed(
    refuses: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    results = tmp_path / "sign-off.json"
    results.write_text("{}")
    monkeypatch.setattr(sign_off, "RESULTS", results)
    monkeypatch.setattr(sign_off, "git", lambda *words: None if words[0] == refuses else b"1234567\n")
    sign_off.record("td_ram", "proof", {"failed": 0, "not ended": 0})
    assert results.read_text() == "{}"
    assert "commit hdl/common/td_ram.sv" in capsys.readouterr().out


def test_a_result_is_kept_unless_there_is_one_of_more_mutants(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    results = tmp_path / "sign-off.json"
    results.write_text("{}")
    monkeypatch.setattr(sign_off, "RESULTS", results)
    monkeypatch.setattr(sign_off, "git", lambda *words: b"1234567\n")
    for killed in (40, 200, 100):
        sign_off.record("td_ram", "mutants", {"killed": killed, "equivalent": 0, "different": 0, "open": 0})
    kept = json.loads(results.read_text())["td_ram"]["mutants"]
    assert (kept["killed"], kept["commit"]) == (200, "1234567")
    assert sign_off.row("td_ram", {"mutants": kept})[4:8] == ("200 killed, of 200", "100.0 %", "1234567", "same")
    assert sign_off.row("td_ram", {"mutants": kept | {"rtl": "other"}})[7] == "changed"
    sign_off.record("td_ram", "proof", {"failed": 0, "not ended": 0})
    both = json.loads(results.read_text())["td_ram"]
    assert (sign_off.row("td_ram", both)[1], sign_off.row("td_ram", both)[8]) == ("hold", "V3")
    for figures, verdict in (({"not ended": 1}, "not all ended"), ({"not ended": 1, "failed": 1}, "FAILED")):
        assert sign_off.row("td_ram", {"proof": both["proof"] | figures})[1] == verdict
