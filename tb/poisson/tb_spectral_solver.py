# SPDX-License-Identifier: Apache-2.0
"""spectral_solver against its model: the tests that it shares with the other solvers, and its own frames and reset."""

from typing import Any

import cocotb

from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.rom_files import write_solver
from tactile_depth.chip.tactile_depth import hdl_parameters
from tb.poisson.solver_bench import a_frame_begins_afresh, check, codes, many_frames
from tb.stream import configuration, parametrize
from tb.structures import BOTH, ICARUS, VERILATOR, Mutants, Structure


def built(choices: Any, **runs: Any) -> Structure:
    config = Configuration(**choices)
    return Structure(
        hdl_parameters(config),
        device={"configuration": choices},
        roms=lambda folder: write_solver(folder, config),
        **runs,
    )


STRUCTURES = (
    built({"columns": 16}, on=VERILATOR),
    built({"columns": 16, "data_width": 20, "gradient_limit": 4.0}, on=ICARUS),
    built({"columns": 32, "data_width": 12, "coefficient_width": 10}, mutants=BOTH),
    built({"columns": 16, "data_width": 32, "coefficient_width": 24, "depth_range_px": 9.5}),
)
PROTOCOL = {"protocol_words": {"Rows": "value(Config, RowsField)"}}
MUTANTS = Mutants(flat=False)
NO_PROOF = "a chain of proven cores, each of which takes what the one before it sends; no control of its own"


__all__ = ["a_frame_begins_afresh", "frames_that_fit", "frames_that_saturate", "many_frames", "reset_in_mid_frame"]


@cocotb.test
@parametrize((("gap", "pause"), [(0.0, 0.0), (0.3, 0.3)]))
async def frames_that_fit(dut: Any, gap: float, pause: float) -> None:
    await check(dut, codes(3, 0.002), gap=gap, pause=pause)


@cocotb.test
async def frames_that_saturate(dut: Any) -> None:
    f = codes(3, 1.0)
    f[1], f[2] = f.max(), f.min()
    assert await check(dut, f, gap=0.1), "full scale everywhere must clip somewhere"


@cocotb.test
@parametrize(amplitude=[0.002, 1.0])
async def reset_in_mid_frame(dut: Any, amplitude: float) -> None:
    """Reset as the third frame enters and the first one leaves: every core is active, and clips if it can."""
    size = configuration().columns
    first = 2 * size * size + 10 * size + size // 2
    await check(dut, codes(1, amplitude), interrupts=[first, first + size // 3])
