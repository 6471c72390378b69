# SPDX-License-Identifier: Apache-2.0
"""dst_inverse against its model: the tests that both sine transforms share."""

from typing import Any

from formal.entries import Proof
from formal.tables import transform_roms
from tactile_depth.chip.poisson.transform.dst_inverse import latency as dst_inverse_latency
from tactile_depth.chip.rom_files import write_direction
from tb.poisson.transform.dst_bench import bursts, limits, many_bursts, reset_in_mid_burst, transform_parameters
from tb.structures import ICARUS, VERILATOR, Mutants, Structure


def built(parameters: dict[str, int], **runs: Any) -> Structure:
    size, coeff = parameters["Size"], parameters["CoeffWidth"]
    return Structure(parameters, roms=lambda folder: write_direction(folder, size, 0, True, coeff), **runs)


STRUCTURES = (
    built(transform_parameters(32, 24, -3, 27, 18, -1, 24, 1), on=VERILATOR),
    built(transform_parameters(16, 27, 0, 27, 18, 1, 24, 1), on=ICARUS),
    built(transform_parameters(8, 12, -3, 15, 10, -1, 12, 1), on=ICARUS),
    built(transform_parameters(16, 15, 0, 15, 10, 2, 9, 1)),  # the output alone can clip
    built(transform_parameters(16, 27, 0, 27, 18, 1, 24, 0)),
    built(transform_parameters(32, 6, -5, 9, 7, -1, 6, 1), mutants=ICARUS),  # eight values can clip at once
    built(transform_parameters(64, 35, 0, 35, 24, -1, 32, 1)),
)
PROTOCOL = {"protocol_bursts": {"Columns": "Size"}}
MUTANTS = Mutants(flat=False)
PROOFS = (
    Proof(
        "the smallest transform, every core of a longer one is in it",
        {"Size": 8, "Latency": dst_inverse_latency(8)},
        roms=transform_roms,
    ),
)


__all__ = ["bursts", "limits", "many_bursts", "reset_in_mid_burst"]
