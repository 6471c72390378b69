# SPDX-License-Identifier: Apache-2.0
"""wide_elimination against its model: the tests that it shares with the other eliminations."""

from typing import Any

from formal.entries import ROUNDING, Proof
from formal.tables import thomas_roms
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.poisson.wide_solver import solver_parameters
from tactile_depth.chip.rom_files import write_wide_thomas
from tb.poisson.elimination_bench import (
    a_frame_begins_afresh,
    frames,
    many_frames,
    reset_as_the_mean_is_clipped,
    reset_in_mid_frame,
)
from tb.structures import ICARUS, VERILATOR, Structure

NAMES = ["Width", "CoeffWidth", "Rows", "Columns", "StoreDrop", "Neumann"]
NAMES += ["LastShiftWidth", "MomentDrop", "MeanReciprocal", "MeanDrop"]
CHOICES = {"columns": 16, "rows": 8, "solver": "tridiagonal", "lanes": 4}


def built(choices: Any, **runs: Any) -> Structure:
    config = Configuration(**choices)
    parameters = solver_parameters(config)
    return Structure(
        {name: parameters[name] for name in NAMES}
        | {"OutWidth": config.data_width, "Words": config.down_words}
        | {"TableWords": parameters["DownTableWords"], "SettledWidth": parameters["DownSettledWidth"]},
        device={"configuration": choices},
        roms=lambda folder: write_wide_thomas(folder, config),
        **runs,
    )


STRUCTURES = (
    built(CHOICES | {"neumann": True}, on=VERILATOR),
    built(CHOICES | {"rows": 9}, on=ICARUS),
    # Few bits are dropped: ties are common.
    built(
        CHOICES | {"neumann": True, "data_width": 12, "coefficient_width": 10, "lanes": 4}, mutants=ICARUS, on=ICARUS
    ),
    built(CHOICES | {"columns": 32, "data_width": 12, "coefficient_width": 10, "lanes": 16}, mutants=ICARUS),
    built(CHOICES | {"rows": 21, "neumann": True, "data_width": 32, "coefficient_width": 24}),
)
PROOFS = tuple(
    Proof(
        f"the smallest burst that holds the loop of the recursion; each of two words; {ROUNDING}",
        {"Rows": 3, "Columns": 16, "Words": 2, "Word": word, "Neumann": neumann, "TableWords": 16},
        steps=2,
        roms=thomas_roms(3, 8, 16, 6, 2, 2, "wide_down"),
    )
    for word, neumann in ((0, 1), (1, 0))
)


__all__ = ["a_frame_begins_afresh", "frames", "many_frames", "reset_as_the_mean_is_clipped", "reset_in_mid_frame"]
