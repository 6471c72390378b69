# SPDX-License-Identifier: Apache-2.0
"""Depth in millimetres from visuotactile fingertips, bit for bit as the hardware of this repository computes it.

    import tactile_depth as td

    pipeline = td.Pipeline(td.load("gelsight-mini"), reference="background.png")
    result = pipeline("press.png")
    result.height_mm, result.contact.touching

`sample()` returns drawn pictures for users without a sensor. The models of the cores are in `tactile_depth.chip`, in a
subpackage for each folder of hdl/; a wheel leaves out those that nothing public imports.
"""

from __future__ import annotations

import importlib

from tactile_depth.base.moved import refuse_old_paths

TYPE_CHECKING = False  # true for type checkers; typing takes half of the time of this import
if TYPE_CHECKING:
    from typing import Any

    __version__: str
    from tactile_depth.base.errors import InputError, InputWarning
    from tactile_depth.calibrate.ball_press import BallPress
    from tactile_depth.calibrate.evaluation import Evaluation, evaluate
    from tactile_depth.calibrate.fitting import fit
    from tactile_depth.depth.pipeline import Pipeline
    from tactile_depth.depth.result import Contact, Result
    from tactile_depth.device.device import Device
    from tactile_depth.device.errors import DeviceError
    from tactile_depth.device.frame import DeviceFrame
    from tactile_depth.pictures.identify import identify
    from tactile_depth.sensor.built_in import calibrations, load
    from tactile_depth.sensor.samples import Sample, sample, samples
    from tactile_depth.sensor.sensor import Camera, HeightError, Sensor

__all__ = [
    "BallPress",
    "Camera",
    "Contact",
    "Device",
    "DeviceError",
    "DeviceFrame",
    "Evaluation",
    "HeightError",
    "InputError",
    "InputWarning",
    "Pipeline",
    "Result",
    "Sample",
    "Sensor",
    "calibrations",
    "evaluate",
    "fit",
    "identify",
    "load",
    "sample",
    "samples",
]

_MODULES = {
    "calibrate.ball_press": ("BallPress",),
    "pictures.identify": ("identify",),
    "sensor.built_in": ("calibrations", "load"),
    "device.device": ("Device",),
    "device.errors": ("DeviceError",),
    "device.frame": ("DeviceFrame",),
    "base.errors": ("InputError", "InputWarning"),
    "calibrate.evaluation": ("Evaluation", "evaluate"),
    "calibrate.fitting": ("fit",),
    "depth.pipeline": ("Pipeline",),
    "depth.result": ("Contact", "Result"),
    "sensor.samples": ("Sample", "sample", "samples"),
    "sensor.sensor": ("Camera", "HeightError", "Sensor"),
}
_PLACES = {name: module for module, names in _MODULES.items() for name in names}

refuse_old_paths()


def __getattr__(name: str) -> Any:
    """Import a public name on first use, so that a testbench that needs one model does not wait for the others."""
    if name == "__version__":
        return importlib.import_module("importlib.metadata").version("tactile-depth")
    if name not in _PLACES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(importlib.import_module(f"{__name__}.{_PLACES[name]}"), name)


def __dir__() -> list[str]:
    return [*__all__, "__version__"]
