# SPDX-License-Identifier: Apache-2.0
"""Writes a surface as a PLY file (Turk, 1994): a mesh in millimetres, binary, little endian."""

from __future__ import annotations

from pathlib import Path

import numpy as np


def vertices_mm(
    height_mm: np.ndarray, pixel_pitch_mm: float, pixel_aspect: float, origin_mm: tuple[float, float] = (0.0, 0.0)
) -> np.ndarray:
    """Return the points of a surface, float32 (rows * columns, 3): x to the right, y up the picture, z the height.

    x and y count from the upper left corner of the grid: depth (i, j) lies half a pixel up and to the left of the
    centre of pixel (i, j). `origin_mm` is the row and the column of the first value, in mm.
    """
    rows, columns = height_mm.shape
    y, x = np.mgrid[:rows, :columns].astype(np.float32) * np.float32(pixel_pitch_mm)
    x *= np.float32(pixel_aspect)
    top, left = map(np.float32, origin_mm)
    return np.stack([x + left, -(y + top), height_mm.astype(np.float32)], axis=-1).reshape(-1, 3)


def triangles(rows: int, columns: int) -> np.ndarray:
    """Return two triangles for each four neighbours, int32 (n, 3), counter-clockwise seen from above."""
    index = np.arange(rows * columns, dtype=np.int32).reshape(rows, columns)
    a, b, c, d = index[:-1, :-1], index[:-1, 1:], index[1:, :-1], index[1:, 1:]
    return np.stack([a, c, b, b, c, d], axis=-1).reshape(-1, 3)


def write_ply(path: Path, height_mm: np.ndarray, pixel_pitch_mm: float, pixel_aspect: float) -> None:
    """Write a height map, float (rows, columns) in mm."""
    points = vertices_mm(height_mm, pixel_pitch_mm, pixel_aspect)
    faces = triangles(*height_mm.shape)
    coordinates = "".join(f"property float {axis}\n" for axis in "xyz")
    header = (
        "ply\nformat binary_little_endian 1.0\ncomment units: mm, z is the height above the untouched surface\n"
        f"element vertex {len(points)}\n{coordinates}"
        f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    records = np.zeros(len(faces), dtype=[("count", "u1"), ("corners", "<i4", 3)])
    records["count"], records["corners"] = 3, faces
    path.write_bytes(header.encode("ascii") + points.astype("<f4").tobytes() + records.tobytes())
