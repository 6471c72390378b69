# SPDX-License-Identifier: Apache-2.0
"""Types of arrays, and checks of a file before it is read."""

from __future__ import annotations

from collections.abc import Mapping
from hashlib import sha256
from pathlib import Path
from typing import BinaryIO

import numpy as np
import numpy.typing as npt

from tactile_depth.base.errors import InputError

Bytes = npt.NDArray[np.uint8]
Codes = npt.NDArray[np.int32]
Floats = npt.NDArray[np.float64]
Flags = npt.NDArray[np.bool_]
DIGEST = "digest"


def is_file(path: Path) -> bool:
    """Return True if a path is a file; raise InputError if the system does not accept the path."""
    try:
        return path.is_file()
    except OSError as error:  # the path is too long, or its folder may not be read
        raise InputError(f"{path}: {error.strerror}: give the path of a file") from error


def read_header(file: BinaryIO) -> tuple[tuple[int, ...], bool, np.dtype]:
    """Return shape, order and type from the header of a .npy, and leave the file at the start of its data."""
    version = np.lib.format.read_magic(file)
    if version == (1, 0):
        return np.lib.format.read_array_header_1_0(file)
    raise ValueError(f"version {version[0]}.{version[1]}, which arrays of numbers do not need")


def digest_of(entries: Mapping[str, npt.ArrayLike]) -> str:
    """Return the digest of the entries of an .npz but for its own."""
    digest = sha256()
    for name in sorted(entries.keys() - {DIGEST}):
        array = np.asarray(entries[name])
        digest.update(f"{name} {array.dtype.str} {array.shape}".encode() + array.tobytes())
    return digest.hexdigest()
