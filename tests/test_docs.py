# SPDX-License-Identifier: Apache-2.0
"""The README and the pages of docs/: length, links, paths and make targets that they name."""

import re
from pathlib import Path
from typing import Any

import pytest

from commands.common import repository

ROOT = repository.ROOT
PAGES = sorted([*ROOT.glob("*.md"), *(ROOT / "docs").glob("*.md")])
LINK = re.compile(r"\]\(([^)\s]+)\)")
FOLDERS = "hdl|models|tb|tests|formal|commands|boards|constraints|registers|docs"
# A path in backquotes that begins with a folder of the repository.
PATH = re.compile(rf"`((?:{FOLDERS})/[\w./-]*)`")
PLACEHOLDER = re.compile(r"(?:/|_)X\.")  # for the name of any core
TARGET = re.compile(r"(?:^    |`)make ([a-z-]+)\b", re.MULTILINE)
LARGEST_README = (150, 900)  # lines, words


def named(page: Path, pattern: Any) -> Any:
    return sorted(set(pattern.findall(page.read_text())))


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
class TestPage:
    def test_every_relative_link_and_picture_leads_to_a_file(self, page: Path) -> None:
        links = [link.partition("#")[0] for link in named(page, LINK) if "://" not in link]
        assert [link for link in links if link and not (page.parent / link).exists()] == []

    def test_every_path_in_backquotes_exists(self, page: Path) -> None:
        paths = [path for path in named(page, PATH) if not PLACEHOLDER.search(path)]
        assert [path for path in paths if not (ROOT / path).exists()] == []

    def test_every_make_target_exists(self, page: Path) -> None:
        makefile = (ROOT / "Makefile").read_text()
        targets = re.findall(r"^([a-z-]+):", makefile, re.MULTILINE)
        assert [target for target in named(page, TARGET) if target not in targets] == []


def test_the_index_links_every_page() -> None:
    index = ROOT / "docs" / "README.md"
    linked = {(index.parent / link).resolve() for link in named(index, LINK)}
    assert [page.name for page in PAGES if page.parent == index.parent and page != index and page not in linked] == []


def test_the_readme_is_short() -> None:
    readme = (ROOT / "README.md").read_text()
    lines, words = LARGEST_README
    assert len(readme.splitlines()) <= lines
    assert len(readme.split()) <= words
