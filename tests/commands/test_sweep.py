# SPDX-License-Identifier: Apache-2.0
"""`make sweep`: its configurations; no row is lost or measured twice; errors for bad input."""

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
from typing import Any

import pytest

from commands.common import published, repository, run_request
from commands.cost.cost import cost
from commands.run import sim
from commands.study import accuracy, sweep
from commands.study.rows import line
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.latency import first_depth_latency, last_pixel_to_last_depth
from tactile_depth.chip.limits import COLUMNS

SMALL = [{"columns": 16, "solver": solver, "data_width": width} for solver in COLUMNS for width in (12, 18, 24) * 1] + [
    {"columns": 16, "neumann": True}
]


def table(folder: Path) -> Any:
    with (folder / "sweep.csv").open(newline="") as file:
        return list(csv.DictReader(file))


def test_the_plan_is_the_issue_s() -> None:
    rows = [sweep.configuration_cells(choices) for choices in sweep.plan()]
    assert len({tuple(row.values()) for row in rows}) == len(rows)
    default = sweep.configuration_cells({})
    for solver in COLUMNS:
        mine = [row for row in rows if row["solver"] == solver and row["lanes"] == "1"]
        plane = {
            (int(row["data_width"]), int(row["coefficient_width"]))
            for row in mine
            if row["columns"] == "128" and row["boundary"] == "dirichlet" and row["depth_range"] == "default"
        }
        assert plane == {(d, c) for d in range(12, 33) for c in range(10, 25)}
        safe = [row for row in mine if row["depth_range"] == "worst"]
        assert {int(row["data_width"]) for row in safe} == set(range(12, 33))
        assert Counter(row["boundary"] for row in safe) == {"dirichlet": 21, "neumann": 1}
        within = [row for row in mine if row["depth_range"] == "default"]
        others = [row for row in within if (row["columns"], row["boundary"]) != ("128", "dirichlet")]
        for row in others:  # differ from the default in one thing
            assert sum(row[name] != default[name] for name in ("columns", "boundary", "data_width")) == 1
        assert {row["columns"] for row in others} == {"32", "64", "128", "256", "512"}
        assert Counter(row["boundary"] for row in others)["neumann"] == 1
    lanes = [(row["columns"], int(row["lanes"])) for row in rows if row["lanes"] != "1"]
    assert Counter(lanes) == Counter((columns, 1 << n) for columns in ("128", "256") for n in range(1, 7))


def test_lanes_from_2_on_change_the_cost_and_the_latency_alone() -> None:
    one, two, four = (accuracy.measure({"columns": 32, "solver": "tridiagonal", "lanes": lanes}) for lanes in (1, 2, 4))
    config = Configuration(columns=32, solver="tridiagonal", lanes=2)
    assert int(two["last_pixel_to_last_depth_cycles"]) == last_pixel_to_last_depth(config)
    assert int(two["multipliers"]) == cost(config).tiles > int(one["multipliers"])
    same = [name for name in sweep.TABLE.header if name.startswith(("rms_", "max_", "true_", "sat"))]
    assert [four[name] for name in same] == [two[name] for name in same]
    assert float(two["rms_percent_mean"]) < 1.05 * float(one["rms_percent_mean"])
    assert "32 x 32" not in sweep.summary([one, two])

    wide = {"columns": "128", "rows": "128"}
    text = sweep.summary([one | wide, two | wide])
    assert "| 128 x 128, 2 | " in text


def test_a_range_that_nothing_leaves() -> None:
    row, default = (accuracy.measure({"columns": 32, "depth_range_px": limit}) for limit in (accuracy.WORST, None))
    assert (row["depth_range"], default["depth_range"]) == ("worst", "default")
    assert float(row["depth_range_mm"]) > float(default["depth_range_mm"])
    assert row["saturations"] == "0"
    assert float(row["rms_percent_mean"]) > float(default["rms_percent_mean"])


