# SPDX-License-Identifier: Apache-2.0
"""`make coverage`: merging of Verilator's counts, waivers, gates, bins."""

import re
from pathlib import Path
from typing import Any

import pytest

from commands.common import repository
from commands.verify.coverage import (
    GATES,
    WAIVERS,
    Judged,
    Point,
    Waiver,
    gate,
    judge,
    judge_bins,
    load_waivers,
    reached_by_file,
    read,
)
from tactile_depth.chip.video.frame_guard import FAULTS
from tb.axis import positions
from tb.functional_coverage import PLACES, bins, impossible, place_of

SOURCES = {"a.sv": ["assign x = y & z;", "if (bad) $fatal;", "logic [1:0] q;"]}


def record(
    kind: str, line: Any, name: str, count: int, file: Any = f"{repository.HDL}/common/a.sv", hierarchy: Any = "top.u_a"
) -> Any:
    key = "".join(
        f"\1{field}\2{value}" for field, value in zip("flntoh", (file, line, 3, kind, name, hierarchy), strict=True)
    )
    return f"C '{key}' {count}\n"


def point(kind: str, line: Any, name: str) -> Any:
    return Point(kind, "a.sv", line, 3, name)


def waiver(**fields: Any) -> Any:
    return Waiver(**{"file": r"a\.sv", "kind": ".*", "source": "", "point": "", "reason": "because"} | fields)


def test_instances_and_runs_are_added_and_a_point_that_is_never_reached_stays() -> None:
    """Add the counts of hdl/ alone."""
    lines = ["# SystemC::Coverage-3\n", record("branch", 1, "if", 0), record("branch", 1, "if", 2, hierarchy="top.u_b")]
    points = read(lines) + read([record("branch", 1, "if", 5)])
    assert points == {point("branch", 1, "if"): 7}
    assert read([record("branch", 1, "if", 0)] * 2) == {point("branch", 1, "if"): 0}
    assert not read([record("line", 1, "block", 1, file=f"{repository.ROOT}/tb/bench.sv")])


@pytest.mark.parametrize(
    ("narrow", "wide"),
    [
        ("((row == 2'h0)==0) => 0", "((row == 7'h0)==0) => 0"),
        ("((row == (Rows - 32'sh1)[1:0])==1) => 1", "((row == (Rows - 32'sh1)[6:0])==1) => 1"),
    ],
)
def test_widths_that_follow_from_parameters_are_no_difference(narrow: Any, wide: Any) -> None:
    assert len(read([record("expr", 1, narrow, 0), record("expr", 1, wide, 1)])) == 1


@pytest.mark.parametrize("names", [("q[0]:0->1", "q[1]:0->1"), ("(q == 2'h1) => 1", "(q == 2'h2) => 1")])
def test_bits_and_values_are_a_difference(names: Any) -> None:
    assert len(read(record("toggle", 3, name, 1) for name in names)) == 2


def test_a_waiver_takes_points_out_by_source_and_by_name() -> None:
    missed = {
        point("expr", 2, "(bad==1) => 1"): 0,
        point("toggle", 3, "q[1]:0->1"): 0,
        point("toggle", 3, "q[0]:0->1"): 4,
    }
    by_source, by_name = waiver(source=r"\$fatal"), waiver(kind="toggle", point=r"q\[1\]")
    judged = judge(missed, [by_source, by_name], SOURCES)
    assert judged.counted == {point("toggle", 3, "q[0]:0->1"): 4}
    assert judged.waived == {by_source: 1, by_name: 1}
    assert not judged.errors


@pytest.mark.parametrize(
    ("fields", "error"),
    [
        ({"source": "no such text"}, "a waiver matches nothing"),
        ({"kind": "line"}, "a waiver matches a point that is reached"),
    ],
)
def test_a_waiver_of_nothing_or_of_what_is_reached_is_an_error(fields: Any, error: str) -> None:
    judged = judge({point("line", 1, "block"): 1}, [waiver(**fields)], SOURCES)
    assert [text.partition(":")[0] for text in judged.errors] == [error]


def test_what_is_excluded_does_not_count_either_way() -> None:
    points = {point("toggle", 3, "q[0]:0->1"): 0, point("toggle", 3, "q[1]:0->1"): 9}
    judged = judge(points, [waiver(excluded=True)], SOURCES)
    assert judged == Judged(counted={}, waived=judged.waived, errors=[])
    assert judge({}, [waiver(excluded=True)], SOURCES).errors


def test_waivers_are_read_from_a_file(tmp_path: Path) -> None:
    file = tmp_path / "waivers.toml"
    file.write_text("[[waiver]]\nfile = 'a\\.sv'\nkind = 'line'\nsource = '\\$fatal'\nreason = 'because'\n")
    assert load_waivers(file) == [waiver(kind="line", source=r"\$fatal")]
    file.write_text("[[waiver]]\nfile = 'a\\.sv'\nkind = 'line'\nsource = 'x'\n")
    with pytest.raises(TypeError, match="reason"):
        load_waivers(file)
    assert all(waiver.reason for waiver in load_waivers(WAIVERS))


def test_a_waiver_is_of_a_line_that_exists() -> None:
    lines = [(path.name, line) for path in repository.sources() for line in path.read_text().splitlines()]
    for waiver in load_waivers(WAIVERS):
        assert any(re.fullmatch(waiver.file, name) and re.search(waiver.source, line) for name, line in lines), waiver


@pytest.mark.parametrize("kind", GATES)
def test_below_the_gate(kind: str) -> None:
    reached = {point(kind, 1, str(index)): 1 for index in range(9)}
    assert gate(reached) == []
    assert [text.partition(":")[0] for text in gate(reached | {point(kind, 2, "not"): 0})] == [kind]


def test_toggles_may_be_missed_up_to_their_gate() -> None:
    points = {point("toggle", 3, str(index)): int(index >= 5) for index in range(100)}
    assert gate(points) == []
    assert gate(points | {point("toggle", 3, "one more"): 0})


def test_the_table_says_what_is_reached() -> None:
    rows = str(reached_by_file({point("branch", 1, "if"): 1, point("branch", 1, "else"): 0})).splitlines()
    cells = [[cell.strip() for cell in row.split("|")[1:-1]] for row in rows]
    assert cells[0] == ["file", *GATES]
    assert cells[2:] == [[name, "-", "1/2 50.0 %", "-", "-"] for name in ("a.sv", "all")]


def test_bins_missed_unknown_and_impossible() -> None:
    bins = {"hit": None, "missed": None, "never": "no reason to", "impossible": "it cannot be"}
    missed, errors = judge_bins({"hit": 1, "impossible": 2, "unknown": 1}, bins)
    assert missed == ["missed"]
    assert errors == ["an unknown bin: unknown", "hit, though impossible (it cannot be): impossible"]


@pytest.mark.parametrize("fault", FAULTS)
def test_a_place_is_impossible_where_no_frame_can_be_broken_so(fault: str) -> None:
    rows, columns = 4, 8
    possible = {place_of(*divmod(position, columns), rows, columns) for position in positions(fault, rows, columns)}
    assert possible == {place for place in PLACES if not impossible("fault, place", "spectral", (fault, place))}


def test_bins_of_both_solvers_have_names_of_their_own() -> None:
    assert (
        sum("tridiagonal" in name for name in bins()) == sum("spectral" in name for name in bins()) == len(bins()) / 2
    )
