# SPDX-License-Identifier: Apache-2.0
"""Module paths of version 0.1: importing one raises ImportError, which names the new path."""

from __future__ import annotations

import sys

ROOMS = {
    "base": "by_value errors files interruption npy",
    "pictures": "frames grid_sampler pictures reader",
    "sensor": "built_in calibration_file presets samples scenes sensor",
    "chip": "bounds c_header camera camera_configuration common configuration contact depth fixed_point gradient "
    "hardware_files latency link poisson registers resampling rom_files table_entries tactile_depth video",
    "chip.poisson": "cores fast",
    "depth": "pipeline reference result stream",
    "calibrate": "ball_press circles evaluation fitting press_folder presses",
}
NEW = {name: f"{room}.{name}" for room, names in ROOMS.items() for name in names.split()} | {"checks": "pictures"}
"""Modules and packages of version 0.1, and where they are now."""
GONE = ("accuracy", "certificate", "cost", "devices", "luts", "parts")
"""Modules that only commands of the repository used: they lie in commands/ now."""


class Moved:
    """Finder that comes after all others, and refuses old paths."""

    def find_spec(self, name: str, path: object, target: object = None) -> None:
        package, _, inside = name.partition(".")
        old, dot, rest = inside.partition(".")
        if package == __package__.partition(".")[0] and old in (*NEW, *GONE):
            here = f"{package}.{NEW[old]}{dot}{rest} now" if old in NEW else "in commands/ of the repository now"
            raise ImportError(f"{name} is {here}", name=name)


def refuse_old_paths() -> None:
    """Refuse old paths, which no other finder finds."""
    sys.meta_path.append(Moved())
