# SPDX-License-Identifier: Apache-2.0
"""Memories of an elaborated design, and the UltraRAMs and block RAMs that they need by the plain rule."""

import json
import math
import re
from dataclasses import dataclass
from pathlib import Path

TOP = "tactile_depth"
ULTRA_SHAPE = (4096, 72)
BLOCK_SHAPES = ((512, 72), (1024, 36), (2048, 18), (4096, 9), (8192, 4), (16384, 2), (32768, 1))
BLOCKS_PER_ULTRA = 8  # 36 Kb and 288 Kb


@dataclass(frozen=True)
class Memory:
    """An array of the RTL. `style`: ultra, block, distributed, logic, or empty, which leaves the choice to the tool."""

    path: str
    depth: int
    width: int
    style: str
    rom: bool

    @property
    def ultras(self) -> int:
        """Return the number of UltraRAMs of 4,096 x 72 bits, one word to a row."""
        depth, width = ULTRA_SHAPE
        return math.ceil(self.depth / depth) * math.ceil(self.width / width)

    @property
    def blocks(self) -> float:
        """Return the number of block RAMs of 36 Kb; half of one where 18 Kb are enough."""
        if any(self.depth <= depth and self.width <= width / 2 for depth, width in BLOCK_SHAPES if width > 1):
            return 0.5
        return min(math.ceil(self.depth / depth) * math.ceil(self.width / width) for depth, width in BLOCK_SHAPES)

    def plain(self) -> dict[str, float]:
        """Return UltraRAMs and block RAMs by its style."""
        return {
            "UltraRAM": self.ultras if self.style == "ultra" else 0,
            "BRAM36": self.blocks if self.style == "block" else 0,
        }


def memories(design: Path) -> list[Memory]:
    """Return the memories of an elaborated design, largest first."""
    arrays = []
    for module, content in json.loads(design.read_text())["modules"].items():
        for name, cell in content["cells"].items():
            if cell["type"] != "$mem_v2":
                continue
            depth, width, writers = (int(cell["parameters"][key], 2) for key in ("SIZE", "WIDTH", "WR_PORTS"))
            attributes = cell["attributes"]
            style = attributes.get("ram_style") or attributes.get("rom_style") or ""
            # td_ram.sv and td_rom.sv call their array words, in a generate block of its style
            path = path_of(module) + ("" if ".words" in name else f".{name.removeprefix(chr(92))}")
            arrays.append(Memory(path.lstrip("."), depth, width, style, writers == 0))
    return sorted(arrays, key=lambda memory: (-memory.depth * memory.width, memory.path))


def path_of(module: str) -> str:
    """Return the path in a name <core>$<top>.<path>, without generate blocks other than those of a loop."""
    _, _, path = module.partition("$")[2].partition(".")
    return ".".join(part for part in path.split(".") if not re.fullmatch(r"g_\w+", part))
