# SPDX-License-Identifier: Apache-2.0
"""Means of blocks of a picture, in which it is compared with its reference."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from scipy.linalg.lapack import dposv

BLOCKS = (24, 32)  # rows and columns of blocks, if the picture has so many pixels
RIDGE = 1e-6  # so that a fit to few blocks has a solution


@dataclass(frozen=True)
class Rest:
    """The sensor without contact, on the grid.

    Attributes
    ----------
    pixels : float32 array (rows, columns, 3)
        Mean of the frames of the reference.
    blocks : float32 array (block rows, block columns, 3)
    """

    pixels: np.ndarray
    blocks: np.ndarray

    @classmethod
    def of(cls, frames: np.ndarray) -> Rest:
        """Return the reference of frames on the grid, uint8 (frames, rows, columns, 3)."""
        pixels = frames.mean(axis=0, dtype=np.float32)
        return cls(pixels, np.maximum(block_means(pixels), 1))


def block_means(picture: np.ndarray) -> np.ndarray:
    """Return means of `BLOCKS` of a picture (rows, columns, n), float32; a remainder at the far edges is left out.

    A square picture has as many columns of blocks as rows, so that it can be rotated.
    """
    across, down = _averages(*picture.shape)
    rows = down @ picture.reshape(picture.shape[0], -1).astype(np.float32)
    return (rows.reshape(len(rows), -1) @ across).reshape(len(rows), -1, picture.shape[2])


def block_size(rows: int, columns: int) -> tuple[int, int]:
    """Return rows and columns of a block of a picture."""
    counts = (BLOCKS[0], BLOCKS[0]) if rows == columns else BLOCKS
    return -(-rows // counts[0]), -(-columns // counts[1])


@cache
def _averages(rows: int, columns: int, values: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the matrices that average columns, (columns * n, block columns * n), and rows, (block rows, rows)."""
    height, width = block_size(rows, columns)
    down, across = (
        np.repeat(np.eye(length // size), size, axis=1) / size for length, size in ((rows, height), (columns, width))
    )
    down, across = (np.pad(each, ((0, 0), (0, n - each.shape[1]))) for each, n in ((down, rows), (across, columns)))
    return np.kron(across.T, np.eye(values)).astype(np.float32), down.astype(np.float32)


def differences(blocks: np.ndarray, rest: np.ndarray) -> np.ndarray:
    """Return log(picture / reference) after a gain for each colour, float32 (block rows, block columns, 3)."""
    difference = np.log(np.maximum(blocks, 0.01) / rest)
    return difference - medians(difference)


# A picture of a stream has a few ms. On so few blocks these take a fraction of numpy's time along axes.


def medians(values: np.ndarray) -> np.ndarray:
    """Return the median of each colour, of an even number the upper one, from values (.., colours)."""
    flat = np.ascontiguousarray(values.reshape(-1, values.shape[-1]).T)
    middle = flat.shape[1] // 2
    return np.partition(flat, middle)[:, middle]


def median(values: np.ndarray) -> float:
    """Return the median of all values, of an even number the upper one."""
    return float(medians(values.reshape(-1, 1))[0])


def largest(values: np.ndarray) -> np.ndarray:
    """Return the largest of three colours, from values (.., 3)."""
    result: np.ndarray = np.maximum(np.maximum(values[..., 0], values[..., 1]), values[..., 2])
    return result


def spread(values: np.ndarray, tail: float) -> np.ndarray:
    """Return the width of the middle of the values (rows, columns, n) without both tails, (n,)."""
    ordered = np.sort(np.ascontiguousarray(values.reshape(-1, values.shape[-1]).T))
    cut = int(tail * ordered.shape[1])
    return ordered[:, -1 - cut] - ordered[:, cut]


def smooth(values: np.ndarray, degree: int, rounds: int = 1, scale: float = 0.012) -> np.ndarray:
    """Fit polynomials to values (rows, columns, 3); beyond one round, values far from it lose their weight."""
    (terms, products), flat = _terms(*values.shape[:2], degree), values.reshape(-1, 3).astype(np.float64)
    weights, ridge = np.ones(len(flat)), RIDGE * np.eye(terms.shape[1])
    for _ in range(rounds):
        normal = (weights @ products).reshape(ridge.shape) + ridge
        _, coefficients, _ = dposv(normal, terms.T @ (weights[:, None] * flat))
        fitted = terms @ coefficients
        weights = 1 / (scale**2 + largest(np.abs(flat - fitted)) ** 2)
    return fitted.reshape(values.shape)


@cache
def _terms(rows: int, columns: int, degree: int) -> tuple[np.ndarray, np.ndarray]:
    """Return powers of the position up to a degree, float64 (pixels, terms), and their products (pixels, terms^2)."""
    y, x = np.meshgrid(np.linspace(-1, 1, rows), np.linspace(-1, 1, columns), indexing="ij")
    powers = [x**i * y**j for i in range(degree + 1) for j in range(degree + 1 - i)]
    terms = np.stack(powers, axis=-1).reshape(rows * columns, -1)
    return terms, (terms[:, :, None] * terms[:, None, :]).reshape(len(terms), -1)
