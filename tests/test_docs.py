# SPDX-License-Identifier: Apache-2.0
"""README and pages of docs/: links, and the paths and make targets that they name."""

import inspect
import json
import re
from collections.abc import Callable
from dataclasses import fields
from pathlib import Path
from typing import Any

import pytest

import tactile_depth as td
from commands.common import repository
from commands.common.run_request import ACCEPTED, CAMERA
from tactile_depth.chip.configuration import NUMBERS
from tactile_depth.device.status import DeviceStatus

ROOT = repository.ROOT
PAGES = sorted(
    [*ROOT.glob("*.md"), *(page for name in ("docs", "hdl", "boards") for page in (ROOT / name).rglob("*.md"))]
)
LINK = re.compile(r"\]\(([^)\s]+)\)")
FOLDERS = "hdl|models|tb|tests|formal|commands|boards|constraints|registers|docs"
# A path in backquotes that begins with a folder of the repository.
PATH = re.compile(rf"`((?:{FOLDERS})/[\w./-]*)`")
PLACEHOLDER = re.compile(r"(?:/|_)X\.")  # for the name of any core
TARGET = re.compile(r"(?:^    |`)make ([a-z-]+)\b", re.MULTILINE)
# A test that a page names as the measurement of a claim: a part of its name, and its file.
TEST = re.compile(r"pytest\s+-k\s+(\w+)\s+(tests/[\w/]+\.py)")


def named(page: Path, pattern: Any) -> Any:
    return sorted(set(pattern.findall(page.read_text())))


def missing(pattern: Any, exists: Callable[[Path, Any], bool]) -> list[tuple[str, Any]]:
    """Return what the pages name by a pattern and does not exist, each with the page."""
    return [
        (str(page.relative_to(ROOT)), name) for page in PAGES for name in named(page, pattern) if not exists(page, name)
    ]


def test_every_relative_link_and_picture_leads_to_a_file() -> None:
    def exists(page: Path, link: str) -> bool:
        file = link.partition("#")[0]
        return "://" in link or not file or (page.parent / file).exists()

    assert missing(LINK, exists) == []


def test_every_path_in_backquotes_exists() -> None:
    assert missing(PATH, lambda _, path: bool(PLACEHOLDER.search(path)) or (ROOT / path).exists()) == []


def test_every_make_target_exists() -> None:
    targets = re.findall(r"^([a-z-]+):", (ROOT / "Makefile").read_text(), re.MULTILINE)
    assert missing(TARGET, lambda _, target: target in targets) == []


def test_every_test_that_measures_a_claim_exists() -> None:
    def exists(_: Path, test: tuple[str, str]) -> bool:
        name, file = test
        return bool(re.search(rf"^def test_\w*{name}", (ROOT / file).read_text(), re.MULTILINE))

    assert missing(TEST, exists) == []


def test_the_index_links_every_page() -> None:
    index = ROOT / "docs" / "README.md"
    linked = {(index.parent / link).resolve() for link in named(index, LINK)}
    assert [page.name for page in PAGES if index.parent in page.parents and page not in (index, *linked)] == []


def test_the_page_of_make_sim_lists_every_variable() -> None:
    page = (ROOT / "docs" / "make-sim.md").read_text()
    assert [name for name in (*ACCEPTED, *CAMERA) if f"`{name}`" not in page] == []


def test_the_page_of_the_python_api_lists_every_argument_and_attribute() -> None:
    page = (ROOT / "docs" / "python.md").read_text()
    names = [*inspect.signature(td.Pipeline).parameters, *inspect.signature(td.fit).parameters]
    for call in (td.Device, td.Device.capture_zero, td.Device.set_thresholds, td.Device.depth):
        names += [name for name in inspect.signature(call).parameters if name != "self"]
    for kind in (td.Result, td.Contact, td.DeviceFrame):
        names += [field.name for field in fields(kind)]
        names += [name for name in vars(kind) if not name.startswith("_")]
    names += [name for kind in (td.Device, DeviceStatus) for name in vars(kind) if not name.startswith("_")]
    # In codes, by model, and what makes the records: threshold_mm, outside and records are for users.
    internal = ("threshold", "fitted_slope", "recorder", "streamed")
    elsewhere = (*internal, *NUMBERS)  # NUMBERS are in make-sim.md
    assert [name for name in names if not re.search(rf"\b{name}\b", page) and name not in elsewhere] == []


HANDSHAKES = {  # by waveform: signals of valid and ready, and the signals of the word
    "video": ("tvalid", "tready", ("tdata", "tuser", "tlast")),
    "depth": ("m_axis_tvalid", "m_axis_tready", ("m_axis_tdata", "m_axis_tuser")),
    "records": ("m_event_tvalid", "m_event_tready", ("m_event_tdata", "m_event_tlast")),
    "raster": ("valid", "en", ("data", "first_row", "first_column", "last_column")),
}


def values(wave: str) -> list[str]:
    """Return the value of a WaveDrom signal in each cycle; each item of data is one value."""
    out: list[str] = []
    for cycle, letter in enumerate(wave):
        out.append(out[-1] if letter == "." else f"{letter}{cycle}" if letter in "345|" else letter)
    return out


@pytest.mark.parametrize("name", HANDSHAKES)
def test_a_waveform_keeps_the_rules_of_its_stream(name: str) -> None:
    """Check that a word stays until it is taken, and that the next cycle has another word or none."""
    drawn = json.loads((ROOT / "docs" / "waves" / f"{name}.json").read_text())["signal"]
    waves = {signal["name"]: values(signal["wave"]) for signal in drawn}
    offered, takes, fields = HANDSHAKES[name]
    for cycle, (valid, ready) in enumerate(zip(waves[offered][:-1], waves[takes], strict=False)):
        if valid == "1" and ready == "0":
            stays = (offered, *fields)
            assert [waves[field][cycle] for field in stays] == [waves[field][cycle + 1] for field in stays], cycle
        elif valid == "1":
            assert waves[fields[0]][cycle] != waves[fields[0]][cycle + 1], f"the word of cycle {cycle} is not taken"


def test_each_folder_of_hdl_has_a_readme_with_its_cores() -> None:
    for folder in sorted({path.parent for path in repository.sources()}):
        text = (folder / "README.md").read_text()
        assert len(text.splitlines()) <= 50, f"{folder}: one screen"
        assert [path.name for path in sorted(folder.glob("*.sv")) if text.count(f"]({path.name})") != 1] == []
