# SPDX-License-Identifier: Apache-2.0
"""What is asked of a file before it is read."""

from __future__ import annotations

from pathlib import Path
from typing import BinaryIO

import numpy as np

from models.errors import InputError


def is_file(path: Path) -> bool:
    """Whether a path is a file; InputError when the system does not take it as a path at all."""
    try:
        return path.is_file()
    except OSError as error:  # too long, or in a folder that may not be read
        raise InputError(f"{path}: {error.strerror}: give the path of a file") from error


def read_header(file: BinaryIO) -> tuple[tuple[int, ...], bool, np.dtype]:
    """Shape, order and type that a .npy claims; the file then stands at its data."""
    version = np.lib.format.read_magic(file)
    if version == (1, 0):
        return np.lib.format.read_array_header_1_0(file)
    raise ValueError(f"version {version[0]}.{version[1]}, which arrays of numbers do not need")
