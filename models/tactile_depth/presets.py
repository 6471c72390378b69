# SPDX-License-Identifier: Apache-2.0
"""Two presets, the choices that a configuration starts from: the published pipeline, and a real sensor."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, cast

from tactile_depth.configuration import Configuration

Solver = Literal["tridiagonal", "spectral"]
Boundary = Literal["neumann", "dirichlet"]
Model = Literal["lut", "quadratic", "cubic"]


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
    """

    solver: Solver
    boundary: Boundary
    model: Model
    calibration: str
    grid: tuple[int, int]
    zero_offset: bool
    light_gains: bool


PUBLISHED = Preset(
    solver=cast(Solver, Configuration.solver),
    boundary="neumann" if Configuration.neumann else "dirichlet",
    model=cast(Model, Configuration.gradient_model),
    calibration="synthetic",
    grid=(Configuration.columns, Configuration.columns),
    zero_offset=Configuration.zero_offset,
    light_gains=Configuration.light_gains,
)
"""The pipeline of the published design: colours as they are sent, and a table of slopes."""
SENSOR = Preset("tridiagonal", "neumann", "cubic", "gelsight-mini", (96, 128), zero_offset=True, light_gains=True)
"""A real sensor: colours relative to a reference and to its light, and the whole picture of a camera of 4:3."""
PRESETS = {"published": PUBLISHED, "sensor": SENSOR}
