# SPDX-License-Identifier: Apache-2.0
"""elimination against its model: codes, latency and saturation counts, with gaps, pauses and resets."""

import math
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
from tb.beats import BeatsMonitor, check_bursts
from tb.pins import Read
from tb.stream import MANY, configuration, parametrize, sample, uniform, with_and_without_en
from tb.structures import ICARUS, VERILATOR, Structure

NAMES = ["Width", "CoeffWidth", "Rows", "Columns", "StoreDrop", "Neumann"]
NAMES += ["LastShiftWidth", "MomentDrop", "MeanReciprocal", "MeanDrop"]
CHOICES = {"columns": 16, "rows": 8, "solver": "tridiagonal", "lanes": 4}


def built(choices: Any, **runs: Any) -> Structure:
    config = Configuration(**choices)
    parameters = solver_parameters(config)
    return Structure(
        {name: parameters[name] for name in NAMES}
        | {"OutWidth": config.data_width, "Words": config.down_words}
        | {"TableWords": parameters["DownTableWords"], "SettledWidth": parameters["DownSettledWidth"]},
        device={"configuration": choices},
        roms=lambda folder: write_thomas(folder, config),
        **runs,
    )


STRUCTURES = (
    built(CHOICES | {"neumann": True}, on=VERILATOR),
    built(CHOICES | {"rows": 9}, on=ICARUS),
    # Few bits are dropped: ties are common.
    built(
        CHOICES | {"neumann": True, "data_width": 12, "coefficient_width": 10, "lanes": 4}, mutants=ICARUS, on=ICARUS
    ),
    built(CHOICES | {"columns": 32, "data_width": 12, "coefficient_width": 10, "lanes": 16}, mutants=ICARUS),
    built(CHOICES | {"rows": 9, "neumann": True, "lanes": 1}, on=ICARUS),
    built(CHOICES | {"rows": 21, "neumann": True, "data_width": 32, "coefficient_width": 24}),
)
PROOFS = tuple(
    Proof(
        f"the smallest burst that holds the loop of the recursion; each of two words; {ROUNDING}",
        {"Rows": 3, "Columns": 16, "Words": 2, "Word": word, "Neumann": neumann, "TableWords": 16},
        steps=2,
        roms=thomas_roms(3, 8, 16, 6, 2, 2, "down"),
    )
    for word, neumann in ((0, 1), (1, 0))
)


UNCLIPPED = 0.01  # amplitude at which nothing clips


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


async def check(dut: Any, amplitude: Any, frames: int = 3, **behaviour: Any) -> None:
    """Send frames of random words up to an amplitude, and compare the output with the model of the device.

    An amplitude of None gives mostly the lowest and the highest word, infinity the highest word only.
    """
    config = configuration()
    paths, width = config.down_words, config.arithmetic_width
    shape = (frames * config.rows, config.columns // paths, paths, 1)
    words = np.full(shape, (1 << width - 1) - 1) if amplitude == math.inf else uniform(shape, width, amplitude)

    def model(words: Any, monitor: Monitor) -> Any:
        out = elimination(words.reshape(-1, config.rows, config.columns), config, monitor)
        seen = np.zeros((*out.shape, 2), np.int64)
        seen[:, -1, :, 0] = out[:, -1]
        seen[:, 1:, :, 1] = out[:, :-1]
        return seen.reshape(*shape[:3], 2)

    behaviour |= {"out_fields": ("last", "ahead"), "sink": partial(Eliminated, lead=LEAD_OUT)}
    await check_bursts(dut, words, model, LATENCY, frame=config.rows, **behaviour)


@cocotb.test
@parametrize((("gap", "pause"), sample([(0, 0.0), (30, 0.0), (0, 0.3), (30, 0.3)])), ("full_scale", [False, True]))
async def frames(dut: Any, gap: float, pause: float, full_scale: bool) -> None:
    await check(dut, 1.0 if full_scale else UNCLIPPED, gap=gap, pause=pause)


@cocotb.test
@parametrize(amplitude=[0.003, 0.1, None])
async def many_frames(dut: Any, amplitude: float) -> None:
    """Reach ties of every rounding, and clip every value that can clip."""
    await check(dut, amplitude, frames=MANY)


@cocotb.test
@parametrize(amplitude=[0.1, None])
async def reset_in_mid_frame(dut: Any, amplitude: float) -> None:
    """Reset as the first words enter and leave and in the middle of a frame; None: while values are clipped."""
    config = configuration()
    clocks = config.columns // config.down_words
    inner = clocks * (config.rows // 2) + clocks // 2
    counts = [*range(1, LATENCY + 4), *range(inner, inner + 4)]
    await check(dut, amplitude, interrupts=with_and_without_en(counts))


@cocotb.test
@parametrize(strays=[1, 2, 11])
async def a_frame_begins_afresh(dut: Any, strays: int) -> None:
    """Start a frame after part of another one, and after more than one without a start of frame in between."""
    await check(dut, 0.1, frames=1, strays=strays)


@cocotb.test
async def reset_as_the_mean_is_clipped(dut: Any) -> None:
    """Reset in each cycle after the addend of the last row but one: nothing is counted."""
    config = configuration()
    last_addend = config.columns // config.down_words * (config.rows - 2) + LATENCY
    await check(dut, math.inf, interrupts=with_and_without_en(range(last_addend - 4, last_addend + 7)))
