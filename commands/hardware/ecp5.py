# SPDX-License-Identifier: Apache-2.0
"""Registers into the multipliers of an ECP5, which Yosys leaves outside them.

A MULT18X18D has registers at its inputs and at its output. With them the routes between a product and the registers
around it fall away, and most of its delay.
"""

from __future__ import annotations

from collections import Counter
from typing import NamedTuple

MULTIPLIER, REGISTER = "MULT18X18D", "TRELLIS_FF"
SIDES, WIDTH = "AB", 18
CLOCKS = 4  # clocks, enables and resets of a multiplier, of each
Bit = int | str  # of Yosys' JSON: number of a net, or "0", "1", "x"


class Control(NamedTuple):
    """What a register obeys."""

    clock: Bit
    enable: Bit


def _control(register: dict) -> Control | None:
    """Of a register that nothing resets; None: another."""
    parameters, ports = register["parameters"], register["connections"]
    if ports["LSR"] != ["0"] or parameters["REGSET"] != "RESET" or parameters["CLKMUX"] != "CLK":
        return None
    return Control(ports["CLK"][0], ports["CE"][0] if parameters["CEMUX"] == "CE" else "1")


def pack(module: dict) -> dict[str, int]:
    """Move registers around multipliers into them, in a flat module of Yosys' JSON after synth_ecp5.

    Operands: where all bits of both come from registers without reset, those of an operand under one enable. A constant
    bit counts as registered: the other bits are as unknown before their first clock. Product: where then each bit goes
    into such a register alone, all under one enable.

    Returns
    -------
    multipliers, how many of them have their operands registered inside, and their product too; registers that went
    """
    cells = module["cells"]
    registers = {cell["connections"]["Q"][0]: name for name, cell in cells.items() if cell["type"] == REGISTER}
    behind = {cell["connections"]["DI"][0]: name for name, cell in cells.items() if cell["type"] == REGISTER}
    readers: Counter[Bit] = Counter(
        bit
        for cell in cells.values()
        for port, bits in cell["connections"].items()
        if cell["port_directions"][port] == "input"
        for bit in bits
    )
    readers.update(bit for port in module["ports"].values() if port["direction"] != "input" for bit in port["bits"])
    multipliers = [cell for cell in cells.values() if cell["type"] == MULTIPLIER]
    before = len(cells)
    operands = products = 0
    for multiplier in multipliers:
        ports, parameters = multiplier["connections"], multiplier["parameters"]
        controls = {}
        sources: dict[str, dict] = {}  # of pins
        for side in SIDES:
            inputs = {f"{side}{place}": ports[f"{side}{place}"][0] for place in range(WIDTH)}
            inputs = {pin: bit for pin, bit in inputs.items() if isinstance(bit, int)}
            if all(bit in registers for bit in inputs.values()):
                found = {pin: cells[registers[bit]] for pin, bit in inputs.items()}
                sources |= found
                controls[f"INPUT{side}"] = {_control(register) for register in found.values()}
        if len(controls) != len(SIDES) or not _one_each(controls):
            continue
        operands += 1
        for pin, register in sources.items():
            readers[ports[pin][0]] -= 1
            ports[pin] = register["connections"]["DI"]
            readers[ports[pin][0]] += 1
        outputs = {pin: ports[pin][0] for pin in ports if pin[0] == "P" and readers[ports[pin][0]]}
        if outputs and all(readers[bit] == 1 and bit in behind for bit in outputs.values()):
            sinks = {pin: behind[bit] for pin, bit in outputs.items()}
            after = {**controls, "OUTPUT": {_control(cells[name]) for name in sinks.values()}}
            if _one_each(after):
                products += 1
                controls = after
                for pin, name in sinks.items():
                    ports[pin] = cells.pop(name)["connections"]["Q"]
                    del registers[ports[pin][0]]
        chosen = {name: control for name, (control,) in controls.items() if control}
        enables = list(dict.fromkeys(control.enable for control in chosen.values()))
        for name, control in chosen.items():
            parameters[f"REG_{name}_CLK"] = "CLK0"
            parameters[f"REG_{name}_CE"] = f"CE{enables.index(control.enable)}"
        parameters |= {"GSR": "DISABLED", "RESETMODE": "SYNC"}
        pins = {f"RST{place}": "0" for place in range(CLOCKS)}
        pins |= {f"CLK{place}": "0" for place in range(1, CLOCKS)}
        pins["CLK0"] = next(iter(chosen.values())).clock
        pins |= {f"CE{place}": enables[place] if place < len(enables) else "0" for place in range(CLOCKS)}
        for pin, bit in pins.items():
            ports[pin] = [bit]
            multiplier["port_directions"][pin] = "input"
    for bit, name in registers.items():
        if not readers[bit]:
            del cells[name]
    return {
        "multipliers": len(multipliers),
        "operands": operands,
        "products": products,
        "registers": before - len(cells),
    }


def _one_each(controls: dict[str, set[Control | None]]) -> bool:
    """Whether each group of registers obeys one control, and all one clock."""
    every = [control for group in controls.values() for control in group]
    return (
        len(every) == len(controls) and None not in every and len({control.clock for control in every if control}) == 1
    )