def test_a_row_holds_what_was_measured() -> None:
    row = accuracy.measure({"columns": 32, "solver": "tridiagonal", "data_width": 20})
    config = Configuration(columns=32, solver="tridiagonal", data_width=20)
    assert list(row) == list(sweep.TABLE.header)
    assert row["problem"] == ""
    assert int(row["frames"]) == 15
    assert 0 < float(row["rms_percent_mean"]) < float(row["rms_percent_worst"]) < float(row["max_percent_worst"]) < 1
    assert int(row["first_depth_cycles"]) == first_depth_latency(config)
    assert int(row["multipliers"]) == cost(config).tiles
    bits = [int(row[name]) for name in ("frame_store_bits", "delay_line_bits", "table_bits", "row_buffer_bits")]
    assert sum(bits) == int(row["memory_bits"])


def test_wider_words_err_less_and_the_sensor_s_share_stays() -> None:
    narrow, wide = (accuracy.measure({"columns": 32, "data_width": width}) for width in (16, 24))
    assert float(wide["rms_percent_mean"]) < float(narrow["rms_percent_mean"]) / 100
    for row in (narrow, wide):  # 4 bits of each colour leave a hundredth of a millimetre
        assert 0.001 < float(row["true_rms_mm_mean"]) < 0.02


# The bars of the accuracy over the bench.
@pytest.mark.parametrize("solver", COLUMNS)
def test_bench_at_the_default_and_at_twenty_bits(solver: str) -> None:
    row = accuracy.measure({"solver": solver})
    assert float(row["rms_percent_mean"]) <= 0.005
    assert float(row["rms_percent_worst"]) <= 0.015
    narrow = accuracy.measure({"solver": solver, "data_width": 20})
    assert float(narrow["rms_percent_mean"]) <= published.RMS_PERCENT


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
    row = accuracy.measure({"columns": 16, "neumann": boundary == "neumann", **choices})
    for name in ("rms", "max"):
        percent = report[f"{name}_percent_of_peak"]
        assert float(row[f"{name}_percent_mean"]) == pytest.approx(sum(percent) / len(percent), rel=1e-5)
        assert float(row[f"{name}_percent_worst"]) == pytest.approx(max(percent), rel=1e-5)
    assert {int(row["first_depth_cycles"])} == set(report["first_depth_latency_cycles"])
    assert {int(row["last_pixel_to_first_depth_cycles"])} == set(report["last_pixel_to_first_depth_cycles"])
    assert int(row["saturations"]) == sum(report["saturations"].values())


def test_a_configuration_that_cannot_be_built_is_a_row(tmp_path: Path) -> None:
    (row,) = sweep.sweep([{"columns": 512, "data_width": 12}], tmp_path)
    assert "data_width=12 cannot hold the formats" in row["problem"]
    assert row["rms_percent_mean"] == ""
    assert table(tmp_path) == [row]


def test_nothing_is_measured_twice(tmp_path: Path, monkeypatch: Any) -> None:
    first = sweep.sweep(SMALL[:3], tmp_path)
    before = (tmp_path / "sweep.csv").read_bytes()
    measured = []
    monkeypatch.setattr(
        sweep,
        "on_all_cores",
        lambda rows: (measured.append(row) or accuracy.measure(row) for row in rows),  # type: ignore[func-returns-value]
    )
    rows = sweep.sweep(SMALL, tmp_path)
    assert measured == SMALL[3:]
    assert rows[:3] == first
    assert (tmp_path / "sweep.csv").read_bytes().startswith(before)
    assert Counter(map(str, table(tmp_path))) == Counter(map(str, rows))


@pytest.mark.parametrize("torn", [b"spectral,dirichlet,16,16,2", b'tridiagonal,dirichlet,16,16,24,18,default,"DATA'])
def test_a_torn_last_line_is_mended(tmp_path: Path, torn: Any) -> None:
    rows = sweep.sweep(SMALL[:2], tmp_path)
    path = tmp_path / "sweep.csv"
    content = path.read_bytes()
    path.write_bytes(content + torn)
    assert sweep.sweep(SMALL[:2], tmp_path) == rows
    assert path.read_bytes() == content


