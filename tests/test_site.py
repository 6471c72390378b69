# SPDX-License-Identifier: Apache-2.0
"""`make site`: pages build without a warning, load nothing from elsewhere, and have the groups of docs/README.md."""

import importlib.util
import re
from pathlib import Path
from typing import Any

import pytest
import yaml

import tactile_depth as td
from commands.common.repository import ROOT
from commands.study import site

CONFIG = yaml.safe_load((ROOT / "mkdocs.yml").read_text())
GENERATED = {"api.md"}  # by the build
LOADED = re.compile(
    r'<(?:script|img|iframe)\b[^>]*\bsrc="([^"]*)"|<link rel="(?:stylesheet|icon)"[^>]*\bhref="([^"]*)"'
)


@pytest.fixture(scope="session")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder of the site, built with every warning as an error."""
    for module in ("mkdocs", "material", "mkdocstrings_handlers"):
        if importlib.util.find_spec(module) is None:
            pytest.skip(f"{module} is not installed: pip install -r requirements-docs.txt")
    folder = tmp_path_factory.mktemp("site")
    site.build(folder)
    return folder


def groups(items: list[Any]) -> dict[str, set[str]]:
    """Return the pages of each group of the navigation, without those of other sites and without what is generated."""
    named = {name: pages for item in items for name, pages in item.items() if isinstance(pages, list)}
    return {
        name: {page for item in pages for page in item.values() if "://" not in page} - GENERATED
        for name, pages in named.items()
    }


def test_the_navigation_has_the_groups_of_the_index() -> None:
    index = (ROOT / "docs" / "README.md").read_text()
    sections = dict(re.findall(r"^## (.*?)\n(.*?)(?=^## |\Z)", index, re.MULTILINE | re.DOTALL))
    listed = {
        name: {*re.findall(r"^- \[.*?\]\((?!\.\.)(.*?)\)", text, re.MULTILINE)} for name, text in sections.items()
    }
    assert groups(CONFIG["nav"]) == {name: pages for name, pages in listed.items() if pages}


def test_a_page_loads_nothing_from_elsewhere(built: Path) -> None:
    pages = list(built.rglob("*.html"))
    assert len(pages) > 30
    loaded = {(page.name, link) for page in pages for pair in LOADED.findall(page.read_text()) for link in pair if link}
    assert {(name, link) for name, link in loaded if "//" in link} == set()


def test_links_into_the_repository_lead_to_files(built: Path) -> None:
    inside = re.compile(rf'{re.escape(CONFIG["extra"]["repository"])}/(blob|tree)/main/([^"#]+)')
    links = {link for page in built.rglob("*.html") for link in inside.findall(page.read_text())}
    assert len(links) > 5
    assert [
        path for kind, path in links if (ROOT / path).is_dir() != (kind == "tree") or not (ROOT / path).exists()
    ] == []


def test_the_reference_has_every_public_name(built: Path) -> None:
    page = (built / "api.html").read_text()
    assert [name for name in td.__all__ if f'id="tactile_depth.{name}"' not in page] == []
