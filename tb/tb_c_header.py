# SPDX-License-Identifier: Apache-2.0
"""tactile_depth: the function of the C header loads the tables of another calibration over AXI4-Lite."""

import ctypes
from dataclasses import replace
from typing import Any

import cocotb
import numpy as np
from cocotb.task import bridge, resume

from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.gradient.frame_marks import slope_limit
from tactile_depth.chip.registers.axil_port import Response
from tactile_depth.chip.table_entries import table_entries
from tactile_depth.sensor.synthetic import synthetic
from tb.settings import RUN
from tb.tactile_depth.bench import COMMIT, started

PITCH_MM = 0.0634
WRITE = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_uint32, ctypes.c_uint32)
READ = ctypes.CFUNCTYPE(ctypes.c_uint32, ctypes.c_void_p, ctypes.c_uint32)


def calibration(config: Configuration) -> dict[str, Any]:
    """Return the arguments of `c_header`: another calibration than that of the build, zero offset and gains."""
    sensor, rng = synthetic(config.bits_per_channel), np.random.default_rng(1)
    assert sensor.gradient is not None
    assert sensor.coefficients is not None
    other = replace(
        sensor,
        gradient=sensor.gradient * rng.uniform(0.2, 0.9, sensor.gradient.shape),
        coefficients=sensor.coefficients * 0.7,
        pixel_pitch_mm=PITCH_MM,
        fitted_slope={config.gradient_model: 0.3},
    )
    limit = 1 << config.data_width - 4
    return {
        "calibration": other,
        "config": config,
        "zero": rng.integers(-limit, limit, config.reference_nodes) if config.zero_offset else None,
        "gains": (1 << config.gain.fraction) // rng.integers(90, 160, (*config.reference_nodes, 3)),
    }


@cocotb.test(timeout_time=10, timeout_unit="ms")
async def loaded(dut: Any) -> None:
    """Load every table by the function of the header: the next frame has the codes of the new tables."""
    pipeline = await started(dut)
    master, refused = pipeline.registers.master, []
    frame = pipeline.frame()
    await pipeline.send(frame)
    before = (await pipeline.check()).codes

    @resume
    async def write(_: Any, address: int, word: int) -> None:
        if await master.write(address, word) != Response.OKAY:
            refused.append((address, word))

    @resume
    async def read(_: Any, address: int) -> int:
        return int(await master.read(address))

    @bridge
    def load() -> int:
        return int(ctypes.CDLL(RUN.device["library"]).load(WRITE(write), READ(read)))

    assert await load() == 0
    assert refused == []
    tables = table_entries(**calibration(pipeline.config))
    assert await pipeline.read("TABLE_COMMIT") == COMMIT.pack(**dict.fromkeys(tables, 1))
    assert await pipeline.read("PITCH") == round(PITCH_MM * 1e6)
    pipeline.scoreboard.slope_limit = await pipeline.read("SLOPE_LIMIT")
    assert pipeline.scoreboard.slope_limit == slope_limit(calibration(pipeline.config)["calibration"], pipeline.config)
    for name, entries in tables.items():
        assert (entries != pipeline.tables.content.entries[name]).any(), (
            f"the test is void: {name} is that of the build"
        )
        pipeline.tables.use(name, entries)
    await pipeline.send(frame)
    after = (await pipeline.check()).codes
    assert (after != before).any()
    assert await pipeline.read("TABLE_COMMIT") == 0
