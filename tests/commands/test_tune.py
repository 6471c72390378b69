# SPDX-License-Identifier: Apache-2.0
"""`make tune`: its search finds the cheapest configuration, its choice is proven in RTL, and failures are reported."""

import json
import math
import re
import shutil
from functools import cache
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import tactile_depth as td
from commands.common import published, run_request, variables
from commands.cost.cost import cost
from commands.run import sim
from commands.study import tune
from commands.study.tune_search import COEFFICIENT_BITS, DATA_BITS, WORST_FRAME, Limits, Search, Widths
from tactile_depth.calibrate.press_pictures import gather
from tactile_depth.chip.configuration import WORDS, Configuration
from tactile_depth.chip.latency import last_pixel_to_last_depth
from tactile_depth.chip.limits import COLUMNS
from tactile_depth.pictures.frames import load_frames
from tactile_depth.sensor.presets import CHIP
from tests import ball_presses

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
    widths = product(range(DATA_BITS[0], DATA_BITS[1] + 1), range(COEFFICIENT_BITS[0], COEFFICIENT_BITS[1] + 1))
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
    return variables.read(tune.main, ["PRESET=published", "SIM=icarus", "N=32", f"OUT={tmp_path / 'out'}", *words])


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
    assert re.search(r"^tuning takes about \d+ (s|minutes|hours), and the proof in RTL follows$", output, re.MULTILINE)
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
        request, _ = tune.choices({"PRESET": "published", "N": "32", "SIM": "icarus"})
        limits = variables.read(Limits, [f"MAX_MAP_LATENCY_US={limit_us}"])
        return tune.lanes_within(lambda at: config(at.lanes), request, limits, "tridiagonal")

    def config(lanes: int) -> Configuration:
        return Configuration(columns=32, solver="tridiagonal", lanes=lanes)

    for lanes in (1, 2, 4, 8, 16):
        exact_us = last_pixel_to_last_depth(config(lanes)) / published.CLOCK_MHZ
        assert choose(exact_us + 1e-6) == lanes
        assert choose(exact_us - 1e-6) == min(2 * lanes, 16)
    assert tune.lanes_within(lambda at: None, tune.choices({"LANES": "2", "N": "32"})[0], Limits(), "tridiagonal") == 2

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
        (["TOLERANCE=0.001", "MAX_DSP=26"], "the nearest is SOLVER=tridiagonal DATA_WIDTH=24 COEFF_WIDTH="),
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


def test_auto_keeps_caps_and_centroids_of_presses_it_was_not_tuned_on(tmp_path: Path) -> None:
    """`PRESET=chip` is the choice on the real presses; caps are within 1 %, centroids within 0.02 mm of 24 bits."""
    source = ball_presses.real_folder()
    pictures, grid = gather(source), ball_presses.read(source)
    presses = {view.press.name: view for view in grid.views if view.is_whole}
    names = {f"{index:03}.png": press.name for index, press in enumerate(pictures.presses)}
    (tmp_path / "frames").mkdir()
    for file, name in names.items():
        shutil.copy(source / name, tmp_path / "frames" / file)
    background = source / "background.png"
    given = ["TOLERANCE=auto", "DEPTH_RANGE=2", "TARGET=ecp5", f"FRAMES={tmp_path / 'frames'}"]
    given += [f"REFERENCE={background}", "CALIBRATION=gelsight-mini", f"OUT={tmp_path / 'out'}"]
    assert variables.read(tune.main, given) == 0
    report = json.loads((tmp_path / "out" / "report.json").read_text())
    chosen = json.loads((tmp_path / "out" / "config.json").read_text())
    assert {name: chosen[variable] for name, variable in WORDS.items()} == CHIP.words
    assert report["chosen"]["multipliers"] < 0.75 * report["default"]["multipliers"]
    assert report["chosen"]["memory_bits"] < 0.75 * report["default"]["memory_bits"]
    sensor = td.load("gelsight-mini")
    wide, short = (td.Pipeline(sensor, background, **words) for words in ({}, CHIP.words))  # type: ignore[arg-type]
    proven = [names[label] for label in report["proven_on"] if names[label] in presses]
    assert len(proven) >= 8
    for name in proven:
        at_24, result = (pipeline(source / name) for pipeline in (wide, short))
        caps = [presses[name].press.recovered(each.depth_mm) for each in (at_24, result)]
        assert caps[1] == pytest.approx(caps[0], rel=0.01)
        off = np.subtract(at_24.contact.centroid_px, result.contact.centroid_px) * result.pixel_pitch_mm
        assert np.hypot(*off) < 0.02
