# SPDX-License-Identifier: Apache-2.0
"""The pipeline of a sensor on its grid, in the codes of the hardware and in double precision; rows from the top."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from tactile_depth.chip.common.td_round_saturate import Monitor
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.depth.zero_capture import captured_zero
from tactile_depth.chip.depth.zero_offset import exact_zero
from tactile_depth.chip.gradient.light_gains import Light, LightFilter
from tactile_depth.chip.poisson.cores import NUMPY, Cores
from tactile_depth.chip.poisson.divergence import divergence
from tactile_depth.chip.tactile_depth import Tables, light_of, slope_codes, slope_tables, solve, zeroed
from tactile_depth.depth import reference
from tactile_depth.sensor.sensor import Sensor

PIXELS_AT_ONCE = 1 << 17  # pixels of a batch of frames, whose arrays stay in a cache


@dataclass(frozen=True, eq=False)
class Twin:
    """Both arithmetics of a pipeline.

    Attributes
    ----------
    sensor, config
        The sensor on the grid of the configuration.
    no_contact : uint8 array (2**k, rows, columns, 3), or None
        Frames from which the zero offset is captured.
    """

    sensor: Sensor
    config: Configuration
    no_contact: np.ndarray | None = None
    cores: Cores = NUMPY

    @cached_property
    def tables(self) -> Tables:
        return slope_tables(self.sensor, self.config)

    @cached_property
    def zero(self) -> np.ndarray | None:
        """Zero offset that a capture of `no_contact` measures, codes (node rows, node columns)."""
        if self.no_contact is None:
            return None
        as_read = Twin(self.sensor, replace(self.config, zero_offset=False), cores=self.cores)
        return captured_zero(self.upright(as_read.codes(self.no_contact)), self.config)

    def upright(self, depth: np.ndarray) -> np.ndarray:
        """Convert between the row orders of stream and picture; the tridiagonal solver starts at the bottom row."""
        return depth[..., ::-1, :] if self.config.solver == "tridiagonal" else depth

    def light(self, frames: np.ndarray) -> np.ndarray | None:
        """Return the light gains of single pictures (frames, 3); None without them."""
        return light_of(frames, self.tables, self.config, cores=self.cores)

    def light_of_stream(self, frames: np.ndarray, repeat: int = 1) -> np.ndarray | None:
        """Return the light gains of frames that are streamed `repeat` times, int64 (repeat, frames, 3).

        The stream begins with the gains of its first picture, which the registers get, and goes on by the filter.
        """
        if not self.config.light_gains:
            return None
        stream = LightFilter(Light.of(self.config), self.light(frames[0]))
        return np.array([light_of(frames, self.tables, self.config, stream) for _ in range(repeat)])

    def codes(self, frames: np.ndarray, monitor: Monitor | None = None, light: np.ndarray | None = None) -> np.ndarray:
        """Return depth codes, int64 (frames, rows, columns); `light`: gains of each frame, by default its own."""
        step, parts = max(1, PIXELS_AT_ONCE // (self.config.rows * self.config.columns)), []
        light = self.light(frames) if light is None else light
        for first in range(0, len(frames), step):
            some = slice(first, first + step)
            gains = None if light is None else light[some]
            slopes = slope_codes(frames[some], self.sensor, self.config, monitor, tables=self.tables, light=gains)
            depth = solve(divergence(slopes, self.config.neumann), self.config, monitor, self.cores)
            parts.append(zeroed(depth, self.config, monitor, self.zero))
        return self.upright(np.concatenate(parts))

    def played(self, frames: np.ndarray, repeat: int = 1) -> tuple[np.ndarray, np.ndarray | None, dict[str, int]]:
        """Return codes of a stream of frames, light gains, and the values clipped by node in all repetitions.

        Codes are (repeat, frames, rows, columns); without light gains every repetition has the same: (1, ..).
        """
        monitor, light = Monitor(), self.light_of_stream(frames, repeat)
        passes = [self.codes(frames, monitor, gains) for gains in ([None] if light is None else light)]
        times = repeat if light is None else 1
        return np.stack(passes), light, {node: times * n for node, n in sorted(monitor.saturations.items())}

    def exact_px(self, frames: np.ndarray, light: np.ndarray | None = None) -> np.ndarray:
        """Return the depth in double precision, in grid pixels; `light` as of `codes`."""
        depth = self._exact(frames, self.light(frames) if light is None else light)
        if self.no_contact is None:
            return depth
        at_rest = self._exact(self.no_contact, self.light(self.no_contact))
        return self.upright(exact_zero(self.upright(depth), self.upright(at_rest), self.config))

    def _exact(self, frames: np.ndarray, light: np.ndarray | None) -> np.ndarray:
        return reference.depth_of(frames, self.sensor, self.config, light=light)

    def depth_px(self, frames: np.ndarray, monitor: Monitor | None = None) -> np.ndarray:
        """Return the depth of `codes` in grid pixels."""
        return self.codes(frames, monitor) * self.config.depth_lsb_px
