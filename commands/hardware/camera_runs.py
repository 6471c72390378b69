# SPDX-License-Identifier: Apache-2.0
"""`python -m commands.hardware.camera_runs raw8 yuyv ..`: measure the camera front end by pixel format, on each device.

Maps camera_unit as `make synth` does, for a picture of 640 x 480 pixels on a grid of 96 x 128, and adds the counts to
commands/cost/cameras.json, which the table in docs/hardware.md shows.
"""

import json
import sys

from commands.cost.cost import CAMERAS
from commands.hardware import synth
from commands.hardware.targets import TARGETS
from tactile_depth.base import files
from tactile_depth.chip.camera_configuration import CameraConfiguration
from tactile_depth.chip.configuration import Configuration
from tactile_depth.sensor.synthetic import synthetic_for

PICTURE, CONFIG = (480, 640), Configuration(columns=128, rows=96, solver="tridiagonal")


def main() -> None:
    known = json.loads(CAMERAS.read_text()) if CAMERAS.exists() else {}
    for target in TARGETS.values():
        device = target.device
        for pixel_format in sys.argv[1:]:
            camera = CameraConfiguration(PICTURE, (CONFIG.rows, CONFIG.columns), pixel_format)
            with files.temporary() as folder:
                unit, _ = synth.camera_unit(CONFIG, synthetic_for(CONFIG), camera, target, folder)
            counts = [int(unit.counts[name]) for name in (device.multiplier, device.block, "LUT")]
            known.setdefault(device.name, {})[pixel_format] = counts
            CAMERAS.write_text(json.dumps(known, indent=1, sort_keys=True) + "\n")


if __name__ == "__main__":
    main()
