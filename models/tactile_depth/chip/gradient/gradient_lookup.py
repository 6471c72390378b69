# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/gradient/gradient_lookup.sv, and the contents of its table."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from tactile_depth.chip.calibration import Calibration
from tactile_depth.chip.common.td_banked_table import BankedTable
from tactile_depth.chip.common.td_table_port import TablePort
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.limits import CORRECTION_BITS, CORRECTION_WIDTH
from tactile_depth.chip.registers.register_map import TABLES
from tactile_depth.chip.resources import Parts, Words, banks

LATENCY = 4


def gradient_codes(calibration: Calibration, config: Configuration) -> np.ndarray:
    """Return the slope codes gx, gy by bin {red, green, blue}, int64 (bins, 2); slope = code * config.gradient_lsb."""
    slopes = calibration.table.reshape(-1, 2)
    return np.rint(slopes / config.gradient_lsb).astype(np.int64)


def gradient_lookup(frames: np.ndarray, codes: np.ndarray, bits: int) -> np.ndarray:
    """Return the slope codes of frames: uint8 (..., rows, cols, 3) RGB to int64 (..., rows, cols, 2)."""
    top = frames.astype(np.int64) >> (8 - bits)
    index = (top[..., 0] << bits | top[..., 1]) << bits | top[..., 2]
    return codes[index]


class GradientLookup:
    """The table, its port and the beats on their way: each valid, its position, and index or entry."""

    def __init__(self, entries: Sequence[int | None], bits: int, width: int) -> None:
        self.bits, self.width = bits, width
        self.table = BankedTable(entries)
        self.port = TablePort(TABLES["gradient"], 3 * bits, width, words=2, signed=1)
        self.beats: list[tuple[int, int, Any]] = [(0, 0, None)] * LATENCY

    def clock(
        self, *, rst: int, en: int, table_command: int, table_bank: int, in_valid: int, in_pixel: int, in_position: int
    ) -> dict[str, int | None]:
        """Advance by one clock edge; return the outputs before it, None where one does not count."""
        first, *middle, (valid, position, slopes) = self.beats
        bus = self.port.clock(rst=rst, table_command=table_command, free_word=self.table.free_word)
        table = self.table.clock(
            rst=rst,
            en=en,
            table_bank=table_bank,
            frame_start=in_valid and in_position & 3 == 3,
            change=first[0] and first[1] & 3 == 3,
            read=first[0],
            read_address=first[2],
            free_write=bus["write"],
            free_write_address=bus["index"],
            free_write_word=bus["word"],
            free_read=bus["read"],
            free_read_address=bus["index"],
        )
        if en:
            red, green, blue = (in_pixel >> place + 8 - self.bits & (1 << self.bits) - 1 for place in (16, 0, 8))
            index = (red << self.bits | green) << self.bits | blue
            self.beats = [(in_valid, in_position, index), first, (*middle[0][:2], table["read_word"]), middle[1]]
        if rst:
            self.beats = [(0, 0, None)] * LATENCY
        shown = valid and slopes is not None
        return {
            "table_answer": bus["table_answer"],
            "table_in_use": table["table_in_use"],
            "out_valid": valid,
            "out_position": position if valid else None,
            "out_gx": slopes if shown else None,
            "out_gy": slopes >> self.width if shown else None,
        }


def parts(config: Configuration) -> Parts:
    """Return the tables of slopes or, with polynomials, of corrections."""
    bits, width = config.bits_per_channel, config.gradient.width
    if config.polynomials:
        bits, width = CORRECTION_BITS, CORRECTION_WIDTH
    return [Words(width), *banks(2 * width, 1 << 3 * bits)]
