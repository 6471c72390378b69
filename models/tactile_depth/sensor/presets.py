# SPDX-License-Identifier: Apache-2.0
"""Presets, the choices that a configuration starts from: the published pipeline, a real sensor, and its chip."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import cast

from tactile_depth.chip.configuration import COEFFICIENT, GAIN, STORED, Configuration
from tactile_depth.chip.limits import Boundary, Model, Solver


@dataclass(frozen=True)
class Preset:
    """Choices for everything that is not named.

    Attributes
    ----------
    solver, boundary, model, calibration : str
    grid : (rows, columns)
    zero_offset : bool
        Colours are relative to a reference, and the depth without contact is subtracted.
    light_gains : bool
        A gain for each colour follows the light.
    parity : bool
        A parity bit in each word of the memories.
    self_check : bool
        The depth of each frame is put into the equation.
    words : dict
        Numbers and depth range, as arguments of `td.Pipeline`; by default those of `td.Pipeline`.
    """

    solver: Solver
    boundary: Boundary
    model: Model
    calibration: str
    grid: tuple[int, int]
    zero_offset: bool
    light_gains: bool
    parity: bool = False
    self_check: bool = False
    words: dict[str, float] = field(default_factory=dict)


PUBLISHED = Preset(
    solver=cast(Solver, Configuration.solver),
    boundary=Configuration().boundary,
    model="lut",
    calibration="synthetic",
    grid=(Configuration.columns, Configuration.columns),
    zero_offset=Configuration.zero_offset,
    light_gains=Configuration.light_gains,
)
"""The pipeline of the published design: colours as they are sent, and a table of slopes."""
SENSOR = Preset("tridiagonal", "neumann", "cubic", "gelsight-mini", (96, 128), zero_offset=True, light_gains=True)
"""A real sensor: colours relative to a reference and to its light, and the whole picture of a camera of 4:3."""
CHIP = replace(
    SENSOR, parity=True, self_check=True, words={STORED: 15, COEFFICIENT: 10, GAIN: 16, "depth_range_mm": 2.0}
)
"""A real sensor with the shortest words that add a tenth to the error of its calibration, as `make tune TOLERANCE=auto
TARGET=ecp5` chose them for 2 mm on 45 presses of a GelSight Mini."""
THRESHOLD_MM, AREA_THRESHOLD_MM = 0.07, 0.3  # of a contact
PRESETS = {"published": PUBLISHED, "sensor": SENSOR, "chip": CHIP}
