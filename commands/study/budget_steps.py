# SPDX-License-Identifier: Apache-2.0
"""The steps of `make budget`: the depth of a picture, from the codes of the pipeline to the true height."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.fft import dstn, idstn

import tactile_depth as td
from tactile_depth.calibrate.presses import GridPress, GridPresses
from tactile_depth.chip.camera_configuration import CameraChoice
from tactile_depth.chip.depth.zero_offset import exact_zero
from tactile_depth.chip.gradient.light_gains import Light, settled
from tactile_depth.chip.limits import RATIO
from tactile_depth.chip.poisson.divergence import divergence
from tactile_depth.chip.resampling import resampling
from tactile_depth.depth.twin import Twin
from tactile_depth.pictures.grid_sampler import GridSampler, grid_sampler

FRONT = ("quantisation", "pixel format", "camera noise and 8 bits", "light drift", "calibration")
BACK = ("boundary", "discretisation")
BESIDE = "gel beside the contact"
MEASURES = {"contact": "height in the contact", "cap": "height of the cap", "untouched": "untouched gel"}


@dataclass(frozen=True)
class Exact:
    """A pipeline in double precision, for frames of any type; depth in grid pixels, slopes per pixel.

    Attributes
    ----------
    pipeline : Pipeline
    rest : array (rows, columns, 3)
        Frame without contact.
    """

    pipeline: td.Pipeline
    rest: np.ndarray

    @cached_property
    def twin(self) -> Twin:
        return Twin(self.pipeline.sensor, self.pipeline.config, rest=self.rest)

    @cached_property
    def zero(self) -> np.ndarray:
        """The zero offset, rows from the top."""
        depth = self.twin.solved(self.slopes(self.rest))[::-1]
        return -exact_zero(np.zeros_like(depth), depth, self.pipeline.config)[::-1]

    def slopes(self, frame: np.ndarray, follow: bool = True) -> np.ndarray:
        """Return slopes; `follow`: with light gains, as in the hardware."""
        light = None
        if follow:
            ratios = np.rint(frame * self.twin.exact_tables.gains * 2.0**RATIO.fraction).astype(np.int64)
            light = settled(ratios, Light.of(self.pipeline.config))
        return self.twin.exact_slopes(frame, light)

    def depth(self, slopes: np.ndarray) -> np.ndarray:
        return self.twin.solved(slopes) - self.zero


def framed(slopes: np.ndarray, height: np.ndarray) -> np.ndarray:
    """Return the depth of slopes (rows, columns, 2) that has the true height (rows, columns) at the frame's edge.

    The solution inside the outermost pixels, by the sine transform whose points next to the ends are 0.
    """
    steps = np.stack((np.diff(height, axis=1, append=0), np.diff(height, axis=0, append=0)), axis=-1)
    error = divergence(slopes - steps)[1:-1, 1:-1]
    rows, columns = (2 * (np.cos(np.arange(1, n + 1) * np.pi / (n + 1)) - 1) for n in error.shape)
    return height + np.pad(idstn(dstn(error, type=1) / (rows[:, None] + columns), type=1), 1)


@dataclass(frozen=True)
class Camera:
    """The ways from a picture to a frame: as the camera block takes it, of all colours, and without rounding."""

    sampler: GridSampler
    average: Callable[[np.ndarray], np.ndarray]

    @classmethod
    def of(cls, presses: GridPresses, choice: CameraChoice) -> Camera:
        rows, columns, _ = presses.background.shape
        sampler = grid_sampler("background", (rows, columns), presses.grid, choice)
        return cls(sampler, resampling((rows, columns), presses.grid).average)

    def rounded(self, picture: np.ndarray) -> np.ndarray:
        return np.rint(self.average(picture)).astype(np.uint8)


@dataclass(frozen=True)
class Seen:
    """A contact on the grid, heights in grid pixels.

    Attributes
    ----------
    place : str
    picture : uint8 array (camera rows, camera columns, 3)
        With noise, in light that drifted.
    levels, steady : array (camera rows, camera columns, 3)
        Without that noise; and in the light before it drifted.
    slopes : float64 array (rows, columns, 2)
        True slopes.
    known : bool array (rows, columns, 1), or None
        Where the true slopes are known; elsewhere they are assumed. None: everywhere.
    height : float64 array (rows, columns)
        True height, at the positions of a depth map: half a pixel up and to the left (divergence.py).
    contact, untouched : bool array (rows, columns)
    cap : function of a depth map
        Its height of the cap.
    """

    place: str
    picture: np.ndarray
    levels: np.ndarray
    steady: np.ndarray
    slopes: np.ndarray
    known: np.ndarray | None
    height: np.ndarray
    contact: np.ndarray
    untouched: np.ndarray
    cap: Callable[[np.ndarray], float]


def parts_of(seen: Seen, camera: Camera, exact: Sequence[Exact], follow: bool) -> np.ndarray:
    """Return the map of each part of the error in mm, float64 (parts, rows, columns).

    Parameters
    ----------
    exact : of the rest as sent, as rounded colours and as levels
    follow : bool
        Light gains act on the steady light too, because it is not exactly that of the reference.
    """
    levels = exact[-1]
    pipeline, frame = levels.pipeline, camera.sampler.frame(seen.picture)
    depths = [pipeline(frame).depth_mm / pipeline.pixel_pitch_mm]
    frames = frame, camera.rounded(seen.picture), camera.average(seen.levels)
    depths += [each.depth(each.slopes(one)) for each, one in zip(exact, frames, strict=True)]
    calibrated = levels.slopes(camera.average(seen.steady), follow)
    depths.append(levels.depth(calibrated))
    if seen.known is not None:
        depths.append(levels.twin.solved(np.where(seen.known, seen.slopes, calibrated)))
    depths += [levels.twin.solved(seen.slopes), framed(seen.slopes, seen.height), seen.height]
    return -np.diff(depths, axis=0) * pipeline.pixel_pitch_mm


def products(seen: Seen, parts: np.ndarray) -> dict[str, np.ndarray]:
    """Return for each measure the mean products of all pairs of parts, mm^2, float64 (parts, parts)."""
    found = {"cap": np.array([seen.cap(part) for part in parts])[:, None]}
    for name, area in (("contact", seen.contact), ("untouched", seen.untouched)):
        values = parts[:, area]
        found[name] = (values - values.mean(axis=1, keepdims=True)) / np.sqrt(values.shape[1])
    return {name: found[name] @ found[name].T for name in MEASURES}


def height_between(top: np.ndarray, edge: np.ndarray) -> Callable[[np.ndarray], float]:
    """Return the function of the mean height of two areas, bool arrays, one above the other."""
    return lambda depth: float(depth[top].mean() - depth[edge].mean())


def height_of_cap(press: GridPress) -> Callable[[np.ndarray], float]:
    """Return the function of the height of a ball's cap, `GridPress.recovered`, in grid pixels."""
    return lambda depth: press.recovered(depth) * press.cap_height
