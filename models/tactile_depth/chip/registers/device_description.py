# SPDX-License-Identifier: Apache-2.0
"""The registers that describe a device: their HDL parameters, and the units that a host computes from them."""

from __future__ import annotations

import math
from collections.abc import Mapping

from tactile_depth.chip.common.signature import signature
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.registers.register_map import REGISTERS

DEPTH_UNIT = REGISTERS["DEPTH_UNIT"]  # SLOPE_UNIT has the same fields
MANTISSA_BITS = DEPTH_UNIT.field("mantissa").width
NM_PER_MM = 1_000_000

BESIDE_ARITHMETIC = (
    *("Lanes", "RowInverseIn", "RowInverseOut", "WordsPerRow", "DownWords", "DownTableWords", "UpTableWords"),
    *("DownSettledWidth", "UpSettledWidth", "FrameLatency", "StoreStyle", "CaptureLog2", "PitchNm", "TablesCrc"),
    *("Parity", "ResidualBound", "CheckDropped", "CheckInDropped", "CheckScale", "CheckScaleFraction", "CheckSumWidth"),
)
"""Fields of Config that depth does not depend on, or that follow from the others, beside those of the camera."""


def is_arithmetic(name: str) -> bool:
    """Return True if the register ARITHMETIC holds the field of Config."""
    return name not in BESIDE_ARITHMETIC and not name.startswith("Camera")


def arithmetic_word(parameters: Mapping[str, int]) -> int:
    """Return the word of the register ARITHMETIC from all fields of Config, in their order."""
    return signature(number for name, number in parameters.items() if is_arithmetic(name))


def scaled(value: float) -> tuple[int, int]:
    """Return mantissa and exponent of a positive number, mantissa * 2**exponent, with a mantissa of `MANTISSA_BITS`."""
    exponent = math.frexp(value)[1] - MANTISSA_BITS
    mantissa = round(math.ldexp(value, -exponent))
    return (mantissa >> 1, exponent + 1) if mantissa >> MANTISSA_BITS else (mantissa, exponent)


def description_parameters(config: Configuration, pixel_pitch_mm: float) -> dict[str, int]:
    """Return the parameters of hdl/tactile_depth.sv that only describe it; a pitch of 0: unknown."""
    depth, slope = scaled(config.depth_lsb_px), scaled(config.gradient_lsb)
    return {
        "DepthMantissa": depth[0],
        "DepthExponent": depth[1],
        "SlopeMantissa": slope[0],
        "SlopeExponent": slope[1],
        "PitchNm": round(pixel_pitch_mm * NM_PER_MM),
    }


def _unit(word: int) -> float:
    """Return the number that a word of DEPTH_UNIT or SLOPE_UNIT holds."""
    fields = DEPTH_UNIT.unpack(word)
    exponent = DEPTH_UNIT.field("exponent")
    negative = fields["exponent"] >> (exponent.width - 1) << exponent.width
    return math.ldexp(fields["mantissa"], fields["exponent"] - negative)


def depth_lsb_mm(words: Mapping[str, int]) -> float:
    """Return the depth of code 1 in mm, from the words of DEPTH_UNIT and PITCH; 0 if the pitch is unknown."""
    return _unit(words["DEPTH_UNIT"]) * words["PITCH"] / NM_PER_MM


def gradient_lsb(words: Mapping[str, int]) -> float:
    """Return the slope of code 1 from the word of SLOPE_UNIT."""
    return _unit(words["SLOPE_UNIT"])
