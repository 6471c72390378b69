# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/poisson/transform/sdf_butterfly.sv."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tactile_depth.chip.common.td_round_saturate import Monitor, round_saturate

LATENCY = 2  # without its delay line


@dataclass(frozen=True)
class Stage:
    """One stage in stream order: a butterfly (`delay` > 0) or a twiddle multiplication."""

    block: int  # points of the sub-transform that the stage belongs to
    delay: int = 0  # butterfly: distance of its operands, and length of its delay line
    rotate: bool = False  # butterfly: the last quarter of the block is first multiplied by -j (inverse: +j)
    halve: bool = False  # butterfly: its results are halved


def sdf_butterfly(
    re: np.ndarray,
    im: np.ndarray,
    stage: Stage,
    inverse: bool,
    width: int,
    monitor: Monitor | None = None,
    node: str = "butterfly",
) -> tuple[np.ndarray, np.ndarray]:
    """Compute sums, then differences, of words `stage.delay` apart in each block of 2 `stage.delay` words.

    Parameters
    ----------
    re, im : int64 arrays (..., N), in stream order along the last axis

    Returns
    -------
    re, im : int64 arrays (..., N), saturated to `width` bits
    """
    if stage.rotate:
        re, im = _rotate_last_quarter(re, im, stage.block, inverse)
    drop = int(stage.halve)
    return (
        round_saturate(_butterfly(re, stage.delay), drop, width, monitor, node + ".re"),
        round_saturate(_butterfly(im, stage.delay), drop, width, monitor, node + ".im"),
    )


def _butterfly(x: np.ndarray, delay: int) -> np.ndarray:
    pairs = x.reshape(*x.shape[:-1], -1, 2, delay)
    first, second = pairs[..., 0, :], pairs[..., 1, :]
    out = np.empty_like(pairs)  # in the memory layout of x
    np.add(first, second, out=out[..., 0, :])
    np.subtract(first, second, out=out[..., 1, :])
    return out.reshape(x.shape)


def _rotate_last_quarter(re: np.ndarray, im: np.ndarray, block: int, inverse: bool) -> tuple[np.ndarray, np.ndarray]:
    """Multiply the last quarter of each block by -j (inverse: +j)."""
    quarters = (*re.shape[:-1], -1, 4, block // 4)
    turned_re, turned_im = re.copy(order="K"), im.copy(order="K")
    for turned, other, negative in ((turned_re, im, inverse), (turned_im, re, not inverse)):
        last = turned.reshape(quarters)[..., 3, :]
        last[...] = other.reshape(quarters)[..., 3, :]
        if negative:
            np.negative(last, out=last)
    return turned_re, turned_im
