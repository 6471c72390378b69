# SPDX-License-Identifier: Apache-2.0
"""Area and energy of memory macros, low and high: there is no memory compiler to ask, so published macros bound them.

Low: a foundry's cell under other people's circuits.
  Area: six-transistor cell of 2.28 um2 in 0.13 um (UMC, 2000: design-reuse.com/news/?id=1611), 135 squares of the
  feature size; less than 0.25 um2 in 45 nm (UMC, 2006) is 123, 0.122 um2 in 28 nm (UMC, 2008) 156. Cells are taken to
  be 70 % of a macro.
  Energy: 10 pJ for 64 bits out of 8 KiB, 20 out of 32 KiB, 100 out of 1 MiB, in 45 nm at 0.9 V (M. Horowitz,
  Computing's energy problem, ISSCC 2014): all three are 10 pJ sqrt(size / 8 KiB), here per bit. One port, for reads
  and writes by turns.
High: macros that anyone can have, gf180mcu_fd_ip_sram of the open 180 nm process of GlobalFoundries: six transistors
  for 5 V in 13.5 um2, one port. Area and energy at 1.8 V, typical, 25 C, as their Liberty files give them for 64 x 8
  and 512 x 8, linear between the two. Wider words take several side by side, deeper ones several of which one is
  enabled.

Both go with feature size (area F^2, energy F) and voltage (energy V^2). Leakage and speed are not modelled. A ROM is
taken to be a RAM that is not written: too much, for a bit of ROM is one transistor.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

MACRO_BITS = 1024  # above this a memory is a macro: about where flip-flops grow larger than the dearest macro

CELL_SQUARES = 2.28 / 0.13**2
CELL_SHARE = 0.7
LOW_PJ, LOW_WORD, LOW_BITS = 10.0, 64, 8 * 8192
LOW_NM, LOW_VOLT = 45.0, 0.9

HIGH_NM, HIGH_VOLT = 180.0, 1.8
HIGH_WIDTH = 8
HIGH_WORDS = (64, 512)
HIGH_UM2 = (100_571.5568, 209_400.2768)
HIGH_READ_PJ = (2 * 84.3399, 2 * 103.176)  # both edges of the clock
HIGH_WRITE_PJ = (2 * 92.043, 2 * 112.563)


@dataclass(frozen=True)
class Range:
    low: float
    high: float

    def __add__(self, other: Range) -> Range:
        return Range(self.low + other.low, self.high + other.high)

    def __mul__(self, factor: float) -> Range:
        return Range(self.low * factor, self.high * factor)


def _banks(width: int, depth: int) -> tuple[int, int, int]:
    """(side by side, on end, words of each) macros of the high model."""
    deep = -(-depth // HIGH_WORDS[1])
    return -(-width // HIGH_WIDTH), deep, max(-(-depth // deep), HIGH_WORDS[0])


def _between(values: tuple[float, float], words: int) -> float:
    share = (words - HIGH_WORDS[0]) / (HIGH_WORDS[1] - HIGH_WORDS[0])
    return values[0] + share * (values[1] - values[0])


def area_um2(width: int, depth: int, node_nm: float) -> Range:
    """Of a macro of `depth` words of `width` bits in a process of `node_nm`."""
    low = width * depth * CELL_SQUARES / CELL_SHARE * (node_nm / 1000) ** 2
    wide, deep, words = _banks(width, depth)
    return Range(low, wide * deep * _between(HIGH_UM2, words) * (node_nm / HIGH_NM) ** 2)


def energy_pj(width: int, depth: int, node_nm: float, voltage: float, write: bool) -> Range:
    """Of one access to a word."""
    per_bit = LOW_PJ / LOW_WORD * math.sqrt(width * depth / LOW_BITS)
    low = width * per_bit * node_nm / LOW_NM * (voltage / LOW_VOLT) ** 2
    wide, _, words = _banks(width, depth)
    bank = _between(HIGH_WRITE_PJ if write else HIGH_READ_PJ, words)
    return Range(low, wide * bank * node_nm / HIGH_NM * (voltage / HIGH_VOLT) ** 2)


UNITS = ['  time_unit : "1ns";', '  voltage_unit : "1V";', '  current_unit : "1mA";', "  capacitive_load_unit (1,pf);"]
THRESHOLDS = [
    f"  {kind}_threshold_pct_{edge} : {percent};"
    for kind, percent in (("input", 50), ("output", 50), ("slew_lower", 20), ("slew_upper", 80))
    for edge in ("rise", "fall")
]


def liberty(macros: dict[str, dict[str, tuple[str, int]]], pin_picofarad: float) -> str:
    """Liberty cells for OpenSTA: ports with their direction and width; no time passes in them.

    What a path into or out of a memory has left in a clock is then what the macro may take to set up or to read.
    """
    lines = ["library(macros) {", "  delay_model : table_lookup;", *UNITS, *THRESHOLDS]
    widths = sorted({width for ports in macros.values() for _, width in ports.values()})
    for width in widths:
        lines.append(
            f"  type (bus{width}) {{ base_type : array; data_type : bit; bit_width : {width}; bit_from : {width - 1}; "
            "bit_to : 0; downto : true; }"
        )
    zero = '(scalar) { values ("0"); }'
    for name, ports in macros.items():
        lines.append(f"  cell({name}) {{ area : 0; interface_timing : true;")
        for port, (direction, width) in ports.items():
            group = f"bus({port}) {{ bus_type : bus{width};" if width > 1 else f"pin({port}) {{"
            if port == "clk":
                timing = "clock : true;"
            elif direction == "output":
                timing = "timing() { related_pin : clk; timing_type : rising_edge; " + " ".join(
                    f"{table}{zero}" for table in ("cell_rise", "cell_fall", "rise_transition", "fall_transition")
                ) + " }"  # fmt: skip
            else:
                tables = f"rise_constraint{zero} fall_constraint{zero}"
                timing = f"timing() {{ related_pin : clk; timing_type : setup_rising; {tables} }}"
            capacitance = f"capacitance : {pin_picofarad};" if direction == "input" else ""
            lines.append(f"    {group} direction : {direction}; {capacitance} {timing} }}")
        lines.append("  }")
    return "\n".join([*lines, "}", ""])
