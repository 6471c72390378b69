# SPDX-License-Identifier: Apache-2.0
"""Exchanges of colours and sides, found as what brings the light of a picture nearest to another one."""

from __future__ import annotations

import itertools
from collections.abc import Callable

import numpy as np

from tactile_depth.pictures.blocks import differences, median
from tactile_depth.sensor.sensor import Sensor, lighting

# RMS difference of a lighting to that of the calibration, nearest exchange over none. Right: 1.8 and more, 1.29 with
# the light 5 % up at one side and down at the other; exchanged, mirrored or rotated: 0.55 at most.
EXCHANGED = 0.7
DARKEST = 1e-3  # of a lighting, so that it has a logarithm
CORRECT_IT = "give pictures as the calibrated camera gives them, RGB (from OpenCV: picture[..., ::-1])"

GEOMETRIES: dict[str, Callable[[np.ndarray], np.ndarray]] = {
    "": lambda blocks: blocks,
    "it is mirrored left to right": lambda blocks: blocks[:, ::-1],
    "it is mirrored top to bottom": lambda blocks: blocks[::-1],
    "it is rotated by 180 degrees": lambda blocks: blocks[::-1, ::-1],
}
ROTATIONS: dict[str, Callable[[np.ndarray], np.ndarray]] = {
    "it is rotated by 90 degrees": lambda blocks: np.rot90(blocks),
    "it is rotated by 270 degrees": lambda blocks: np.rot90(blocks, 3),
}
ORDERS = {
    (0, 1, 2): "",
    (2, 1, 0): "red and blue are exchanged",
    (1, 0, 2): "red and green are exchanged",
    (0, 2, 1): "green and blue are exchanged",
    (1, 2, 0): "its colours are in the order blue, red, green",
    (2, 0, 1): "its colours are in the order green, blue, red",
}


def pattern(blocks: np.ndarray, rest: np.ndarray) -> float:
    """Return the median difference of a picture to its reference, after a gain for each colour."""
    return median(np.abs(differences(blocks, rest)))


def nearest_exchange(
    blocks: np.ndarray, rest: np.ndarray, is_square: bool, measure: Callable[[np.ndarray, np.ndarray], float] = pattern
) -> tuple[str, float]:
    """Return the exchange after which a picture is nearest to its reference, "" for none, and what then differs."""
    geometries = {**GEOMETRIES, **(ROTATIONS if is_square else {})}
    best, least = "", measure(blocks, rest)
    for (geometry, moved), (order, exchanged) in itertools.product(geometries.items(), ORDERS.items()):
        difference = measure(moved(blocks)[..., order], rest)
        if difference < least:
            best, least = " and ".join(filter(None, (exchanged, geometry))), difference
    return best, least


def exchange_of(sensor: Sensor, reference: np.ndarray) -> str:
    """Return which exchange brings a picture without contact near the lighting of a sensor; "": none.

    Parameters
    ----------
    reference : array (rows, columns, 3)
    """
    assert sensor.lighting is not None
    own, seen = np.maximum(sensor.lighting, DARKEST), np.maximum(lighting(reference), DARKEST)
    best, left = nearest_exchange(seen, own, reference.shape[0] == reference.shape[1], _rms)
    return best if left < EXCHANGED * _rms(seen, own) else ""


def _rms(blocks: np.ndarray, rest: np.ndarray) -> float:
    """Return the RMS difference of two lightings, after a gain for each colour."""
    difference = np.log(blocks / rest)
    return float(np.sqrt(((difference - difference.mean(axis=(0, 1))) ** 2).mean()))
