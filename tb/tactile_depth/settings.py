# SPDX-License-Identifier: Apache-2.0
"""Builds, mutants, refusals and proofs of tactile_depth, whose testbench is this folder."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

from formal.entries import Cone
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.tactile_depth import config_value, top_parameters, write_roms
from tactile_depth.sensor.synthetic import synthetic
from tb.axil import CLIENT
from tb.structures import BOTH, ICARUS, VERILATOR, Mutants, Structure

WHOLE = ""  # every test of the run
FORMATS = "formats"  # tests that depend on formats and options of a build
TRIDIAGONAL: dict[str, Any] = {"columns": 16, "rows": 8, "solver": "tridiagonal"}
FLAT_QUADRATIC: dict[str, Any] = {"flat_field": True, "gradient_model": "quadratic"}
SENSOR = TRIDIAGONAL | FLAT_QUADRATIC | {"rows": 9, "lanes": 4, "neumann": True, "zero_offset": True}
SENSOR |= {"light_gains": True, "parity": True}


def built(
    name: str, choices: dict[str, Any], level: str, replaced: Mapping[str, int] = MappingProxyType({}), **runs: Any
) -> Structure:
    """Return the pipeline of a configuration, with some parameters in place of its own, and the last level of tests.

    The tests of a level come in any order: no test depends on an earlier one.
    """
    config = Configuration(**choices)
    return Structure(
        {"Config": config_value({**top_parameters(config), **replaced})},
        device={"configuration": choices, "parameters": dict(replaced), "level": level},
        roms=lambda folder: write_roms(folder, synthetic(config.bits_per_channel), config),
        name=name,
        **runs,
    )


SMALLEST = built("tridiagonal-8x16", TRIDIAGONAL | {"bits_per_channel": 2}, WHOLE, on=VERILATOR, mutants=VERILATOR)
STRUCTURES = (
    built(
        "tridiagonal-8x32-quadratic",
        TRIDIAGONAL | FLAT_QUADRATIC | {"columns": 32, "gain_width": 17, "parity": True, "self_check": True},
        FORMATS,
        on=VERILATOR,
    ),
    SMALLEST,
    built("16-24", {"columns": 16, "bits_per_channel": 2}, WHOLE, on=VERILATOR),
    built("tridiagonal-9x16-4-lanes-sensor", SENSOR, FORMATS, on=BOTH),
    built(
        "tridiagonal-8x16-zero",
        TRIDIAGONAL | {"bits_per_channel": 2, "neumann": True, "zero_offset": True, "parity": True},
        FORMATS,
        on=ICARUS,
    ),
    built("32-12", {"columns": 32, "data_width": 12, "bits_per_channel": 3, "self_check": True}, "stream"),
    built(
        "16-flat-neumann",
        {"columns": 16, "flat_field": True, "neumann": True, "zero_offset": True, "parity": True},
        FORMATS,
    ),
    built("16-27-neumann", {"columns": 16, "data_width": 27, "neumann": True}, FORMATS),
    built("tridiagonal-21x16-neumann", TRIDIAGONAL | {"rows": 21, "data_width": 27, "neumann": True}, FORMATS),
    built("tridiagonal-8x16-2-lanes", TRIDIAGONAL | {"lanes": 2, "bits_per_channel": 2, "neumann": True}, FORMATS),
    built(
        "tridiagonal-9x32-4-lanes",
        TRIDIAGONAL | {"columns": 32, "rows": 9, "lanes": 4, "bits_per_channel": 2, "self_check": True, "parity": True},
        FORMATS,
    ),
    built(
        "tridiagonal-21x16-2-lanes-zero",
        TRIDIAGONAL | {"rows": 21, "lanes": 2, "bits_per_channel": 2, "zero_offset": True},
        FORMATS,
    ),
    built("tridiagonal-9x32-8-lanes-cubic", SENSOR | {"columns": 32, "lanes": 8, "gradient_model": "cubic"}, FORMATS),
)
PROTOCOL = CLIENT | {
    "axis_source": {
        "valid": "s_axis_tvalid",
        "ready": "s_axis_tready",
        "word": "{s_axis_tuser, s_axis_tlast, s_axis_tdata}",
    },
    "counts": "live",
    "m_axis_tdata m_axis_tlast m_axis_tuser": "live & m_axis_tvalid",
    "contact m_event_tvalid": "live & ~reset",
    "m_event_tdata m_event_tlast": "live & ~reset & m_event_tvalid",
}
MUTANTS = Mutants(flat=False)
PROOFS = tuple(
    Cone(
        "a structural fact, the same generate blocks at every grid; narrow words, since no bit is left out",
        {"solver": solver, "rows": rows, "columns": 16, "neumann": neumann, "data_width": 12, "coefficient_width": 10}
        | colours,
    )
    for solver, rows in (("spectral", 16), ("tridiagonal", 8))
    for neumann, colours in (
        (0, {}),
        (1, {}),
        (1, {"flat_field": 1, "zero_offset": 1}),
        (0, {"flat_field": 1, "gradient_model": "quadratic"}),
        (1, {"flat_field": 1, "gradient_model": "cubic"}),
    )
)
