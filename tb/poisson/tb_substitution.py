# SPDX-License-Identifier: Apache-2.0
"""substitution against its model: codes, latency and clip counts, with gaps between frames, pauses and resets."""

from functools import partial
from typing import Any

import cocotb
import numpy as np

from formal.entries import ROUNDING, Proof
from formal.tables import up_roms
from tactile_depth.chip.common.td_round_saturate import Monitor
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.poisson.frame_stack import LEAD as LEAD_IN
from tactile_depth.chip.poisson.substitution import LATENCY, substitution
from tactile_depth.chip.poisson.tridiagonal_solver import solver_parameters
from tactile_depth.chip.rom_files import write_thomas
from tb.beats import BeatsDriver, BeatsMonitor, check_bursts
from tb.pairs import AloneMonitor, side_by_side
from tb.stream import MANY, configuration, parametrize, uniform, with_and_without_en
from tb.structures import ICARUS, VERILATOR, Structure

CHOICES = {"columns": 16, "rows": 8, "solver": "tridiagonal", "lanes": 4}


def built(choices: Any, **runs: Any) -> Structure:
    config = Configuration(**choices)
    parameters = solver_parameters(config)
    return Structure(
        {name: parameters[name] for name in ("Width", "CoeffWidth", "Rows", "Columns")}
        | {"InWidth": config.data_width, "Drop": -parameters["StoreDrop"], "Paths": config.up_paths}
        | {"TableWords": parameters["UpTableWords"], "SettledWidth": parameters["UpSettledWidth"]},
        device={"configuration": choices},
        roms=lambda folder: write_thomas(folder, config),
        **runs,
    )


STRUCTURES = (
    built(CHOICES | {"rows": 9}, on=VERILATOR),
    built(CHOICES | {"lanes": 8, "neumann": True}, on=ICARUS),  # z goes straight into the next product
    built(CHOICES | {"rows": 11, "lanes": 2}, on=ICARUS),
    # Few bits are dropped: ties are common.
    built(CHOICES | {"data_width": 12, "coefficient_width": 10}, mutants=ICARUS, on=ICARUS),
    built(CHOICES | {"rows": 9, "data_width": 12, "coefficient_width": 10, "lanes": 8}, mutants=ICARUS),
    built(CHOICES | {"rows": 21, "data_width": 32, "coefficient_width": 24, "lanes": 1}),
    built(CHOICES | {"columns": 64, "lanes": 32}),
)
PROTOCOL = "protocol_pairs"
PROOFS = tuple(
    Proof(
        "z that goes straight into the next product, and z that waits; an even and an odd number of rows; three pairs, "
        f"so that a product follows a product; each of two words; {ROUNDING}",
        {"Rows": rows, "Columns": columns, "Word": word, "TableWords": 32},
        roms=up_roms((rows + 1) // 2, columns),
    )
    for rows, columns, word in ((5, 4, 0), (6, 4, 1), (5, 8, 1))
)


UNCLIPPED = 0.05  # amplitude at which nothing clips


class PairDriver(BeatsDriver):
    """BeatsDriver of pairs of rows, the last one of an odd frame alone."""

    def __init__(self, *arguments: Any, **named: Any) -> None:
        self.rows, self.pair = configuration().rows, 0
        super().__init__(*arguments, **named)

    async def _driver_send(self, transaction: Any, sync: bool = True) -> None:
        self.pair = 0 if self.frame_start else self.pair + 1
        self.entity.in_alone.value = int(self.rows % 2 == 1 and self.pair == self.rows // 2)
        await super()._driver_send(transaction, sync)


async def check(dut: Any, amplitude: Any, count: int = 3, **behaviour: Any) -> None:
    """Send frames of random words up to an amplitude, and compare the output with the model.

    An amplitude of None gives mostly the lowest and the highest word.
    """
    config = configuration()
    rows, paths = config.rows, config.up_paths
    pairs = (rows + 1) // 2
    shape = (count * pairs, config.columns // paths, 2 * paths, 1)
    e = uniform(shape, config.data_width, amplitude)  # beside a row alone come words of no meaning

    def model(sent: Any, monitor: Monitor) -> Any:
        both = np.moveaxis(sent.reshape(count, pairs, -1, 2, paths), 3, 2)
        z = substitution(both.reshape(count, 2 * pairs, -1)[:, :rows], config, monitor)
        return side_by_side(z, paths).reshape(shape)

    alone = AloneMonitor(dut, "out")
    behaviour |= {"driver": partial(PairDriver, lead=LEAD_IN), "source": partial(BeatsMonitor, lead=LEAD_IN)}
    await check_bursts(dut, e, model, LATENCY, frame=pairs, gap_every=pairs, **behaviour)
    want = [rows % 2 != 0 and pair % pairs == pairs - 1 for pair in range(count * pairs)]
    assert alone.marks[-len(want) :] == want


@cocotb.test
@parametrize(pause=[0.0, 0.3], full_scale=[False, True])
async def frames(dut: Any, pause: float, full_scale: bool) -> None:
    await check(dut, 1.0 if full_scale else UNCLIPPED, gap=30, pause=pause)


@cocotb.test
@parametrize(amplitude=[0.003, 0.1, None])
async def many_frames(dut: Any, amplitude: float) -> None:
    """Reach ties of the rounding, clip every value that can clip, and let frame follow frame without a pause."""
    await check(dut, amplitude, count=MANY)


@cocotb.test
@parametrize(amplitude=[0.1, None])
async def reset_in_mid_frame(dut: Any, amplitude: float) -> None:
    """Reset as the first words enter and leave and in the middle of a frame; None: while values are clipped."""
    config = configuration()
    inner = config.columns // config.up_paths * (config.rows // 4)
    counts = [*range(1, LEAD_IN + LATENCY + 4), *range(inner, inner + 4)]
    await check(dut, amplitude, interrupts=with_and_without_en(counts))


@cocotb.test
@parametrize(strays=[1, 2, 11])
async def a_frame_begins_afresh(dut: Any, strays: int) -> None:
    """Start a frame after part of another one, and after more than one without a start of frame in between."""
    await check(dut, 0.1, count=1, strays=strays)
