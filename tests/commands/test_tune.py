# SPDX-License-Identifier: Apache-2.0
"""`make tune`: its search finds the cheapest configuration, its choice is proven in RTL, and failures are reported."""

import json
import math
from functools import cache
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from commands.common import published, run_request
from commands.run import sim
from commands.study import tune
from commands.study.tune_search import WORST_FRAME, Limits, Search, Widths
from tactile_depth.configuration import COEFFICIENT_WIDTHS, COLUMNS, DATA_WIDTHS, Configuration
from tactile_depth.cost import cost
from tactile_depth.frames import load_frames
from tactile_depth.latency import last_pixel_to_last_depth

NONE = math.inf


@cache
def built(at: Any) -> Any:
    if at.solver == "spectral" and at.data < 14:  # as on large grids
        return None
    return Configuration(columns=16, solver=at.solver, data_width=at.data, coefficient_width=at.coefficient)


@cache
def cost_of(at: Any) -> Any:
    return cost(built(at))


def falling(solver_bits: Any) -> Any:
    """Return an error that falls with both widths, by a different law for each solver."""
    by_configuration = {}
    for at in all_points():
        bits = solver_bits[at.solver]
        by_configuration[built(at)] = 2.0 ** (bits - at.data) + 2.0 ** (bits - 7 - at.coefficient)
    return by_configuration.__getitem__


@cache
def all_points() -> list[Any]:
    widths = product(range(DATA_WIDTHS[0], DATA_WIDTHS[1] + 1), range(COEFFICIENT_WIDTHS[0], COEFFICIENT_WIDTHS[1] + 1))
    return [at for d, c in widths for s in COLUMNS if built(at := Widths(s, d, c)) is not None]


@pytest.mark.parametrize("tolerance", [3.0, 0.1, 1e-3, 1e-4])
@pytest.mark.parametrize(
    ("latency", "multipliers", "memory"), [(NONE, NONE, NONE), (NONE, NONE, 20), (NONE, 30, NONE), (2.2, 40, 26)]
)
@pytest.mark.parametrize("bits", [{"spectral": 17, "tridiagonal": 17}, {"spectral": 15, "tridiagonal": 21}])
def test_the_search_finds_the_cheapest_of_all(
    tolerance: Any, latency: Any, multipliers: Any, memory: Any, bits: int
) -> None:
    limits = Limits(tolerance, latency, NONE, 166, multipliers, NONE, memory)
    search = Search(built, falling(bits), limits, tolerance)
    within = [at for at in all_points() if not limits.broken(cost_of(at))]
    enough = [at for at in within if search.measure(built(at)) <= tolerance]
    best = search.cheapest(list(COLUMNS))
    if enough:
        assert search.rank(best) == min(map(search.rank, enough))  # type: ignore[arg-type]
    else:
        assert best is None
        nearest = search.nearest(list(COLUMNS))
        if within:
            assert search.error(nearest) == min(search.measure(built(at)) for at in within)  # type: ignore[arg-type]
        else:
            assert nearest is None
    assert len(search.tried) <= len(all_points()) / 5


def test_frames_are_tuned_on_or_proven_on_never_both() -> None:
    frames = load_frames("bench", (16, 16))
    peaks = np.ones(15)
    peaks[3] = 0
    tuning, proving, how = tune.split(frames, peaks, seed=1)
    assert (len(tuning.pixels), len(proving.pixels)) == (9, 5)
    assert {*tuning.labels, *proving.labels} == {*frames.labels} - {frames.labels[3]}
    assert not {*tuning.labels} & {*proving.labels}
    assert "9 frames" in how and "5 others" in how and "1 without contact" in how  # noqa: PT018
    assert tune.split(frames, peaks, seed=2)[1].labels != proving.labels


def test_a_frame_that_comes_alone_is_proven_on_copies_with_other_noise() -> None:
    frames = load_frames("ball", (32, 32))
    tuning, proving, how = tune.split(frames, np.ones(1), seed=1)
    assert (len(tuning.pixels), len(proving.pixels)) == (4, 2)
    np.testing.assert_array_equal(tuning.pixels[0], frames.pixels[0])
    pixels = [*tuning.pixels, *proving.pixels]
    assert len({frame.tobytes() for frame in pixels}) == 6
    assert "noise" in how


def run(tmp_path: Any, *words: Any) -> Any:
    return tune.run(*tune.parse(["PRESET=published", "SIM=icarus", "N=32", f"OUT={tmp_path / 'out'}", *words]))


