# SPDX-License-Identifier: Apache-2.0
"""The pipeline of a sensor on its grid, in the codes of the hardware and in double precision; rows from the top."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from tactile_depth.base.errors import Argument, InputError
from tactile_depth.chip.common.td_round_saturate import Monitor
from tactile_depth.chip.configuration import Configuration, ExactConfiguration
from tactile_depth.chip.depth.zero_capture import captured_zero
from tactile_depth.chip.depth.zero_offset import exact_zero
from tactile_depth.chip.gradient.flat_field import pixel_gains, reference_gains
from tactile_depth.chip.gradient.light_gains import Light, LightFilter
from tactile_depth.chip.poisson.cores import NUMPY, Cores
from tactile_depth.chip.poisson.divergence import divergence
from tactile_depth.chip.tactile_depth import Tables, light_of, slope_tables, slopes_and_light, solve, zeroed
from tactile_depth.depth import reference
from tactile_depth.sensor.sensor import Sensor

PICTURES = Argument("pictures")
PIXELS_AT_ONCE = 1 << 16  # pixels of a batch of frames, whose arrays stay in a cache


@dataclass(frozen=True, eq=False)
class Twin:
    """Both arithmetics of a pipeline.

    Attributes
    ----------
    sensor, config
        The sensor on the grid of the configuration.
    no_contact : uint8 array (2**k, rows, columns, 3), or None
        Frames from which the zero offset is captured.
    cores : Cores
        Models that take the most time, in numpy or compiled.
    rest : array (rows, columns, 3), or None
        Colours of any type that double precision takes in place of the sensor's reference.
    """

    sensor: Sensor
    config: Configuration
    no_contact: np.ndarray | None = None
    cores: Cores = NUMPY
    rest: np.ndarray | None = None

    @cached_property
    def tables(self) -> Tables:
        """Tables of the chip; without slopes where the configuration is for double precision alone."""
        if not isinstance(self.config, ExactConfiguration):
            return slope_tables(self.sensor, self.config)
        gains = reference_gains(self.sensor, self.config) if self.config.flat_field else None
        return Tables(None if gains is None else pixel_gains(gains, self.config), np.empty(0, np.int64))

    @cached_property
    def exact_tables(self) -> reference.Tables:
        """Tables of double precision."""
        return reference.slope_tables(self.sensor, self.config, self.rest)

    @cached_property
    def zero(self) -> np.ndarray | None:
        """Zero offset that a capture of `no_contact` measures, codes (node rows, node columns)."""
        return None if self.no_contact is None else self.captured_zero(self.no_contact)

    def captured_zero(self, no_contact: np.ndarray) -> np.ndarray:
        """Return the zero offset that a capture of frames measures, codes (node rows, node columns)."""
        return captured_zero(self.chip(no_contact)[1], self.config)

    def upright(self, depth: np.ndarray) -> np.ndarray:
        """Convert between the row orders of stream and picture; the tridiagonal solver starts at the bottom row."""
        return depth[..., ::-1, :] if self.config.solver == "tridiagonal" else depth

    def dark(self, frames: np.ndarray) -> np.ndarray:
        """Return the pixels where the reference is too dark, bool (frames, rows, columns)."""
        gains = self.tables.gains
        return np.zeros(frames.shape[:-1], bool) if gains is None else gains.dark(frames)

    def light(self, frames: np.ndarray, stream: LightFilter | None = None) -> np.ndarray | None:
        """Return the light gains of single pictures, or of a stream (frames, 3); None without them."""
        return light_of(frames, self.tables, self.config, stream, self.cores)

    def light_of_stream(self, frames: np.ndarray, repeat: int = 1) -> np.ndarray | None:
        """Return the light gains of frames that are streamed `repeat` times, int64 (repeat, frames, 3).

        The stream begins with the gains of its first picture, which the registers get, and goes on by the filter.
        """
        if not self.config.light_gains:
            return None
        stream = LightFilter(Light.of(self.config), self.light(frames[0]))
        return np.array([self.light(frames, stream) for _ in range(repeat)])

    def chip(
        self, frames: np.ndarray, monitor: Monitor | None = None, light: np.ndarray | LightFilter | None = None
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray | None]:
        """Compute as the RTL does, bit for bit.

        Parameters
        ----------
        light : int64 array (frames, 3) or LightFilter
            Light gains, or the filter of a stream; by default each picture has its own.

        Returns
        -------
        Slope codes (frames, rows, columns, 2); depth codes in the order of the stream before the zero offset; light
        gains (frames, 3), or None without them
        """
        step = max(1, PIXELS_AT_ONCE // (self.config.rows * self.config.columns))
        slopes, depths, gains = [], [], []
        for first in range(0, len(frames), step):
            some = slice(first, first + step)
            own = self.cores.settled if light is None else light[some] if isinstance(light, np.ndarray) else light
            codes, lit = slopes_and_light(frames[some], self.config, self.tables, monitor, light=own)
            slopes.append(codes)
            depths.append(solve(divergence(codes, self.config.neumann), self.config, monitor, self.cores))
            gains.append(lit)
        lights = np.concatenate([each for each in gains if each is not None]) if self.config.light_gains else None
        return np.concatenate(slopes), np.concatenate(depths), lights

    def codes(self, frames: np.ndarray, monitor: Monitor | None = None, light: np.ndarray | None = None) -> np.ndarray:
        """Return depth codes, int64 (frames, rows, columns); `light`: gains of each frame, by default its own."""
        return self.upright(zeroed(self.chip(frames, monitor, light)[1], self.config, monitor, self.zero))

    def played(self, frames: np.ndarray, repeat: int = 1) -> tuple[np.ndarray, np.ndarray | None, dict[str, int]]:
        """Return codes of a stream of frames, light gains, and the values clipped by node in all repetitions.

        Codes are (repeat, frames, rows, columns); without light gains every repetition has the same: (1, ..).
        """
        monitor, light = Monitor(), self.light_of_stream(frames, repeat)
        passes = [self.codes(frames, monitor, gains) for gains in ([None] if light is None else light)]
        times = repeat if light is None else 1
        return np.stack(passes), light, {node: times * n for node, n in sorted(monitor.saturations.items())}

    def exact_slopes(self, frames: np.ndarray, light: np.ndarray | None = None) -> np.ndarray:
        """Return slopes in double precision, (frames, rows, columns, 2); `light`: gains, by default 1."""
        return reference.slopes_of(frames, self.sensor, self.config, self.exact_tables, light)

    def solved(self, slopes: np.ndarray) -> np.ndarray:
        """Return the depth of slopes in double precision, in grid pixels, before the zero offset."""
        return reference.solve(divergence(slopes, self.config.neumann), self.config.neumann)

    def exact_px(self, frames: np.ndarray, light: np.ndarray | None = None) -> np.ndarray:
        """Return the depth in double precision, in grid pixels; `light` as of `codes`."""
        depth = self._as_read(frames, light)
        if self.no_contact is None:
            return depth
        at_rest = self._as_read(self.no_contact, None)
        return self.upright(exact_zero(self.upright(depth), self.upright(at_rest), self.config))

    def _as_read(self, frames: np.ndarray, light: np.ndarray | None) -> np.ndarray:
        return self.solved(self.exact_slopes(frames, self.light(frames) if light is None else light))

    def depth_px(self, frames: np.ndarray, monitor: Monitor | None = None) -> np.ndarray:
        """Return the depth of `codes` in grid pixels."""
        return self.codes(frames, monitor) * self.config.depth_lsb_px


def require_flat_field(config: Configuration) -> None:
    """Refuse the capture of a reference that no colour is relative to."""
    if not config.flat_field:
        problem = ": this pipeline takes colours as sent"
        raise InputError(PICTURES, problem, remedy=("make it with ", Argument("reference", "<picture>")))


def require_zero_offset(config: Configuration) -> None:
    """Refuse the capture of a zero offset that is not subtracted."""
    if not config.zero_offset:
        problem = ": this pipeline has no zero offset"
        raise InputError(PICTURES, problem, remedy=("make it with ", Argument("zero_offset", True)))
