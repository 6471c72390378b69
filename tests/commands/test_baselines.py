# SPDX-License-Identifier: Apache-2.0
"""make baselines: every method that is installed is right, a wrong one is refused, bad input is named."""

import json
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from commands.common.variables import Mismatch
from commands.study import baseline_methods, baseline_throughput, baselines, report
from commands.study.baseline_methods import METHODS, Method, Prepared
from commands.study.baselines import WARM_UPS, BaselinesRun
from tactile_depth.base.errors import InputError
from tactile_depth.base.files import RECORD
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.latency import first_depth_latency, last_pixel_to_first_depth


@pytest.mark.parametrize("threads", [1, 2])
@pytest.mark.parametrize("method", [method for method in METHODS if not method.device], ids=lambda method: method.name)
def test_methods_equal_the_reference(method: Any, threads: Any) -> None:
    if problem := baseline_methods.missing(method):
        pytest.skip(f"{problem}: `make baselines` installs it")
    prepared = method.prepare(32, threads)
    scene = baselines.scene(32)
    frames = scene.pixels if method.from_pixels else scene.divergence
    for frame, want in zip(frames, scene.depth, strict=True):
        depth = np.array(prepared.take(prepared.solve(prepared.give(frame))), np.float64)
        assert baselines.percent_of_peak(depth, want) <= baselines.TOLERANCE_PERCENT


def job(runs: Any, seconds: float = 100) -> Any:
    return baselines.Job(0, 1, {16: baselines.scene(16)}, runs, time.monotonic() + seconds, 1)


def test_a_wrong_result_is_not_timed(monkeypatch: pytest.MonkeyPatch) -> None:
    wrong = Method("wrong", lambda size, threads: Prepared(lambda f: 0.999 * f), ())
    monkeypatch.setattr(baselines, "METHODS", (wrong,))
    (row,) = baselines.measure(job(10))
    assert row["problem"] == "wrong result"
    assert "times_us" not in row
    monkeypatch.setattr(baselines, "in_own_process", baselines.measure)
    with pytest.raises(Mismatch, match="wrong at 16"):
        baselines.measure_all(BaselinesRun((16,)))


def test_a_slow_method_is_cut_short() -> None:
    (row,) = baselines.measure(job(1000, seconds=0))
    assert len(row["times_us"]) == baselines.FEWEST_RUNS
    (row,) = baselines.measure(job(1000))
    assert len(row["times_us"]) == 1000


def test_the_pipeline_beside_them() -> None:
    rows = baselines.pipeline((64,), 100.0)
    assert [(row["solver"], row["lanes"]) for row in rows] == [("spectral", 1), ("tridiagonal", 1), ("tridiagonal", 32)]
    for row in rows:
        config = Configuration(columns=64, solver=row["solver"], lanes=row["lanes"])
        assert row["first_depth"] == last_pixel_to_first_depth(config)
        leaves = first_depth_latency(config) - row["first_depth"] + 1  # with one lane a frame takes as long as to come
        assert row["last_depth"] == row["first_depth"] + leaves // row["lanes"] - 1
        assert row["last_depth_us"] == row["last_depth"] / 100


def test_percentiles() -> None:
    row = baselines.summarise({"times_us": list(range(101))})
    assert row == {"runs": 101, "p1_us": 1, "p50_us": 50, "p99_us": 99, "max_us": 100}
    assert baselines.summarise({"problem": "no device"}) == {"problem": "no device"}


def test_a_small_run(tmp_path: Path, monkeypatch: Any) -> None:
    absent = Method("absent", METHODS[0].prepare, ("no-such-package",))
    monkeypatch.setattr(baselines, "METHODS", (METHODS[0], absent))
    monkeypatch.setattr(baselines.os, "sched_getaffinity", lambda process: {0})
    monkeypatch.setattr(baselines.os, "sched_setaffinity", lambda process, cores: None)
    baselines.run(BaselinesRun((16,), 20, max_load=10_000, out=tmp_path))
    assert sorted(path.name for path in tmp_path.iterdir()) == [RECORD, "baselines.json", "baselines.png"]
    document = json.loads((tmp_path / "baselines.json").read_text())
    timed, missing = document["software"]
    assert timed["runs"] == 20
    assert document["warm_ups"] == WARM_UPS
    assert 0 < timed["p50_us"] <= timed["p99_us"] <= timed["max_us"]
    assert timed["error_percent"] <= baselines.TOLERANCE_PERCENT
    assert missing["problem"] == "no-such-package not installed"
    assert "absent" in baselines.show(document)
    (batch,) = document["throughput"]
    assert (batch["cores"], batch["method"]) == (1, METHODS[0].name)
    assert batch["frames_per_second"] > 0

    monkeypatch.setattr(baselines, "DEFAULT_OUT", tmp_path)  # make report takes what is there
    section = report.baselines_section(report.document_of(baselines, "baselines")).html()
    assert "data:image/png" in section
    assert "no-such-package not installed" in section


def row(grid: int, p50_us: float, from_pixels: bool) -> dict[str, Any]:
    return {"grid": grid, "method": "C", "threads": 1, "from_pixels": from_pixels, "p50_us": p50_us}


def test_throughput_is_a_table_of_its_own() -> None:
    rate = {"grid": 64, "from_pixels": False, "cores": 2, "frames_per_second": 1_000_000.0}
    software = [row(64, 2.0, False), row(64, 3.0, False), row(64, 4.0, True)]
    head, rows, _ = baselines.throughput({"software": software, "throughput": [rate], "clock_mhz": 4.096})
    assert head[5].startswith("in batches, 2 threads")
    assert rows == [
        ("64 x 64", "divergence", "C", "500,000", "-", "1,000,000 (1000.0 times)", "1,000"),
        ("64 x 64", "pixels", "C", "250,000", "-", "-", "1,000"),
    ]


def test_batches_run_on_all_cores_at_once() -> None:
    cores = sorted(baselines.os.sched_getaffinity(0))
    assert baseline_throughput.frames_per_second(0, baselines.scene(16).divergence, 1e5, cores) > 0


def test_a_batch_that_crashes_is_a_failure() -> None:
    with pytest.raises(RuntimeError, match="ended without a result"):
        baseline_throughput.frames_per_second(0, np.zeros((1, 0, 0)), 1e6, [0])


def test_a_busy_machine_gives_no_times(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(baselines.os, "getloadavg", lambda: (1.23, 0.0, 0.0))
    with pytest.raises(InputError, match=r"a load of 1\.2 .* MAX_LOAD=2"):
        baselines.run(BaselinesRun(out=tmp_path))
    assert not list(tmp_path.iterdir())


def test_a_process_is_pinned_to_its_threads(monkeypatch: pytest.MonkeyPatch) -> None:
    pinned: list[list[int]] = []
    monkeypatch.setattr(baselines.os, "sched_getaffinity", lambda process: {0, 1, 5})
    monkeypatch.setattr(baselines.os, "sched_setaffinity", lambda process, cores: pinned.append(cores))
    monkeypatch.setattr(baselines.signal, "signal", lambda *_: None)
    for threads in (1, 2):
        baselines.begin_process(threads)
    assert pinned == [[5], [1, 5]]


def test_the_report_runs_what_has_not_been_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def run(request: BaselinesRun) -> None:
        (request.out / "baselines.json").write_text(json.dumps({"load": request.max_load}))

    monkeypatch.setattr(baselines, "DEFAULT_OUT", tmp_path)
    monkeypatch.setattr(baselines, "run", run)
    assert report.document_of(baselines, "baselines") == {"load": 10_000}
