# SPDX-License-Identifier: Apache-2.0
"""LUTs of a configuration: what is counted in its parameters, times coefficients fitted to runs of `make synth`.

Counted for each core: LUTs of its small memories, bits of its products, butterflies and words. The coefficients are
computed from luts.json, which `python -m commands.hardware.lut_runs` writes: non-negative least squares over the cores
of all runs. docs/hardware.md states the error on other runs.
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

from tactile_depth.configuration import CORRECTION_WIDTH, GUARD_BITS, Configuration
from tactile_depth.devices import Device
from tactile_depth.parts import Memory, parts
from tactile_depth.poisson.transform.sdf_fft import stages
from tactile_depth.tactile_depth import top_parameters

RUNS = Path(__file__).with_name("luts.json")
REST = "small cores"
SMALLEST = 100  # LUTs: smaller cores have no more weight in the fit

Terms = dict[tuple[str, str], float]  # amount by core and term


def _memory_luts(memory: Memory, device: Device) -> dict[str, float]:
    """Return the LUTs of a memory that is no block memory, and the bits of the choice between its parts."""
    width, words = memory.width, memory.words
    if any(device.memories(words, width, memory.style, memory.rom).values()):
        return {}
    if memory.rom:
        return {"rom": width * math.ceil(words / 2**device.lut_inputs)}
    deep, wide, luts = next((ram for ram in device.lut_rams if words <= ram[0]), device.lut_rams[-1])
    rows = math.ceil(words / deep)
    return {"ram": rows * math.ceil(width / wide) * luts, "choice": width * (rows - 1)}


def terms(p: Mapping[str, int], device: Device) -> Terms:
    """Count the terms of each core of a configuration from its parameters, as `top_parameters` returns them."""
    counted: defaultdict[tuple[str, str], float] = defaultdict(float)
    for part in parts(p):
        if isinstance(part, Memory):
            for term, amount in _memory_luts(part, device).items():
                counted[part.core, term] += amount
        else:
            counted[part.core, "product"] += part.a + part.b
            counted[part.core, "split"] += (device.multipliers(part.a, part.b) - 1) * (part.a + part.b)
    for core, instances, bits in _cores(p):
        counted[core, core] += instances
        counted[core, f"{core} word"] += instances * bits
        for term in BUTTERFLIES.get(core, ()):
            paths = p["DownWords"] if "forward" in core else max(1, p["Lanes"] // 2)
            each = sum(stage.delay > 0 for stage in stages(p["Columns"], False))
            counted[core, term] += (
                instances * each * (p["DataWidth"] + GUARD_BITS + 1) * (paths if "wide" in core else 1)
            )
    return counted


BUTTERFLIES = {
    "dst_forward": ("butterfly",),
    "dst_inverse": ("butterfly",),
    "wide_dst_forward": ("wide butterfly",),
    "wide_dst_inverse": ("wide butterfly",),
}


def _cores(p: Mapping[str, int]) -> list[tuple[str, int, int]]:
    """Return core, number of them, and bits of the words that each takes in a clock; all small cores are one."""
    data, down, up, slopes = p["DataWidth"], p["DownWords"], p["Lanes"], p["GradientWidth"]
    cores = [(REST, 1, up * data), ("contact_events", 1, up * data), ("divergence", 1, slopes)]
    if p["FlatField"]:
        cores += [("flat_field", 1, p["GainWidth"]), ("reference_capture", 1, p["GainWidth"])]
    if p["LightGains"]:
        cores.append(("light_gains", 1, 0))
    if p["Polynomial"]:
        cores.append(("polynomial_gradient", 1, p["Corrections"]))
    if p["Corrections"] or not p["Polynomial"]:
        cores.append(("gradient_lookup", 1, CORRECTION_WIDTH if p["Corrections"] else slopes))
    if p["ZeroOffset"]:
        cores += [("zero_offset", 1, up * data), ("zero_capture", 1, up * data)]
    if up > 1:
        cores += [(f"wide_{core}", 1, down * data) for core in ("rows", "dst_forward", "elimination")]
        return cores + [(f"wide_{core}", 1, up * data) for core in ("stack", "substitution", "dst_inverse")]
    cores.append(("row_reorder", 2, data))
    if p["Tridiagonal"]:
        solver = ("dst_forward", "forward_elimination", "frame_stack", "back_substitution", "dst_inverse")
        return cores + [(core, 1, data) for core in solver]
    return (
        cores
        + [(core, 2, data) for core in ("dst_forward", "transpose", "dst_inverse")]
        + [("spectral_divide", 1, data)]
    )


def grouped(luts_by_core: Mapping[str, float], p: Mapping[str, int]) -> dict[str, float]:
    """Return LUTs by core, those of the small cores together."""
    names = {core for core, _, _ in _cores(p)}
    found: defaultdict[str, float] = defaultdict(float)
    for core, number in luts_by_core.items():
        found[core if core in names else REST] += number
    return dict(found)


@cache
def coefficients(device: Device) -> dict[str, float]:
    """Return LUTs for each term, fitted to the runs of a device."""
    rows = []
    for run in json.loads(RUNS.read_text()):
        if run["device"] == device.name:
            p = top_parameters(Configuration(**run["configuration"]))
            rows += [(amounts, run["luts"].get(core, 0)) for core, amounts in by_core(terms(p, device)).items()]
    names = sorted({name for amounts, _ in rows for name in amounts})
    counts = np.array([[amounts.get(name, 0.0) for name in names] for amounts, _ in rows])
    luts = np.array([luts for _, luts in rows])
    weights = 1 / np.maximum(luts, SMALLEST)
    scale = np.abs(counts * weights[:, None]).max(0) + 1e-12
    solution, _ = nnls(counts * weights[:, None] / scale, luts * weights)
    return dict(zip(names, solution / scale, strict=True))


def by_core(counted: Terms) -> dict[str, dict[str, float]]:
    """Return the terms of each core."""
    cores: defaultdict[str, dict[str, float]] = defaultdict(dict)
    for (core, term), amount in counted.items():
        cores[core][term] = amount
    return cores


def luts(p: Mapping[str, int], device: Device) -> dict[str, float]:
    """Return the LUTs of each core of a configuration on a device."""
    fitted = coefficients(device)
    return {
        core: sum(fitted.get(term, 0.0) * amount for term, amount in amounts.items())
        for core, amounts in by_core(terms(p, device)).items()
    }