@pytest.mark.parametrize(
    "words",
    [
        pytest.param([], marks=pytest.mark.regress),
        pytest.param(["BOUNDARY=neumann", "SOLVER=spectral", "TOLERANCE=0.02"], marks=pytest.mark.regress),
        ["FRAMES=ball"],
    ],
)
def test_the_choice_holds_in_rtl_and_make_sim_takes_its_file(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], words: Any
) -> None:
    assert run(tmp_path, *words) == 0
    output = capsys.readouterr().out
    out = tmp_path / "out"
    report = json.loads((out / "report.json").read_text())
    proof = json.loads((out / "proof" / "report.json").read_text())
    assert proof["bit_exact"]
    assert max(proof["rms_percent_of_peak"]) == report["proven_percent"] <= report["tolerance_percent"]
    assert report["tuned_percent"] <= report["tolerance_percent"] / WORST_FRAME.margin
    assert proof["frames"] == len(report["proven_on"])
    assert report["chosen"]["multipliers"] <= report["default"]["multipliers"]
    assert report["chosen"]["memory_bits"] < report["default"]["memory_bits"]
    assert "make sim CONFIG=" in output
    chosen = run_request.parse(
        [f"CONFIG={out / 'config.json'}", "SIM=icarus", f"OUT={tmp_path / 'sim'}", "FRAMES=ball"]
    )
    assert sim.run(chosen) == 0
    again = json.loads((tmp_path / "sim" / "report.json").read_text())
    for name in ("grid", "solver", "boundary", "data_width", "coeff_width", "depth_range_mm"):
        assert again[name] == proof[name]
    for option in words:
        key, _, value = option.partition("=")
        if key in ("SOLVER", "BOUNDARY"):
            assert again[key.lower()] == value


def test_a_limit_of_the_whole_map_takes_lanes(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    def choose(limit_us: float) -> int:
        words = ["PRESET=published", "N=32", "SIM=icarus", f"MAX_MAP_LATENCY_US={limit_us}"]
        request, limits, _ = tune.parse(words)
        return tune.lanes_within(lambda at: config(at.lanes), request, limits, "tridiagonal")

    def config(lanes: int) -> Configuration:
        return Configuration(columns=32, solver="tridiagonal", lanes=lanes)

    for lanes in (1, 2, 4, 8, 16):
        exact_us = last_pixel_to_last_depth(config(lanes)) / published.CLOCK_MHZ
        assert choose(exact_us + 1e-6) == lanes
        assert choose(exact_us - 1e-6) == min(2 * lanes, 16)
    assert tune.lanes_within(lambda at: None, *tune.parse(["LANES=2", "N=32"])[:2], "tridiagonal") == 2

    assert run(tmp_path, "FRAMES=ball", f"MAX_MAP_LATENCY_US={exact_us + 1e-6}") == 0
    chosen = json.loads((tmp_path / "out" / "config.json").read_text())
    assert (chosen["SOLVER"], chosen["LANES"]) == ("tridiagonal", 16)
    proof = json.loads((tmp_path / "out" / "proof" / "report.json").read_text())
    assert proof["lanes"] == 16
    costs = json.loads((tmp_path / "out" / "report.json").read_text())["chosen"]
    assert set(proof["last_pixel_to_last_depth_cycles"]) == {costs["map_cycles"]}
    assert "us from the last pixel to the last depth" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (["TOLERANCE=1e-9"], "SOLVER=tridiagonal DATA_WIDTH=32 COEFF_WIDTH=24"),
        (["TOLERANCE=0.001", "MAX_DSP=24"], "the nearest is SOLVER=tridiagonal DATA_WIDTH=24 COEFF_WIDTH="),
        (["MAX_DSP=4"], "beyond MAX_DSP=4"),
        (["MAX_LATENCY_US=1"], "beyond MAX_LATENCY_US=1"),
        (["SOLVER=tridiagonal", "MAX_MAP_LATENCY_US=1"], "COEFF_WIDTH=10 LANES=16: beyond MAX_MAP_LATENCY_US=1"),
        (["MAX_MEMORY_KBIT=1"], "beyond MAX_MEMORY_KBIT=1"),
    ],
)
def test_no_configuration_meets_it(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], words: Any, expected: Any
) -> None:
    assert run(tmp_path, *words) == 1
    assert expected in capsys.readouterr().out.splitlines()[-1]
    assert [*tmp_path.rglob("*.json")] == []
