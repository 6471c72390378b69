# SPDX-License-Identifier: Apache-2.0
"""elimination against its model: codes, latency and saturation counts, with gaps, pauses and resets."""

from collections.abc import Sequence
from functools import partial
from typing import Any

import cocotb
import numpy as np

from formal.entries import ROUNDING, Proof
from formal.tables import thomas_roms
from tactile_depth.chip.common.td_round_saturate import Monitor
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.poisson.elimination import LATENCY, elimination
from tactile_depth.chip.poisson.frame_stack import LEAD as LEAD_OUT
from tactile_depth.chip.poisson.tridiagonal_solver import solver_parameters
from tactile_depth.chip.rom_files import write_thomas
from tb.beats import BeatsMonitor
from tb.pins import Read
from tb.poisson.burst_core import BurstCore
from tb.stream import configuration, of_configuration, with_and_without_en
from tb.structures import ICARUS, VERILATOR

NAMES = ["Width", "CoeffWidth", "Rows", "Columns", "StoreDrop", "Neumann"]
NAMES += ["LastShiftWidth", "MomentDrop", "MeanReciprocal", "MeanDrop"]
CHOICES = {"columns": 16, "rows": 8, "solver": "tridiagonal", "lanes": 4}


def core_parameters(config: Configuration) -> Any:
    parameters = solver_parameters(config)
    table = {"TableWords": parameters["DownTableWords"], "SettledWidth": parameters["DownSettledWidth"]}
    widths = {"OutWidth": config.data_width, "Words": config.down_words}
    return widths | table | {name: parameters[name] for name in NAMES}


built = of_configuration(core_parameters, write_thomas)


STRUCTURES = (
    built(CHOICES | {"neumann": True}, on=VERILATOR),
    built(CHOICES | {"rows": 9}, on=ICARUS),
    # Few bits are dropped: ties are common.
    built(CHOICES | {"neumann": True, "data_width": 12, "coefficient_width": 10}, mutants=ICARUS, on=ICARUS),
    built(CHOICES | {"neumann": True, "data_width": 12, "coefficient_width": 10, "lanes": 2}, mutants=ICARUS),
    built(CHOICES | {"rows": 9, "neumann": True, "lanes": 1}, on=ICARUS),
    built(CHOICES | {"rows": 21, "neumann": True, "data_width": 32, "coefficient_width": 24}),
)
PROOFS = tuple(
    Proof(
        f"the smallest burst that holds the loop of the recursion; each of two words; {ROUNDING}",
        {"Rows": 3, "Columns": 16, "Words": 2, "Word": word, "Neumann": neumann, "TableWords": 16},
        steps=2,
        roms=thomas_roms(3, 8, 16, 6, 2, 2),
    )
    for word, neumann in ((0, 1), (1, 0))
)


class Eliminated(BeatsMonitor):
    """Monitor of the words that count: d of a frame's last row, and e of the row above in all rows but the first."""

    def __init__(self, *arguments: Any, **named: Any) -> None:
        super().__init__(*arguments, **named)
        self.rows, self.row = configuration().rows, 0

    def word(self, reads: Sequence[Read]) -> Any:
        if len(self.words) % self.length == 0:
            self.row = 0 if self.frame_starts[-1] else self.row + 1
        zero = (0,) * self.paths
        last = super().word(reads[: self.paths]) if self.row == self.rows - 1 else zero
        return last + (super().word(reads[self.paths :]) if self.row else zero)


def model(dut: Any, x: Any, monitor: Monitor) -> Any:
    config = configuration()
    out = elimination(x.reshape(-1, config.rows, config.columns), config, monitor)
    seen = np.zeros((*out.shape, 2), np.int64)
    seen[:, -1, :, 0] = out[:, -1]
    seen[:, 1:, :, 1] = out[:, :-1]
    return seen.reshape(*x.shape[:3], 2)


CORE = BurstCore(
    model,
    lambda dut: LATENCY,
    fields=("data",),
    ports={"out_fields": ("last", "ahead"), "sink": partial(Eliminated, lead=LEAD_OUT)},
    frame=lambda dut: configuration().rows,
)
bursts, many_bursts, limits, reset_in_mid_burst, a_frame_begins_afresh = CORE.tests()


@cocotb.test
async def reset_as_the_mean_is_clipped(dut: Any) -> None:
    """Reset in each cycle after the addend of the last row but one: nothing is counted."""
    config = configuration()
    last_addend = config.columns // config.down_words * (config.rows - 2) + LATENCY
    words = np.full(CORE.shape(dut, 3), (1 << config.arithmetic_width - 1) - 1)
    await CORE.check(dut, words, interrupts=with_and_without_en(range(last_addend - 4, last_addend + 7)))
