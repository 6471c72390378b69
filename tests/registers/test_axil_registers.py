# SPDX-License-Identifier: Apache-2.0
"""axil_registers: RTL against the model."""

from collections.abc import Callable
from typing import Any

from formal.entries import FULL_WIDTH, Proof
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.tactile_depth import config_value, default_parameters, top_parameters
from tb.structures import BOTH, ICARUS, QUICK_FIRST, VERILATOR, Mutants, Structure


def fields_of(**choices: Any) -> dict[str, int]:
    """Return the fields of a configuration."""
    return top_parameters(Configuration(**choices), 0.0634)


EXTREMES = default_parameters() | {
    "Tridiagonal": 1,
    "Neumann": 1,
    "Rows": 65535,
    "Columns": 1,
    "DataWidth": 32,
    "GradientWidth": 32,
    "GradientFraction": 31,
    "BitsPerChannel": 1,
    "FlatField": 1,
    "Polynomial": 0,
    "LightGains": 1,
    "ZeroOffset": 1,
    "Lanes": 32,
    "BlockLog2": 0,
    "GainWidth": 32,
    "DepthMantissa": (1 << 24) - 1,
    "DepthExponent": -128,
    "SlopeMantissa": 1 << 23,
    "SlopeExponent": 127,
    "PitchNm": (1 << 31) - 1,
}
QUADRATIC = fields_of(columns=128, rows=96, solver="tridiagonal", flat_field=True, gradient_model="quadratic")


def built(name: str, fields: dict[str, int], **runs: Any) -> Structure:
    return Structure({"Config": config_value(fields)}, name=name, **runs)


STRUCTURES = (
    built("128", fields_of(columns=128), on=VERILATOR),
    built("extremes", EXTREMES, on=ICARUS, late=VERILATOR, mutants=True),
    built("quadratic", QUADRATIC, late=BOTH),
)
MUTANTS = Mutants(simulators=QUICK_FIRST, flat=False)
REFUSED = {
    "Rows=0": "Rows_does_not_fit_GRID",
    "Rows=65536": "Rows_does_not_fit_GRID",
    "Columns=0": "Columns_does_not_fit_GRID",
    "Columns=65536": "Columns_does_not_fit_GRID",
    "GradientWidth=1": "GradientWidth_must_be_2_to_32",
    "GradientWidth=33": "GradientWidth_must_be_2_to_32",
    "BitsPerChannel=0": "BitsPerChannel_must_be_1_to_8",
    "BitsPerChannel=9": "BitsPerChannel_must_be_1_to_8",
    "GradientFraction=256": "GradientFraction_does_not_fit_FORMAT",
    "DepthMantissa=16777216": "a_mantissa_does_not_fit_24_bits",
    "SlopeMantissa=-1": "a_mantissa_does_not_fit_24_bits",
    "DepthExponent=-129": "an_exponent_does_not_fit_8_bits",
    "SlopeExponent=128": "an_exponent_does_not_fit_8_bits",
    "PitchNm=-1": "PitchNm_must_not_be_negative",
}
PROOFS = tuple(
    Proof(
        "AXI4-Lite rules; every register reads, counts, sticks and clears as docs/generated/registers.md says",
        f"{FULL_WIDTH}; each gradient model, with a camera or without, all options",
        {"Polynomial": polynomial, "Corrections": corrections, "Camera": camera},
        depth=16,
    )
    for polynomial, corrections, camera in ((0, 0, 0), (1, 0, 1), (1, 1, 0))
)


def test_axil_registers(run_tb: Callable[..., None], structure: Structure) -> None:
    run_tb(structure)
