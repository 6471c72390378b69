# SPDX-License-Identifier: Apache-2.0
"""Drawn pictures for users without a sensor."""

from __future__ import annotations

from dataclasses import dataclass, replace

from tactile_depth.base.by_value import ByValue
from tactile_depth.base.errors import Argument, one_of
from tactile_depth.base.npy import Bytes, Floats
from tactile_depth.sensor.scenes import BENCH, Press, render, scene_pixel_pitch_mm
from tactile_depth.sensor.sensor import Camera, Sensor
from tactile_depth.sensor.synthetic import synthetic

CAMERA = Camera(240, 320)


@dataclass(frozen=True, eq=False)
class Sample(ByValue):
    """Pictures of a contact by the synthetic sensor, and the height map that was drawn.

    Attributes
    ----------
    sensor : Sensor
    image, reference : uint8 array (240, 320, 3), RGB
        Pictures with and without contact.
    height_mm : float64 array (240, 320)
        Height above the untouched surface, positive pressed in.
    """

    sensor: Sensor
    image: Bytes
    reference: Bytes
    height_mm: Floats

    def __repr__(self) -> str:
        rows, columns = self.height_mm.shape
        return f"Sample({columns}x{rows}, height up to {self.height_mm.max():.3g} mm)"


def samples() -> tuple[str, ...]:
    """Return the names of the drawn contacts that `sample` takes."""
    return tuple(BENCH)


def sample(name: str = "ball", seed: int = 1) -> Sample:
    """Return a drawn contact.

    Parameters
    ----------
    name : str
        One of `samples()`.
    seed : int
        Seed of the camera's noise.

    Raises
    ------
    InputError
        There is no contact of that name.
    """
    one_of(Argument("name", name), BENCH)
    size = (CAMERA.rows, CAMERA.columns)
    scene, rest = render(name, *size, seed), render("flat", *size, seed + 1, Press(noise=0))
    pitch = scene_pixel_pitch_mm(min(size))
    sensor = replace(
        synthetic(), name="sample", pixel_pitch_mm=pitch, camera=CAMERA, flat_field=True, model="cubic", view=(1.0, 1.0)
    )
    return Sample(sensor, scene.frames[0], rest.frames[0], scene.height[0] * pitch)
