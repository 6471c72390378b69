# SPDX-License-Identifier: Apache-2.0
"""spectral_solver against its model: the tests of solver_bench."""

from tactile_depth.chip.rom_files import write_solver
from tactile_depth.chip.tactile_depth import hdl_parameters
from tb.flips import no_flips as no_flips
from tb.poisson.solver_bench import a_frame_begins_afresh, frames, full_scale_saturates, many_frames, reset_in_mid_frame
from tb.stream import of_configuration
from tb.structures import ICARUS, VERILATOR, Mutants

built = of_configuration(hdl_parameters, write_solver)
STRUCTURES = (
    built({"columns": 16}, on=VERILATOR),
    built({"columns": 16, "data_width": 20, "gradient_limit": 4.0}, on=ICARUS),
    built({"columns": 16, "data_width": 12, "coefficient_width": 10}, mutants=ICARUS),
    built({"columns": 16, "data_width": 32, "coefficient_width": 24, "depth_range_px": 9.5}),
)
PROTOCOL = {"protocol_words": {"Rows": "value(Config, RowsField)"}}
MUTANTS = Mutants(flat=False)
NO_PROOF = "a chain of proven cores, each of which takes what the one before it sends; no control of its own"


__all__ = ["a_frame_begins_afresh", "frames", "full_scale_saturates", "many_frames", "reset_in_mid_frame"]
