# SPDX-License-Identifier: Apache-2.0
"""Rows of `make extremes`, short: RTL equals the model, saturations are flagged, no code wraps, errors are small."""

import json
from typing import Any

import numpy as np
import pytest

from commands.study import extremes, transform_noise
from commands.study.extremes import EXTREMES, drift, faults, largest, measure, model_drift, smallest
from commands.study.transform_noise import compliance, transforms
from tactile_depth.common.td_round_saturate import Monitor
from tactile_depth.configuration import COLUMNS, Configuration

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
    for module, rows in ((extremes, document["extremes"]), (transform_noise, document["compliance"])):
        for each in rows:
            assert len(module.cells(each)) == len(module.HEAD)
