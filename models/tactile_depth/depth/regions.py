# SPDX-License-Identifier: Apache-2.0
"""Contacts of a height map: regions above a threshold, divided where the height falls between two summits."""

from __future__ import annotations

import numpy as np

from tactile_depth.base.npy import Flags

FALL_OF_SUMMIT = 0.2
"""Least fall from the lower of two summits to the saddle between them, over its height, that divides two contacts.

Within one contact at most 0.17: 45 real presses, and every drawn contact. A ball that is pressed 0.14 mm deep on the
slope of another one: 0.22.
"""
FALL_OF_THRESHOLD = 0.5
"""Least such fall over the threshold: 0.4 within one contact, by the table of colours, and 1.1 between two balls."""
PAIRS = (
    (np.s_[:, :-1], np.s_[:, 1:]),
    (np.s_[:-1], np.s_[1:]),
    (np.s_[:-1, :-1], np.s_[1:, 1:]),
    (np.s_[:-1, 1:], np.s_[1:, :-1]),
)
"""Two parts of a map, whose pixels at the same place are neighbours on it."""


def regions(heights: np.ndarray, threshold: int, least: int) -> list[Flags]:
    """Return the pixels of each contact, bool (rows, columns), the one with most pixels first.

    Parameters
    ----------
    heights : int array (rows, columns)
        Codes of heights above the untouched surface.
    threshold : int
        Height above which a pixel touches.
    least : int
        Pixels that a contact has at least. A smaller summit is of the contact that it stands on; by itself it is noise.
    """
    summits = _summits(heights, threshold)
    tops, sizes = (each.tolist() for each in np.unique(summits[summits >= 0], return_counts=True))
    size, higher, height = dict(zip(tops, sizes, strict=True)), {top: top for top in tops}, heights.ravel()
    for *sides, saddle in _saddles(heights, summits):
        lower, upper = sorted((_highest(side, higher) for side in sides), key=lambda top: (height[top], -top))
        fall = height[lower] - saddle
        is_apart = fall >= max(FALL_OF_SUMMIT * height[lower], FALL_OF_THRESHOLD * threshold) and size[lower] >= least
        if lower != upper and not is_apart:
            higher[lower] = upper
            size[upper] += size[lower]
    owner = np.full(heights.size + 1, -1)  # the last one is that of pixels beside all
    owner[tops] = [_highest(top, higher) for top in tops]
    owned = owner[summits]
    return [owned == top for top in sorted(set(owner[tops]), key=lambda top: (-size[top], top)) if size[top] >= least]


def _highest(summit: int, higher: dict[int, int]) -> int:
    """Return the summit that a summit belongs to."""
    while higher[summit] != summit:
        summit = higher[summit]
    return summit


def _summits(heights: np.ndarray, threshold: int) -> np.ndarray:
    """Return the index of the summit that the steepest ascent reaches from each pixel; -1 below the threshold."""
    index = np.arange(heights.size).reshape(heights.shape)
    rank = np.where(heights > threshold, heights.astype(np.int64) * heights.size - index, np.iinfo(np.int64).min)
    best, up = rank.copy(), index.copy()
    for one, other in (*PAIRS, *(pair[::-1] for pair in PAIRS)):
        is_higher = rank[other] > best[one]
        best[one] = np.where(is_higher, rank[other], best[one])
        up[one] = np.where(is_higher, index[other], up[one])
    reached = up.ravel()
    while not np.array_equal(further := reached[reached], reached):
        reached = further
    return np.where(heights > threshold, reached.reshape(heights.shape), -1)


def _saddles(heights: np.ndarray, summits: np.ndarray) -> list[tuple[int, int, int]]:
    """Return pairs of summits whose pixels meet, and the greatest height at which they do, the highest saddle first."""
    met = []
    for one, other in PAIRS:
        first, second = summits[one], summits[other]
        meets = (first != second) & (first >= 0) & (second >= 0)
        saddle = np.minimum(heights[one], heights[other])
        met.append(np.stack([first[meets], second[meets], saddle[meets]], axis=-1))
    pairs = np.concatenate(met)
    pairs[:, :2].sort(axis=1)
    pairs = pairs[np.argsort(-pairs[:, 2], kind="stable")]
    _, firsts = np.unique(pairs[:, :2], axis=0, return_index=True)
    return [tuple(pair) for pair in pairs[np.sort(firsts)].tolist()]
