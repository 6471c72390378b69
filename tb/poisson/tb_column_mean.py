# SPDX-License-Identifier: Apache-2.0
"""column_mean against its model: means and clip counts, with pauses; a frame begins afresh."""

from typing import Any

import cocotb
import numpy as np

from formal.entries import ROUNDING, Proof
from tactile_depth.chip.common.td_round_saturate import Monitor
from tactile_depth.chip.poisson.elimination import zero_mean
from tactile_depth.chip.poisson.tridiagonal_solver import solver_parameters
from tb.stream import MANY, at_every_edge, configuration, drive, of_configuration, parametrize, uniform
from tb.structures import ICARUS, VERILATOR

CHOICES = {"columns": 16, "rows": 8, "solver": "tridiagonal", "neumann": True}
NAMES = ("Width", "CoeffWidth", "Rows", "MomentDrop", "MeanReciprocal", "MeanDrop")


built = of_configuration(lambda config: {name: solver_parameters(config)[name] for name in NAMES})


STRUCTURES = (
    built(CHOICES, on=VERILATOR),
    built(CHOICES | {"rows": 9}, on=ICARUS),
    # Few bits are dropped: ties are common.
    built(CHOICES | {"rows": 21, "data_width": 12, "coefficient_width": 10}, on=ICARUS, mutants=ICARUS),
)
PROOFS = (Proof(f"rows are only counted; {ROUNDING}", {"Rows": 4}),)


CLOSEST = 6  # cycles between two rows, at least: the way of an addend into the mean


async def check(dut: Any, amplitude: float | None, frames: int, pause: float, strays: int = 0) -> None:
    """Send columns d; `strays` words of an incomplete frame come before the second frame."""
    config = configuration()
    rows, width = config.rows, config.arithmetic_width
    d = uniform((frames, rows, 1), width, amplitude)
    distances = np.random.default_rng(cocotb.RANDOM_SEED).integers(CLOSEST, CLOSEST + 9, 2 * d.size + strays)
    apart = iter(distances.tolist())
    stimuli: list[dict[str, int]] = []
    used = []  # clocks in which a mean is complete
    for index, column in enumerate(d[..., 0].tolist()):
        words = column[:-1] if index != 1 else column[:strays] + column[:-1]
        begins = {0, strays if index == 1 else 0}
        for row, word in enumerate(words):
            stimuli.append({"in_next": 1, "in_frame_start": int(row in begins), "in_data": 0})
            stimuli += [{"in_next": 0, "in_frame_start": 0, "in_data": word}] * next(apart)
        used.append(len(stimuli) - 1)
    clips: list[Any] = []  # in every clock, those without en too
    at_every_edge(dut.clk, map(clips.append, iter(lambda: dut.clipped.value, None)))
    pins = await drive(dut, stimuli, ["mean"], pause)
    monitor = Monitor()
    zero_mean(d, config, monitor)
    np.testing.assert_array_equal([pins["mean"][clock].to_signed() for clock in used], d[:, -1, 0])
    assert sum(int(clip).bit_count() for clip in clips[CLOSEST:]) == monitor.saturations.total()


@cocotb.test
@parametrize(amplitude=[0.01, 1.0, None], pause=[0.0, 0.3])
async def means(dut: Any, amplitude: float | None, pause: float) -> None:
    await check(dut, amplitude, MANY * 3, pause)


@cocotb.test
@parametrize(strays=[1, 5])
async def a_frame_begins_afresh(dut: Any, strays: int) -> None:
    await check(dut, 0.5, 3, 0.0, strays)
