# SPDX-License-Identifier: Apache-2.0
"""gain_map: RTL against the model."""

import json

import pytest
from stream import REGRESS

from models.configuration import Configuration
from models.flat_field import unit_gains
from models.gain_map import ENTRIES_PER_NODE, gain_map_parameters, table_entries
from models.rom_files import write_gains

SOURCES = ["gain_map.sv", "ram.sv", "multiply.sv", "round_saturate.sv"]


@pytest.mark.structures(
    "columns rows", both=[(16, 8), *([(128, 128)] if REGRESS else [])], icarus=[(16, 16), (32, 21), (128, 8)]
)
def test_rtl(run_tb, columns, rows):
    choices = {"columns": columns, "rows": rows, "solver": "tridiagonal"}
    config = Configuration(**choices)
    run_tb(
        "gain_map",
        SOURCES,
        gain_map_parameters(config),
        roms=lambda folder: write_gains(folder, unit_gains(config)),
        environment={"CONFIGURATION": json.dumps(choices)},
    )


def test_entries_are_the_channels_of_each_node():
    gains = [[[10, 11, 12], [20, 21, 22]]]
    assert table_entries(gains) == {0: 10, 1: 11, 2: 12, 4: 20, 5: 21, 6: 22}
    assert ENTRIES_PER_NODE == 4
