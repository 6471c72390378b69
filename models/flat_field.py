# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/flat_field.sv: colours relative to the reference frame.

The reference (the frame without contact) is kept as gains, 1 / reference, on a coarse grid of block means, and the
gains are interpolated between the blocks' centres: lighting is smooth, so this costs nothing that shows, and a pixel
takes one multiplication a colour and no division. Words, all integers:

    pixel       8 bits unsigned
    gain        24 bits unsigned, 2**27 / reference; at the nodes, and interpolated
    code        8 bits unsigned, 128 I / ref, for the table: 128 is the reference, saturated at 255
    deviation   14 bits signed, 12 fraction bits, I / ref - 1, for the quadratic model, saturated at 2

Interpolation, along rows and columns alike: with blocks of b = 2**L pixels, pixel i lies at pos = 2 i + 1 - b half
pixels from the first block's centre, clamped to the first and the last centre (constant beyond them);
node = pos >> (L + 1), w = pos mod 2 b, and 2 b times the gain is (2 b - w) g[node] + w g[node + 1]. Both directions
are exact; one rounding to even, of 2 L + 2 bits, makes the word. Where w is 0 the next node is not looked at.

A pixel is dark where all its colours are under `dark_level` (0: none is), or the reference of any colour is under 16
grey levels, which is the top bit of its gain. A dark pixel takes over what left for the pixel before it in its row;
the first of a row reads flat. Every dark pixel is counted.
"""

from __future__ import annotations

import numpy as np

from models.calibration import Calibration
from models.configuration import DEVIATION, GAIN_FRACTION, GAIN_WIDTH, Configuration
from models.round_saturate import Monitor, round_half_even, round_saturate

FLAT_CODE = 128
CODE_WIDTH = 8


def unit_gains(config: Configuration) -> np.ndarray:
    """The gains at power-up, of a reference of 128 everywhere: codes are the pixels.

    Returns
    -------
    int64 array (node rows, node columns, 3)
    """
    return np.full((*config.reference_nodes, 3), (1 << GAIN_FRACTION) // FLAT_CODE, np.int64)


def flat_field_parameters(config: Configuration, quadratic: bool) -> dict[str, int]:
    """Parameters of hdl/flat_field.sv: deviations for the quadratic model, else codes for the table."""
    fraction = DEVIATION.fraction if quadratic else FLAT_CODE.bit_length() - 1
    return {
        "Rows": config.rows,
        "Columns": config.columns,
        "BlockLog2": config.reference_block_log2,
        "GainWidth": GAIN_WIDTH,
        "Drop": GAIN_FRACTION - fraction,
        "Offset": 1 << fraction if quadratic else 0,
        "OutWidth": DEVIATION.width if quadratic else CODE_WIDTH,
        "Flat": 0 if quadratic else FLAT_CODE,
    }


def reference_gains(calibration: Calibration, config: Configuration) -> np.ndarray:
    """The gains of a calibration's reference frame, int64 (node rows, node columns, 3)."""
    if calibration.reference is None:
        return unit_gains(config)
    return captured_gains(calibration.reference[None], config)


def captured_gains(frames: np.ndarray, config: Configuration) -> np.ndarray:
    """Gains from frames without contact: each 2**27 over the mean of a block and of all frames, ties up, saturated.

    Parameters
    ----------
    frames : uint8 array (2**k, rows, columns, 3)

    Returns
    -------
    int64 array (node rows, node columns, 3)
    """
    count = len(frames)
    assert count.bit_count() == 1, "a power of two of frames"
    log2 = config.reference_block_log2
    rows, columns = config.reference_nodes
    whole = frames[:, : rows << log2, : columns << log2].astype(np.int64)
    total = whole.reshape(count, rows, 1 << log2, columns, 1 << log2, 3).sum(axis=(0, 2, 4))
    dividend = np.int64(2 * count << (GAIN_FRACTION + 2 * log2))
    quotient = (dividend // np.maximum(total, 1) + 1) >> 1
    return np.minimum(quotient, (1 << GAIN_WIDTH) - 1)


def interpolated_gains(gains: np.ndarray, config: Configuration) -> np.ndarray:
    """The gain of every pixel, from that of the nodes: int64 (rows, columns, 3)."""
    return round_half_even(interpolate_nodes(gains, config), 2 * config.reference_block_log2 + 2)


def interpolate_nodes(nodes: np.ndarray, config: Configuration) -> np.ndarray:
    """Words at every pixel, times 4 b**2: (rows, columns, n) of words (node rows, node columns, n)."""
    log2 = config.reference_block_log2
    along_rows = _interpolate(nodes, config.rows, log2)
    return _interpolate(along_rows.swapaxes(0, 1), config.columns, log2).swapaxes(0, 1)


def _interpolate(nodes: np.ndarray, pixels: int, log2: int) -> np.ndarray:
    """Between nodes along axis 0, times twice the block."""
    at = np.clip(2 * np.arange(pixels) + 1 - (1 << log2), 0, (len(nodes) - 1) << (log2 + 1))
    node, share = at >> (log2 + 1), (at & ((2 << log2) - 1))[:, None, None]
    return nodes[node] * ((2 << log2) - share) + nodes[np.minimum(node + 1, len(nodes) - 1)] * share


def dark_pixels(frames: np.ndarray, gains: np.ndarray, config: Configuration, dark_level: int = 0) -> np.ndarray:
    """Which pixels are held from their neighbour, bool (..., rows, columns)."""
    dead = (interpolated_gains(gains, config) >> (GAIN_WIDTH - 1)).any(axis=-1)
    return np.logical_or((frames < dark_level).all(axis=-1), dead)


def flat_codes(
    frames: np.ndarray, gains: np.ndarray, config: Configuration, dark_level: int = 0, monitor: Monitor | None = None
) -> np.ndarray:
    """128 I / ref: uint8 (..., rows, columns, 3) to uint8 of the same shape."""
    ratio = frames * interpolated_gains(gains, config)
    code = round_half_even(ratio, GAIN_FRACTION - (FLAT_CODE.bit_length() - 1))
    dark = dark_pixels(frames, gains, config, dark_level)
    largest = (1 << CODE_WIDTH) - 1
    if monitor is not None:
        monitor.clipped("flat_field", int(np.count_nonzero((code > largest) & ~dark[..., None])))
    return _hold(np.minimum(code, largest), dark, FLAT_CODE).astype(np.uint8)


def deviations(
    frames: np.ndarray, gains: np.ndarray, config: Configuration, dark_level: int = 0, monitor: Monitor | None = None
) -> np.ndarray:
    """I / ref - 1 as codes of `DEVIATION`: uint8 (..., rows, columns, 3) to int64 of the same shape."""
    dark = dark_pixels(frames, gains, config, dark_level)
    lit = np.where(dark[..., None], 0, frames)  # saturation is not counted where nothing is seen
    ratio = lit * interpolated_gains(gains, config) - (np.int64(1) << GAIN_FRACTION)
    code = round_saturate(ratio, GAIN_FRACTION - DEVIATION.fraction, DEVIATION.width, monitor, "flat_field")
    return _hold(code, dark, 0)


def _hold(codes: np.ndarray, dark: np.ndarray, flat: int) -> np.ndarray:
    """Where `dark`, what the pixel before has, in rows; the first of a row: `flat`."""
    columns = np.arange(dark.shape[-1])
    last = np.maximum.accumulate(np.where(dark, -1, columns), axis=-1)[..., None]
    return np.where(last < 0, flat, np.take_along_axis(codes, np.maximum(last, 0), axis=-2))
