# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/poisson/transform/wide_twiddle.sv."""

from __future__ import annotations

import numpy as np

from tactile_depth.chip.common.td_round_saturate import Monitor
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.poisson.transform.twiddle_multiply import twiddle_multiply
from tactile_depth.chip.resources import Memory, late_style, rom

LATENCY = 5


def wide_twiddle(
    re: np.ndarray,
    im: np.ndarray,
    factors: np.ndarray,
    drop: int,
    width: int,
    monitor: Monitor | None = None,
    node: str = "twiddle",
    real_only: bool = False,
) -> tuple[np.ndarray, np.ndarray]:
    """Multiply beats (..., beats, paths) by `factors` (beats, paths, 2), rounded as in `twiddle_multiply`."""
    flat = (*re.shape[:-2], -1)
    words = factors.reshape(-1, 2)
    out_re, out_im = twiddle_multiply(re.reshape(flat), im.reshape(flat), words, drop, width, monitor, node, real_only)
    return out_re.reshape(re.shape), out_im.reshape(re.shape)


def ones(factors: np.ndarray, factor_width: int) -> int:
    """Return a word with a bit for each path, 1 where the factor is 1 in every beat."""
    one = factors == (2 ** (factor_width - 1) - 1, 0)
    return sum(int(path) << index for index, path in enumerate(np.all(one, axis=(0, 2))))


def factors_rom(config: Configuration, paths: int) -> Memory:
    """Return the table of factors, a block memory where the factors of one path fill one."""
    width, beats = 3 * config.coefficient.width, config.columns // paths
    return rom(width * paths, beats, late_style(width * beats))
