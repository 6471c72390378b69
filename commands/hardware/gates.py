# SPDX-License-Identifier: Apache-2.0
"""A mapped netlist: read from the JSON of Yosys, cut to a part, written as Verilog for Icarus and OpenSTA."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import cached_property

from commands.hardware.liberty import Cell, Library, boolean
from tactile_depth.errors import InputError

Bit = int | str  # a net's number, or a constant: "0", "1", "x"


@dataclass
class Instance:
    """A cell of the library, or a memory that is a macro (`kind` no cell of it).

    Attributes
    ----------
    path : str
        Of the core that it is in: instance names with dots; "" for the top.
    pins : dict of str to list of Bit, lowest first
    """

    kind: str
    path: str
    pins: dict[str, list[Bit]]


@dataclass
class Netlist:
    """Gates and macros between ports.

    Attributes
    ----------
    ports : dict of str to (str, list of Bit)
        Direction and nets of each.
    instances : list of Instance
        Each is called c with its place in the list.
    """

    name: str
    ports: dict[str, tuple[str, list[Bit]]]
    instances: list[Instance]
    library: Library
    clock: Bit = field(default="x")

    @cached_property
    def gates(self) -> list[tuple[int, Instance, Cell]]:
        cells = self.library.cells
        return [
            (i, instance, cells[instance.kind]) for i, instance in enumerate(self.instances) if instance.kind in cells
        ]

    @cached_property
    def macros(self) -> list[tuple[int, Instance]]:
        return [(i, instance) for i, instance in enumerate(self.instances) if instance.kind not in self.library.cells]

    @cached_property
    def drivers(self) -> dict[Bit, tuple[int, str]]:
        """Of each net that a gate drives: the gate's place and its pin."""
        return {
            instance.pins[pin][0]: (i, pin)
            for i, instance, cell in self.gates
            for pin in cell.outputs
            if pin in instance.pins
        }

    def flip_flops(self) -> list[tuple[int, Instance, Cell]]:
        return [gate for gate in self.gates if gate[2].flip_flop]


def from_yosys(design: dict, top: str, library: Library, clock: str = "clk") -> Netlist:
    """The flat module `top` of Yosys's JSON."""
    module = design["modules"][top]
    ports = {name: (port["direction"], port["bits"]) for name, port in module["ports"].items()}
    instances = [Instance(cell["type"], path_of(name), cell["connections"]) for name, cell in module["cells"].items()]
    netlist = Netlist(top, ports, instances, library, ports[clock][1][0])
    for _, instance, cell in netlist.flip_flops():
        assert cell.flip_flop is not None
        pin = re.sub(r"[\s()!']", "", cell.flip_flop.attributes["clocked_on"])
        if instance.pins[pin][0] != netlist.clock:
            raise RuntimeError(f"a flip-flop in {instance.path or top} has another clock than {clock}")
    return netlist


def path_of(name: str) -> str:
    """The core that a cell is in, from the name that flattening gave it."""
    if name.startswith("$flatten"):
        return ".".join(re.findall(r"\\(.*?)\.(?=\\|\$)", name))
    return name.partition("$")[0].rstrip(".") if "$" in name else name.rpartition(".")[0]


def part(netlist: Netlist, path: str) -> Netlist:
    """The gates of a core and of what is in it, between ports `in` and `out`; its macros stay outside."""
    cells = netlist.library.cells
    inside = [
        instance
        for instance in netlist.instances
        if (instance.path == path or instance.path.startswith(f"{path}.")) and instance.kind in cells
    ]
    mine = {id(instance) for instance in inside}
    driven = {
        instance.pins[pin][0] for instance in inside for pin in cells[instance.kind].outputs if pin in instance.pins
    }
    used = {bits[0] for instance in inside for pin, bits in instance.pins.items() if pin in cells[instance.kind].inputs}
    outside: set[Bit] = {bit for direction, bits in netlist.ports.values() if direction == "output" for bit in bits}
    for instance in netlist.instances:
        if id(instance) not in mine:
            outside.update(bit for bits in instance.pins.values() for bit in bits)
    nets = sorted(bit for bit in used - driven if isinstance(bit, int) and bit != netlist.clock)
    out = sorted(bit for bit in driven & outside if isinstance(bit, int))
    ports: dict[str, tuple[str, list[Bit]]] = {
        "clk": ("input", [netlist.clock]),
        "in": ("input", list(nets)),
        "out": ("output", list(out)),
    }
    return Netlist("part", ports, inside, netlist.library, netlist.clock)


# Verilog.


def _name(bit: Bit) -> str:
    return f"n{bit}" if isinstance(bit, int) else f"1'b{0 if bit == 'x' else bit}"


def _joined(bits: Iterable[Bit]) -> str:
    return "{" + ", ".join(_name(bit) for bit in reversed(list(bits))) + "}"


def expression(cell: Cell, pin: str, pins: dict[str, str]) -> str:
    """What an output pin of a gate without state is, of the nets at its inputs.

    Raises
    ------
    InputError
    """
    function = cell.pins[pin].function
    if not function:
        raise InputError(f"LIB: the cell {cell.name} was used and has no function for its pin {pin}")
    return re.sub(r"(?<![\w'])[A-Za-z_]\w*", lambda match: pins[match[0]], boolean(function))


