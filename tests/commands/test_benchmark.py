# SPDX-License-Identifier: Apache-2.0
"""make benchmark: its variables, the package that it imports, and its statistics."""

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from commands.study import benchmark
from commands.study.benchmark import ROUNDS, parse, summary, table
from commands.study.benchmark_child import CASES, import_path
from tactile_depth.errors import InputError


@pytest.mark.parametrize(
    ("word", "says"),
    [
        ("AFTER=HEAD", "unknown variable"),
        ("ROUNDS=3", "a whole number from 10"),
        ("BEFORE=no-such-commit", "no commit of this clone"),
        ("BEFORE=--all", "no commit of this clone"),
    ],
)
def test_bad_input(word: Any, says: str) -> None:
    with pytest.raises(InputError, match=says):
        parse([word])


def test_a_commit_is_named_by_its_hash() -> None:
    request = parse(["BEFORE=HEAD", "ROUNDS="])
    assert re.fullmatch("[0-9a-f]{7,}", request.before)
    assert request.rounds == ROUNDS


def test_a_folder_that_cannot_be_written(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    with pytest.raises(InputError, match="is a file: give a folder"):
        benchmark.run(parse(["BEFORE=HEAD", f"OUT={tmp_path / 'file'}"]))


def test_the_package_is_imported_from_models(tmp_path: Path) -> None:
    (tmp_path / "models" / "tactile_depth").mkdir(parents=True)
    assert import_path(tmp_path) == tmp_path / "models"


def test_modules_before_the_package_are_imported_as_models(tmp_path: Path) -> None:
    (tmp_path / "models").mkdir()
    assert import_path(tmp_path) == tmp_path


def test_the_ratio_is_that_of_neighbouring_runs() -> None:
    """Slow the machine down by three in half of the rounds: medians of each version alone would give a wrong ratio."""
    slow = np.where(np.arange(40) % 2, 3.0, 1.0)
    row = summary("chip", np.stack((10 * slow, 4 * slow), axis=-1), 0.0)
    assert (row["ratio"], row["ratio_low"], row["ratio_high"]) == pytest.approx((0.4, 0.4, 0.4))
    assert (row["before_ms"], row["now_ms"]) == pytest.approx((20, 8))


def test_the_spread_is_that_of_the_ratios() -> None:
    ratios = np.linspace(0.3, 0.5, 101)
    row = summary("chip", np.stack((np.full(101, 10.0), 10 * ratios), axis=-1), 0.0)
    assert (row["ratio_low"], row["ratio"], row["ratio_high"]) == pytest.approx((0.32, 0.4, 0.48))


def test_the_table_shows_both_times_the_ratio_and_the_difference() -> None:
    row = summary("float", np.array([[10.0, 4.0], [10.0, 4.0]]), 2e-16)
    cells = [cell.strip() for cell in table([row], "1234567").splitlines()[-1].strip("|").split("|")]
    assert cells == ["float", "10.00", "4.00", "0.40", "0.40 to 0.40", "2e-16"]


def test_a_version_that_does_not_run_is_told(tmp_path: Path) -> None:
    broken = tmp_path / "models" / "tactile_depth"
    broken.mkdir(parents=True)
    (broken / "__init__.py").touch()
    benchmark.draw_pictures(tmp_path)
    with (
        benchmark.started("1234567", tmp_path, tmp_path) as version,
        pytest.raises(RuntimeError, match="the models of 1234567 do not run"),
    ):
        version.run("chip")


def test_a_version_runs_every_case(tmp_path: Any) -> None:
    benchmark.draw_pictures(tmp_path)
    with benchmark.started("this", benchmark.ROOT, tmp_path) as version:
        for case, pictures in CASES.items():
            assert version.run(case) > 0
            depth = np.load(version.results / f"{case}.npy")
            assert depth.shape == (pictures, 128, 128)
            assert depth.dtype == np.float64
