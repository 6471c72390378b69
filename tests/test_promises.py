# SPDX-License-Identifier: Apache-2.0
"""docs/promises.json: each promise stands in its page, what holds it exists, and no sentence promises more."""

import re
from functools import cache

import pytest

from commands.common.repository import ROOT
from commands.study import promises
from commands.verify import formal
from tactile_depth.base.errors import InputError

PROMISES = promises.load()
CHECKS = sorted({check for listed in PROMISES.values() for checks in listed.values() for check in checks})
WORDS = re.compile(
    r"\b(never|always|every (code|bit)|bit for bit|exactly|guarantee(s|d)?|nothing is lost|no wrong|whatever)\b", re.I
)
EXCEPTIONS = {  # sentences with such a word, and what they are
    "docs/verification.md": {"whatever pixels and tables hold": "a definition of control"},
}


@cache
def targets() -> set[str]:
    """Return the names of the targets of make."""
    return {*re.findall(r"^([a-z-]+):", (ROOT / "Makefile").read_text(), re.MULTILINE)}


def exists(check: str) -> bool:
    """Return True if a check names a function of a file, a target of make or, with its cores, proofs."""
    if not check.startswith("make "):
        file, _, name = check.partition("::")
        path = ROOT / file
        return path.is_file() and bool(re.search(rf"^(?:async )?def {name}\(", path.read_text(), re.MULTILINE))
    _, target, *variables = check.split()
    if target == "formal" and variables:
        try:
            return bool(formal.selected(variables[0].removeprefix("CORE=")))
        except InputError:  # no such core, or one without a proof
            return False
    return target in targets()


def absent(page: str, parts: dict[str, object]) -> list[str]:
    """Return the parts of sentences that do not stand in a page."""
    listed = list(promises.sentences(ROOT / page))
    return [part for part in parts if not any(part in sentence for sentence in listed)]


@pytest.mark.parametrize("page", PROMISES)
def test_each_promise_stands_in_its_page(page: str) -> None:
    assert absent(page, {**PROMISES[page]}) == []


@pytest.mark.parametrize("page", EXCEPTIONS)
def test_each_exception_stands_in_its_page(page: str) -> None:
    assert absent(page, {**EXCEPTIONS[page]}) == []


def test_each_promise_has_a_check() -> None:
    assert [text for listed in PROMISES.values() for text, checks in listed.items() if not checks] == []


@pytest.mark.parametrize("check", CHECKS)
def test_a_check_exists(check: str) -> None:
    assert exists(check)


@pytest.mark.parametrize(
    "check", ["tests/test_promises.py::test_none", "tests/none.py::test_x", "make none", "make formal CORE=none"]
)
def test_a_check_that_does_not_exist_is_found_out(check: str) -> None:
    assert not exists(check)


def test_no_sentence_promises_more() -> None:
    """Find each sentence with a word of a promise among the promises, or among those that say something else."""
    more = []
    for page in promises.PAGES:
        name = str(page.relative_to(ROOT))
        known = (*PROMISES.get(name, {}), *EXCEPTIONS.get(name, {}))
        more += [
            (name, sentence)
            for sentence in promises.sentences(page)
            if WORDS.search(sentence) and not any(part in sentence for part in known)
        ]
    assert more == [], "add it to docs/promises.json with what holds it, or say less"


def test_the_table_is_current() -> None:
    assert promises.PAGE.read_text() == promises.document(), "run make figures"