def state(cell: Cell, pins: dict[str, str]) -> tuple[str, str, str, dict[str, bool]]:
    """Of a flip-flop: the event of its clock, what it takes, and of each output whether it is the inverse.

    Raises
    ------
    InputError
        It has a set or reset that no clock waits for: this design uses none.
    """
    group = cell.flip_flop
    assert group is not None
    inputs = cell.inputs
    asynchronous = [group.attributes[name] for name in ("clear", "preset") if name in group.attributes]
    if any(pins.get(pin, "1'b1") not in ("1'b0", "1'b1") for text in asynchronous for pin in re.findall(r"\w+", text)):
        raise InputError(
            f"LIB: the cell {cell.name} was used with an asynchronous reset, which this flow does not know"
        )
    clocked_on = boolean(group.attributes["clocked_on"])
    edge = "negedge" if "~" in clocked_on else "posedge"
    following = re.sub(r"(?<![\w'])[A-Za-z_]\w*", lambda match: pins[match[0]], boolean(group.attributes["next_state"]))
    clock = next(pin for pin in inputs if pin in clocked_on)
    outputs = {}
    for name in cell.outputs:
        function = re.sub(r"[\s()]", "", cell.pins[name].function)
        outputs[name] = (function.strip("!'") == group.names[1]) != ("!" in function or "'" in function)
    return edge, clock, following, outputs


def header(netlist: Netlist) -> list[str]:
    """The module's ports."""
    declared = [
        f"  {direction} {f'[{len(bits) - 1}:0] ' if len(bits) > 1 or name in ('in', 'out') else ''}{name}"
        for name, (direction, bits) in netlist.ports.items()
    ]
    return [f"module {netlist.name} (", ",\n".join(declared), ");"]


def _nets(netlist: Netlist) -> list[str]:
    bits = {bit for _, port in netlist.ports.values() for bit in port}
    for instance in netlist.instances:
        for pins in instance.pins.values():
            bits.update(pins)
    return [f"n{bit}" for bit in sorted(bit for bit in bits if isinstance(bit, int))]


def ports(netlist: Netlist) -> list[str]:
    """Assignments between ports and nets."""
    lines = []
    for name, (direction, bits) in netlist.ports.items():
        for i, bit in enumerate(bits):
            port = f"{name}[{i}]" if len(bits) > 1 or name in ("in", "out") else name
            lines.append(
                f"  assign {_name(bit)} = {port};" if direction == "input" else f"  assign {port} = {_name(bit)};"
            )
    return lines


def macro_lines(netlist: Netlist) -> list[str]:
    return [
        f"  {instance.kind} c{i} ({', '.join(f'.{pin}({_joined(bits)})' for pin, bits in instance.pins.items())});"
        for i, instance in netlist.macros
    ]


def structural(netlist: Netlist, power_up: dict[Bit, str] | None = None) -> str:
    """Instances of the library's cells; `power_up` gives what flip-flops hold at the start, by the net they drive."""
    lines = header(netlist)
    lines += [f"  wire {net};" for net in _nets(netlist)] + ports(netlist) + macro_lines(netlist)
    for i, instance, cell in netlist.gates:
        given = ""
        if power_up is not None and cell.flip_flop:
            inverse = state(cell, dict.fromkeys(cell.inputs, "1'b0"))[3]
            for pin, inverted in inverse.items():
                value = power_up.get(instance.pins[pin][0]) if pin in instance.pins else None
                if value is not None:
                    given = f" #(.Start(1'b{int(value) ^ inverted}))"
        pins = ", ".join(f".{pin}({_name(bits[0])})" for pin, bits in instance.pins.items())
        lines.append(f"  {instance.kind}{given} c{i} ({pins});")
    return "\n".join([*lines, "endmodule", ""])


def cell_models(netlist: Netlist, timed: bool) -> str:
    """The library's cells that a netlist uses, as Verilog; `timed`: with paths for a file of delays (SDF)."""
    lines = ["`timescale 1ns/1ps"]
    used = {cell.name: cell for _, _, cell in netlist.gates}
    for cell in used.values():
        names = {name: name for name in cell.pins}
        lines.append(f"module {cell.name} {'#(parameter Start = 1' + chr(39) + 'bx) ' if cell.flip_flop else ''}(")
        lines.append(
            ",\n".join(f"  {cell.pins[name].direction} {name}" for name in (*cell.inputs, *cell.outputs)) + ");"
        )
        if cell.flip_flop:
            edge, clock, following, inverse = state(cell, dict(names) | _tied(cell))
            lines += ["  reg held;", "  initial held = Start;", f"  always @({edge} {clock}) held <= {following};"]
            lines += [f"  assign {pin} = {'~' if inverted else ''}held;" for pin, inverted in inverse.items()]
        else:
            lines += [f"  assign {pin} = {expression(cell, pin, names)};" for pin in cell.outputs]
        if timed:
            paths = [f"    ({cause} => {pin}) = (0, 0);" for pin in cell.outputs for cause in cell.pins[pin].related]
            lines += ["  specify", *paths, "  endspecify"]
        lines.append("endmodule")
    return "\n".join([*lines, ""])


def _tied(cell: Cell) -> dict[str, str]:
    """Asynchronous inputs of a flip-flop, which `state` has seen to be constant."""
    assert cell.flip_flop is not None
    text = " ".join(cell.flip_flop.attributes.get(name, "") for name in ("clear", "preset"))
    return dict.fromkeys(re.findall(r"\w+", text), "1'b1")
