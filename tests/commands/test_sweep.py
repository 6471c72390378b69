# SPDX-License-Identifier: Apache-2.0
"""`make sweep`: its configurations; no row is lost or measured twice; errors for bad input."""

import contextlib
import csv
import json
import os
import re
import signal
import socket
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from commands.common import published, repository, run_request
from commands.cost.cost import cost
from commands.run import sim
from commands.study import study, sweep
from commands.study.study import line
from commands.study.sweep import SWEEP, WORST, Point, Row, square
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.latency import first_depth_latency, last_pixel_to_last_depth
from tactile_depth.chip.limits import COLUMNS

SMALL = [square(16, solver=solver, data_width=width) for solver in COLUMNS for width in (12, 18, 24)] + [
    square(16, boundary="neumann")
]


def table(folder: Path) -> Any:
    with (folder / "sweep.csv").open(newline="") as file:
        return list(csv.DictReader(file))


def test_the_plan_is_the_issue_s() -> None:
    points = sweep.plan()
    assert len(set(points)) == len(points)
    for solver in COLUMNS:
        mine = [point for point in points if point.solver == solver and point.lanes == 1]
        plane = {
            (point.data_width, point.coefficient_width)
            for point in mine
            if (point.columns, point.boundary, point.depth_range) == (128, "dirichlet", "default")
        }
        assert plane == {(d, c) for d in range(12, 33) for c in range(10, 25)}
        safe = [point for point in mine if point.depth_range == WORST]
        assert {point.data_width for point in safe} == set(range(12, 33))
        assert Counter(point.boundary for point in safe) == {"dirichlet": 21, "neumann": 1}
        within = [point for point in mine if point.depth_range == "default"]
        others = [point for point in within if (point.columns, point.boundary) != (128, "dirichlet")]
        for point in others:  # differ from the default in one thing
            changes = vars(point).items() - vars(sweep.DEFAULT).items()
            assert len({name for name, _ in changes} & {"columns", "boundary", "data_width"}) == 1
        assert {point.columns for point in others} == {32, 64, 128, 256, 512}
        assert Counter(point.boundary for point in others)["neumann"] == 1
    lanes = [(point.columns, point.lanes) for point in points if point.lanes > 1]
    assert Counter(lanes) == Counter((columns, 1 << n) for columns in (128, 256) for n in range(1, 7))


def test_lanes_change_the_cost_and_the_latency_alone() -> None:
    one, two, four = (SWEEP.measured(square(32, solver="tridiagonal", lanes=lanes)) for lanes in (1, 2, 4))
    config = Configuration(columns=32, solver="tridiagonal", lanes=2)
    assert two.last_pixel_to_last_depth_cycles == last_pixel_to_last_depth(config)
    assert one.multipliers == two.multipliers == cost(config).tiles < four.multipliers
    same = [name for name in SWEEP.header if name.startswith(("rms_", "max_", "true_", "sat"))]
    assert [getattr(four, name) for name in same] == [getattr(one, name) for name in same]
    assert "32 x 32" not in sweep.summary([one, two])

    text = sweep.summary([row.but(columns=128, rows=128) for row in (one, two)])
    assert "| 128 x 128, 2 | " in text


def test_a_range_that_nothing_leaves() -> None:
    row, default = (SWEEP.measured(square(32, depth_range=depth)) for depth in (WORST, "default"))
    assert row.depth_range_mm > default.depth_range_mm
    assert row.saturations == 0
    assert row.rms_percent_mean > default.rms_percent_mean


def test_a_row_holds_what_was_measured() -> None:
    row = SWEEP.measured(square(32, solver="tridiagonal", data_width=20))
    config = Configuration(columns=32, solver="tridiagonal", data_width=20)
    assert row.problem == ""
    assert row.frames == 15
    assert 0 < row.rms_percent_mean < row.rms_percent_worst < row.max_percent_worst < 1
    assert row.first_depth_cycles == first_depth_latency(config)
    assert row.multipliers == cost(config).tiles
    assert row.frame_store_bits + row.delay_line_bits + row.table_bits + row.row_buffer_bits == row.memory_bits


def test_wider_words_err_less_and_the_sensor_s_share_stays() -> None:
    narrow, wide = (SWEEP.measured(square(32, data_width=width)) for width in (16, 24))
    assert wide.rms_percent_mean < narrow.rms_percent_mean / 100
    for row in (narrow, wide):  # 4 bits of each colour leave a hundredth of a millimetre
        assert 0.001 < row.true_rms_mm_mean < 0.02


# The bars of the accuracy over the bench.
@pytest.mark.parametrize("solver", COLUMNS)
def test_bench_at_the_default_and_at_twenty_bits(solver: str) -> None:
    row = SWEEP.measured(square(solver=solver))
    assert row.rms_percent_mean <= 0.005
    assert row.rms_percent_worst <= 0.015
    narrow = SWEEP.measured(square(solver=solver, data_width=20))
    assert narrow.rms_percent_mean <= published.RMS_PERCENT


