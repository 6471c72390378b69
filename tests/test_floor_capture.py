# SPDX-License-Identifier: Apache-2.0
"""floor_capture: RTL against the model, and the model against exact fractions."""

import json
from fractions import Fraction

import numpy as np
import pytest
from stream import REGRESS

from models.configuration import Configuration
from models.floor_capture import LARGEST_LOG2, captured_floor, floor_capture_parameters

SOURCES = ["floor_capture.sv", "ram.sv", "round_saturate.sv"]


@pytest.mark.structures(
    "columns rows width largest",
    both=[(16, 8, 24, LARGEST_LOG2)],
    icarus=[
        (16, 8, 12, 2),
        (32, 21, 12, 1),
        *([(16, 16, 24, 3), (128, 8, 24, 4), (128, 20, 16, 3), (16, 9, 32, 0)] if REGRESS else []),
    ],
)
def test_rtl(run_tb, columns, rows, width, largest):
    choices = {"columns": columns, "rows": rows, "data_width": width, "solver": "tridiagonal"}
    run_tb(
        "floor_capture",
        SOURCES,
        floor_capture_parameters(Configuration(**choices)) | {"MaxLog2": largest},
        environment={"CONFIGURATION": json.dumps(choices)},
    )


@pytest.mark.parametrize("count", [1, 2, 8])
@pytest.mark.parametrize("limit", [2, 1 << 23])
def test_a_floor_is_the_mean_to_the_nearest_with_ties_to_even(count, limit):
    config = Configuration(columns=32, rows=21, solver="tridiagonal")
    frames = np.random.default_rng(count).integers(-limit, limit, (count, 21, 32))
    floor = captured_floor(frames, config)
    block = 1 << config.reference_block_log2
    for row, column in np.ndindex(*config.reference_nodes):
        words = frames[:, row * block : (row + 1) * block, column * block : (column + 1) * block]
        assert floor[row, column] == round(Fraction(int(words.sum()), words.size))
