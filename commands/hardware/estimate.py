# SPDX-License-Identifier: Apache-2.0
"""Estimate at 45 nm from recorded figures of the logic, and the published figures. `make asic` measures neither."""

from typing import NamedTuple

from commands.common import published
from commands.hardware import memory_model

SOURCE = "NanGate FreePDK45, typical corner, version 0.1.0, 2026-11-23"
PUBLISHED = (
    f"published, {published.CLOCK_MHZ:g} MHz",
    published.ASIC_AREA_MM2,
    published.ASIC_POWER_MW,
    "docs/results.md: NanGate FreePDK45, typical corner, single-port SRAM by CACTI and bsg_fakeram, another "
    "pipeline; here one figure per bit of memory, a write and a read port each, no wires and no clock tree",
)


class Recorded(NamedTuple):
    """Logic of a design of 128 x 128 at 45 nm and published.CLOCK_MHZ, and its memories."""

    logic_mm2: float
    logic_mw: tuple[float, float]  # with delays, least and greatest
    memory_bits: int
    accessed_bits_per_clock: float  # by `make asic` with Debian's library; no library changes it
    multipliers: int  # 27 x 18 bits, as LUTs by `make synth TARGET=xczu7ev` of that RTL
    luts: int


RECORDED = {
    "tridiagonal": Recorded(0.227, (88.0, 91.0), 865_095, 1323.8, 32, 10_194),
    "spectral": Recorded(0.41, (178.0, 185.0), 1_420_403, 2044.0, 61, 16_997),
}


def at_45_nm(solver: str) -> tuple[str, float, float, str]:
    """Return name, area in mm2, power in mW and source: recorded logic and the memory model."""
    logic = RECORDED[solver]
    area_mm2 = logic.logic_mm2 + memory_model.area_um2(logic.memory_bits, memory_model.NODE_NM) / 1e6
    access_pj = memory_model.energy_pj(logic.accessed_bits_per_clock, memory_model.NODE_NM, memory_model.VOLTAGE)
    power_mw = sum(logic.logic_mw) / 2 + access_pj * published.CLOCK_MHZ / 1e3
    name = f"45 nm estimate, {solver}, 128 x 128, {published.CLOCK_MHZ:g} MHz"
    return name, area_mm2, power_mw, f"not of this run: logic recorded with {SOURCE}; memory model"
