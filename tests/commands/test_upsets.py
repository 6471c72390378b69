# SPDX-License-Identifier: Apache-2.0
"""Flips of `make upsets`: a flip does what it says, bits are in their populations, a table is read back."""

from pathlib import Path

import numpy as np
import pytest

from commands.verify import upset_places
from commands.verify.upset_model import Model, Outcome, prepare, simulated
from commands.verify.upset_places import CONTROL, DATA, MEMORIES, SETTINGS, SOLVER, TABLES, Place, populations
from commands.verify.upsets import CASES, HEADER, PASSING, hangs, harms, kept, measure, shares
from conftest import SEED
from tactile_depth.chip.registers.register_map import WORD


def test_registers_of_every_form_are_found() -> None:
    """`a <= b`, `{a, b} <= c`, `a[i] <= b` and `a.b <= c` in a clocked block, and in its reset."""
    assert {"place", "column", "hunting"} <= upset_places.registers_of("frame_guard")
    assert {"full", "due_here", "tags"} <= upset_places.registers_of("frame_tags")
    assert "full" in upset_places.reset_in("frame_tags")
    assert "tags" not in upset_places.reset_in("frame_tags")
    assert "bank" in upset_places.reset_in("td_banked_table")


def test_places_of_a_list() -> None:
    """A name that no core assigns, and a bit that does not stay flipped, is no place."""
    lines = [
        "TOP.bench.u_a frame_tags full 2 1 1 1",
        "TOP.bench.u_a frame_tags held 1 1 1 1",
        "TOP.bench.u_a.u_b td_ram words 15 2 64 1",
        "TOP.bench.u_a.u_c td_delay_line out 8 1 1 0",
    ]
    full, words = upset_places.places(lines)
    assert full == Place(0, "bench.u_a.full", ("frame_tags",), 2, 1, 1)
    assert words == Place(2, "bench.u_a.u_b.words", ("frame_tags", "td_ram"), 15, 2, 64)
    assert words.is_memory
    assert not words.is_table


@pytest.mark.parametrize(
    ("path", "module", "first", "second", "other", "expected"),
    [
        ("u_a.count", "td_burst_counter", 0b01, 0b10, 0b10, {CONTROL: [0, 1, 2]}),
        ("u_a.full", "frame_tags", 0, 0, 0, {CONTROL: [0, 1, 2]}),  # a reset clears it
        ("u_a.tags", "frame_tags", 0, 0, 0, {DATA: [0, 1, 2]}),
        ("u_a.taps", "td_delay_line", 0b000, 0b101, 0b001, {CONTROL: [0], DATA: [1, 2]}),  # a mark beside a datum
        ("u_solver.taps", "td_delay_line", 0b000, 0b001, 0b110, {SOLVER: [0, 1, 2]}),
        ("u_a.settings", "setting_registers", 0, 1, 1, {SETTINGS: [0, 1, 2]}),
    ],
)
def test_population_of_a_register(
    path: str, module: str, first: int, second: int, other: int, expected: dict[str, list[int]]
) -> None:
    memories = [Place(1, "u_a.words", (module, "td_ram"), 2, 1, 2), Place(2, "u_b.words", ("td_rom",), 1, 1, 3)]
    history = np.array([[first], [second]], np.uint8)
    found = populations(
        [*memories, Place(0, path, (module,), 3, 1, 1)], history, np.array([[first], [other]], np.uint8)
    )
    assert [bits.tolist() for _, bits in found[MEMORIES]] == [[0, 1, 2, 3]]
    assert [bits.tolist() for _, bits in found[TABLES]] == [[0, 1, 2]]
    registers = {name: bits.tolist() for name, each in found.items() for place, bits in each if place.path == path}
    assert registers == expected


LINE = ["7", "1.5", "0", "0", "0", "0", "3", "0.2", "0", "0", "0"]


def test_outcome_of_a_line() -> None:
    outcome = Outcome.of(LINE)
    assert outcome == Outcome((7, 0, 3), (1.5, 0.0, 0.2), (False, False, False), 0, 0)
    assert harms(outcome)
    assert not harms(outcome, 3)
    assert not outcome.is_flagged
    assert not hangs(outcome)


