# SPDX-License-Identifier: Apache-2.0
"""`make mutate`: on one small core every verdict is the right one; every core of hdl/ is listed."""

from dataclasses import replace

import pytest

from commands import mutate
from commands import simulator as simulation

SMALL = "burst_counter"


@pytest.fixture
def outcome(monkeypatch, tmp_path):
    """Of a few mutants of the small core, with some of its tests."""

    def run(**changes):
        monkeypatch.setattr(mutate, "OUT", tmp_path)
        return mutate.mutate(SMALL, replace(mutate.CORES[SMALL], **changes), count=40, seed=1, jobs=1, seconds=5)

    return run


def test_every_core_is_listed():
    assert {path.stem for path in simulation.sources()} == mutate.CORES.keys() | mutate.LEFT_OUT.keys()


def test_mutants_are_killed_or_proven_equivalent(outcome):
    seen = outcome()
    assert seen.mutants == 40
    assert seen.killed + seen.equivalent == 40
    assert seen.killed > 30
    assert seen.passed


def test_holes_are_seen(outcome):
    """Without a reset in mid-burst nobody sees a counter that is not reset; without pauses, none that does not wait."""
    seen = outcome(tests="positions/pause=0.0/before=0$")
    assert seen.different > 0
    assert not seen.passed
    assert {survivor["verdict"] for survivor in seen.survivors} <= {"equivalent", "different"}
