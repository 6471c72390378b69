# SPDX-License-Identifier: Apache-2.0
"""reference_capture: RTL against the model; the largest number of frames."""

import json
from typing import Any

import numpy as np
import pytest

from tactile_depth.calibration.reference_capture import (
    largest_log2_frames,
    reference_capture,
    reference_capture_parameters,
)
from tactile_depth.configuration import GAIN_WIDTH, Configuration


@pytest.mark.structures(
    "columns rows largest",
    verilator=[(16, 8, 5)],  # columns, rows, log2 of the largest number of frames
    icarus=[(16, 8, 2)],
    regress=[(16, 16, 3), (32, 21, 3), (128, 8, 4), (16, 8, 8)],
    regress_verilator=[(16, 8, 8)],
)
def test_rtl(run_tb: Any, columns: int, rows: int, largest: Any) -> None:
    choices: dict[str, Any] = {"columns": columns, "rows": rows, "solver": "tridiagonal"}
    run_tb(
        "reference_capture",
        reference_capture_parameters(Configuration(**choices)) | {"MaxLog2": largest},
        environment={"CONFIGURATION": json.dumps(choices)},
    )


@pytest.mark.parametrize(("columns", "largest"), [(16, 8), (128, 8), (256, 8), (512, 6), (1024, 4)])
def test_the_largest_sum_fits_its_word(columns: int, largest: int) -> None:
    config = Configuration(columns=columns, solver="tridiagonal")
    assert largest_log2_frames(config) == largest
    pixels = 1 << 2 * config.reference_block_log2 + largest
    assert 255 * pixels < 1 << GAIN_WIDTH
    assert largest == 8 or 2 * 255 * pixels >= 1 << GAIN_WIDTH


def test_a_broken_frame_starts_afresh() -> None:
    config = Configuration(columns=16, rows=8, solver="tridiagonal")
    frames = [np.full((8, 16, 3), level, np.uint8) for level in (50, 60, 100, 102, 30)]
    captured = reference_capture(frames, [False, True, False, False, False], [1, 1, 1, 2, 2], 8, config)
    assert captured is not None
    index, gains = captured
    assert index == 3
    assert np.all(gains == round(2**27 / 101))
    assert reference_capture(frames[:3], [False, True, False], [1, 1, 1], 8, config) is None
