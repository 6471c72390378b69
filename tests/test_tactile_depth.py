# SPDX-License-Identifier: Apache-2.0
"""tactile_depth: RTL against the models, at its pins."""

import pytest

from models.calibration import synthetic
from models.configuration import Configuration
from models.tactile_depth import top_parameters, write_roms

# What is run in other formats than the first, and on a larger grid; on the first everything is.
FORMATS = "configuration|back_to_back|contact.*=none|every_fault|saturation|gaps_and_stalls/offers=random/accepts=[14]"
LARGER = "configuration|back_to_back|resets.*=2.*full|gaps_and_stalls/offers=random/accepts=4"


@pytest.mark.parametrize(
    ("size", "data_width", "bits_per_channel", "tests"),
    [(16, 24, 2, ""), (16, 27, 4, FORMATS), (32, 12, 3, LARGER)],
    ids=["16-24", "16-27", "32-12"],
)
def test_rtl(run_tb, size, data_width, bits_per_channel, tests):
    config = Configuration(size=size, data_width=data_width, bits_per_channel=bits_per_channel)
    run_tb(
        "tactile_depth",
        None,
        top_parameters(config),
        roms=lambda folder: write_roms(folder, synthetic(bits_per_channel), config),
        environment={"COCOTB_TEST_FILTER": tests},
    )
