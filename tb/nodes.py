# SPDX-License-Identifier: Apache-2.0
"""Grids of td_node_map and of the cores that contain it."""

from dataclasses import dataclass
from typing import Any

from tactile_depth.chip.fixed_point import Format
from tactile_depth.chip.limits import DARKEST_LOG2
from tb.stream import parameters, places


def first_words(rows: int, columns: int, channels: int, width: int) -> Any:
    """Return the words at power-up, (node rows, node columns, channels); every word differs."""
    return places(rows * columns * channels, width).reshape(rows, columns, channels) & (1 << width) - 1


@dataclass(frozen=True)
class Grid:
    """Grid smaller than a configuration allows, with the fields that the models read."""

    rows: int
    columns: int
    reference_block_log2: int
    depth: Format  # of the words of the nodes

    @classmethod
    def of(cls, dut: Any, width: Any = "Width") -> Any:
        rows, columns, block_log2, width = parameters(dut, "Rows", "Columns", "BlockLog2", width)
        return cls(rows, columns, block_log2, Format(width, 0))

    @property
    def reference_nodes(self) -> tuple[Any, ...]:
        return self.rows >> self.reference_block_log2, self.columns >> self.reference_block_log2

    @property
    def gain(self) -> Format:
        return Format(self.depth.width, self.depth.width + DARKEST_LOG2)
