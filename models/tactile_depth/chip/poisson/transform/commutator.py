# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/poisson/transform/commutator.sv, and the order of words in several paths."""

from __future__ import annotations

from functools import cache

import numpy as np

from tactile_depth.chip.poisson.transform.orders import read_only

LEAD = 2  # cycles from a start to the first words of its burst, in all cores of bursts


@cache
def positions(size: int, paths: int, lowest: int) -> np.ndarray:
    """Return the position in its burst of each word, int64 (beats, paths).

    The path number is a window of the position whose lowest bit is `lowest`; the beat number has the other bits.
    """
    beat, path = np.arange(size // paths)[:, None], np.arange(paths)
    above, below = beat >> lowest, beat & (1 << lowest) - 1
    return read_only((above * paths + path) << lowest | below)


def to_beats(words: np.ndarray, paths: int, lowest: int) -> np.ndarray:
    """Return bursts (..., N) as beats (..., N / paths, paths)."""
    return words[..., positions(words.shape[-1], paths, lowest)]


def from_beats(beats: np.ndarray, lowest: int) -> np.ndarray:
    """Return beats (..., beats, paths) as bursts (..., N), the inverse of `to_beats`."""
    count, paths = beats.shape[-2:]
    order = np.argsort(positions(count * paths, paths, lowest), axis=None)
    return beats.reshape(*beats.shape[:-2], -1)[..., order]


def commutator(beats: np.ndarray, delay: int, up: bool) -> np.ndarray:
    """Move the window of beats (..., beats, paths) by one bit, which is the bit log2(delay) of the beat number."""
    bit = delay.bit_length() - 1
    before, behind = (bit, bit + 1) if up else (bit + 1, bit)
    return to_beats(from_beats(beats, before), beats.shape[-1], behind)
