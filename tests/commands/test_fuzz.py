# SPDX-License-Identifier: Apache-2.0
"""make fuzz: a little of it, without the fuzzer's guidance; and that it sees what it looks for."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from commands.verify import fuzz
from tactile_depth.errors import InputError

SEED = 1
RUNS = 60


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("reader", fuzz.READERS)
def test_a_reader_gives_a_result_or_one_clear_line(tmp_path: Path, reader: Any) -> None:
    chance = np.random.default_rng(SEED)
    inputs = [chance.bytes(int(chance.integers(1, fuzz.LONGEST))) for _ in range(RUNS)]
    problems = {index: fuzz.attempt(reader, data, tmp_path) for index, data in enumerate(inputs)}
    assert not {index: problem for index, problem in problems.items() if problem}, f"SEED={SEED}"


def fails(data: Any, folder: Path) -> None:
    raise KeyError("gone")


def takes_much(data: Any, folder: Path) -> None:
    np.ones((int(fuzz.memory_mb()) + 2 * fuzz.MEMORY_MB) << 17).sum()  # more than the tests before it ever took


def says_nothing(data: Any, folder: Path) -> None:
    raise InputError("")


@pytest.mark.parametrize(
    ("reader", "seen"),
    [(fails, "KeyError in test_fuzz.py"), (takes_much, "MB of memory"), (says_nothing, "not one clear line")],
)
def test_a_failure_is_seen(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, reader: Any, seen: Any) -> None:
    monkeypatch.setitem(fuzz.READERS, "bad", reader)
    assert seen in fuzz.attempt("bad", b"1", tmp_path)


def test_the_fuzzer_runs() -> None:
    runs, failures = fuzz.run("variables", 1, SEED)
    assert not failures
    assert runs > 64  # the inputs it begins with
