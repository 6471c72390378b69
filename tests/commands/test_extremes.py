# SPDX-License-Identifier: Apache-2.0
"""Rows of `make extremes`, short: RTL equals the model, saturations are flagged, no code wraps, errors are small."""

import json
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from commands.common import run_request, tabular
from commands.study import extremes, long_state, sensor_extremes, transform_noise
from commands.study.drawn_light import DrawnLight
from commands.study.extremes import EXTREMES, drift, faults, largest, measure, model_drift, smallest
from commands.study.transform_noise import Compliance, compliance, transforms
from tactile_depth.chip.common.td_round_saturate import Monitor
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.limits import COLUMNS
from tactile_depth.chip.tactile_depth import slope_tables

SIZE = 16
SOLVERS = tuple(COLUMNS)

# RMS in codes of the worst frame where nothing saturates; measured at 16 on 24 bits: up to 59, at 12 bits 5.0, at 32
# bits 36 (coefficients of 18 and 24 bits weigh more in wider words).
QUIET_RMS_CODES = 75.0
# The tridiagonal solver runs in `make test`, the slower one in `make regress`.
SPECTRAL_IN_REGRESS = ["tridiagonal", pytest.param("spectral", marks=pytest.mark.regress)]


@pytest.mark.parametrize("solver", SPECTRAL_IN_REGRESS)
@pytest.mark.parametrize("extreme", EXTREMES, ids=lambda extreme: extreme.name.replace(" ", "-"))
def test_row(extreme: Any, solver: str) -> None:
    row = measure(extreme, solver, SIZE, "icarus")
    assert faults(extreme, row) == []
    if not row.saturations:
        assert row.rms_codes < QUIET_RMS_CODES


@pytest.mark.parametrize("solver", SOLVERS)
def test_the_smallest_grid(solver: str) -> None:
    extreme = smallest(solver)
    row = measure(extreme, solver, SIZE, "icarus")
    assert faults(extreme, row) == []
    assert row.grid == {"spectral": "16x16", "tridiagonal": "8x16"}[solver]
    assert row.rms_codes < QUIET_RMS_CODES


@pytest.mark.regress
@pytest.mark.parametrize("solver", SOLVERS)
def test_the_largest_grid(solver: str) -> None:
    extreme = largest(solver)
    row = measure(extreme, solver, SIZE, "verilator")
    assert faults(extreme, row) == []
    assert row.grid == {"spectral": "512x512", "tridiagonal": "1024x1024"}[solver]
    assert row.rms_percent < 0.1  # type: ignore[operator]


@pytest.mark.regress
@pytest.mark.parametrize("solver", SOLVERS)
def test_frames_back_to_back_do_not_drift(solver: str) -> None:
    extreme = drift(32)
    row = measure(extreme, solver, SIZE, "icarus")
    assert faults(extreme, row) == []
    assert row.frames == 32


@pytest.mark.parametrize("solver", SOLVERS)
def test_frames_on_the_model_do_not_drift(solver: str) -> None:
    row = model_drift(solver, SIZE, extremes.SHORT_MODEL)
    assert row.bit_exact
    assert not row.saturations
    assert not row.wrapped


@pytest.mark.parametrize("data_width", [24, 32])
def test_transforms_comply(data_width: int) -> None:
    """Compare with bars near the measured values: small noise has only the error of its roundings, for every width."""
    rows = compliance(Configuration(columns=SIZE, data_width=data_width), 640)
    assert {row.core for row in rows} == {"dst_forward", "dst_inverse", "2-D forward", "2-D inverse"}
    for row in rows:
        assert row.zero_in_zero_out
        assert row.saturations == 0
        assert row.mean_in_standard_errors < transform_noise.BIAS, row
        if row.input == "noise + of 5 steps":
            assert (
                row.mean_square
                < {"dst_forward": 0.13, "dst_inverse": 0.26, "2-D forward": 0.6, "2-D inverse": 9}[row.core]
            )
            assert row.peak <= {"dst_forward": 1, "dst_inverse": 2, "2-D forward": 4, "2-D inverse": 15}[row.core]


