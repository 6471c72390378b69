# SPDX-License-Identifier: Apache-2.0
"""dst_inverse against its model: codes, latency, saturations; rows alone, gaps, pauses, extremes, reset."""

import random
from collections.abc import Sequence
from typing import Any

import cocotb
import numpy as np

from formal.entries import Proof
from formal.tables import transform_roms
from tactile_depth.chip.common.td_round_saturate import Monitor
from tactile_depth.chip.poisson.transform.commutator import from_beats, to_beats
from tactile_depth.chip.poisson.transform.dst_inverse import dst_inverse_pairs
from tactile_depth.chip.poisson.transform.dst_inverse import latency as dst_inverse_latency
from tactile_depth.chip.poisson.transform.transform import Transform
from tactile_depth.chip.rom_files import write_direction
from tb.beats import AloneDriver, BeatsMonitor, all_stages_clip, alone
from tb.flips import no_flips as no_flips
from tb.pairs import AloneMonitor
from tb.pins import Read
from tb.poisson.burst_core import BurstCore
from tb.stream import MANY, parameters
from tb.structures import ICARUS, VERILATOR, Mutants, Structure

PARAMETERS = ("Size", "Paths", "InWidth", "InputDrop", "Width", "CoeffWidth", "OutputDrop", "OutWidth", "Sine")


def built(*values: int, **runs: Any) -> Structure:
    parameters = dict(zip(PARAMETERS, values, strict=True))
    size, paths, coeff = (parameters[name] for name in ("Size", "Paths", "CoeffWidth"))
    return Structure(parameters, roms=lambda folder: write_direction(folder, size, paths, True, coeff), **runs)


STRUCTURES = (
    built(16, 2, 27, 0, 27, 18, 3, 24, 1, on=VERILATOR),
    built(16, 4, 27, 0, 27, 18, 3, 24, 1, on=ICARUS),
    built(16, 1, 15, 0, 15, 10, 3, 12, 1, on=ICARUS),
    built(32, 4, 9, 1, 9, 7, 1, 6, 0, on=ICARUS),
    built(8, 2, 9, -1, 9, 7, 3, 5, 1, on=ICARUS),
    built(32, 2, 9, -1, 9, 7, 2, 5, 1, mutants=ICARUS),  # of fewer points none clips beside a row alone
    built(64, 16, 27, 0, 27, 18, 3, 24, 1),
    built(64, 1, 24, -3, 27, 18, 3, 24, 1),
    built(128, 4, 27, 0, 27, 18, 3, 24, 1),
)
PROTOCOL = {"protocol_beats": {"Beats": "Size / Paths"}}
MUTANTS = Mutants(flat=False)
PROOFS = (
    Proof(
        "the smallest transform, every core of a longer one is in it",
        {"Size": 8, "Paths": 2, "Latency": dst_inverse_latency(8, 2)},
        roms=transform_roms(2, 4),
    ),
)


class RowsMonitor(BeatsMonitor):
    """BeatsMonitor of two rows; what leaves beside a row alone counts as 0."""

    def __init__(self, dut: Any, *arguments: Any) -> None:
        super().__init__(dut, *arguments)
        self.of_starts, self.alone = AloneMonitor(dut, "out"), False

    def word(self, reads: Sequence[Read]) -> Any:
        if len(self.words) % self.length == 0:
            self.alone = self.of_starts.marks[-1]
        return super().word(reads[: self.paths]) + (0,) * self.paths if self.alone else super().word(reads)


class GapDriver(AloneDriver):
    """AloneDriver of which in_alone is random in gaps."""

    def idle(self) -> None:
        super().idle()
        self.entity.in_alone.value = random.getrandbits(1)


class RowsCore(BurstCore):
    """BurstCore of two rows, with zeros beside a row alone.

    Words of fewer bits than the arithmetic, whose sums do not fit, have zeros beside them too, as in spectral_solver.
    """

    async def check(self, dut: Any, words: Any, **behaviour: Any) -> None:
        in_width, width = parameters(dut, "InWidth", "Width")
        words[alone(words) | (in_width < width), ..., 1] = 0
        await super().check(dut, words, **behaviour)


def formats(dut: Any) -> Transform:
    values: Any = parameters(dut, "InputDrop", "Width", "CoeffWidth", "OutputDrop", "OutWidth", "Sine")
    return Transform(*values)


def model(dut: Any, x: Any, monitor: Monitor) -> Any:
    _, beats, paths, _ = x.shape
    pairs = np.stack([from_beats(x[..., row], 0) for row in (0, 1)], axis=1)
    out = np.zeros_like(pairs)
    for samples, modes, count in zip(out, pairs, 2 - alone(x), strict=True):
        samples[:count] = dst_inverse_pairs(modes[:count], formats(dut), monitor)
    return np.stack([to_beats(out[:, row], paths, beats.bit_length() - 1) for row in (0, 1)], axis=-1)


CORE = RowsCore(
    model,
    lambda dut: dst_inverse_latency(*parameters(dut, "Size", "Paths")),
    "InWidth",
    ("a", "b"),
    {"driver": GapDriver, "sink": RowsMonitor},
)
bursts, many_bursts, limits, reset_in_mid_burst, *_ = CORE.tests()


@cocotb.test
async def every_stage_clips_at_once(dut: Any) -> None:
    (in_width,) = parameters(dut, "InWidth")

    def of_pairs(x: Any, monitor: Monitor) -> Any:
        pairs = np.stack([from_beats(x[..., row], 0) for row in (0, 1)], axis=1)
        pairs[alone(x), 1] = 0
        return dst_inverse_pairs(pairs, formats(dut), monitor)

    def width_of(node: str) -> int:
        return formats(dut).output_width if node.endswith("output") else formats(dut).width

    await CORE.check(dut, all_stages_clip(CORE.shape(dut, 7 * MANY), in_width, of_pairs, width_of))
