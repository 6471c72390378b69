# SPDX-License-Identifier: Apache-2.0
"""dst_forward against its model: codes, latency, saturations; gaps, pauses, extremes, reset."""

from typing import Any

import cocotb
import numpy as np

from formal.entries import Proof
from formal.tables import transform_roms
from tactile_depth.chip.common.td_round_saturate import Monitor
from tactile_depth.chip.poisson.transform.commutator import from_beats, to_beats
from tactile_depth.chip.poisson.transform.dst_forward import dst_forward
from tactile_depth.chip.poisson.transform.dst_forward import latency as dst_forward_latency
from tactile_depth.chip.poisson.transform.transform import Transform
from tactile_depth.chip.rom_files import write_direction
from tb.beats import check_beats
from tb.stream import MANY, extremes, parameters, parametrize, sample, uniform, with_and_without_en
from tb.structures import ICARUS, VERILATOR, Mutants, Structure

PARAMETERS = ("Size", "Words", "InWidth", "InputDrop", "Width", "CoeffWidth", "OutputDrop", "OutWidth", "Sine")


def built(*values: int, **runs: Any) -> Structure:
    parameters = dict(zip(PARAMETERS, values, strict=True))
    size, words, coeff = (parameters[name] for name in ("Size", "Words", "CoeffWidth"))
    return Structure(parameters, roms=lambda folder: write_direction(folder, size, words, False, coeff), **runs)


STRUCTURES = (
    built(16, 4, 23, 0, 27, 18, 3, 24, 1, on=VERILATOR),
    built(16, 2, 23, 0, 27, 18, 3, 24, 1, on=ICARUS),
    built(16, 8, 15, 0, 15, 10, 3, 12, 1, on=ICARUS),
    built(8, 4, 9, 0, 9, 7, 3, 6, 1, on=ICARUS, mutants=ICARUS),
    built(32, 4, 9, 0, 9, 7, 1, 6, 0, on=ICARUS),
    built(32, 1, 24, -3, 27, 18, 3, 24, 1, on=ICARUS),
    built(16, 1, 9, 1, 9, 7, 1, 6, 0, mutants=ICARUS),
    built(128, 4, 27, 0, 27, 18, 0, 27, 1),
)
PROTOCOL = {"protocol_beats": {"Beats": "Size / Words"}}
MUTANTS = Mutants(flat=False)
PROOFS = (
    Proof(
        "the smallest transform, every core of a longer one is in it",
        {"Size": 8, "Words": 2, "Latency": dst_forward_latency(8, 2)},
        roms=transform_roms(2, 4),
    ),
)


CLOCKS_OF_A_BURST_EDGE = 12  # cycles in which a burst begins to enter, or to leave


async def check(dut: Any, words: Any, **behaviour: Any) -> Any:
    """Send bursts (count, beats, words, 1) and compare the output with the model of the device."""
    formats: Any = parameters(dut, "InputDrop", "Width", "CoeffWidth", "OutputDrop", "OutWidth", "Sine")
    size, paths = parameters(dut, "Size", "Words")

    def model(words: Any, monitor: Monitor) -> Any:
        rows = from_beats(words[..., 0], (size // paths).bit_length() - 1)
        return to_beats(dst_forward(rows, Transform(*formats), monitor), paths, 0)[..., None]

    return await check_beats(
        dut, words, model, dst_forward_latency(size, paths), fields=["data"], paths=paths, **behaviour
    )


def shape(dut: Any, bursts: int) -> tuple[int, ...]:
    size, paths = parameters(dut, "Size", "Words")
    return bursts, size // paths, paths, 1


@cocotb.test(timeout_time=2, timeout_unit="ms")
@parametrize((("gap", "pause"), [(0, 0.0), (30, 0.0), (0, 0.3)]), ("amplitude", sample([0.3, 1.0, None])))
async def bursts(dut: Any, gap: float, pause: float, amplitude: float) -> None:
    (width,) = parameters(dut, "InWidth")
    await check(dut, uniform(shape(dut, 5), width, amplitude), gap=gap, pause=pause)


@cocotb.test(timeout_time=50, timeout_unit="ms")
@parametrize(amplitude=[0.1, None])
async def many_bursts(dut: Any, amplitude: float) -> None:
    """Reach ties of every rounding, and clip every value that can clip."""
    (width,) = parameters(dut, "InWidth")
    await check(dut, uniform(shape(dut, 4 * MANY), width, amplitude))


@cocotb.test(timeout_time=2, timeout_unit="ms")
async def limits(dut: Any) -> None:
    size, width = parameters(dut, "Size", "InWidth")
    _, sink = await check(dut, extremes(size, width).reshape(shape(dut, 8)))
    assert not np.any(sink.words[: shape(dut, 1)[1]]), "zero in, but not zero out"


@cocotb.test(timeout_time=2, timeout_unit="ms")
@parametrize((("late", "clips"), sample([(False, True), (False, False), (True, False), (True, True)])))
async def reset_in_mid_burst(dut: Any, late: bool, clips: bool) -> None:
    """Reset in each cycle in which a burst begins to enter, or to leave; a clip after the reset is not counted."""
    size, width, paths = parameters(dut, "Size", "InWidth", "Words")
    first = dst_forward_latency(size, paths) - 3 if late else 1
    words = uniform(shape(dut, 2), width, None if clips else 1.0)
    await check(dut, words, interrupts=with_and_without_en(range(first, first + CLOCKS_OF_A_BURST_EDGE)))
