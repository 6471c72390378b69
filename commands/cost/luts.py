# SPDX-License-Identifier: Apache-2.0
"""LUTs of a configuration: what is counted in its parameters, times coefficients fitted to runs of `make synth`.

LUTs of memories follow from the shapes of the device. Those of logic are counted for each core in terms: bits of
butterflies and products, of tables and of the choice between parts of a memory, bits of words, and a constant. The
coefficients are computed from luts.json, which `python -m commands.hardware.lut_runs` writes: non-negative least
squares over the cores of all runs that are marked as fitted. docs/hardware.md has the differences, for other runs too.
"""

from __future__ import annotations

import json
import math
from collections import defaultdict
from collections.abc import Mapping
from functools import cache, lru_cache
from pathlib import Path

import numpy as np
from scipy.optimize import nnls

from commands.cost.devices import Device
from commands.cost.parts import parts
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.poisson.transform.fft import stages
from tactile_depth.chip.resources import Memory, Multiplier, Words

RUNS = Path(__file__).with_name("luts.json")
REST = "small cores"
RIDGE = 0.1
SMALLEST = 100  # LUTs: smaller cores have no more weight in the fit
OPTIONS = ("flat_field", "light_gains", "polynomials", "zero_offset", "parity", "self_check")  # each with registers
SEVERAL = " of several words"  # in a clock: other butterflies, and cores without a constant
TABLES = "bits of tables"  # one LUT each, which is not fitted, as the next
PARITY = "trees of parity"
PROPORTIONAL = ("flat", "reference", "spectral", "zero")  # beginnings of names: cores without a constant

Terms = dict[str, dict[str, float]]  # amount by core and term


@lru_cache(maxsize=4096)  # it takes as long as all the rest of a cost
def luts(config: Configuration, device: Device) -> int:
    """Return the LUTs of a configuration."""
    return round(sum(logic(config, device).values())) + memories(config, device)


def memories(config: Configuration, device: Device) -> int:
    """Return the LUTs of the RAMs that are built of LUTs."""
    return sum(
        rows * columns * each
        for part in parts(config)
        if isinstance(part, Memory) and not part.rom and _of_luts(part, device)
        for rows, columns, each in [_tiles(part, device)]
    )


def logic(config: Configuration, device: Device) -> dict[str, float]:
    """Return the LUTs of the logic of each core."""
    fitted = coefficients(device)
    return {
        core: sum(fitted.get(term, 0.0) * amount for term, amount in amounts.items())
        for core, amounts in terms(config, device).items()
    }


def grouped(by_core: Mapping[str, float], config: Configuration) -> dict[str, float]:
    """Return the LUTs of each core, those of the small cores together."""
    names = {part.core for part in parts(config)}
    found: defaultdict[str, float] = defaultdict(float)
    for core, number in by_core.items():
        found[core if core in names else REST] += number
    return dict(found)


@cache
def coefficients(device: Device) -> dict[str, float]:
    """Return LUTs for each term, fitted to the runs of a device."""
    rows = []
    for run in json.loads(RUNS.read_text()):
        if run["fitted"] and run["device"] == device.name:
            config = Configuration(**run["configuration"])
            rows += [(amounts, run["logic"].get(core, 0)) for core, amounts in terms(config, device).items()]
    number = np.array([luts - amounts.pop(TABLES, 0) - amounts.pop(PARITY, 0) for amounts, luts in rows], float)
    names = sorted({name for amounts, _ in rows for name, amount in amounts.items() if amount})
    weights = 1 / np.maximum(number, SMALLEST)
    counts = np.array([[amounts.get(name, 0.0) for name in names] for amounts, _ in rows]) * weights[:, None]
    scale = counts.max(0)
    ridge = np.eye(len(names)) * RIDGE  # shares between terms that no run tells apart
    solution, _ = nnls(np.vstack([counts / scale, ridge]), np.hstack([number * weights, np.zeros(len(names))]))
    return {TABLES: 1.0, PARITY: 1.0} | dict(zip(names, (solution / scale).tolist(), strict=True))


def terms(config: Configuration, device: Device) -> Terms:
    """Count the terms of each core."""
    counted: defaultdict[str, defaultdict[str, float]] = defaultdict(lambda: defaultdict(float))
    for part in [Words(config.lanes * config.depth.width, REST), *parts(config)]:
        name, core = part.core, counted[part.core]
        if isinstance(part, Multiplier):
            core["split"] += (device.multipliers(part.a, part.b) - 1) * (part.a + part.b)
            if name.startswith("dst"):
                core["product"] += part.a + part.b
        elif isinstance(part, Memory):
            trees = config.parity * (2 if not part.rom and not part.banked else 1)  # two banks share that of the read
            core[PARITY] += trees * math.ceil((part.width - 1) / (device.lut_inputs - 1))
            if part.rom and _of_luts(part, device):
                core[TABLES] += part.width * math.ceil(part.words / 2**device.lut_inputs)
            elif _of_luts(part, device):
                core["choice"] += part.width * (_tiles(part, device)[0] - 1)
        else:
            several = SEVERAL if config.up_paths > 1 and part.work < 1 else ""
            if not name.startswith(PROPORTIONAL) and not several:
                core[name] += 1
            if not name.endswith("dst_forward"):
                core[f"{name}, bits{several}"] += part.bits
            if name.startswith("dst"):
                for stage in stages(config.columns, "inverse" in name):
                    core[f"butterflies{several}"] += (stage.delay > 0) * part.bits
                    core[f"rotations{several}"] += stage.rotate * part.bits
    for name in (REST, "contact_events"):
        counted[name][f"{name}, positions"] += (config.rows * config.columns).bit_length()
    counted[REST]["options"] += sum(getattr(config, option) for option in OPTIONS)
    if config.neumann and config.solver == "tridiagonal":
        core = counted["elimination"]
        core["column_mean"] += config.depth.width
    return {name: dict(amounts) for name, amounts in counted.items()}


def _of_luts(memory: Memory, device: Device) -> bool:
    return not any(device.memories(memory).values())


def _tiles(memory: Memory, device: Device) -> tuple[int, int, int]:
    """Return rows and columns of LUT memories in a RAM, and the LUTs of one of them."""
    shapes = [(math.ceil(memory.words / deep), math.ceil(memory.width / wide), n) for deep, wide, n in device.lut_rams]
    return min(shapes, key=lambda tiles: (math.prod(tiles), tiles))