@pytest.mark.parametrize(
    ("solver", "data_width", "coefficient_width", "boundary"),
    [
        ("tridiagonal", 32, 24, "dirichlet"),
        pytest.param("spectral", 14, 10, "neumann", marks=pytest.mark.regress),
    ],
)
def test_a_row_is_what_the_rtl_does(
    tmp_path: Path, solver: str, data_width: int, coefficient_width: int, boundary: str
) -> None:
    words = [f"SOLVER={solver}", f"DATA_WIDTH={data_width}", f"COEFF_WIDTH={coefficient_width}", f"BOUNDARY={boundary}"]
    assert sim.run(run_request.parse(["N=16", "FRAMES=bench", "SIM=icarus", f"OUT={tmp_path / 'out'}", *words])) == 0
    report = json.loads((tmp_path / "out" / "report.json").read_text())
    choices: dict[str, Any] = {"solver": solver, "data_width": data_width, "coefficient_width": coefficient_width}
    row = SWEEP.measured(square(16, boundary=boundary, **choices))
    for name in ("rms", "max"):
        percent = report[f"{name}_percent_of_peak"]
        assert getattr(row, f"{name}_percent_mean") == pytest.approx(sum(percent) / len(percent), rel=1e-5)
        assert getattr(row, f"{name}_percent_worst") == pytest.approx(max(percent), rel=1e-5)
    assert {row.first_depth_cycles} == set(report["first_depth_latency_cycles"])
    assert {row.last_pixel_to_first_depth_cycles} == set(report["last_pixel_to_first_depth_cycles"])
    assert row.saturations == sum(report["saturations"].values())


def test_a_configuration_that_cannot_be_built_is_a_row(tmp_path: Path) -> None:
    (row,) = SWEEP.complete([square(512, data_width=12)], tmp_path)
    assert "data_width=12 cannot hold the formats" in row.problem
    assert row.rms_percent_mean is None
    assert [cells["rms_percent_mean"] for cells in table(tmp_path)] == [""]


def test_nothing_is_measured_twice(tmp_path: Path, monkeypatch: Any) -> None:
    first = SWEEP.complete(SMALL[:3], tmp_path)
    before = (tmp_path / "sweep.csv").read_bytes()
    measured: list[Point] = []

    def here(measure: Any, points: list[Point]) -> Iterator[Any]:
        measured.extend(points)
        return (measure(point) for point in points)

    monkeypatch.setattr(study, "on_all_cores", here)
    rows = SWEEP.complete(SMALL, tmp_path)
    assert measured == SMALL[3:]
    assert rows[:3] == first
    assert (tmp_path / "sweep.csv").read_bytes().startswith(before)
    assert sorted(map(str, study.read(tmp_path / "sweep.csv", Row))) == sorted(map(str, rows))


@pytest.mark.parametrize("torn", [b"spectral,dirichlet,16,16,2", b'tridiagonal,dirichlet,16,16,24,18,default,"DATA'])
def test_a_torn_last_line_is_mended(tmp_path: Path, torn: Any) -> None:
    rows = SWEEP.complete(SMALL[:2], tmp_path)
    path = tmp_path / "sweep.csv"
    content = path.read_bytes()
    path.write_bytes(content + torn)
    assert SWEEP.complete(SMALL[:2], tmp_path) == rows
    assert path.read_bytes() == content


@pytest.mark.parametrize("length", [0, 10])
def test_a_torn_header_is_mended(tmp_path: Path, length: int) -> None:
    path = tmp_path / "sweep.csv"
    path.write_bytes(b"solver,boundary,rows,columns"[:length])
    assert table(tmp_path) == []
    assert SWEEP.complete(SMALL[:1], tmp_path) == study.read(path, Row)


def test_a_sweep_goes_on_behind_a_cluster_that_failed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def fails(_: Any, measure: Any, points: list[Point]) -> Iterator[Any]:
        yield measure(points[0])
        raise RuntimeError("the cluster failed")

    client = SimpleNamespace(ncores=lambda: {"worker": 1})
    monkeypatch.setattr(study, "cluster", lambda _: contextlib.nullcontext(client))
    monkeypatch.setattr(study, "on_cluster", fails)
    with pytest.raises(RuntimeError, match="the cluster failed"):
        SWEEP.complete(SMALL[:2], tmp_path, "192.0.2.1:8786")
    kept = (tmp_path / "sweep.csv").read_bytes()
    assert kept.count(b"\n") == 2, "the head and a row"
    assert len(SWEEP.complete(SMALL[:2], tmp_path)) == 2
    assert (tmp_path / "sweep.csv").read_bytes().startswith(kept)


