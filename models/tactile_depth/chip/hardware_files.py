# SPDX-License-Identifier: Apache-2.0
"""Writes what the hardware of a configuration needs: parameters, $readmemh files, and a C header that loads tables."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from tactile_depth.base.files import new_files
from tactile_depth.chip import c_header
from tactile_depth.chip.calibration import Calibration
from tactile_depth.chip.camera_configuration import CameraConfiguration
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.gradient.frame_marks import slope_limit
from tactile_depth.chip.rom_files import table_files
from tactile_depth.chip.self_test import built_in
from tactile_depth.chip.tactile_depth import config_value, top_parameters, write_roms

PARAMETERS = "parameters.json"


def write_hardware(
    folder: Path,
    sensor: Calibration,
    config: Configuration,
    zero: np.ndarray,
    gains: np.ndarray,
    thresholds: Mapping[str, int],
) -> Path:
    """Write the files of a configuration into a folder, all or none, and return the path of `PARAMETERS` there.

    The arguments are those of `write_files`.
    """
    with new_files(folder, PARAMETERS) as unfinished:
        write_files(unfinished, sensor, config, zero, gains, thresholds)
    return folder / PARAMETERS


def write_files(
    folder: Path,
    sensor: Calibration,
    config: Configuration,
    zero: np.ndarray | None,
    gains: np.ndarray | None,
    thresholds: Mapping[str, int],
    camera: CameraConfiguration | None = None,
) -> dict[str, int]:
    """Write the files of a configuration into an empty folder, and return the fields of Config.

    Parameters
    ----------
    sensor : Calibration
        Calibration on the grid of the configuration.
    zero, gains
        See `tactile_depth.chip.tactile_depth`.
    thresholds : mapping
        Depth code of each register of a threshold, by the name of the register.
    camera : CameraConfiguration, optional
        Camera of the device, if it is a `tactile_sensor`.
    """
    crc = write_roms(folder, sensor, config, zero, gains)
    fields = top_parameters(config, sensor.pixel_pitch_mm, camera, crc)
    description = {
        "parameters": {"Config": config_value(fields)},
        "fields": fields,
        "registers": {**thresholds, "SLOPE_LIMIT": slope_limit(sensor, config)},
        "self_test": built_in(sensor, config, zero, gains),
        "grid": [config.rows, config.columns],
        "depth_lsb_mm": config.depth_lsb_px * sensor.pixel_pitch_mm,
        "pixel_pitch_mm": sensor.pixel_pitch_mm,
        "pixel_aspect": sensor.pixel_aspect,
        "gradient_lsb": config.gradient_lsb,
        "calibration": sensor.name,
        "gradient_model": config.gradient_model,
        "tables": table_files(folder),
        "c_header": c_header.FILE,
    }
    (folder / PARAMETERS).write_text(json.dumps(description, indent=1) + "\n")
    (folder / c_header.FILE).write_text(c_header.c_header(sensor, config, zero, gains, thresholds, camera))
    return fields
