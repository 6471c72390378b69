# SPDX-License-Identifier: Apache-2.0
"""spectral_divide against its model: whole frames, which reach all positions; gaps, pauses, extremes, reset."""

from typing import Any

from formal.entries import ROUNDING, Proof
from formal.tables import divide_rom
from tactile_depth.chip.common.td_round_saturate import Monitor
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.poisson.spectral_divide import LATENCY, reciprocals, spectral_divide
from tactile_depth.chip.rom_files import write_solver
from tb.poisson.burst_core import BurstCore
from tb.stream import configuration, of_configuration
from tb.structures import ICARUS, VERILATOR


def core_parameters(config: Configuration) -> Any:
    table = reciprocals(config)
    widths = {"Width": config.arithmetic_width, "CoeffWidth": config.coefficient_width}
    return widths | {"Columns": config.columns, "ShiftWidth": table.shift_width, "Drop": table.drop}


built = of_configuration(core_parameters, write_solver)


STRUCTURES = (
    built({"columns": 16}, on=VERILATOR),
    # Here the largest reciprocals exceed 2^(CoeffWidth - 1): they shift further than Drop drops.
    built({"columns": 16, "coefficient_width": 10, "depth_range_px": 0.1, "gradient_limit": 4.0}, on=ICARUS),
    built({"columns": 16, "data_width": 12, "coefficient_width": 10}, mutants=ICARUS),
    built({"columns": 16, "data_width": 32, "coefficient_width": 24, "depth_range_px": 40.0}),
)
PROTOCOL = {"protocol_beats": {"Beats": "Columns", "Rows": "Columns"}}
PROOFS = tuple(
    Proof(f"one recurrence for every size; {ROUNDING}", {"Columns": size}, roms=divide_rom(size)) for size in (4, 8)
)


def model(dut: Any, x: Any, monitor: Monitor) -> Any:
    config = configuration()
    return spectral_divide(x.reshape(-1, config.columns, config.columns), config, monitor).reshape(x.shape)


CORE = BurstCore(model, lambda dut: LATENCY, fields=("data",), frame=lambda dut: configuration().columns)
bursts, many_bursts, limits, reset_in_mid_burst, a_frame_begins_afresh = CORE.tests()
