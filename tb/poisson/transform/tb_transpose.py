# SPDX-License-Identifier: Apache-2.0
"""transpose against its model: positions, latency, columns without a pause; gaps, pauses, reset."""

from typing import Any

import cocotb

from formal.entries import ONE_ORDER, WORD_FREE, Proof
from tactile_depth.chip.poisson.transform.transpose import LATENCY, transpose
from tb.beats import one_path
from tb.stream import check_frame_memory, parameters, parametrize, places
from tb.structures import ICARUS, VERILATOR, of_parameters

built = of_parameters("Columns Width MakhoulIn MakhoulOut")
STRUCTURES = (
    built(16, 24, 0, 1, on=VERILATOR),
    built(8, 16, 0, 0, on=ICARUS),
    built(8, 16, 0, 1, on=ICARUS),
    built(8, 16, 1, 0, on=ICARUS),
    built(8, 16, 1, 1),
    built(4, 5, 0, 1, mutants=ICARUS),
)
PROTOCOL = {"protocol_beats": {"Beats": "Columns", "Rows": "Columns"}}
PROOFS = tuple(
    Proof(f"{ONE_ORDER}; {WORD_FREE}", {"Columns": 4, "MakhoulIn": makhoul_in, "MakhoulOut": makhoul_out})
    for makhoul_in, makhoul_out in ((0, 1), (1, 0))
)


FRAMES = 4  # in place, rows and columns of the memory change roles with every frame


async def check(dut: Any, frames: Any = FRAMES, **behaviour: Any) -> None:
    columns, width, makhoul_in, makhoul_out = parameters(dut, "Columns", "Width", "MakhoulIn", "MakhoulOut")

    def model(words: Any) -> Any:
        return transpose(words, bool(makhoul_in), bool(makhoul_out))

    words = places(frames * columns * columns, width).reshape(frames, -1)
    await check_frame_memory(dut, words, model, LATENCY, rows=columns, **one_path(dut, columns), **behaviour)


@cocotb.test(timeout_time=2, timeout_unit="ms")
@parametrize((("gap", "pause"), [(0, 0.0), (5, 0.0), (80, 0.0), (0, 0.3), (30, 0.3)]))
async def frames(dut: Any, gap: float, pause: float) -> None:
    await check(dut, gap=gap, pause=pause)


@cocotb.test(timeout_time=2, timeout_unit="ms")
@parametrize(late=[False, True])
async def reset_in_mid_frame(dut: Any, late: bool) -> None:
    """Reset as the first words enter, as the last row enters, as reading begins, and in the middle of a third frame."""
    (columns,) = parameters(dut, "Columns")
    first = (columns - 1) * columns if late else 1
    await check(dut, frames=2, interrupts=[*range(first, first + 5), 5 * columns * columns // 2])


@cocotb.test(timeout_time=5, timeout_unit="ms")
@parametrize(strays=[1, 2, 11])
async def a_frame_begins_afresh(dut: Any, strays: int) -> None:
    """Start a frame after part of another one, and after more than one without a start of frame in between."""
    await check(dut, frames=2, strays=strays)
