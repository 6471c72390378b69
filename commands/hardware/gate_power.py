# SPDX-License-Identifier: Apache-2.0
"""Power of a mapped netlist from the toggles of its nets, by the tables of its library.

Each transition of a gate's output takes half of C V^2 of the driven pins (no wires) and the cell's own energy at that
load and at the slew of its inputs: the mean of a rise and a fall and of the pins that may have caused it. Each
transition of an input takes the energy of that pin, whether or not the output moves. Each clock takes both edges of the
clock pin of a flip-flop. Leakage is the library's, at its temperature.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from commands.hardware.gates import Bit, Netlist
from commands.hardware.liberty import Library, Table, mean

FANOUT = 4  # inverters: the load of an output port and of a macro's pin, and the driver of the typical slew
# Clock pins of flip-flops with the energy of the cells at both edges; other energy in cells; driven pins; leakage.
PARTS = CLOCK, INTERNAL, SWITCHING, LEAKAGE = range(4)
NAMES = ("clock", "internal", "switching", "leakage")
DATA = [INTERNAL, SWITCHING]  # proportional to the toggles of nets other than the clock


def typical(library: Library) -> tuple[float, float]:
    """Return load and slew of an inverter that drives FANOUT others and is driven by such an inverter."""
    inverter = library.inverter()
    load = FANOUT * inverter.pins[inverter.inputs[0]].capacitance
    slew = 0.0
    for _ in range(8):  # converges in three
        slew = mean(inverter.pins[inverter.outputs[0]].slews, load=load, slew=slew)
    return load, slew


def loads(netlist: Netlist) -> dict[Bit, float]:
    """Return the capacitance on each net, in the library's unit."""
    outside, _ = typical(netlist.library)
    load: dict[Bit, float] = {}
    for _, instance, cell in netlist.gates:
        for name, bits in instance.pins.items():
            capacitance = cell.pins[name].capacitance if cell.pins[name].direction == "input" else 0.0
            load[bits[0]] = load.get(bits[0], 0.0) + capacitance
    outputs = [bit for direction, bits in netlist.ports.values() if direction == "output" for bit in bits]
    for bit in [*outputs, *netlist.memory_nets[1]]:
        load[bit] = load.get(bit, 0.0) + outside
    return load


def _energy(causes: Mapping[str, list[Table]], load: float, slews: Mapping[str, float], otherwise: float) -> float:
    """Return the energy of one transition: the mean over its causes."""
    energies = [mean(tables, load=load, slew=slews.get(pin, otherwise)) for pin, tables in causes.items()]
    return sum(energies) / len(energies) if energies else 0.0


@dataclass(frozen=True)
class GatePower:
    """Power of each gate of `netlist.gates` in W, by PARTS: float (gates, 4).

    `terms` are gate, part, net and the power of one transition of the net in each clock; `fixed` is what else there is.
    """

    fixed: np.ndarray
    terms: list[tuple[int, int, Bit, float]]

    def of(self, toggles: Mapping[Bit, float]) -> np.ndarray:
        """Return the power with these transitions of each net per clock."""
        power = self.fixed.copy()
        if self.terms:
            gates, parts, nets, watts = zip(*self.terms, strict=True)
            rates = np.array([toggles.get(net, 0.0) for net in nets])
            np.add.at(power, (np.array(gates), np.array(parts)), rates * np.array(watts))
        return power


def power_of(netlist: Netlist, clock_hz: float) -> GatePower:
    """Return what the power of a netlist follows from."""
    library = netlist.library
    load = loads(netlist)
    _, usual_slew = typical(library)
    slew: dict[Bit, float] = {}
    for _, instance, cell in netlist.gates:
        for name in cell.outputs:
            if name in instance.pins and cell.pins[name].slews:
                net = instance.pins[name][0]
                slew[net] = mean(cell.pins[name].slews, load=load[net], slew=usual_slew)
    per_capacitance = 0.5 * library.farad * library.voltage**2 * clock_hz
    per_energy = library.farad * clock_hz
    power = GatePower(np.zeros((len(netlist.gates), len(PARTS))), [])

    for i, (_, instance, cell) in enumerate(netlist.gates):
        fixed = power.fixed[i]
        fixed[LEAKAGE] = cell.leakage * library.watt
        at_pins = {name: slew.get(bits[0], usual_slew) for name, bits in instance.pins.items()}
        for name, bits in instance.pins.items():
            pin, net = cell.pins[name], bits[0]
            if pin.direction == "output":
                power.terms.append((i, SWITCHING, net, per_capacitance * load[net]))
                watts = per_energy * _energy(pin.energy, load[net], at_pins, usual_slew)
                power.terms.append((i, INTERNAL, net, watts))
            elif net == netlist.clock:
                edge = per_energy * _energy(pin.energy, 0.0, at_pins, usual_slew)
                fixed[CLOCK] += 2 * (per_capacitance * pin.capacitance + edge)
            else:
                watts = per_energy * _energy(pin.energy, 0.0, at_pins, at_pins[name])
                power.terms.append((i, INTERNAL, net, watts))
    return power
