# SPDX-License-Identifier: Apache-2.0
"""dst_inverse against its model: codes, latency, saturations; rows alone, gaps, pauses, extremes, reset."""

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
from tb.pairs import AloneMonitor
from tb.pins import Read
from tb.stream import MANY, check_bursts, extremes, parameters, parametrize, sample, uniform, with_and_without_en
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


CLOCKS_OF_A_BURST_EDGE = 12  # cycles in which a burst begins to enter, or to leave


def shape(dut: Any, bursts: int) -> tuple[int, ...]:
    size, paths = parameters(dut, "Size", "Paths")
    return bursts, size // paths, 2 * paths


def pairs_of(beats: Any) -> Any:
    """Return bursts (count, beats, 2 paths) as rows (count, 2, N)."""
    return np.stack([from_beats(part, 0) for part in np.split(beats, 2, axis=-1)], axis=1)


def formats(dut: Any) -> Transform:
    values: Any = parameters(dut, "InputDrop", "Width", "CoeffWidth", "OutputDrop", "OutWidth", "Sine")
    return Transform(*values)


class RowsMonitor(BeatsMonitor):
    """BeatsMonitor of two rows; what leaves beside a row alone counts as 0."""

    def __init__(self, dut: Any, beats: int, paths: int) -> None:
        super().__init__(dut, "out", ["a", "b"], beats, paths)
        self.of_starts, self.alone = AloneMonitor(dut, "out"), False

    def word(self, reads: Sequence[Read]) -> Any:
        if len(self.words) % self.length == 0:
            self.alone = self.of_starts.marks[-1]
        return super().word(reads[: self.paths]) + (0,) * self.paths if self.alone else super().word(reads)


async def check(dut: Any, bursts: Any, **behaviour: Any) -> None:
    size, paths = parameters(dut, "Size", "Paths")
    bursts[alone(bursts), :, paths:] = 0

    def model(beats: Any, monitor: Monitor) -> Any:
        pairs = pairs_of(beats)
        out = np.zeros_like(pairs)
        for samples, modes, count in zip(out, pairs, 2 - alone(beats), strict=True):
            samples[:count] = dst_inverse_pairs(modes[:count], formats(dut), monitor)
        lowest = (size // paths).bit_length() - 1
        return np.concatenate([to_beats(out[:, row], paths, lowest) for row in (0, 1)], axis=-1)

    await check_bursts(
        dut,
        bursts,
        model,
        dst_inverse_latency(size, paths),
        in_fields=["word"] * 2 * paths,
        out_fields=["word"] * 2 * paths,
        driver=AloneDriver(dut, "in", ["a", "b"], paths),
        source=BeatsMonitor(dut, "in", ["a", "b"], size // paths, paths),
        sink=RowsMonitor(dut, size // paths, paths),
        **behaviour,
    )


@cocotb.test(timeout_time=2, timeout_unit="ms")
@parametrize((("gap", "pause"), [(0, 0.0), (30, 0.0), (0, 0.3)]), ("amplitude", sample([0.3, 1.0, None])))
async def bursts(dut: Any, gap: int, pause: float, amplitude: float) -> None:
    (width,) = parameters(dut, "InWidth")
    await check(dut, uniform(shape(dut, 8), width, amplitude), gap=gap, pause=pause)


@cocotb.test(timeout_time=50, timeout_unit="ms")
@parametrize(amplitude=[0.1, None])
async def many_bursts(dut: Any, amplitude: float) -> None:
    """Reach ties of every rounding, and clip every value that can clip."""
    (width,) = parameters(dut, "InWidth")
    await check(dut, uniform(shape(dut, 4 * MANY), width, amplitude))


@cocotb.test(timeout_time=50, timeout_unit="ms")
async def every_stage_clips_at_once(dut: Any) -> None:
    (in_width,) = parameters(dut, "InWidth")

    def model(beats: Any, monitor: Monitor) -> Any:
        pairs = pairs_of(beats)
        pairs[alone(beats), 1] = 0
        return dst_inverse_pairs(pairs, formats(dut), monitor)

    def width_of(node: str) -> int:
        return formats(dut).output_width if node.endswith("output") else formats(dut).width

    await check(dut, all_stages_clip(shape(dut, 20 * MANY), in_width, model, width_of))


@cocotb.test(timeout_time=2, timeout_unit="ms")
async def limits(dut: Any) -> None:
    size, width = parameters(dut, "Size", "InWidth")
    await check(dut, extremes(2 * size, width).reshape(shape(dut, 8)))


@cocotb.test(timeout_time=2, timeout_unit="ms")
@parametrize((("late", "clips"), sample([(False, True), (False, False), (True, False), (True, True)])))
async def reset_in_mid_burst(dut: Any, late: bool, clips: bool) -> None:
    """Reset in each cycle in which a burst begins to enter, or to leave; a clip after the reset is not counted."""
    size, width, paths = parameters(dut, "Size", "InWidth", "Paths")
    first = dst_inverse_latency(size, paths) - 3 if late else 1
    bursts = uniform(shape(dut, 3), width, None if clips else 1.0)
    await check(dut, bursts, interrupts=with_and_without_en(range(first, first + CLOCKS_OF_A_BURST_EDGE)))
