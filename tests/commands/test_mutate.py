# SPDX-License-Identifier: Apache-2.0
"""`make mutate`: on one small core every verdict is the right one; every core of hdl/ but the units is mutated."""

import itertools
from pathlib import Path
from typing import Any

import pytest

from commands.common import repository
from commands.verify import mutants, mutate
from commands.verify.equivalence import HOLDS, Gates, Graph, clocks, confined, graph
from commands.verify.mutants import SELECTOR

SMALL = "td_burst_counter"


@pytest.fixture
def outcome(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Any:
    """Return a function that gives the outcome of a few mutants of the small core."""

    def run() -> Any:
        monkeypatch.setattr(mutate, "OUT", tmp_path)
        return mutate.mutate(SMALL, count=40, seed=1, jobs=1, seconds=5)

    return run


def test_every_core_but_the_units_is_mutated() -> None:
    assert set(mutate.cores()) == repository.cores().keys() - set(repository.units())


def test_a_unit_is_tested_by_its_own_testbench_or_by_that_of_its_top() -> None:
    tested = {unit: repository.tested([unit])[0] for unit in repository.units()}
    assert tested.pop("camera_unit") == "tactile_sensor"
    assert tested.pop("link_unit") == "link_unit"
    assert set(tested.values()) == {"tactile_depth"}


def test_mutants_are_killed_or_proven_equivalent(outcome: Any) -> None:
    result = outcome()
    assert result.mutants == 40
    assert result.killed + result.equivalent == 40
    assert result.killed > 30
    assert result.passed


def test_holes_are_seen(outcome: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """Without a reset inside a burst and without pauses, mutants of the reset and of the enable survive."""
    monkeypatch.setattr(mutate, "CORE_BAR", 99.0)  # of 40 mutants one is a hole
    monkeypatch.setattr(repository, "testbench", lambda core: "tests.commands.weak_bench")
    result = outcome()
    assert result.different > 0
    assert not result.passed
    assert {survivor["verdict"] for survivor in result.survivors} <= {"equivalent", "different"}


def test_an_open_mutant_counts_as_a_hole_and_a_contradiction_fails() -> None:
    counts: dict[str, Any] = {"mutants": 100, "killed": 95, "equivalent": 1}
    assert mutate.Outcome(SMALL, **counts, open=4).score == 100 * 95 / 99
    assert mutate.Outcome(SMALL, **counts, open=4).passed
    assert not mutate.Outcome(SMALL, **counts, open=4, contradictions=1).passed
    assert not mutate.Outcome(SMALL, mutants=100, killed=94, equivalent=1, open=5).passed


def test_survivors_of_a_core_with_cores_inside_can_be_settled(tmp_path: Path) -> None:
    """Build the graph of a core with cores inside: the cores are a part of it."""
    core, (built, *_) = "axil_registers", repository.structures("axil_registers")
    mutants.make(core, built, 20, 1, tmp_path, flat=repository.mutants(core).flat)
    outputs = graph(core, tmp_path, built.parameters).outputs
    assert any("s_axil_rdata" in name for name in outputs)


@pytest.mark.parametrize(("core", "count"), [("camera_setup", 1), ("td_async_fifo", 2)])
def test_a_clock_that_a_core_puts_out_is_none_of_its_clocks(tmp_path: Path, core: str, count: int) -> None:
    mutants.make(core, repository.structures(core)[0], 1, 1, tmp_path)
    assert len(clocks(core, tmp_path)) == count


def contrary(mutant: Any) -> Any:
    """Return a graph with a word register, a register of its inverse, and a valid register; all load with `en`.

    The output is the word; it counts while the valid register is high. A mutant inverts the output:

    - "equal": when word and inverse are the same, which never occurs after a cycle with `en`;
    - "loose": likewise, but the inverse register loads in every cycle;
    - "patient": after four cycles without `en`.
    """
    en, rst, x, selector, word, inverse, valid, *idle = range(2, 2 * 12, 2)  # literals of inputs and registers
    gates = Gates(12)

    def choose(condition: Any, one: Any, other: Any) -> Any:
        return gates.either((gates.both(condition, one), gates.both(condition ^ 1, other)))

    following = {
        word: choose(en, x, word),
        inverse: x ^ 1 if mutant == "loose" else choose(en, x ^ 1, inverse),
        valid: gates.both(rst ^ 1, gates.either((en, valid))),
        idle[0]: en ^ 1,
        **{later: gates.both(earlier, en ^ 1) for earlier, later in itertools.pairwise(idle)},
    }
    if mutant != "patient":
        following |= dict.fromkeys(idle, 0)
    inverts = idle[-1] if mutant == "patient" else gates.differ(word, inverse) ^ 1
    outputs = {
        "out[0]": gates.differ(word, gates.both(selector, inverts)),
        "looked_at_out": gates.both(valid, rst ^ 1),
        HOLDS: 1,
    }
    inputs = {"any_en": en, "any_rst": rst, "any_x": x, f"{SELECTOR}[0]": selector}
    latches = [(latch, to, latch) for latch, to in following.items()]
    ands = [(2 * (12 + index), a, b) for index, (a, b) in enumerate(gates.ands)]
    return Graph(inputs, latches, outputs, ands)


def turning(every: Any) -> Any:
    """Return a graph whose mutant toggles a register in every cycle, beside a word that is the same in both copies.

    The output counts in every second cycle since the last reset, or in all cycles.
    """
    rst, x, selector, toggle, word, even = range(2, 2 * 7, 2)
    gates = Gates(7)
    result = gates.differ(toggle, word)
    following = {
        toggle: gates.both(rst ^ 1, gates.differ(toggle, selector)),
        word: gates.either((gates.both(x, word ^ 1), gates.both(x ^ 1, word))),
        even: gates.either((rst, even ^ 1)),
    }
    return Graph(
        {"any_rst": rst, "any_x": x, f"{SELECTOR}[0]": selector},
        [(latch, to, latch) for latch, to in following.items()],
        {"out[0]": result, "looked_at_out": gates.both(rst ^ 1, 1 if every else even), HOLDS: 1},
        [(2 * (7 + index), a, b) for index, (a, b) in enumerate(gates.ands)],
    )


@pytest.mark.parametrize(
    ("graph", "proven"),
    [
        (contrary("equal"), True),
        (contrary("loose"), False),
        (contrary("patient"), False),
        (turning(every=False), True),
        (turning(every=True), False),
    ],
)
def test_a_difference_confined_to_a_few_registers(tmp_path: Path, graph: Any, proven: Any) -> None:
    assert confined(graph, 1, tmp_path, 5) == proven