@pytest.mark.parametrize("length", [0, 10])
def test_a_torn_header_is_mended(tmp_path: Path, length: int) -> None:
    path = tmp_path / "sweep.csv"
    path.write_bytes(b"solver,boundary,rows,columns"[:length])
    assert table(tmp_path) == [] and sweep.sweep(SMALL[:1], tmp_path) == table(tmp_path)  # noqa: PT018


@pytest.mark.parametrize("moment", ["SIGKILL", "SIGINT"])
def test_an_interrupted_sweep_goes_on(tmp_path: Any, moment: Any) -> None:
    rows = [{"columns": 64, "data_width": width, "coefficient_width": c} for width in (20, 22) for c in range(10, 20)]
    script = (
        "import json, sys; from commands.study import sweep; "
        "rows = json.loads(sys.argv.pop()); sweep.plan = lambda: rows; sweep.main()"
    )
    environment = {**os.environ, "LOKY_MAX_CPU_COUNT": "1"}
    command = [sys.executable, "-c", script, f"OUT={tmp_path}", json.dumps(rows)]
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
    assert before.count(b"\n") < 1 + len(rows), "it was too quick to be interrupted"
    subprocess.run(command, cwd=repository.ROOT, env=environment, check=True, capture_output=True)
    assert path.read_bytes().startswith(before[: before.rfind(b"\n") + 1])
    names = [tuple(row[name] for name in sweep.TABLE.configuration) for row in table(tmp_path)]
    assert sorted(names) == sorted(sweep.TABLE.key(sweep.configuration_cells(choices)) for choices in rows)


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
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], cluster: list[str]
) -> None:
    monkeypatch.setattr(sweep, "CONNECT_S", 60)  # the scheduler has only just been started
    monkeypatch.setattr(sweep, "plan", lambda: SMALL)
    monkeypatch.setattr("sys.argv", ["sweep", *cluster, f"OUT={tmp_path / 'there'}"])
    sweep.main()
    assert f"{len(SMALL)} rows" in capsys.readouterr().out
    rows = sweep.sweep(SMALL, tmp_path / "here")
    assert sorted(map(str, table(tmp_path / "there"))) == sorted(map(str, rows))


# Bad input: one line that names what was given, exit status 2, earlier results untouched.


def _table(folder: Path, change: Any) -> str:
    folder.mkdir()
    row = accuracy.measure(SMALL[0])
    (folder / "sweep.csv").write_bytes(change(line(sweep.TABLE.header) + line(tuple(row.values()))))
    return f"OUT={folder}"


BAD_INPUT: dict[str, Any] = {
    "no scheduler": lambda t: "DASK_SCHEDULER=127.0.0.1:1",
    "no address": lambda t: "DASK_SCHEDULER=cluster",
    "unwritable": lambda t: "OUT=/proc/sweep",
    "other models": lambda t: _table(t / "old", lambda b: b.replace(accuracy.VERSION.encode(), b"0" * 12)),
    "other columns": lambda t: _table(t / "old", lambda b: b.replace(b"boundary", b"edge")),
    "other models, torn": lambda t: _table(t / "old", lambda b: b.replace(accuracy.VERSION.encode(), b"0" * 12) + b"x"),
    "a cell too few": lambda t: _table(t / "old", lambda b: b.replace(b",default,", b",")),
    "no table": lambda t: _table(t / "old", lambda b: b"\x89PNG\r\n\x1a"),
    "no line end": lambda t: _table(t / "old", lambda b: b"GIF89a"),
}


@pytest.mark.parametrize("case", BAD_INPUT)
def test_bad_input(tmp_path: Any, monkeypatch: pytest.MonkeyPatch, refused: Any, case: Any) -> None:
    words = BAD_INPUT[case](tmp_path)
    before = {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()}
    monkeypatch.setattr(sweep, "CONNECT_S", 1)
    line = refused("sweep", f"OUT={tmp_path / 'out'}", words)
    assert words.partition("=")[2] in line, "the line must name what was given"
    assert {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()} == before
