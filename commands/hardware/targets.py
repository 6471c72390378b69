# SPDX-License-Identifier: Apache-2.0
"""Devices of `make synth`: what each has, Yosys' steps to it, and the resources that its cells are.

XCZU7EV: every design is mapped twice at the same time. The mapping to UltraScale+ ends at multipliers and memories:
DSP48E2, block RAM, UltraRAM. LUTs and registers come from a mapping to 7-series logic, the only one for which Yosys
packs registers and adders into multipliers; its DSP gets the 27 x 18 bits of a DSP48E2. Artix-7 and Zynq-7000: one
mapping to 7-series cells; memories that are UltraRAM elsewhere are block RAM. LFE5U-85F: the synthesis of `make fpga`;
a carry cell is two LUTs there, and a memory of 16 x 4 bits is four, as nextpnr counts them.
"""

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from commands.common import repository
from commands.cost.devices import ECP5, XC7A35T, XC7A100T, XC7Z020, XCZU7EV, Device

LOGIC, MEMORY, SHIFT = "LUT as logic", "LUT as memory", "LUT as shift register"
Cells = Mapping[str, tuple[str, float]]  # resource and number of it, by cell


@dataclass(frozen=True)
class Target:
    """A device, its resources, and its mappings: lines of Yosys after reading, and the cells that count.

    `plain` names the memories that are counted by the plain rule of commands/hardware/fpga_memory.py, and `delays` are
    lines that make a mapped design ready for Yosys' `sta`; without them the target has no logic depth.
    """

    device: Device
    has: Mapping[str, int]
    mappings: Mapping[str, Sequence[str]]
    cells: Mapping[str, Cells]
    notes: tuple[str, ...]
    plain: tuple[str, ...] = ()
    delays: tuple[str, ...] = ()

    def sources(self) -> list[Path]:
        """Return the sources that replace cores of hdl/."""
        return repository.TECHNOLOGY if self.device == ECP5 else []

    @property
    def memory_bits(self) -> int:
        """Bits of all block memories."""
        ultra = math.prod(self.device.ultra_shape) * self.has["UltraRAM"] if self.device.ultra_shape else 0
        return math.prod(self.device.block_shapes[0]) * self.has[self.device.block] + ultra

    def shares(self, multipliers: float, luts: float, memory_bits: float) -> tuple[float, float, float]:
        """Return the fractions of multipliers, LUTs and memory bits that a design takes of the device."""
        have = self.has[self.device.multiplier], self.has["LUT"], self.memory_bits
        return multipliers / have[0], luts / have[1], memory_bits / have[2]

    def counts(self, mapped: Mapping[str, Counter[str]], modules: Sequence[str]) -> dict[str, float]:
        """Return the resources of a module from its cells in each mapping.

        Raises RuntimeError: a cell of the last mapping, which is complete, has no count.
        """
        last = list(self.mappings)[-1]
        known = {*self.cells[last], *modules}
        if strange := sorted(cell for cell in mapped[last] if cell not in known and not cell.startswith("$")):
            raise RuntimeError(f"Yosys put in cells that commands/hardware/targets.py does not count: {strange}")
        totals = dict.fromkeys((*self.has, LOGIC, MEMORY, SHIFT), 0.0)
        for mapping, cells in self.cells.items():
            for cell, (resource, number) in cells.items():
                if resource:
                    totals[resource] += number * mapped[mapping][cell]
        return totals | {"LUT": totals[LOGIC] + totals[MEMORY] + totals[SHIFT]}


def _each(resource: str, *cells: str, number: float = 1) -> dict[str, tuple[str, float]]:
    return dict.fromkeys(cells, (resource, number))


