# SPDX-License-Identifier: Apache-2.0
"""transpose against its model: positions, latency, columns without a pause; gaps, pauses, reset."""

from typing import Any

import cocotb
import numpy as np

from formal.entries import ONE_ORDER, WORD_FREE, Proof
from tactile_depth.chip.poisson.transform.transpose import LATENCY, transpose
from tb.beats import check_bursts
from tb.stream import parameters, parametrize, places
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
    Proof(f"{ONE_ORDER}; {WORD_FREE}", {"Columns": 4, "MakhoulIn": makhoul_in, "MakhoulOut": makhoul_out}, steps=1)
    for makhoul_in, makhoul_out in ((0, 1), (1, 0))
)


FRAMES = 4  # in place, rows and columns of the memory change roles with every frame


async def check(dut: Any, frames: int = FRAMES, **behaviour: Any) -> None:
    columns, width, makhoul_in, makhoul_out = parameters(dut, "Columns", "Width", "MakhoulIn", "MakhoulOut")

    def model(words: Any, _: Any) -> Any:
        maps = words.reshape(frames, columns, columns)
        return transpose(maps, bool(makhoul_in), bool(makhoul_out)).reshape(words.shape)

    words = places(frames * columns * columns, width).reshape(-1, columns, 1, 1)
    source, sink = await check_bursts(dut, words, model, None, frame=columns, **behaviour)
    last_rows, first_out = source.starts[columns - 1 :: columns], sink.starts[::columns]
    assert [out - row for out, row in zip(first_out, last_rows, strict=True)] == [LATENCY] * frames
    apart = np.diff(np.array(sink.starts).reshape(frames, columns), axis=1)
    assert np.all(apart == columns), "a frame leaves with a pause between two columns"


@cocotb.test
@parametrize((("gap", "pause"), [(0, 0.0), (5, 0.0), (80, 0.0), (0, 0.3), (30, 0.3)]))
async def frames(dut: Any, gap: float, pause: float) -> None:
    await check(dut, gap=gap, pause=pause)


@cocotb.test
@parametrize(late=[False, True])
async def reset_in_mid_frame(dut: Any, late: bool) -> None:
    """Reset as the first words enter, as the last row enters, as reading begins, and in the middle of a third frame."""
    (columns,) = parameters(dut, "Columns")
    first = (columns - 1) * columns if late else 1
    await check(dut, frames=2, interrupts=[*range(first, first + 5), 5 * columns * columns // 2])


@cocotb.test
@parametrize(strays=[1, 2, 11])
async def a_frame_begins_afresh(dut: Any, strays: int) -> None:
    """Start a frame after part of another one, and after more than one without a start of frame in between."""
    await check(dut, frames=2, strays=strays)
