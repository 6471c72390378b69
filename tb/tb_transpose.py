# SPDX-License-Identifier: Apache-2.0
"""transpose against its model: places, latency, columns without a pause; gaps, pauses, reset."""

import cocotb
import numpy as np
from stream import check_bursts, parameters

from models.latency import TRANSPOSE
from models.transpose import transpose

FRAMES = 4  # in place, rows and columns of the memory change roles with every frame


async def check(dut, frames=FRAMES, **behaviour):
    size, makhoul_in, makhoul_out = parameters(dut, "Size", "MakhoulIn", "MakhoulOut")

    def model(x, monitor):
        return transpose(x.reshape(-1, size, size), bool(makhoul_in), bool(makhoul_out))

    words = np.arange(1, frames * size * size + 1)  # each stands for its place
    source, sink = await check_bursts(
        dut, words.reshape(-1, size, 1), model, None, in_fields=["data"], out_fields=["data"], **behaviour
    )
    last_rows, first_columns = source.starts[size - 1 :: size], sink.starts[::size]
    assert [out - row for out, row in zip(first_columns, last_rows, strict=True)] == [TRANSPOSE] * frames
    columns = np.diff(np.array(sink.starts).reshape(frames, size), axis=1)
    assert np.all(columns == size), "the columns of a frame follow each other without a pause"


@cocotb.test(timeout_time=2, timeout_unit="ms")
@cocotb.parametrize((("gap", "pause"), [(0, 0.0), (5, 0.0), (80, 0.0), (0, 0.3), (30, 0.3)]))
async def frames(dut, gap, pause):
    await check(dut, gap=gap, pause=pause)


@cocotb.test(timeout_time=2, timeout_unit="ms")
@cocotb.parametrize(sent=[0.5, 1, 1.6, 2.5])
async def reset_in_mid_frame(dut, sent):
    """A row is half in; the last row has begun, so reading just begins; a second, a third frame are half in."""
    (size,) = parameters(dut, "Size")
    await check(dut, frames=2, interrupt=int(sent * size) * size - (size - 1 if sent == 1 else size // 2))