LOGIC_OF_7_SERIES = (
    _each(LOGIC, *(f"LUT{inputs}" for inputs in range(1, 7)), "INV")  # it may go into the next LUT
    | _each(SHIFT, "SRL16E", "SRLC32E")
    | _each(MEMORY, "RAM32X1S", "RAM64X1S")
    | _each(MEMORY, "RAM128X1S", "RAM32X1D", "RAM64X1D", number=2)
    | _each(MEMORY, "RAM256X1S", "RAM128X1D", "RAM32M", "RAM64M", number=4)
    | _each("FF", "FDRE", "FDSE", "FDCE", "FDPE")
    | _each("", "CARRY4", "MUXF7", "MUXF8")
)
DELAYS_OF_7_SERIES = (
    "setattr -mod -unset keep_hierarchy *",
    "flatten -noscopeinfo",  # sta follows no path into another module
    "autoname",
    # The mapping ends with bare boxes for registers and carries, so the library is read again for their delays.
    "delete =$paramod*",
    "read_verilog -overwrite -lib -specify +/xilinx/cells_sim.v",
)
XILINX = "synth_xilinx -flatten -noiopad -noclkbuf"
DEFAULT_TARGET = "xczu7ev"
TARGETS = {
    DEFAULT_TARGET: Target(
        XCZU7EV,
        {"DSP48E2": 1728, "BRAM36": 312, "UltraRAM": 96, "LUT": 230_400, "FF": 460_800},
        {
            "device": [f"{XILINX} -family xcup -uram -run begin:map_ffram"],
            "logic": [
                f"{XILINX} -family xc7 -run begin:map_dsp",
                "memory_dff",
                "alumacc -macc-only",
                "maccmap -unmap",
                "opt_clean",
                "techmap -map +/mul2dsp.v -map wide_dsp.v -D DSP_A_MAXWIDTH=27 -D DSP_B_MAXWIDTH=18 "
                "-D DSP_A_MAXWIDTH_PARTIAL=18 -D DSP_A_MINWIDTH=2 -D DSP_B_MINWIDTH=2 -D DSP_Y_MINWIDTH=9 "
                "-D DSP_SIGNEDONLY=1 -D DSP_NAME=$__MUL27X18",
                "select a:mul2dsp",
                "setattr -unset mul2dsp",
                "opt_expr -fine",
                "wreduce",
                "select -clear",
                "xilinx_dsp -family xc7",
                "chtype -set $mul t:$__soft_mul",
                f"{XILINX} -family xc7 -run coarse:edif",
            ],
        },
        {
            "device": _each("DSP48E2", "DSP48E2")
            | _each("UltraRAM", "URAM288")
            | _each("BRAM36", "RAMB36E2")
            | _each("BRAM36", "RAMB18E2", number=0.5),
            "logic": LOGIC_OF_7_SERIES | _each("", "DSP48E1", "RAMB36E1", "RAMB18E1"),
        },
        (
            "LUT, FF: before placement, each core by itself; an inverter is a LUT, and no two functions share one.",
            "Registers beside multipliers are packed as a 7-series DSP takes them, the closest that Yosys knows.",
            "UltraRAM, BRAM36: the plain rule, 4,096 x 72 bits and the widths of a block RAM; 'mapped' is Yosys, which "
            "packs several words into a row of an UltraRAM where Vivado does not.",
            "Logic depth: by Yosys' delays of 7-series cells, without wires, across the cores.",
            "No clock: nothing is placed or routed. constraints/xczu7ev_ooc.tcl does that with Vivado.",
        ),
        ("UltraRAM", "BRAM36"),
        DELAYS_OF_7_SERIES,
    ),
    "ecp5": Target(
        ECP5,
        {"MULT18X18D": 156, "DP16KD": 208, "LUT": 83_640, "FF": 83_640},
        {"logic": ["synth_ecp5"]},
        {
            "logic": _each(LOGIC, "LUT4")
            | _each(LOGIC, "CCU2C", number=2)
            | _each(MEMORY, "TRELLIS_DPR16X4", number=4)
            | _each("FF", "TRELLIS_FF")
            | _each("MULT18X18D", "MULT18X18D")
            | _each("DP16KD", "DP16KD")
            | _each("", "PFUMX", "L6MUX21"),
        },
        (
            "LUT, FF: before placement, each core by itself. Registers in multipliers count too.",
            "No clock: see make fpga.",
        ),
    ),
}
"""Devices that the cost model knows."""


def _of_7_series(device: Device, multipliers: int, blocks: int, luts: int) -> Target:
    """Return the target of a device of the 7 series, which has two registers beside each LUT."""
    return Target(
        device,
        {"DSP48E1": multipliers, "BRAM36": blocks, "LUT": luts, "FF": 2 * luts},
        {"logic": ['setattr -set ram_style "block" m:* a:ram_style=ultra %i', f"{XILINX} -family xc7"]},
        {
            "logic": LOGIC_OF_7_SERIES
            | _each("DSP48E1", "DSP48E1")
            | _each("BRAM36", "RAMB36E1")
            | _each("BRAM36", "RAMB18E1", number=0.5)
        },
        (
            "LUT, FF: before placement, each core by itself; an inverter is a LUT, and no two functions share one.",
            "Logic depth: by Yosys' delays of 7-series cells, without wires, across the cores.",
            "No clock: nothing is placed or routed. The cost model has no LUTs of this device.",
        ),
        delays=DELAYS_OF_7_SERIES,
    )


SEVEN_SERIES = {
    "xc7a35t": _of_7_series(XC7A35T, 90, 50, 20_800),
    "xc7a100t": _of_7_series(XC7A100T, 240, 135, 63_400),
    "xc7z020": _of_7_series(XC7Z020, 220, 140, 53_200),
}
"""Devices of `make synth` alone."""
