# SPDX-License-Identifier: Apache-2.0
"""Words, multipliers and memories of a configuration: `parts` of the models of its cores."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from importlib import import_module

from commands.common import repository
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.latency import by_core
from tactile_depth.chip.resources import Memory, Parts


@cache
def parts(config: Configuration) -> Parts:
    """Return what the cores of a configuration take, in the order of the data; each part has the name of its core."""
    found: Parts = []
    for name in dict.fromkeys(core.partition(",")[0] for _, core, _ in by_core(config)):
        if core := repository.cores().get(name):
            model = import_module(".".join(["tactile_depth.chip", *core.block.split("/"), name]))
            for part in getattr(model, "parts", lambda _: [])(config):
                if isinstance(part, Memory) and config.parity:
                    before = part.kind == "delay lines"  # a register
                    part = replace(part, width=part.width + 1, words=part.words - before)
                found.append(replace(part, core=name))
    return found
