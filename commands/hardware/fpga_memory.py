# SPDX-License-Identifier: Apache-2.0
"""Memories of an elaborated design, and the UltraRAMs and block RAMs that they need by the plain rule."""

import json
import re
from dataclasses import dataclass
from pathlib import Path

from commands.cost.devices import XCZU7EV
from tactile_depth.chip.resources import BLOCK, DISTRIBUTED, ULTRA
from tactile_depth.chip.resources import Memory as Array

TOP = "tactile_depth"
STYLES = {"ultra": ULTRA, "block": BLOCK}
BLOCKS_PER_ULTRA = 8  # 36 Kb and 288 Kb


@dataclass(frozen=True)
class Memory:
    """An array of the RTL. `style`: ultra, block, distributed, logic, or empty, which leaves the choice to the tool."""

    path: str
    depth: int
    width: int
    style: str
    rom: bool

    def plain(self) -> dict[str, float]:
        """Return UltraRAMs and block RAMs by its style and the rule of commands/cost/devices.py."""
        built = XCZU7EV.memories(Array("", self.width, self.depth, STYLES.get(self.style, DISTRIBUTED), self.rom))
        return {"UltraRAM": built["ultra"], "BRAM36": built["block"]}


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
