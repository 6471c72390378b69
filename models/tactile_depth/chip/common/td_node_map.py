# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/common/td_node_map.sv: words of every pixel from those of a coarse grid of nodes.

Interpolation, along rows and columns alike: with blocks of b = 2**L pixels, pixel i lies at pos = 2 i + 1 - b half
pixels from the first block's centre, clamped to the first and the last centre (constant beyond them);
node = pos >> (L + 1), w = pos mod 2 b, and 2 b times the word is (2 b - w) F[node] + w F[node + 1]. Both directions
are exact; one rounding to even, of 2 L + 2 bits, makes the word. Where w is 0 the next node has no effect. The words do
not depend on the lanes.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from tactile_depth.chip.common import td_ramp
from tactile_depth.chip.common.td_banked_table import BankedTable
from tactile_depth.chip.common.td_round_saturate import round_half_even
from tactile_depth.chip.common.td_table_port import TablePort
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.fixed_point import joined, split

CYCLES_TO_RAMP = 9
"""Cycles from a beat to the first word of its ramps."""


def side(lanes: int, block_log2: int) -> int:
    """Return the nodes that lie side by side in a word of the table, and that the capture writes at once."""
    return max(1, lanes >> block_log2)


def tables(lanes: int, block_log2: int) -> int:
    """Return the tables of a word of the nodes: with a beat of a block or more one for those above, one for those
    below."""
    return 1 if lanes < 1 << block_log2 else 2


def latency(lanes: int, block_log2: int) -> int:
    """Return the latency in cycles: to the ramps of half a block each, or of a beat; the ramps; the rounding."""
    return CYCLES_TO_RAMP + td_ramp.latency(min(lanes, 1 << block_log2 - 1)) + 1


def entries_per_node(channels: int) -> int:
    """Return the entries of the table for each node: a power of two."""
    return 1 << (channels - 1).bit_length()


def node_map(nodes: np.ndarray, config: Configuration) -> np.ndarray:
    """Return the words of every pixel, int64 (rows, columns, ..), from words at nodes (node rows, node columns, ..)."""
    return round_half_even(interpolated(nodes, config), 2 * config.reference_block_log2 + 2)


def interpolated(nodes: np.ndarray, config: Configuration) -> np.ndarray:
    """Interpolate words at nodes (node rows, node columns, ..) to the pixels (rows, columns, ..), times 4 b**2."""
    log2 = config.reference_block_log2
    down = _interpolated(nodes, config.rows, log2)
    return _interpolated(down.swapaxes(0, 1), config.columns, log2).swapaxes(0, 1)


def _interpolated(nodes: np.ndarray, pixels: int, log2: int) -> np.ndarray:
    """Interpolate between nodes along axis 0; the result is scaled by twice the block size."""
    at = np.clip(2 * np.arange(pixels) + 1 - (1 << log2), 0, (len(nodes) - 1) << (log2 + 1))
    node, weight = at >> (log2 + 1), (at & ((2 << log2) - 1)).reshape(-1, *[1] * (nodes.ndim - 1))
    return nodes[node] * ((2 << log2) - weight) + nodes[np.minimum(node + 1, len(nodes) - 1)] * weight


class NodeMap:
    """Tables of nodes, their port, and the beats on their way.

    Attributes
    ----------
    table : BankedTable
        Of words of neighbouring nodes, with all channels, as the capture writes them.
    step : int
        Indices of the bus for an entry of the table.
    place, size : int
        Beats that came of the frame; beats of a frame.
    frame : list of int
        Words of each beat of the frame, None where one is not known.
    """

    def __init__(
        self, config: Configuration, entries: Sequence[int | None], select: int, channels: int, lanes: int, signed: int
    ) -> None:
        log2, self.width = config.reference_block_log2, config.depth.width
        self._config, self._channels, self._lanes, self._signed = config, channels, lanes, signed
        self._words = side(lanes, log2) * channels  # of an entry
        self.step = entries_per_node(self._words)
        self.table, self.port = BankedTable(entries), TablePort(select, 24, self.width, 1, self._words, signed)
        self.size, self.place = config.rows * config.columns // lanes, 0
        self.frame: list[int | None] = [None] * self.size
        self._starts = [0] * tables(lanes, log2)
        self._beats: list[tuple[int, int, int | None]] = [(0, 0, None)] * latency(lanes, log2)

    def _beats_of(self, entries: Sequence[Any]) -> list[int | None]:
        """Return the words of each beat of a frame, None where the nodes are not known."""
        if None in entries:
            return [None] * self.size
        shape = (*self._config.reference_nodes, self._channels)
        nodes = np.array([split(entry, self._words, self.width) for entry in entries]).reshape(shape)
        nodes -= self._signed * (nodes >> self.width - 1 << self.width)
        beats = node_map(nodes, self._config).reshape(self.size, -1).tolist()
        return [joined(beat, self.width) for beat in beats]

    def clock(self, **pins: int) -> dict[str, Any]:
        """Advance by one clock edge; return the outputs before it, None where one does not count."""
        valid, data, words = self._beats[-1]
        out: dict[str, Any] = {"active": any(beat[0] for beat in self._beats), "out_valid": valid}
        out |= {"out_data": data if valid else None, "out_words": words if valid else None}
        out["capture_read_words"] = self.table.free_word
        bus = self.port.clock(rst=pins["rst"], table_command=pins["table_command"], free_word=self.table.free_word)
        at, place = divmod(bus["index"], self.step)
        writes, written = bus["write"] and place < self._words, self.table.banks[1 - self.table.in_use][at]
        if writes and written is not None:
            changed = split(written, self._words, self.width)
            changed[place] = bus["word"]
            written = joined(changed, self.width)
        captures, reads = pins["capture_write"], pins["capture_read"]
        starts = pins["in_valid"] and pins["in_frame_start"]
        table = self.table.clock(
            rst=pins["rst"],
            en=pins["en"],
            table_bank=pins["table_bank"],
            frame_start=starts,
            change=self._starts[-1],
            read=0,
            free_write=captures or writes,
            free_write_address=pins["capture_write_node"] if captures else at,
            free_write_word=pins["capture_words"] if captures else written,
            free_read=reads or bus["read"],
            free_read_address=pins["capture_read_node"] if reads else at,
        )
        out |= {"table_answer": bus["table_answer"], "table_in_use": table["table_in_use"]}
        if pins["en"]:
            if starts:
                self.frame = self._beats_of(self.table.banks[pins["table_bank"]])
            self._beats = [(0, 0, None), *self._beats[:-1]]
            if pins["in_valid"]:
                self._beats[0] = (1, pins["in_data"], self.frame[self.place])
                self.place = (self.place + 1) % self.size
            self._starts = [starts, *self._starts[:-1]]
        if pins["rst"]:
            self.place, self._starts, self._beats = 0, [0] * len(self._starts), [(0, 0, None)] * len(self._beats)
        return out
