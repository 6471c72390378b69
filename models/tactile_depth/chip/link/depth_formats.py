# SPDX-License-Identifier: Apache-2.0
"""Depth values on the link, in three formats."""

from __future__ import annotations

from enum import IntEnum
from typing import Final, Literal

import numpy as np

from tactile_depth.base.npy import Codes
from tactile_depth.chip.common.td_round_saturate import round_saturate

SHORT_BITS: Final = 16
VALUES_A_PACKET: Final = 256


class DepthFormat(IntEnum):
    """Format of the depth values that a device sends."""

    NONE = 0
    """No depth."""
    WORDS = 1
    """Depth codes, sign-extended to whole bytes as on `m_axis`."""
    SHORT = 2
    """16 bits: the code / 2^shift."""
    AVERAGED = 3
    """16 bits: the mean of 2 x 2 codes / 2^shift."""


DepthFormatName = Literal["words", "16-bit", "averaged"]
NAMES: Final[dict[DepthFormat, DepthFormatName]] = {
    DepthFormat.WORDS: "words",
    DepthFormat.SHORT: "16-bit",
    DepthFormat.AVERAGED: "averaged",
}
"""Names of the formats of depth, for users."""
FORMATS: Final = {name: depth_format for depth_format, name in NAMES.items()}
AVERAGED_PIXELS: Final = 2  # rows, and columns, of the grid whose mean a value of the averaged format is


def value_bytes(depth_format: DepthFormat, width: int) -> int:
    """Return the bytes of a value; `width` is the bits of a depth code."""
    return -(-width // 8) if depth_format == DepthFormat.WORDS else SHORT_BITS // 8


def sent_shape(depth_format: DepthFormat, rows: int, columns: int) -> tuple[int, int]:
    """Return the rows and columns of values that are sent of a frame; an odd last row is not averaged and not sent."""
    span = span_of(depth_format)
    return rows // span, columns // span


def span_of(depth_format: DepthFormat) -> int:
    """Return the rows, and columns, of the grid that a value covers."""
    return AVERAGED_PIXELS if depth_format == DepthFormat.AVERAGED else 1


def exact_shift(width: int) -> int:
    """Return the least shift with which 16 bits have the range of a depth code: its bits beyond 16."""
    return max(width - SHORT_BITS, 0)


def to_bytes(codes: Codes, depth_format: DepthFormat, width: int, shift: int) -> bytes:
    """Return the values that a device sends of a frame, one after another, little-endian.

    The 16-bit formats round half to even, once, and clip.

    Parameters
    ----------
    codes : int32 array (rows, columns)
        Depth codes of `width` bits, in the order in which rows leave.
    depth_format : DepthFormat
    width : int
    shift : int
        Bits that the 16-bit formats drop.
    """
    if depth_format == DepthFormat.WORDS:
        count = value_bytes(depth_format, width)
        return np.ascontiguousarray(codes, "<i4").view(np.uint8).reshape(-1, 4)[:, :count].tobytes()
    wide = codes.astype(np.int64)
    if depth_format == DepthFormat.AVERAGED:
        rows, columns = sent_shape(depth_format, *codes.shape)
        wide = wide[: 2 * rows].reshape(rows, 2, columns, 2).sum(axis=(1, 3))
        shift += 2
    return round_saturate(wide, shift, SHORT_BITS).astype("<i2").tobytes()


def from_bytes(values: bytes, count: int) -> Codes:
    """Return the signed values (n,) of little-endian words of `count` bytes, 1 to 4."""
    wide = np.zeros((len(values) // count, 4), np.uint8)
    wide[:, 4 - count :] = np.frombuffer(values, np.uint8).reshape(-1, count)
    return (wide.view("<i4")[:, 0] >> 8 * (4 - count)).astype(np.int32, copy=False)


def received(codes: Codes, depth_format: DepthFormat, width: int, shift: int, bottom_first: bool) -> Codes:
    """Return the codes that a host gets of those of a frame (rows, columns), both in the order of the picture."""
    if depth_format == DepthFormat.WORDS:
        return codes
    order = slice(None, None, -1 if bottom_first else 1)
    values = from_bytes(to_bytes(codes[order], depth_format, width, shift), value_bytes(depth_format, width))
    return values.reshape(sent_shape(depth_format, *codes.shape))[order] << shift
