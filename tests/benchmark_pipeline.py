# SPDX-License-Identifier: Apache-2.0
"""Time from uint8 pictures of a camera to depth in mm: bit-accurate, in double precision, and bit-accurate in a batch.

Area average to 128 x 128, flat field, light gains, cubic slopes, divergence, tridiagonal solve (Neumann), scale; each
with the models in numpy and with those of the extra `fast`, whose ratio the tables show. Tables are prepared first.
Pictures are a scene of the project. The suite does not collect this file: docs/commands.md.
"""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from tactile_depth.chip.poisson import cores
from tactile_depth.depth.pipeline import Pipeline
from tactile_depth.sensor.scenes import Press, render
from tactile_depth.sensor.sensor import Camera
from tactile_depth.sensor.synthetic import synthetic

CAMERA = (240, 320)  # picture size of a GelSight Mini


@pytest.mark.parametrize("used", ["numpy", "fast"])
@pytest.mark.parametrize(("arithmetic", "pictures"), [("chip", 1), ("float", 1), ("chip", 16)])
def test_picture_to_depth(
    benchmark: Any, monkeypatch: pytest.MonkeyPatch, arithmetic: Any, pictures: int, used: str
) -> None:
    if used == "numpy":
        monkeypatch.setattr("tactile_depth.depth.pipeline.fastest", lambda: cores.NUMPY)
    elif cores.fastest() == cores.NUMPY:
        pytest.skip("numba is missing: pip install .[fast]")
    no_contact = render("flat", *CAMERA, press=Press(noise=0)).frames[0]
    frames = render("bench", *CAMERA).frames
    sensor = replace(synthetic(), camera=Camera(*CAMERA), model="cubic")
    pipeline = Pipeline(sensor, no_contact, grid=(128, 128), zero_offset=False, arithmetic=arithmetic)
    benchmark.group = f"{arithmetic}, {pictures} picture{'s' * (pictures > 1)}"
    result = benchmark(pipeline, frames[np.arange(pictures) % len(frames)])
    benchmark.extra_info["pictures"] = pictures
    assert result.depth_mm.shape == (pictures, 128, 128)