def test_lone_modes_fill_the_range_that_noise_leaves_empty() -> None:
    """Drive a single mode of the depth range to full scale; noise that fits the range stays far below."""
    config = Configuration(columns=SIZE)
    core = transforms(config)["2-D inverse"][0]
    largest_word: dict[Any, Any] = {}
    for name, _, blocks in transform_noise._blocks("2-D inverse", SIZE, 2, config, 20):
        monitor = Monitor()
        largest_word[name] = max(largest_word.get(name, 0), int(np.abs(core(blocks, monitor)).max()))
        assert not monitor.saturations
    limit = 2 ** (config.data_width - 1) / extremes_headroom(config)
    assert 0.9 * limit < largest_word["lone modes"] <= 1.01 * limit
    assert largest_word["noise +"] < 0.5 * limit


def extremes_headroom(config: Any) -> Any:
    return config.depth_limit_px / config.depth_range_px


def test_a_row_that_is_not_as_it_must_be_is_named() -> None:
    extreme = EXTREMES[0]
    row = measure(extreme, "tridiagonal", SIZE, "icarus")
    broken = type(row)(**{**vars(row), "bit_exact": False, "flagged": True, "wrapped": 3, "registers_agree": False})
    lines = faults(extreme, broken)
    assert len(lines) == 4
    assert all(line.startswith("all black, tridiagonal: ") for line in lines)
    assert "3 codes wrapped around" in lines[-1]


def test_the_file_it_leaves() -> None:
    row = model_drift("spectral", SIZE, 16)
    measured = compliance(Configuration(columns=SIZE), 32)
    document = json.loads(json.dumps(extremes.as_document([row], measured)))
    assert document["extremes"][0]["solver"] == "spectral"
    assert len(document["compliance"]) == len(measured)
    for kind, rows in ((extremes.Row, [row]), (Compliance, measured)):
        part = "compliance" if kind is Compliance else "extremes"
        assert tabular.shown(kind, document[part]) == tabular.shown(kind, rows)


# Rows of a real sensor.

WANTED = sensor_extremes.GRID | sensor_extremes.CHOSEN | {"PRESET": "sensor"}


def requested(**variables: str) -> tuple[Any, DrawnLight]:
    request = run_request.of_values(WANTED | variables, frames="")
    return request, sensor_extremes.draw(request)


def sensor_row(name: str, narrowest: bool = False, rtl: bool = False, **variables: str) -> Any:
    request, drawn = requested(**variables)
    case = next(each for each in sensor_extremes.CASES if each.name == name)
    row = sensor_extremes.measure(case, sensor_extremes.configurations(request, drawn)[narrowest], drawn, rtl)
    assert sensor_extremes.faults(case, row) == []
    assert len(sensor_extremes.cells(row)) == len(sensor_extremes.HEAD)
    return row


@pytest.mark.parametrize(("narrowest", "words", "bar_mm"), [(False, "15/10/16", 0.006), (True, "12/10/16", 0.06)])
def test_a_plain_contact_has_the_height_that_was_drawn(narrowest: bool, words: str, bar_mm: float) -> None:
    """Compare with bars near what was measured: 0.004 to 0.006 mm, and 0.027 to 0.051 mm with the narrowest words."""
    row = sensor_row("ball", narrowest)
    assert row.words == words
    assert abs(row.worst.height) < bar_mm
    assert row.alone.untouched < bar_mm
    assert (row.python, row.status, row.right_after) == ("", (), None)


def test_one_frame_without_light_costs_that_frame_alone() -> None:
    row = sensor_row("light off for one frame")
    assert row.worst.height < -0.3
    assert row.right_after == 0
    assert row.alone is None
    assert row.python.startswith("refused: pictures: it is black")


@pytest.mark.parametrize(("name", "frames"), [("light x 0.8", 2), ("light x 1.25", 4)])
def test_gains_follow_a_step_of_the_light(name: str, frames: int) -> None:
    row = sensor_row(name)
    assert row.worst.height > 1
    assert row.right_after == frames
    assert abs(row.alone.height) < 0.01  # a picture by itself


