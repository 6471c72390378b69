# SPDX-License-Identifier: Apache-2.0
"""Description of the device: a host converts codes to mm and slopes with registers only."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.registers.axil_port import Response
from tactile_depth.chip.registers.axil_registers import AxilRegisters, Build
from tactile_depth.chip.registers.device_description import (
    MANTISSA_BITS,
    NM_PER_MM,
    depth_lsb_mm,
    gradient_lsb,
    scaled,
)
from tactile_depth.chip.registers.register_map import REGISTERS
from tactile_depth.chip.tactile_depth import top_parameters

CONFIGURATIONS = {
    "default": Configuration(),
    "odd-range": Configuration(columns=64, rows=48, solver="tridiagonal", neumann=True, depth_range_px=17.3, lanes=8),
    "wide": Configuration(
        columns=32, data_width=32, flat_field=True, gradient_model="cubic", zero_offset=True, gain_width=17
    ),
}
RELATIVE_ERROR = 2.0**-MANTISSA_BITS  # largest, of a unit that `scaled` rounds
NAMES = ("DEVICE", "DEPTH_UNIT", "SLOPE_UNIT", "PITCH")


def words(config: Configuration, pitch_mm: float) -> dict[str, int]:
    """Return the words that a host reads from a device."""
    registers = AxilRegisters(Build(top_parameters(config, pitch_mm)))
    answers = {name: registers.read(REGISTERS[name].offset) for name in NAMES}
    assert {response for _, response in answers.values()} == {Response.OKAY}
    return {name: word for name, (word, _) in answers.items()}


@given(st.floats(min_value=2.0**-100, max_value=2.0**100))
def test_a_unit_is_rounded_to_24_bits(value: float) -> None:
    mantissa, exponent = scaled(value)
    assert 1 << MANTISSA_BITS - 1 <= mantissa < 1 << MANTISSA_BITS
    assert abs(math.ldexp(mantissa, exponent) - value) <= RELATIVE_ERROR * value


@pytest.mark.parametrize("config", CONFIGURATIONS.values(), ids=CONFIGURATIONS)
@pytest.mark.parametrize("pitch_mm", [0.0634, 0.1, 0.02734375, 1.5])
def test_mm_and_slopes_of_codes(config: Configuration, pitch_mm: float) -> None:
    """Convert codes to mm and slopes, with the pitch rounded to 1 nm and units rounded to 24 bits."""
    device = words(config, pitch_mm)
    exact = config.depth_lsb_px * pitch_mm
    bound = RELATIVE_ERROR + (1 + RELATIVE_ERROR) * 0.5 / (pitch_mm * NM_PER_MM)
    assert abs(depth_lsb_mm(device) - exact) <= bound * exact
    assert abs(gradient_lsb(device) - config.gradient_lsb) <= RELATIVE_ERROR * config.gradient_lsb


def test_a_threshold_in_mm_is_that_of_the_configuration() -> None:
    config = CONFIGURATIONS["odd-range"]
    device = words(config, 0.0634)
    for depth_mm in np.linspace(0.01, 1.0, 100):
        assert abs(round(depth_mm / depth_lsb_mm(device)) - depth_mm / (config.depth_lsb_px * 0.0634)) <= 1.0


@pytest.mark.parametrize("config", CONFIGURATIONS.values(), ids=CONFIGURATIONS)
def test_the_device_says_what_it_is_built_of(config: Configuration) -> None:
    register = REGISTERS["DEVICE"]
    fields = register.unpack(words(config, 0.0)["DEVICE"])
    assert fields["solver"] == register.field("solver").values[config.solver]
    assert fields["boundary"] == register.field("boundary").values["neumann" if config.neumann else "dirichlet"]
    assert (
        fields["gradient_model"]
        == register.field("gradient_model").values["polynomials" if config.polynomials else "lut"]
    )
    assert (fields["flat_field"], fields["zero_offset"]) == (config.flat_field, config.zero_offset)
    assert fields["lanes"] == config.lanes
    assert fields["gain_width"] == (config.gain_width if config.flat_field else 0)


def test_an_unknown_pitch_reads_0() -> None:
    assert words(Configuration(), 0.0)["PITCH"] == 0
