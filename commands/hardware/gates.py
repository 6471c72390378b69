# SPDX-License-Identifier: Apache-2.0
"""A mapped netlist: read from the JSON of Yosys, written as Verilog for OpenSTA."""

import re
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from commands.hardware.liberty import Cell, Library, pins_of, truth
from tactile_depth.base.errors import InputError

Bit = int | str  # number of a net, or a constant: "0", "1", "x"


@dataclass
class Instance:
    """A cell of the library, or a memory macro, whose `kind` is no cell.

    `path` is the core that holds it, instance names with dots, "" for the top. `pins` are lists of nets, lowest first.
    """

    kind: str
    path: str
    pins: dict[str, list[Bit]]


@dataclass
class Netlist:
    """Gates and macros between ports, which have a direction and nets; instance number i is called c<i>.

    `high` are the nets of registers that begin with 1: small memories are registers, and have their contents.
    """

    name: str
    ports: dict[str, tuple[str, list[Bit]]]
    instances: list[Instance]
    library: Library
    clock: Bit
    high: list[Bit] = field(default_factory=list)

    @cached_property
    def gates(self) -> list[tuple[int, Instance, Cell]]:
        """Return index, instance and cell of each gate, flip-flops included."""
        cells = self.library.cells
        return [(i, gate, cells[gate.kind]) for i, gate in enumerate(self.instances) if gate.kind in cells]

    @cached_property
    def macros(self) -> list[Instance]:
        """Return the memory macros."""
        return [instance for instance in self.instances if instance.kind not in self.library.cells]

    @cached_property
    def memory_nets(self) -> tuple[list[Bit], list[Bit]]:
        """Return the nets of the outputs of all macros, and of their inputs without the clock, one for each pin."""
        pins = [(name, bit) for macro in self.macros for name, bits in macro.pins.items() for bit in bits]
        outputs = [bit for name, bit in pins if name in ("read_data", "data")]
        return outputs, [bit for name, bit in pins if name not in ("clk", "read_data", "data")]


def from_yosys(design: dict[str, Any], top: str, library: Library) -> Netlist:
    """Return the flat module `top` of Yosys's JSON."""
    module = design["modules"][top]
    ports = {name: (port["direction"], port["bits"]) for name, port in module["ports"].items()}
    instances = [Instance(cell["type"], path_of(name), cell["connections"]) for name, cell in module["cells"].items()]
    starts = [(net["bits"], net["attributes"].get("init", "")) for net in module["netnames"].values()]
    high = {bit for bits, words in starts for bit, start in zip(bits, reversed(words), strict=False) if start == "1"}
    netlist = Netlist(top, ports, instances, library, ports["clk"][1][0], [bit for bit in high if isinstance(bit, int)])
    for _, instance, cell in netlist.gates:
        if cell.flip_flop and instance.pins[clock_pin(cell)][0] != netlist.clock:
            raise RuntimeError(f"a flip-flop in {instance.path or top} has another clock than clk")
    return netlist


def path_of(name: str) -> str:
    """Return the path of the core that holds a cell, from the name that flattening gave it."""
    if name.startswith("$flatten"):
        return ".".join(re.findall(r"\\(.*?)\.(?=\\|\$)", name))
    return name.partition("$")[0].rstrip(".") if "$" in name else name.rpartition(".")[0]


def clock_pin(cell: Cell) -> str:
    """Return the clock pin of a flip-flop. Raises InputError for falling edges and for an asynchronous reset."""
    assert cell.flip_flop is not None
    attributes = cell.flip_flop.attributes
    if "clear" in attributes or "preset" in attributes:
        raise InputError(f"LIB: the cell {cell.name} was used, a flip-flop with an asynchronous reset")
    pins = pins_of(attributes["clocked_on"])
    if len(pins) != 1 or truth(attributes["clocked_on"], pins) != 0b10:
        raise InputError(f"LIB: the cell {cell.name} was used, a flip-flop that works not on rising edges of a pin")
    return pins[0]


def verilog(netlist: Netlist) -> str:
    """Return the gates as Verilog; memories lie outside, between the ports to_memory and from_memory."""
    from_memory, to_memory = netlist.memory_nets
    ports = dict(netlist.ports)
    if netlist.macros:
        ports |= {"from_memory": ("input", from_memory), "to_memory": ("output", to_memory)}
    declared, lines = [], []
    nets = {bit for _, bits in ports.values() for bit in bits}
    for name, (direction, bits) in ports.items():
        declared.append(f"  {direction} {f'[{len(bits) - 1}:0] ' if len(bits) > 1 else ''}{name}")
        for i, bit in enumerate(bits):
            sides = [_name(bit), f"{name}[{i}]" if len(bits) > 1 else name]
            lines.append("  assign {} = {};".format(*(sides if direction == "input" else sides[::-1])))
    for i, instance, _ in netlist.gates:
        nets.update(bits[0] for bits in instance.pins.values())
        pins = ", ".join(f".{pin}({_name(bits[0])})" for pin, bits in instance.pins.items())
        lines.append(f"  {instance.kind} c{i} ({pins});")
    wires = [f"  wire n{bit};" for bit in sorted(bit for bit in nets if isinstance(bit, int))]
    return "\n".join([f"module {netlist.name} (", ",\n".join(declared), ");", *wires, *lines, "endmodule", ""])


def _name(bit: Bit) -> str:
    return f"n{bit}" if isinstance(bit, int) else f"1'b{0 if bit == 'x' else bit}"
