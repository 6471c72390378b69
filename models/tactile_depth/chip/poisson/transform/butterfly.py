# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/poisson/transform/butterfly.sv."""

from __future__ import annotations

import numpy as np

from tactile_depth.chip.common.td_round_saturate import Monitor, round_saturate

LATENCY = 2


def butterfly(
    re: np.ndarray,
    im: np.ndarray,
    path_bit: int,
    rotate_bit: int,
    inverse: bool,
    halve: bool,
    width: int,
    monitor: Monitor | None = None,
    node: str = "butterfly",
) -> tuple[np.ndarray, np.ndarray]:
    """Compute sums and differences of the words of a beat whose path numbers differ in one bit.

    Parameters
    ----------
    re, im : int64 arrays (..., beats, paths)
    rotate_bit : int
        The second word is first multiplied by -j (inverse: +j) where this bit of beat * paths + path is 1; -1: nowhere.

    Returns
    -------
    re, im : int64 arrays (..., beats, paths), saturated to `width` bits
    """
    beats, paths = re.shape[-2:]
    a = np.arange(paths)[np.arange(paths) >> path_bit & 1 == 0]
    b = a + (1 << path_bit)
    b_re, b_im = re[..., b], im[..., b]
    if rotate_bit >= 0:
        place = np.arange(beats)[:, None] * paths + a
        sign = 1 if inverse else -1
        rotate = place >> rotate_bit & 1 == 1
        b_re, b_im = np.where(rotate, -sign * b_im, b_re), np.where(rotate, sign * b_re, b_im)
    out = np.empty((2, *re.shape), np.int64)
    for part, (first, second) in enumerate(((re[..., a], b_re), (im[..., a], b_im))):
        out[part][..., a], out[part][..., b] = first + second, first - second
    drop = int(halve)
    return (
        round_saturate(out[0], drop, width, monitor, node + ".re"),
        round_saturate(out[1], drop, width, monitor, node + ".im"),
    )
