# SPDX-License-Identifier: Apache-2.0
"""tridiagonal_solver against its model: the tests of solver_bench."""

from typing import Any

from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.resources import ULTRA
from tactile_depth.chip.rom_files import write_solver
from tactile_depth.chip.tactile_depth import config_value, top_parameters
from tb.flips import no_flips as no_flips
from tb.poisson.solver_bench import (
    a_frame_begins_afresh,
    frames,
    full_scale_saturates,
    many_frames,
    reset_in_mid_frame,
)
from tb.structures import BOTH, ICARUS, VERILATOR, Mutants, Structure

CHOICES: dict[str, Any] = {"columns": 16, "rows": 8, "solver": "tridiagonal"}
PACKED = {"WordsPerRow": 3, "StoreStyle": ULTRA}  # as a large grid has them, models/tactile_depth/chip/configuration.py


def built(choices: Any, store: Any = {}, **runs: Any) -> Structure:  # noqa: B006
    config = Configuration(**choices)
    return Structure(
        {"Config": config_value(top_parameters(config) | store)},
        device={"configuration": choices},
        roms=lambda folder: write_solver(folder, config),
        **runs,
    )


STRUCTURES = (
    built(CHOICES, on=VERILATOR),
    built(CHOICES | {"rows": 21, "neumann": True}, on=ICARUS),
    built(
        CHOICES | {"lanes": 2, "rows": 9, "neumann": True, "data_width": 12, "coefficient_width": 10},
        on=ICARUS,
        mutants=BOTH,
    ),
    built(CHOICES | {"columns": 32, "rows": 11, "lanes": 8}, on=VERILATOR),
    built(CHOICES | {"lanes": 8, "rows": 9, "neumann": True}, on=ICARUS),
    built(CHOICES | {"columns": 32, "rows": 11}, PACKED, on=ICARUS),
    built(CHOICES | {"lanes": 4, "rows": 9, "data_width": 12, "coefficient_width": 10}, mutants=BOTH),
    built(CHOICES | {"data_width": 32, "coefficient_width": 24, "neumann": True, "depth_range_px": 5.3}),
    built(CHOICES | {"columns": 64, "rows": 8, "lanes": 32}),
    built(CHOICES | {"columns": 32, "rows": 8, "lanes": 16, "data_width": 32, "coefficient_width": 24}),
    built(CHOICES | {"columns": 64, "rows": 96, "lanes": 16, "neumann": True}),
    built(CHOICES | {"columns": 32, "rows": 8, "lanes": 2}, PACKED),
    built(CHOICES | {"columns": 128, "rows": 13, "lanes": 64}),
)
PROTOCOL = "protocol_words"
MUTANTS = Mutants(flat=False)
NO_PROOF = "a chain of proven cores, each of which takes what the one before it sends; no control of its own"


__all__ = [
    "a_frame_begins_afresh",
    "frames",
    "full_scale_saturates",
    "many_frames",
    "reset_in_mid_frame",
]
