# SPDX-License-Identifier: Apache-2.0
"""thomas_table against its model at every position of every row."""

from typing import Any

import cocotb
import numpy as np

from tactile_depth.chip.poisson.thomas_table import LATENCY, thomas_table
from tb.stream import configuration, drive, parametrize


@cocotb.test(timeout_time=10, timeout_unit="ms")
@parametrize(pause=[0.0, 0.3])
async def every_entry(dut: Any, pause: float) -> None:
    config = configuration()
    table = thomas_table(config)
    places = [(row, position) for row in range(config.rows) for position in range(config.columns)]
    stimuli = [{"row": row, "position": position} for row, position in places]
    stimuli += LATENCY * stimuli[-1:]
    pins = await drive(dut, stimuli, ["coefficient", "shift"], pause)
    coefficients = np.vstack((table.rows(config.rows - 1), table.last)).ravel()
    shifts = np.vstack((np.zeros((config.rows - 1, config.columns), np.int64), table.last_shift)).ravel()
    np.testing.assert_array_equal([v.to_signed() for v in pins["coefficient"][LATENCY:]], coefficients)
    np.testing.assert_array_equal([int(v) for v in pins["shift"][LATENCY:]], shifts)
