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
from functools import cache
from pathlib import Path

import numpy as np
from scipy.optimize import nnls

from commands.cost.devices import Device
from commands.cost.parts import Memory, parts
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.limits import CORRECTION_WIDTH
from tactile_depth.chip.poisson.transform.sdf_fft import stages
from tactile_depth.chip.tactile_depth import top_parameters

RUNS = Path(__file__).with_name("luts.json")
REST = "small cores"
RIDGE = 0.1
SMALLEST = 100  # LUTs: smaller cores have no more weight in the fit
OPTIONS = ("FlatField", "LightGains", "Polynomial", "ZeroOffset")  # each with registers
TABLES = "bits of tables"  # one LUT each, which is not fitted
PROPORTIONAL = ("flat", "reference", "spectral", "wide", "zero")  # beginnings of names: cores without a constant
TRANSFORMS = ("dst", "wide_dst")  # with these the names of the transforms begin

Terms = dict[str, dict[str, float]]  # amount by core and term


def luts(p: Mapping[str, int], device: Device) -> int:
    """Return the LUTs of a configuration with the parameters of `top_parameters`."""
    return round(sum(logic(p, device).values())) + memories(p, device)


def memories(p: Mapping[str, int], device: Device) -> int:
    """Return the LUTs of the RAMs that are built of LUTs."""
    return sum(
        rows * columns * each
        for part in parts(p)
        if isinstance(part, Memory) and not part.rom and _of_luts(part, device)
        for rows, columns, each in [_tiles(part, device)]
    )


def logic(p: Mapping[str, int], device: Device) -> dict[str, float]:
    """Return the LUTs of the logic of each core."""
    fitted = coefficients(device)
    return {
        core: sum(fitted.get(term, 0.0) * amount for term, amount in amounts.items())
        for core, amounts in terms(p, device).items()
    }


def grouped(by_core: Mapping[str, float], p: Mapping[str, int]) -> dict[str, float]:
    """Return the LUTs of each core, those of the small cores together."""
    names = {core for core, _, _ in _cores(p)}
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
            p = top_parameters(Configuration(**run["configuration"]))
            rows += [(amounts, run["logic"].get(core, 0)) for core, amounts in terms(p, device).items()]
    number = np.array([luts - amounts.pop(TABLES, 0) for amounts, luts in rows], float)
    names = sorted({name for amounts, _ in rows for name, amount in amounts.items() if amount})
    weights = 1 / np.maximum(number, SMALLEST)
    counts = np.array([[amounts.get(name, 0.0) for name in names] for amounts, _ in rows]) * weights[:, None]
    scale = counts.max(0)
    ridge = np.eye(len(names)) * RIDGE  # shares between terms that no run tells apart
    solution, _ = nnls(np.vstack([counts / scale, ridge]), np.hstack([number * weights, np.zeros(len(names))]))
    return {TABLES: 1.0} | dict(zip(names, (solution / scale).tolist(), strict=True))


def terms(p: Mapping[str, int], device: Device) -> Terms:
    """Count the terms of each core."""
    counted: defaultdict[str, defaultdict[str, float]] = defaultdict(lambda: defaultdict(float))
    for part in parts(p):
        core = counted[part.core]
        if isinstance(part, Memory):
            if part.rom and _of_luts(part, device):
                core[TABLES] += part.width * math.ceil(part.words / 2**device.lut_inputs)
            elif _of_luts(part, device):
                core["choice"] += part.width * (_tiles(part, device)[0] - 1)
        else:
            core["split"] += (device.multipliers(part.a, part.b) - 1) * (part.a + part.b)
            if part.core.startswith(TRANSFORMS):
                core["product"] += part.a + part.b
    for name, instances, bits in _cores(p):
        if not name.startswith(PROPORTIONAL):
            counted[name][name] += instances
        if not name.endswith("dst_forward"):
            counted[name][f"{name}, bits"] += instances * bits
        if name.startswith(TRANSFORMS):
            butterflies = sum(stage.delay > 0 for stage in stages(p["Columns"], "inverse" in name))
            counted[name][f"{name.rpartition('_')[0]}, butterflies"] += instances * butterflies * bits
    for name in (REST, "contact_events"):
        counted[name][f"{name}, positions"] += (p["Rows"] * p["Columns"]).bit_length()
    counted[REST]["options"] += sum(p[option] for option in OPTIONS)
    if p["Neumann"] and p["Tridiagonal"]:
        counted["forward_elimination" if p["Lanes"] == 1 else "wide_elimination"]["column_mean"] += p["DataWidth"]
    return {name: dict(amounts) for name, amounts in counted.items()}


def _of_luts(memory: Memory, device: Device) -> bool:
    return not any(device.memories(memory.words, memory.width, memory.style, memory.rom).values())


def _tiles(memory: Memory, device: Device) -> tuple[int, int, int]:
    """Return rows and columns of LUT memories in a RAM, and the LUTs of one of them."""
    deep, wide, each = next((ram for ram in device.lut_rams if memory.words <= ram[0]), device.lut_rams[-1])
    return math.ceil(memory.words / deep), math.ceil(memory.width / wide), each


def _cores(p: Mapping[str, int]) -> list[tuple[str, int, int]]:
    """Return core, number of them, and bits of the words that each takes in a clock; all small cores are one."""
    data, down, up, slope, gain = p["DataWidth"], p["DownWords"], p["Lanes"], p["GradientWidth"], p["GainWidth"]
    cores = [(REST, 1, up * data), ("contact_events", 1, up * data), ("divergence", 1, slope)]
    if p["FlatField"]:
        cores += [("flat_field", 1, gain), ("reference_capture", 1, gain)]
    if p["LightGains"]:
        cores.append(("light_gains", 1, 0))
    if p["Polynomial"]:
        cores.append(("polynomial_gradient", 1, 0))
    if p["Corrections"] or not p["Polynomial"]:
        cores.append(("gradient_lookup", 1, CORRECTION_WIDTH if p["Corrections"] else slope))
    if p["ZeroOffset"]:
        cores += [("zero_offset", 1, up * data), ("zero_capture", 1, up * data)]
    if up > 1:
        cores += [(f"wide_{core}", 1, down * data) for core in ("rows", "dst_forward", "elimination")]
        cores.append(("wide_dst_inverse", 1, up // 2 * data))
        return cores + [(f"wide_{core}", 1, up * data) for core in ("stack", "substitution")]
    cores.append(("row_reorder", 2, data))
    once: tuple[str, ...] = ("forward_elimination", "frame_stack", "back_substitution", "dst_forward", "dst_inverse")
    twice: tuple[str, ...] = ()
    if not p["Tridiagonal"]:
        once, twice = ("spectral_divide",), ("dst_forward", "transpose", "dst_inverse")
    return [*cores, *((core, 1, data) for core in once), *((core, 2, data) for core in twice)]
