# SPDX-License-Identifier: Apache-2.0
"""Power of a mapped netlist from how often its nets toggle, by the tables of its library.

For each transition of a gate's output: half of C V^2 of the pins it drives (no wires), and the cell's own energy at
that load and the slew of its inputs, the mean of a rise and a fall and of the pins that may have caused it. For each
transition of an input: what the cell takes whether or not its output moves. For each clock of a flip-flop: both edges
of its clock pin. Leakage as the library states it, at its temperature.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass

from commands.hardware.gates import Bit, Netlist
from commands.hardware.liberty import Arc, Library

FANOUT = 4  # inverters: the load of an output port and of a macro's pin, and what the typical slew comes from


@dataclass
class Power:
    """In watts.

    Attributes
    ----------
    clock : clock pins of flip-flops: their capacitance and what the cells take at both edges
    internal : other energy inside cells
    switching : capacitances of the pins driven
    leakage : float
    """

    clock: float = 0.0
    internal: float = 0.0
    switching: float = 0.0
    leakage: float = 0.0

    def __add__(self, other: Power) -> Power:
        return Power(*(a + b for a, b in zip(self.parts(), other.parts(), strict=True)))

    def parts(self) -> tuple[float, float, float, float]:
        return self.clock, self.internal, self.switching, self.leakage

    @property
    def data(self) -> float:
        """What goes with the toggles of nets that are not the clock."""
        return self.internal + self.switching

    @property
    def total(self) -> float:
        return sum(self.parts())


def typical(library: Library) -> tuple[float, float]:
    """(load, slew) of an inverter that drives FANOUT of itself, driven by such a one."""
    inverter = library.inverter()
    load = FANOUT * inverter.pins[inverter.inputs[0]].capacitance
    tables = inverter.pins[inverter.outputs[0]].slews
    slew = 0.0
    for _ in range(8):  # settles in three
        slew = sum(table.at(load=load, slew=slew) for table in tables) / len(tables) if tables else 0.0
    return load, slew


def loads(netlist: Netlist) -> Counter[Bit]:
    """Capacitance on each net, in the library's unit."""
    outside, _ = typical(netlist.library)
    load: Counter[Bit] = Counter()
    for _, instance, cell in netlist.gates:
        for pin, bits in instance.pins.items():
            if cell.pins[pin].direction == "input":
                load[bits[0]] += cell.pins[pin].capacitance
    driven = set(netlist.drivers)
    for _, instance in netlist.macros:
        for bits in instance.pins.values():
            for bit in bits:
                if bit in driven:  # an input of the macro
                    load[bit] += outside
    for direction, bits in netlist.ports.values():
        if direction == "output":
            for bit in bits:
                load[bit] += outside
    return load


def _energy(arcs: list[Arc], load: float, slews: Mapping[str, float], otherwise: float) -> float:
    """Of one transition: the mean over causes, of each the mean over its conditions."""
    causes: dict[str, list[float]] = {}
    for arc in arcs:
        energy = arc.energy(load=load, slew=slews.get(arc.related, otherwise))
        causes.setdefault(arc.related, []).append(energy)
    return sum(sum(energies) / len(energies) for energies in causes.values()) / len(causes) if causes else 0.0


def power_of(netlist: Netlist, toggles: Mapping[Bit, float], clock_hz: float) -> list[Power]:
    """Of each gate of `netlist.gates`; `toggles` are transitions of each net per clock, its clock's are 2."""
    library = netlist.library
    load = loads(netlist)
    _, usual_slew = typical(library)
    slew: dict[Bit, float] = {}
    for _, instance, cell in netlist.gates:
        for pin in cell.outputs:
            tables = cell.pins[pin].slews
            if pin in instance.pins and tables:
                net = instance.pins[pin][0]
                slew[net] = sum(table.at(load=load[net], slew=usual_slew) for table in tables) / len(tables)
    per_capacitance = 0.5 * library.farad * library.voltage**2 * clock_hz
    per_energy = library.joule * clock_hz
    result = []
    for _, instance, cell in netlist.gates:
        power = Power(leakage=cell.leakage * library.watt)
        at_pins = {name: slew.get(bits[0], usual_slew) for name, bits in instance.pins.items()}
        for name, bits in instance.pins.items():
            pin, net = cell.pins[name], bits[0]
            if pin.direction == "output":
                rate = toggles.get(net, 0.0)
                power.switching += rate * per_capacitance * load[net]
                if rate and pin.energy:
                    power.internal += rate * per_energy * _energy(pin.energy, load[net], at_pins, usual_slew)
            elif net == netlist.clock:
                power.clock += 2 * per_capacitance * pin.capacitance
                power.clock += 2 * per_energy * _energy(pin.energy, 0.0, at_pins, usual_slew)
            elif pin.energy:
                power.internal += toggles.get(net, 0.0) * per_energy * _energy(pin.energy, 0.0, at_pins, at_pins[name])
        result.append(power)
    return result
