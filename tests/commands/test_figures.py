# SPDX-License-Identifier: Apache-2.0
"""make figures: pages have the figures of the models and of docs/figures.json, and say which sources have changed."""

import json
import re
from collections.abc import Callable
from pathlib import Path

import pytest

from commands.common import recorded, repository
from commands.hardware import synth
from commands.hardware.targets import DEFAULT_TARGET, TARGETS
from commands.study import budget, figures, presses
from tactile_depth.base.errors import InputError

WITHOUT_FIGURES = ("| variable |", "| J1 |", "| part |")  # heads of tables of settings and of pins


@pytest.mark.parametrize("page", figures.PAGES, ids=lambda page: page.stem)
def test_the_tables_of_a_page_are_current(page: Path) -> None:
    assert page.read_text() == figures.document(page), "run make figures"


def test_every_drawing_is_current() -> None:
    drawn = figures.drawings()
    assert drawn.keys() == set(repository.GENERATED.glob("*.svg"))
    assert [path.name for path, text in drawn.items() if path.read_text() != text] == [], "run make figures"


@pytest.mark.parametrize("page", figures.PAGES[2:], ids=lambda page: page.stem)
def test_a_page_has_no_other_tables_of_figures(page: Path) -> None:
    by_hand = figures.TABLE.sub("", page.read_text())
    heads = re.findall(r"(?:^|\n\n)(\|.*)", by_hand)
    assert [head for head in heads if not head.startswith(WITHOUT_FIGURES)] == []


@pytest.mark.parametrize("page", ["README.md", "docs/accuracy.md"])
def test_a_page_quotes_how_accurate_the_default_configuration_is(page: str) -> None:
    ((_, document, _),) = figures.runs("presses")
    text = " ".join((repository.ROOT / page).read_text().split())
    assert presses.sentence(document) in text
    assert len(re.findall(r"[\d.]+ [mu]m in the middle of the picture", text)) == 1, "another set"


def cells(text: str, row: str) -> list[str]:
    """Return the cells of the first row with this head in a page."""
    line = next(line for line in text.splitlines() if line.startswith(f"| {row} |"))
    return [cell.strip() for cell in line.split("|")[2:-1]]


def test_the_readme_has_the_figures_of_the_pages() -> None:
    """Compare its latencies, errors and clock with the tables of docs/results.md and docs/hardware.md."""
    docs = repository.ROOT / "docs"
    readme, results = (repository.ROOT / "README.md").read_text(), (docs / "results.md").read_text()
    tables = {
        "real sensor¹, tridiagonal": "real sensor, tridiagonal",
        "colour table², tridiagonal": "colours as sent, tridiagonal",
        "colour table², spectral": "colours as sent, spectral",
        "published design": "published design",
    }
    for name, table in tables.items():
        text = results.partition(f"<!-- figures: {table} -->")[2]
        assert cells(readme, f"{name}: latency") == cells(text, "first pixel to first depth, cycles")
        row = "error, % of peak" + ", mean over 15 contacts (worst)" * (name == "published design")
        error = readme.partition(f"| {name}: latency |")[2]  # its row is the next one
        assert cells(error, "error") == [cell.partition(" (")[0] for cell in cells(text, row)]
    words = " ".join(readme.split())
    real = results.partition("<!-- figures: real sensor, tridiagonal -->")[2]
    cycles = cells(real, "last pixel to first depth, cycles")[1]
    assert f"gives its first depth {cycles} cycles after the last pixel (real sensor, 128 x 128)" in words
    clock = next(run[1] for run in figures.runs("fpga TARGET=ulx3s") if run[1]["data_width"] == 15)
    middle, seeds = clock["fmax_mhz"], clock["fmax_mhz_by_seed"].values()
    assert f"is routed at {middle:.1f} MHz (15-bit words, parity and self-check, median of five" in words
    assert f"seeds, the best {max(seeds):.1f}" in words
    assert len(seeds) == 5


