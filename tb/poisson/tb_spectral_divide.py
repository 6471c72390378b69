# SPDX-License-Identifier: Apache-2.0
"""spectral_divide against its model: whole frames, which reach all positions; gaps, pauses, extremes, reset."""

from typing import Any

import cocotb
import numpy as np

from formal.entries import ROUNDING, Proof
from formal.tables import divide_rom
from tactile_depth.chip.common.td_round_saturate import Monitor
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.poisson.spectral_divide import LATENCY, reciprocals, spectral_divide
from tactile_depth.chip.rom_files import write_solver
from tb.beats import check_bursts
from tb.stream import MANY, configuration, extremes, parameters, parametrize, sample, uniform
from tb.structures import ICARUS, VERILATOR, Structure


def built(choices: Any, **runs: Any) -> Structure:
    config = Configuration(**choices)
    table = reciprocals(config)
    return Structure(
        {
            "Columns": config.columns,
            "Width": config.arithmetic_width,
            "CoeffWidth": config.coefficient_width,
            "ShiftWidth": table.shift_width,
            "Drop": table.drop,
        },
        device={"configuration": choices},
        roms=lambda folder: write_solver(folder, config),
        **runs,
    )


STRUCTURES = (
    built({"columns": 16}, on=VERILATOR),
    # Here the largest reciprocals exceed 2^(CoeffWidth - 1): they shift further than Drop drops.
    built({"columns": 16, "coefficient_width": 10, "depth_range_px": 0.1, "gradient_limit": 4.0}, on=ICARUS),
    built({"columns": 32, "data_width": 12, "coefficient_width": 10}, mutants=ICARUS),
    built({"columns": 16, "data_width": 32, "coefficient_width": 24, "depth_range_px": 40.0}),
)
PROTOCOL = {"protocol_beats": {"Beats": "Columns", "Rows": "Columns"}}
PROOFS = tuple(
    Proof(f"one recurrence for every size; {ROUNDING}", {"Columns": size}, roms=divide_rom(size)) for size in (4, 8)
)


async def check(dut: Any, x: Any, **behaviour: Any) -> None:
    config = configuration()

    def model(x: Any, monitor: Monitor) -> Any:
        return spectral_divide(x.reshape(-1, config.columns, config.columns), config, monitor).reshape(x.shape)

    await check_bursts(dut, x.reshape(-1, config.columns, 1, 1), model, LATENCY, frame=config.columns, **behaviour)


@cocotb.test
@parametrize((("gap", "pause"), sample([(0, 0.0), (9, 0.0), (9, 0.3)])), ("amplitude", [0.001, 1.0]))
async def frames(dut: Any, gap: float, pause: float, amplitude: float) -> None:
    columns, width = parameters(dut, "Columns", "Width")
    await check(dut, uniform((3, columns, columns), width, amplitude), gap=gap, pause=pause)


@cocotb.test
@parametrize(amplitude=[0.01, 0.2, None])
async def many_frames(dut: Any, amplitude: float) -> None:
    """Reach ties of the rounding, and values that just clip."""
    columns, width = parameters(dut, "Columns", "Width")
    await check(dut, uniform((MANY, columns, columns), width, amplitude))


@cocotb.test
async def limits(dut: Any) -> None:
    """Fill a frame with each kind of burst, so that it reaches every position and the lowest modes clip."""
    columns, width = parameters(dut, "Columns", "Width")
    await check(dut, np.repeat(extremes(columns, width), columns, axis=0))


@cocotb.test
@parametrize(late=[False, True])
async def reset_in_mid_frame(dut: Any, late: bool) -> None:
    """Reset as the first words enter and leave, and in the middle of the second frame."""
    columns, width = parameters(dut, "Columns", "Width")
    first = 3 * columns * columns // 2 + columns // 2 if late else 1
    await check(dut, uniform((columns, columns), width), interrupts=range(first, first + LATENCY + 2))


@cocotb.test
@parametrize(strays=[1, 2, 11])
async def a_frame_begins_afresh(dut: Any, strays: int) -> None:
    """Start a frame after part of another one, and after more than one without a start of frame in between."""
    columns, width = parameters(dut, "Columns", "Width")
    await check(dut, uniform((columns, columns), width), strays=strays)