def test_shares_of_harm() -> None:
    """Count four: one with a mark, one with a sticky bit and a lost frame, one that is lost, one that is unseen."""
    lost = ["0", "0", "1", *LINE[3:]]
    lines = [[*LINE[:9], "1", "0"], [*lost[:10], "64"], lost, LINE, ["0", "0", "0", *LINE[3:]]]
    assert shares([Outcome.of(line) for line in lines], 0.5) == ["4", "50.0", "25.0", "25.0"]


def test_registers_that_do_not_answer_hang_and_flag_nothing() -> None:
    outcome = Outcome.of([*LINE[:10], str(WORD)])
    assert hangs(outcome)
    assert not outcome.is_flagged


def test_line_that_was_cut_off_is_dropped(tmp_path: Path) -> None:
    row = f"{CONTROL},0,u_a.count,0,1,{','.join(LINE)}\n"
    table = tmp_path / "table.csv"
    table.write_text(f"{','.join(HEADER)}\n{row}{row[:20]}")
    assert kept(table)[CONTROL] == [Outcome.of(LINE)]
    assert table.read_text() == f"{','.join(HEADER)}\n{row}"


@pytest.fixture(scope="module")
def model(tmp_path_factory: pytest.TempPathFactory) -> Model:
    return prepare(CASES["chip"], tmp_path_factory.mktemp("tables"))


def codes(model: Model, population: str, path: str, bit: int) -> set[tuple[int, ...]]:
    """Return the changes of depth, in the frames in flight and the next two, of flips of a bit in many clocks."""
    (place,) = (place for place, _ in model.populations[population] if place.path.endswith(path))
    clocks = range(0, model.pixels, 7)
    return {Outcome.of(line.split()).codes for line in model.run((place, bit, clock) for clock in clocks)}


@pytest.mark.regress
def test_flips_of_a_register_a_stored_word_and_a_table(model: Model) -> None:
    """A depth on its way out changes by the weight of the bit, a stored word in its frame, a table for good."""
    for bit in range(15):
        assert codes(model, DATA, "u_zero_offset.out_data", bit) == {(1 << bit, 0, 0)}
    stored = codes(model, MEMORIES, "u_stack.g_side[0].u_ram.u_ram.g_block.words", 14)
    assert len(stored) > 1
    assert all(not after and not later for _, after, later in stored)
    for bank, is_in_use in enumerate((True, False)):
        zero = f"u_zero_offset.u_map.g_node[0].g_table[0].u_words.g_bank[{bank}].u_ram.g_block.words"
        assert {bool(later) for _, _, later in codes(model, TABLES, zero, 14)} == {is_in_use}


@pytest.mark.regress
@pytest.mark.parametrize("population", [MEMORIES, TABLES])
def test_no_flip_of_a_stored_word_changes_a_depth_unseen(model: Model, population: str) -> None:
    flips = [model.flip(population, number, SEED) for number in range(1000)]
    outcomes = [Outcome.of(line.split()) for line in model.run(flips)]
    changed = [(flip, outcome) for flip, outcome in zip(flips, outcomes, strict=True) if any(outcome.codes)]
    assert len(changed) > 100
    assert not [flip for flip, outcome in changed if not outcome.is_flagged]


@pytest.mark.regress
def test_copy_cannot_be_flipped(model: Model) -> None:
    """A flip of what follows a register by combinational logic would be harmless for the wrong reason."""
    lines = simulated(model.built, model.folder, [model.start])
    number = next(
        number for number, line in enumerate(lines) if " td_delay_line flipped " in line and line.endswith(" 0")
    )
    copy = Place(number, "flipped", ("td_delay_line",), 1, 1, 1)
    with pytest.raises(RuntimeError, match="a flip does not stay"):
        model.run([(copy, 0, 0)])


@pytest.mark.regress
def test_sample(model: Model, tmp_path: Path) -> None:
    """No flip makes it hang, and a run goes on where the last ended."""
    table = tmp_path / "table.csv"
    first = measure(model, table, 1, SEED, 1)
    assert all(first[name] for name in PASSING)
    assert not any(hangs(each) for name in PASSING for each in first[name])
    text = table.read_text()
    assert measure(model, table, 1, SEED, 1) == first
    assert table.read_text() == text
    more = measure(model, table, 2, SEED, 1)
    assert all(more[name][: len(first[name])] == first[name] for name in first)