def test_gains_come_to_rest_in_much_more_light() -> None:
    row = sensor_row("no contact, light x 1.6")
    assert row.last.height < 0.03
    assert row.alone.height < 0.03  # a picture by itself


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("contact over the whole gel", "its light changes across it"),
        ("reference taken while touching", "as if something touched it in the reference"),
        ("overexposed, light x 2 with its reference", "refused: reference"),
        ("flat plate over the whole gel", ""),
    ],
)
def test_what_the_package_says(name: str, text: str) -> None:
    row = sensor_row(name)
    assert row.python.startswith(text) if not text else text in row.python
    assert bool(row.python) == bool(text)


@pytest.mark.parametrize("name", ["light off for one frame", "deeper than DEPTH_RANGE"])
def test_rtl_of_a_sensor_row(name: str) -> None:
    row = sensor_row(name, rtl=True, ROWS="12", COLS="16", SIM="icarus")
    assert row.bit_exact
    assert row.registers_agree
    assert row.status == (("saturation",) if row.saturations else ())


@pytest.mark.regress
@pytest.mark.parametrize("narrowest", [False, True])
@pytest.mark.parametrize("case", sensor_extremes.CASES, ids=lambda case: case.name.replace(" ", "-"))
def test_every_sensor_row(case: Any, narrowest: bool) -> None:
    assert sensor_row(case.name, narrowest, rtl=True, SIM="verilator").bit_exact


def test_a_sensor_row_that_is_not_as_it_must_be_is_named() -> None:
    row = sensor_row("ball", ROWS="12", COLS="16")
    broken = replace(row, bit_exact=False, registers_agree=False, saturations={"flat_field": 1})
    lines = sensor_extremes.faults(sensor_extremes.CASES[0], broken)
    assert len(lines) == 3
    assert all(line.startswith("ball, 15/10/16: ") for line in lines)


def test_light_gains_of_ten_million_frames() -> None:
    """Find them where they were, and within 0.2 % of the light."""
    request, drawn = requested()
    sensor = sensor_extremes.on_grid(drawn, sensor_extremes.untouched_picture(drawn, sensor_extremes.DIM))
    config = run_request.configure(request, sensor)
    states = long_state.light_states(drawn, sensor, config, sensor_extremes.DIM)
    assert {state.light for state in states} == set(long_state.LIGHTS)
    for state in states:
        assert state.settled_after >= 0, state
        assert state.off_percent < 0.2 or state.light.endswith("in turn"), state


def test_the_gains_that_are_skipped_to_are_those_of_every_frame(monkeypatch: pytest.MonkeyPatch) -> None:
    request, drawn = requested(ROWS="12", COLS="16")
    sensor = sensor_extremes.on_grid(drawn, sensor_extremes.untouched_picture(drawn))
    config = run_request.configure(request, sensor)
    pictures = drawn.pictures(drawn.untouched, [(1.2,) * 3] * 3, seed=1)
    gains = slope_tables(sensor, config).gains
    assert gains is not None
    relative = gains.ratios(pictures)
    light = long_state.Light.of(config)
    for frames in (100, 101, 500):
        monkeypatch.setattr(long_state, "FRAMES", frames)
        stream = long_state.LightFilter(light)
        used = [stream.take(relative[n % 3]) for n in range(frames + 1)]
        assert long_state.light_state("", relative, np.full(3, 1.2), light, 0).gains == tuple(used[frames].tolist())


def test_counters_stay_and_numbers_begin_again() -> None:
    counts = {each.register: each for each in long_state.counts(Configuration(columns=16), 3, 256)}
    assert {name: counts.pop(name).after_the_end for name in long_state.COUNTERS} == long_state.LARGEST_COUNT
    assert {name: each.after_the_end for name, each in counts.items()} == {"RECORD_FRAME": 0, "RECORD_TIME": 255}
