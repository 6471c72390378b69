# SPDX-License-Identifier: Apache-2.0
"""wide_substitution against its model: codes, latency and clip counts, with gaps between frames, pauses and resets."""

from typing import Any

import cocotb
import numpy as np

from formal.entries import ROUNDING, Proof
from formal.tables import wide_up_roms
from tactile_depth.chip.common.td_round_saturate import Monitor
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.poisson.transform.wide_commutator import LEAD
from tactile_depth.chip.poisson.transform.wide_row_pairs import up_positions
from tactile_depth.chip.poisson.wide_solver import solver_parameters
from tactile_depth.chip.poisson.wide_stack import LEAD as IN_LEAD
from tactile_depth.chip.poisson.wide_stack import wide_stack
from tactile_depth.chip.poisson.wide_substitution import LATENCY, wide_substitution
from tactile_depth.chip.rom_files import write_wide_thomas
from tb.pairs import AloneMonitor, PairMonitor
from tb.stream import MANY, check_bursts, configuration, parametrize, uniform, with_and_without_en
from tb.structures import ICARUS, VERILATOR, Structure
from tb.wide import WideDriver

CHOICES = {"columns": 16, "rows": 8, "solver": "tridiagonal", "lanes": 4}


def built(choices: Any, **runs: Any) -> Structure:
    config = Configuration(**choices)
    parameters = solver_parameters(config)
    return Structure(
        {name: parameters[name] for name in ("Width", "CoeffWidth", "Rows", "Columns")}
        | {"InWidth": config.data_width, "Drop": -parameters["StoreDrop"], "Words": config.lanes}
        | {"TableWords": parameters["UpTableWords"], "SettledWidth": parameters["UpSettledWidth"]},
        device={"configuration": choices},
        roms=lambda folder: write_wide_thomas(folder, config),
        **runs,
    )


STRUCTURES = (
    built(CHOICES | {"rows": 9}, on=VERILATOR),
    built(CHOICES | {"lanes": 8, "neumann": True}, on=ICARUS),  # z goes straight into the next product
    built(CHOICES | {"rows": 11, "lanes": 2}, on=ICARUS),
    # Few bits are dropped: ties are common.
    built(CHOICES | {"data_width": 12, "coefficient_width": 10}, mutants=ICARUS, on=ICARUS),
    built(CHOICES | {"rows": 9, "data_width": 12, "coefficient_width": 10, "lanes": 8}, mutants=ICARUS),
    built(CHOICES | {"rows": 21, "data_width": 32, "coefficient_width": 24}),
    built(CHOICES | {"columns": 64, "lanes": 32}),
)
PROTOCOL = "protocol_wide_pairs"
PROOFS = tuple(
    Proof(
        "z that goes straight into the next product, and z that waits; an even and an odd number of rows; three pairs, "
        f"so that a product follows a product; each of two words; {ROUNDING}",
        {"Rows": rows, "Columns": columns, "Words": 2, "Word": word, "TableWords": 16},
        roms=wide_up_roms(rows, columns // 2),
    )
    for rows, columns, word in ((5, 4, 0), (4, 4, 1), (5, 8, 1))
)


UNCLIPPED = 0.05  # amplitude at which nothing clips


class PairDriver(WideDriver):
    """WideDriver of pairs of rows, the last one of an odd frame alone."""

    lead = IN_LEAD

    def __init__(self, dut: Any, words: int, rows: int) -> None:
        self.rows, self.pair = rows, 0
        super().__init__(dut, "in", ["data"], words)

    async def _driver_send(self, transaction: Any, sync: bool = True) -> None:
        self.pair = 0 if self.frame_start else self.pair + 1
        self.entity.in_alone.value = int(self.rows % 2 == 1 and self.pair == self.rows // 2)
        await super()._driver_send(transaction, sync)


async def check(dut: Any, amplitude: Any, count: int = 3, **behaviour: Any) -> None:
    """Send frames of random words up to an amplitude, and compare the output with the model.

    An amplitude of None gives mostly the lowest and the highest word.
    """
    config = configuration()
    rows, words, width = config.rows, config.lanes, config.data_width
    beats, pairs = config.columns // words, (rows + 1) // 2
    order = up_positions(config.columns, words)
    e = uniform((count, 2 * pairs, beats, words), width, amplitude)  # behind a row alone come words of no meaning

    def model(sent: Any, monitor: Monitor) -> Any:
        stacked = np.zeros((count, rows, config.columns), np.int64)
        stacked[..., order] = sent.reshape(count, 2 * pairs, beats, words)[:, :rows]
        z = wide_substitution(stacked, config, monitor)
        out = np.zeros((count, 2 * pairs, beats, words), np.int64)
        out[:, :rows] = wide_stack(z[:, ::-1], words)
        return out

    alone = AloneMonitor(dut, "out")
    await check_bursts(
        dut,
        e.reshape(count * pairs, 2 * beats, words),
        model,
        LATENCY,
        in_fields=["data"] * words,
        out_fields=["data"] * words,
        frame=pairs,
        gap_every=pairs,
        driver=PairDriver(dut, words, rows),
        source=PairMonitor(dut, "in", beats, words, 2 * pairs, IN_LEAD),
        sink=PairMonitor(dut, "out", beats, words, rows, LEAD),
        **behaviour,
    )
    want = [rows % 2 != 0 and pair % pairs == pairs - 1 for pair in range(count * pairs)]
    assert alone.marks[-len(want) :] == want


@cocotb.test(timeout_time=20, timeout_unit="ms")
@parametrize(pause=[0.0, 0.3], full_scale=[False, True])
async def frames(dut: Any, pause: float, full_scale: bool) -> None:
    await check(dut, 1.0 if full_scale else UNCLIPPED, gap=30, pause=pause)


@cocotb.test(timeout_time=50, timeout_unit="ms")
@parametrize(amplitude=[0.003, 0.1, None])
async def many_frames(dut: Any, amplitude: float) -> None:
    """Reach ties of the rounding, clip every value that can clip, and let frame follow frame without a pause."""
    await check(dut, amplitude, count=MANY)


@cocotb.test(timeout_time=20, timeout_unit="ms")
@parametrize(amplitude=[0.1, None])
async def reset_in_mid_frame(dut: Any, amplitude: float) -> None:
    """Reset as the first words enter and leave and in the middle of a frame; None: while values are clipped."""
    config = configuration()
    inner = config.columns // config.lanes * (config.rows // 2)
    counts = [*range(1, IN_LEAD + LATENCY + 4), *range(inner, inner + 4)]
    await check(dut, amplitude, interrupts=with_and_without_en(counts))


@cocotb.test(timeout_time=20, timeout_unit="ms")
@parametrize(strays=[1, 2, 11])
async def a_frame_begins_afresh(dut: Any, strays: int) -> None:
    """Start a frame after part of another one, and after more than one without a start of frame in between."""
    await check(dut, 0.1, count=1, strays=strays)
