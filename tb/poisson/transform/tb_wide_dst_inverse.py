# SPDX-License-Identifier: Apache-2.0
"""wide_dst_inverse against its model: codes, latency, saturations; rows alone, gaps, pauses, extremes, reset."""

from typing import Any

import cocotb
import numpy as np

from formal.entries import Proof
from formal.tables import wide_roms
from tactile_depth.chip.common.td_round_saturate import Monitor
from tactile_depth.chip.poisson.transform.transform import Transform
from tactile_depth.chip.poisson.transform.wide_commutator import LEAD
from tactile_depth.chip.poisson.transform.wide_corner_turn import wide_corner_turn
from tactile_depth.chip.poisson.transform.wide_dst_inverse import latency as wide_dst_inverse_latency
from tactile_depth.chip.poisson.transform.wide_dst_inverse import wide_dst_inverse
from tactile_depth.chip.poisson.transform.wide_row_pairs import rows_of_bursts
from tactile_depth.chip.rom_files import write_direction
from tb.stream import MANY, extremes, parameters, parametrize, sample, uniform, with_and_without_en
from tb.structures import ICARUS, VERILATOR, Mutants, Structure
from tb.wide import RowPairDriver, WideMonitor, all_stages_clip, alone, check_row_pairs

PARAMETERS = ("Size", "Words", "InWidth", "InputDrop", "Width", "CoeffWidth", "OutputDrop", "OutWidth", "Sine")


def built(*values: int, **runs: Any) -> Structure:
    parameters = dict(zip(PARAMETERS, values, strict=True))
    size, words, coeff = (parameters[name] for name in ("Size", "Words", "CoeffWidth"))
    return Structure(parameters, roms=lambda folder: write_direction(folder, size, words // 2, True, coeff), **runs)


STRUCTURES = (
    built(16, 4, 27, 0, 27, 18, 3, 24, 1, on=VERILATOR),
    built(16, 8, 27, 0, 27, 18, 3, 24, 1, on=ICARUS),
    built(16, 2, 15, 0, 15, 10, 3, 12, 1, on=ICARUS),
    built(32, 8, 9, 1, 9, 7, 1, 6, 0, on=ICARUS),
    built(8, 4, 9, -1, 9, 7, 3, 5, 1, on=ICARUS),
    built(32, 4, 9, -1, 9, 7, 2, 5, 1, mutants=ICARUS),  # of fewer points none clips beside a row alone
    built(64, 32, 27, 0, 27, 18, 3, 24, 1),
    built(128, 8, 27, 0, 27, 18, 3, 24, 1),
)
PROTOCOL = {"protocol_wide_bursts": {"Beats": "2 * Size / Words", "OutBeats": "Size / Words", "OutLead": 0}}
MUTANTS = Mutants(flat=False)
PROOFS = (
    Proof(
        "the smallest transform, every core of a longer one is in it",
        {"Size": 8, "Words": 4, "Latency": wide_dst_inverse_latency(8, 4)},
        roms=wide_roms(2, 4),
    ),
)


TRANSFORM: Any = wide_dst_inverse
CLOCKS_OF_A_BURST_EDGE = 12  # cycles in which a burst begins to enter, or to leave


def shape(dut: Any, bursts: int) -> tuple[int, ...]:
    size, words = parameters(dut, "Size", "Words")
    return bursts, 2 * size // words, words


async def check(dut: Any, bursts: Any, **behaviour: Any) -> None:
    formats: Any = parameters(dut, "InputDrop", "Width", "CoeffWidth", "OutputDrop", "OutWidth", "Sine")
    size, words = parameters(dut, "Size", "Words")
    beats = size // words

    def model(beats_in: Any, monitor: Monitor) -> Any:
        single = alone(beats_in)
        rows = rows_of_bursts(beats_in, single)
        samples = np.zeros_like(rows)
        for out, pair, count in zip(samples, rows, 2 - single, strict=True):
            out[:count] = TRANSFORM(pair[:count], Transform(*formats), monitor)
        return wide_corner_turn(samples, words // 2)

    await check_row_pairs(
        dut,
        bursts,
        model,
        wide_dst_inverse_latency(size, words) - LEAD,
        driver=RowPairDriver(dut, "in", ["data"], words),
        source=WideMonitor(dut, "in", ["data"], 2 * beats, words),
        sink=WideMonitor(dut, "out", ["data"], beats, words, lead=0),
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
    formats: Any = parameters(dut, "InputDrop", "Width", "CoeffWidth", "OutputDrop", "OutWidth", "Sine")
    (in_width,) = parameters(dut, "InWidth")

    def model(beats: Any, monitor: Monitor) -> Any:
        return TRANSFORM(rows_of_bursts(beats, alone(beats)), Transform(*formats), monitor)

    def width_of(node: str) -> int:
        return formats[4] if node.endswith("output") else formats[1]

    await check(dut, all_stages_clip(shape(dut, 20 * MANY), in_width, model, width_of))


@cocotb.test(timeout_time=2, timeout_unit="ms")
async def limits(dut: Any) -> None:
    size, width = parameters(dut, "Size", "InWidth")
    await check(dut, extremes(2 * size, width).reshape(shape(dut, 8)))


@cocotb.test(timeout_time=2, timeout_unit="ms")
@parametrize((("late", "clips"), sample([(False, True), (False, False), (True, False), (True, True)])))
async def reset_in_mid_burst(dut: Any, late: bool, clips: bool) -> None:
    """Reset in each cycle in which a burst begins to enter, or to leave; a clip after the reset is not counted."""
    size, width, words = parameters(dut, "Size", "InWidth", "Words")
    first = wide_dst_inverse_latency(size, words) - 3 if late else 1
    bursts = uniform(shape(dut, 3), width, None if clips else 1.0)
    await check(dut, bursts, interrupts=with_and_without_en(range(first, first + CLOCKS_OF_A_BURST_EDGE)))