def test_the_arithmetic_adds_less_than_a_tenth_of_a_micrometre() -> None:
    ((_, document, _),) = figures.runs("budget")
    assert document["setting"]["data_width"] == 24
    for source in document["sources"]:
        part = source["parts"].index("quantisation")
        for place in source["places"].values():
            assert all(place[measure]["rms_um"][part][0] < 0.1 for measure in budget.MEASURES)


def test_a_run_of_other_sources_is_marked(monkeypatch: pytest.MonkeyPatch) -> None:
    line = "make synth N=16 PRESET=published SOLVER=tridiagonal"
    entry = {"sources": recorded.sources(line)}
    assert recorded.since(line, entry) == "same"
    plain, core = repository.code, "module divergence"
    monkeypatch.setattr(repository, "code", lambda text: plain(text).replace("module spectral_solver", "module other"))
    assert recorded.since(line, entry) == "same"  # the other solver does not count
    monkeypatch.setattr(repository, "code", lambda text: plain(text).replace(core, f"{core}_2"))
    assert recorded.since(line, entry) == "changed"


def test_comments_and_docstrings_are_no_sources(tmp_path: Path) -> None:
    file = tmp_path / "model.py"
    digests = []
    for text in (
        "def depth(x):\n    return x\n",
        "def depth(x: int) -> int:\n    '''Words.'''\n    return x  # more\n",
        "depth = 1",
    ):
        file.write_text(text)
        digests.append(recorded.digest([file]))
    assert digests[0] == digests[1] != digests[2]


def test_other_tables_are_other_sources() -> None:
    assert len({recorded.sources(f"make synth N={size} PRESET=published") for size in (16, 32)}) == 2


def test_every_recorded_line_is_one_of_its_command() -> None:
    lines = recorded.load()
    with pytest.raises(InputError):
        recorded.sources("make synth NO_VARIABLE=1")
    for line in lines:
        assert recorded.sources(line)
        assert line == recorded.command_line(line.split()[1], line.split()[2:])


@pytest.fixture
def results(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    file = tmp_path / "figures.json"
    file.write_text('{"make synth N=16 PRESET=published": {"name": "small"}}')
    monkeypatch.setattr(recorded, "RESULTS", file)
    monkeypatch.setattr(recorded, "ROOT", tmp_path)
    return file


def git_where(changed: bool) -> Callable[..., bytes | None]:
    return lambda *words: None if changed and words[0] == "diff" else b"1234567\n"


def test_a_run_is_recorded_with_its_commit(results: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    totals = dict.fromkeys(TARGETS[DEFAULT_TARGET].has, 5.0)
    described = {"grid": [16, 16], "solver": "spectral", "lanes": 1}
    design = synth.Design(described, totals, {}, {"memory in UltraRAM": 1.0}, [], [], "", 1.0)
    before = results.read_text()
    monkeypatch.setattr(recorded, "git", git_where(changed=True))
    monkeypatch.setattr("sys.argv", ["synth", *["PRESET=published", "N=16"]])
    recorded.record(synth.recordable([design], DEFAULT_TARGET))
    assert results.read_text() == before
    monkeypatch.setattr(recorded, "git", git_where(changed=False))
    monkeypatch.setattr("sys.argv", ["synth", *["PRESET=published", "N=32"]])
    recorded.record(synth.recordable([design], DEFAULT_TARGET))
    assert json.loads(results.read_text()) == json.loads(before), "a line that is not in the file is not recorded"
    monkeypatch.setattr("sys.argv", ["synth", *["PRESET=published", "N=16"]])
    recorded.record(synth.recordable([design], DEFAULT_TARGET))
    assert figures.synthesized(over_grids=False).markdown().splitlines()[2] == (
        "| small | 16 x 16 | 5 | 5 | 5 | 5 | 5 | 1.0 | 1234567 | same |"
    )
