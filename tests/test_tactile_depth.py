# SPDX-License-Identifier: Apache-2.0
"""tactile_depth: RTL against the models, at its pins."""

import json

import pytest

from models.calibration import synthetic
from models.configuration import Configuration
from models.tactile_depth import top_parameters, write_roms

# What is run in other formats than the first, and on a larger grid; on the first everything is.
FORMATS = "configuration|back_to_back|contact.*=none|every_fault|saturation|gaps_and_stalls/offers=random/accepts=[14]"
LARGER = "configuration|back_to_back|resets.*=2.*full|gaps_and_stalls/offers=random/accepts=4"


SECOND = (
    "configuration|one_frame|gaps_and_stalls/offers=random|waits_for_long|contact|malformed|in_a_row|silence|"
    "registers_written"
)
TRIDIAGONAL = {"columns": 16, "rows": 8, "solver": "tridiagonal"}


@pytest.mark.parametrize(
    ("choices", "tests"),
    [
        ({"columns": 16, "bits_per_channel": 2}, ""),
        ({"columns": 16, "data_width": 27, "neumann": True}, FORMATS),
        ({"columns": 32, "data_width": 12, "bits_per_channel": 3}, LARGER),
        (TRIDIAGONAL | {"bits_per_channel": 2}, FORMATS),
        (TRIDIAGONAL | {"rows": 21, "data_width": 27, "neumann": True}, FORMATS),
    ],
    ids=["16-24", "16-27-neumann", "32-12", "tridiagonal-8x16", "tridiagonal-21x16-neumann"],
)
def test_rtl(run_tb, choices, tests):
    config = Configuration(**choices)
    run_tb(
        "tactile_depth",
        None,
        top_parameters(config),
        roms=lambda folder: write_roms(folder, synthetic(config.bits_per_channel), config),
        environment={"COCOTB_TEST_FILTER": tests, "CONFIGURATION": json.dumps(choices)},
    )


@pytest.mark.parametrize("choices", [TRIDIAGONAL | {"bits_per_channel": 2}], ids=["tridiagonal-8x16"])
def test_a_second_client(run_tb, choices):
    """The same tests through cocotbext-axi, but for those that break a stream off in mid row."""
    config = Configuration(**choices)
    run_tb(
        "tactile_depth",
        None,
        top_parameters(config),
        roms=lambda folder: write_roms(folder, synthetic(config.bits_per_channel), config),
        environment={"COCOTB_TEST_FILTER": SECOND, "CONFIGURATION": json.dumps(choices), "CLIENT": "second"},
    )
