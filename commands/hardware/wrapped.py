# SPDX-License-Identifier: Apache-2.0
"""Hardware of a request: the module around its configuration, its tables and its C header, for every command.

`make wrap`, the generator of FuseSoC and `make fpga` begin with the preset `PRESET`. They write what
`Pipeline.hardware` writes for the same words, by the same function.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from commands.common import run_request, wrapper
from commands.common.zero_offset import untouched
from commands.hardware import synthesis
from tactile_depth.base.errors import Argument, InputError, InputWarning, warn
from tactile_depth.chip.camera_configuration import CameraConfiguration
from tactile_depth.chip.hardware_files import write_files
from tactile_depth.depth.make_words import make_words
from tactile_depth.depth.result import settings_of, thresholds_of
from tactile_depth.depth.twin import Twin
from tactile_depth.pictures.frames import REST_SCENE, Frames
from tactile_depth.sensor.presets import AREA_THRESHOLD_MM, THRESHOLD_MM

PRESET = "chip"
CHOICES = (*run_request.CONFIGURING, *run_request.CAMERA)


def check_name(name: str) -> None:
    """Refuse a NAME that no module can have. Raises InputError."""
    if not wrapper.NAME.fullmatch(name):
        raise InputError(f"NAME={name}: {wrapper.NAMES}, as NAME=finger")


@dataclass(frozen=True)
class Written:
    """Modules, the outermost last, and the fields of Config."""

    modules: tuple[Path, ...]
    fields: Mapping[str, int]


def design(request: run_request.Request) -> tuple[Frames, Twin]:
    """Return the frames of a request, and sensor, configuration and zero offset of its hardware. Raises InputError."""
    frames, sensor, config = synthesis.design(request)
    return frames, Twin(sensor, config, untouched(request, frames))


def announce(request: run_request.Request, twin: Twin, camera: CameraConfiguration | None = None) -> None:
    """Print the preset, all words with which any command writes the same hardware, and the part that a camera shows.

    Warns where the reference of a real sensor is not a picture.
    """
    if request.reference in (None, REST_SCENE) and twin.sensor.camera is not None and twin.config.flat_field:
        tables = "reference and zero offset" if twin.config.zero_offset else "reference"
        remedy = f"capture {tables} on the device before its depth means anything"
        warn(InputWarning("no ", Argument("reference"), remedy=remedy))
    run_request.announce(request, twin.config)
    print(f"make words: {make_words(twin.config, twin.sensor.pixel_pitch_mm, sources(request))}", flush=True)
    if camera is not None:
        rows, columns = camera.picture
        shown = f"WINDOW={','.join(map(str, camera.crop))}, {twin.sensor.pixel_pitch_mm:.4f} mm a pixel of the grid"
        print(f"pictures of {columns} x {rows} from the camera, {shown}", flush=True)


def write(
    request: run_request.Request, folder: Path, name: str, tables: str = "./", with_shell: bool = False
) -> Written:
    """Write the module <top>_<name>, its tables, `PARAMETERS` and its C header into a folder.

    It prints what `announce` does. Raises InputError.

    Parameters
    ----------
    tables : folder of the tables for simulator and synthesis, with a / at its end
    """
    frames, twin = design(request)
    thresholds = _thresholds(twin, frames)
    fields = write_files(folder, twin.sensor, twin.config, twin.zero, None, thresholds, frames.camera)
    modules = [wrapper.write(folder, name, fields, tables)]
    if with_shell:
        modules.append(wrapper.write_shell(folder, name, fields, tables))
    announce(request, twin, frames.camera)
    return Written(tuple(modules), fields)


def _thresholds(twin: Twin, frames: Frames) -> dict[str, int]:
    """Return the thresholds of `td.Pipeline` as words of registers; none where its depth range is smaller."""
    config, sensor = twin.config, twin.sensor
    lsb_mm = config.depth_lsb_px * sensor.pixel_pitch_mm
    if THRESHOLD_MM / lsb_mm >= 2 ** (config.data_width - 1):
        return {}
    at_rest = np.zeros((config.rows, config.columns), np.int32)
    if frames.reference is not None:
        at_rest = twin.codes(frames.reference[None])[0]
    pixel_mm2 = sensor.pixel_pitch_mm**2 * sensor.pixel_aspect
    return thresholds_of(settings_of(THRESHOLD_MM, THRESHOLD_MM, AREA_THRESHOLD_MM, lsb_mm, pixel_mm2, at_rest))


def sources(request: run_request.Request) -> dict[str, str]:
    """Return the words of a request that no configuration holds."""
    rows, columns = request.camera_size or (0, 0)
    camera = request.camera
    return {
        "CALIBRATION": request.calibration,
        "CAMERA_SIZE": f"{columns}x{rows}" if rows else "",
        "CROP": request.crop or "",
        "REFERENCE": request.reference or "",
        "ZERO": request.zero or "",
        "CAMERA": camera.pixel_format if camera else "",
        "BAYER": camera.phase if camera else "",
        "WINDOW": ",".join(map(str, camera.window)) if camera and camera.window else "",
    }
