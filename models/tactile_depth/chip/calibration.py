# SPDX-License-Identifier: Apache-2.0
"""Calibration as the chip takes it, so that no model of hardware depends on how a sensor is calibrated."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    import numpy as np

    from tactile_depth.chip.configuration import Configuration


class Calibration(Protocol):
    """Part of a `tactile_depth.sensor.sensor.Sensor`, described there, that models, tables and headers take."""

    @property
    def name(self) -> str: ...
    @property
    def pixel_pitch_mm(self) -> float: ...
    @property
    def pixel_aspect(self) -> float: ...
    @property
    def reference(self) -> np.ndarray | None: ...
    @property
    def table(self) -> np.ndarray: ...
    @property
    def corrections(self) -> np.ndarray | None: ...
    def grid_coefficients(self, config: Configuration) -> np.ndarray: ...
    def steepest(self, config: Configuration) -> float: ...
    def check(self, config: Configuration, gains_given: bool = False) -> None: ...