@pytest.mark.parametrize("moment", ["SIGKILL", "SIGINT"])
def test_an_interrupted_sweep_goes_on(tmp_path: Any, moment: Any) -> None:
    widths = [[width, c] for width in (20, 22) for c in range(10, 20)]
    script = (
        "import json, sys; from commands import __main__ as entry; from commands.study import sweep; "
        "widths = json.loads(sys.argv.pop()); sweep.plan = lambda: "
        "[sweep.square(64, data_width=width, coefficient_width=c) for width, c in widths]; entry.main()"
    )
    environment = {**os.environ, "LOKY_MAX_CPU_COUNT": "1"}
    command = [sys.executable, "-c", script, "sweep", f"OUT={tmp_path}", json.dumps(widths)]
    running = subprocess.Popen(
        command,
        cwd=repository.ROOT,
        env=environment,
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),  # a suite in the background has it ignored
    )
    path = tmp_path / "sweep.csv"
    deadline = time.monotonic() + 120
    while not path.is_file() or path.read_bytes().count(b"\n") < 4:
        assert time.monotonic() < deadline
        assert running.poll() is None
        time.sleep(0.01)
    running.send_signal(getattr(signal, moment))
    errors = running.communicate()[1]
    if moment == "SIGINT":
        assert running.returncode == 130
        assert "every row measured is kept" in errors
    before = path.read_bytes()
    assert before.count(b"\n") < 1 + len(widths), "it was too quick to be interrupted"
    subprocess.run(command, cwd=repository.ROOT, env=environment, check=True, capture_output=True)
    assert path.read_bytes().startswith(before[: before.rfind(b"\n") + 1])
    rows = study.read(path, Row)
    assert sorted([row.data_width, row.coefficient_width] for row in rows) == widths


def free_port() -> int:
    with socket.socket() as listener:
        listener.bind(("127.0.0.1", 0))
        return int(listener.getsockname()[1])


@pytest.fixture
def cluster(tmp_path: Path) -> Iterator[list[str]]:
    """Start the cluster of docs/sweep-cluster.md at an address of this machine; yield the arguments of its sweep."""
    pytest.importorskip("distributed", reason="Dask is not installed: run `make setup`")
    page = (repository.ROOT / "docs" / "sweep-cluster.md").read_text()
    page = page.replace("192.0.2.1", "127.0.0.1").replace("8786", str(free_port()))
    *servers, last = (line.split() for line in re.findall(r"^    (.*)$", page, re.MULTILINE))
    assert [words[:3] for words in servers] == [[".venv/bin/python", "-m", "dask"]] * 3
    assert last[:2] == ["make", "sweep"]
    started = []
    try:
        for number, (_, *words) in enumerate(servers):
            away = tmp_path / f"machine {number}"
            away.mkdir()
            with (away / "log").open("w") as log:
                command = [sys.executable, *words, "--local-directory", str(away)][
                    : -2 if "scheduler" in words else None
                ]
                started.append(subprocess.Popen(command, cwd=repository.ROOT, stdout=log, stderr=log))
        yield last[2:]
    finally:
        for process in reversed(started):
            process.terminate()
            process.wait()


def test_the_cluster_of_the_page_measures_the_same(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, run_command: Any, cluster: list[str]
) -> None:
    monkeypatch.setattr(study, "CONNECT_S", 60)  # the scheduler has only just been started
    monkeypatch.setattr(sweep, "plan", lambda: SMALL)
    ended = run_command("sweep", *cluster, f"OUT={tmp_path / 'there'}")
    assert f"{len(SMALL)} rows" in ended.output
    rows = SWEEP.complete(SMALL, tmp_path / "here")
    assert sorted(map(str, study.read(tmp_path / "there" / "sweep.csv", Row))) == sorted(map(str, rows))


# Bad input: one line that names what was given, exit status 2, earlier results untouched.


def _table(folder: Path, change: Any) -> str:
    folder.mkdir()
    (folder / "sweep.csv").write_bytes(change(line(SWEEP.header) + line(SWEEP.cells(SMALL[0]))))
    return f"OUT={folder}"


BAD_INPUT: dict[str, Any] = {
    "no scheduler": lambda t: "DASK_SCHEDULER=127.0.0.1:1",
    "no address": lambda t: "DASK_SCHEDULER=cluster",
    "unwritable": lambda t: "OUT=/proc/sweep",
    "other models": lambda t: _table(t / "old", lambda b: b.replace(study.VERSION.encode(), b"0" * 12)),
    "other columns": lambda t: _table(t / "old", lambda b: b.replace(b"boundary", b"edge")),
    "other models, torn": lambda t: _table(t / "old", lambda b: b.replace(study.VERSION.encode(), b"0" * 12) + b"x"),
    "a cell too few": lambda t: _table(t / "old", lambda b: b.replace(b",default,", b",")),
    "no number": lambda t: _table(t / "old", lambda b: b.replace(b",default,,", b",default,,x")),
    "no table": lambda t: _table(t / "old", lambda b: b"\x89PNG\r\n\x1a"),
    "no line end": lambda t: _table(t / "old", lambda b: b"GIF89a"),
}


@pytest.mark.parametrize("case", BAD_INPUT)
def test_bad_input(tmp_path: Any, monkeypatch: pytest.MonkeyPatch, refused: Any, case: Any) -> None:
    words = BAD_INPUT[case](tmp_path)
    before = {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()}
    monkeypatch.setattr(study, "CONNECT_S", 1)
    line = refused("sweep", f"OUT={tmp_path / 'out'}", words)
    assert words.partition("=")[2] in line, "the line must name what was given"
    assert {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()} == before
