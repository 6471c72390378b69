# SPDX-License-Identifier: Apache-2.0
"""Steps of the flow for an ECP5: registers packed into multipliers and memories, enables copied, memories of slices.

A MULT18X18D has registers at its inputs and at its output, which Yosys leaves outside. With them the routes between a
product and its registers disappear, and so does most of the delay.

The enable of the pipeline has thousands of readers, and wires over the whole device. Registers that it enables are at
the end of such a wire; behind it, logic and memories take time too. They read copies, whose wires are shorter.
"""

from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

from tactile_depth.chip.rom_files import write_words

BLOCK = 16384  # bits of a block memory
WHOLE_WORDS = 2048  # words of a memory that boards/ecp5/td_ram.sv builds without slices

MULTIPLIER, REGISTER, MEMORY, LOGIC = "MULT18X18D", "TRELLIS_FF", "DP16KD", "LUT4"
SIDES, WIDTH = "AB", 18
READERS = 1000  # of a register whose logic and memories read copies
OF_A_COPY = 64  # readers, at most
CLOCKS = 4  # number of clocks, of enables and of resets of a multiplier
Bit = int | str  # of Yosys' JSON: number of a net, or "0", "1", "x"
Cells = dict[str, dict[str, Any]]


class Control(NamedTuple):
    """Clock and enable of a register."""

    clock: Bit
    enable: Bit


Controls = dict[str, set[Control | None]]  # of each group of registers of a multiplier


def pack(module: dict[str, Any]) -> dict[str, int]:
    """Move registers around multipliers into them, in a flat module of Yosys' JSON after synth_ecp5.

    Operands move when every bit of both comes from a register without reset and each operand has one enable. A constant
    bit counts as registered, because the other bits are unknown before their first clock too. They stay where one comes
    from a block memory through logic: a memory takes more than half of a clock, so its register has to be near it; and
    where one comes from logic and has other readers than multipliers, which would be far from the multiplier. The
    product moves when every bit goes into one register without reset and nowhere else, all with one enable, whether the
    operands moved or not.

    Returns
    -------
    number of multipliers, of those with registered operands, of those with a registered product too, and of registers
    that were removed
    """
    cells: Cells = module["cells"]
    registers = {ports["Q"][0]: name for name, ports in _registers(cells).items()}
    behind = {ports["DI"][0]: name for name, ports in _registers(cells).items()}
    readers: Counter[Bit] = Counter(bit for _, bit in _pins(cells, "input"))
    readers.update(bit for port in module["ports"].values() if port["direction"] != "input" for bit in port["bits"])
    near = _behind_memories(cells) | _read_elsewhere(cells)
    multipliers = [cell for cell in cells.values() if cell["type"] == MULTIPLIER]
    before = len(cells)
    operands = products = 0
    for multiplier in multipliers:
        ports = multiplier["connections"]
        sources, controls = _sources(ports, cells, registers)
        registered = len(controls) == len(SIDES) and _compatible(controls)
        if not registered or any(register["connections"]["DI"][0] in near for register in sources.values()):
            controls = {}
        else:
            operands += 1
            for pin, register in sources.items():
                readers[ports[pin][0]] -= 1
                ports[pin] = register["connections"]["DI"]
                readers[ports[pin][0]] += 1
        outputs = {pin: ports[pin][0] for pin in ports if pin[0] == "P" and readers[ports[pin][0]]}
        if outputs and all(readers[bit] == 1 and bit in behind for bit in outputs.values()):
            sinks = {pin: behind[bit] for pin, bit in outputs.items()}
            after = {**controls, "OUTPUT": {_control(cells[name]) for name in sinks.values()}}
            if _compatible(after):
                products += 1
                controls = after
                for pin, name in sinks.items():
                    ports[pin] = cells.pop(name)["connections"]["Q"]
                    del registers[ports[pin][0]]
        if controls:
            _configure(multiplier, {name: control for name, (control,) in controls.items() if control})
    for bit, name in registers.items():
        if not readers[bit]:
            del cells[name]
    removed = before - len(cells)
    return {"multipliers": len(multipliers), "operands": operands, "products": products, "registers": removed}


def pack_memories(module: dict[str, Any]) -> dict[str, int]:
    """Move the registers behind block memories into them, in a flat module of Yosys' JSON after synth_ecp5.

    A word leaves such a register 1.0 ns after the clock, the memory itself only after 5.8 ns, with the wire to the
    register still to come. The registers of a port move when every bit that is read goes into one register without
    reset and nowhere else, all with one enable and the clock of the port.

    Returns
    -------
    number of ports of memories that became registered, and of registers that were removed
    """
    cells: Cells = module["cells"]
    behind = {ports["DI"][0]: name for name, ports in _registers(cells).items()}
    readers: Counter[Bit] = Counter(bit for _, bit in _pins(cells, "input"))
    before, ports = len(cells), 0
    for memory in [cell for cell in cells.values() if cell["type"] == MEMORY]:
        pins, parameters = memory["connections"], memory["parameters"]
        wide = int(str(parameters["DATA_WIDTH_A"]), 2) == 2 * WIDTH  # both halves of a word leave with the clock of B
        for side, halves in (("B", "AB"),) if wide else (("A", "A"), ("B", "B")):
            outputs = {pin: pins[pin][0] for half in halves for pin in pins if pin.startswith(f"DO{half}")}
            read = {pin: bit for pin, bit in outputs.items() if readers[bit]}
            if not read or any(readers[bit] > 1 or bit not in behind for bit in read.values()):
                continue
            controls = {_control(cells[behind[bit]]) for bit in read.values()}
            if _compatible({side: controls, "": {Control(pins[f"CLK{side}"][0], "1")}}) and pins[f"RST{side}"] == ["0"]:
                ports += 1
                parameters |= {f"REGMODE_{half}": "OUTREG" for half in halves}
                pins[f"OCE{side}"] = [next(control.enable for control in controls if control)]
                for pin, bit in read.items():
                    pins[pin] = cells.pop(behind[bit])["connections"]["Q"]
    return {"memory_ports": ports, "memory_registers": before - len(cells)}


def _registers(cells: Cells) -> dict[str, dict[str, list[Bit]]]:
    """Return the nets at the ports of each register."""
    return {name: cell["connections"] for name, cell in cells.items() if cell["type"] == REGISTER}


def _pins(cells: Cells, direction: str) -> Iterator[tuple[str, Bit]]:
    """Yield the type of a cell and the net of each pin with a direction."""
    for cell in cells.values():
        for port, bits in cell["connections"].items():
            if cell["port_directions"][port] == direction:
                yield from ((cell["type"], bit) for bit in bits)


def _behind_memories(cells: Cells) -> set[Bit]:
    """Return the outputs of logic that has a word of a block memory at an input."""
    read = {bit for kind, bit in _pins(cells, "output") if kind == MEMORY}
    return {
        cell["connections"]["Z"][0]
        for cell in cells.values()
        if cell["type"] == LOGIC and any(cell["connections"][pin][0] in read for pin in "ABCD")
    }


def _read_elsewhere(cells: Cells) -> set[Bit]:
    """Return the outputs of logic whose register is read by more than multipliers."""
    read = {bit for kind, bit in _pins(cells, "input") if kind != MULTIPLIER}
    computed = {bit for kind, bit in _pins(cells, "output") if kind not in (REGISTER, MEMORY, MULTIPLIER)}
    between = {ports["DI"][0] for ports in _registers(cells).values() if ports["Q"][0] in read}
    return between & computed


def _sources(
    ports: dict[str, list[Bit]], cells: Cells, registers: dict[Bit, str]
) -> tuple[dict[str, dict[str, Any]], Controls]:
    """Return the register behind each input pin, and the controls of the operands that are registered."""
    sources: dict[str, dict[str, Any]] = {}
    controls: Controls = {}
    for side in SIDES:
        bits = {f"{side}{place}": ports[f"{side}{place}"][0] for place in range(WIDTH)}
        inputs = {pin: bit for pin, bit in bits.items() if isinstance(bit, int)}
        if all(bit in registers for bit in inputs.values()):
            behind_pins = {pin: cells[registers[bit]] for pin, bit in inputs.items()}
            sources |= behind_pins
            controls[f"INPUT{side}"] = {_control(register) for register in behind_pins.values()}
    return sources, controls


def _control(register: dict[str, Any]) -> Control | None:
    """Return the control of a register without reset; None for any other register."""
    parameters, ports = register["parameters"], register["connections"]
    if ports["LSR"] != ["0"] or parameters["REGSET"] != "RESET" or parameters["CLKMUX"] != "CLK":
        return None
    return Control(ports["CLK"][0], ports["CE"][0] if parameters["CEMUX"] == "CE" else "1")


def _compatible(controls: Controls) -> bool:
    """Return whether each group of registers has one control, and all groups have one clock."""
    every = [control for group in controls.values() for control in group]
    clocks = {control.clock for control in every if control}
    return len(every) == len(controls) and None not in every and len(clocks) == 1


def _configure(multiplier: dict[str, Any], controls: dict[str, Control]) -> None:
    """Switch on the registers of a multiplier."""
    enables = list(dict.fromkeys(control.enable for control in controls.values()))
    for name, control in controls.items():
        multiplier["parameters"][f"REG_{name}_CLK"] = "CLK0"
        multiplier["parameters"][f"REG_{name}_CE"] = f"CE{enables.index(control.enable)}"
    multiplier["parameters"] |= {"GSR": "DISABLED", "RESETMODE": "SYNC"}
    pins: dict[str, Bit] = {f"RST{place}": "0" for place in range(CLOCKS)}
    pins |= {f"CLK{place}": "0" for place in range(1, CLOCKS)}
    pins["CLK0"] = next(iter(controls.values())).clock
    pins |= {f"CE{place}": enables[place] if place < len(enables) else "0" for place in range(CLOCKS)}
    multiplier["connections"] |= {pin: [bit] for pin, bit in pins.items()}
    multiplier["port_directions"] |= dict.fromkeys(pins, "input")


def copy_enables(module: dict[str, Any]) -> None:
    """Give copies of each register that enables more than `READERS` registers to the logic and memories that read it.

    A copy has readers that are neighbours by their names, which begin with the path of their core. The module is flat,
    of Yosys' JSON after synth_ecp5.
    """
    cells: Cells = module["cells"]
    registers = _registers(cells)
    enabled = Counter(bit for ports in registers.values() for bit in ports.get("CE", ()))
    wide = {name: ports["Q"][0] for name, ports in registers.items() if enabled[ports["Q"][0]] > READERS}
    used = {bit for cell in cells.values() for bits in cell["connections"].values() for bit in bits}
    free = 1 + max((bit for bit in used if isinstance(bit, int)), default=0)
    others = [(name, cell) for name, cell in sorted(cells.items()) if cell["type"] != REGISTER]
    for name, bit in wide.items():
        pins = [
            (cell["connections"], port)
            for _, cell in others
            for port, bits in cell["connections"].items()
            if bit in bits and cell["port_directions"][port] == "input"
        ]
        for number, (connections, port) in enumerate(pins):
            connections[port] = [free + number // OF_A_COPY if each == bit else each for each in connections[port]]
        for number in range(-(-len(pins) // OF_A_COPY)):
            copy = {**cells[name], "connections": {**cells[name]["connections"], "Q": [free]}}
            cells[f"{name}_copy{number}"] = copy
            free += 1


def write_slices(folder: Path) -> None:
    """Write what boards/ecp5/td_ram.sv reads at power-up: the slices of each large table that a folder holds."""
    for table in folder.glob("*.hex"):
        lines = table.read_text().split()
        if WHOLE_WORDS < len(lines) <= BLOCK:
            bits = BLOCK >> (len(lines) - 1).bit_length()
            words = [int(line, 16) for line in lines]
            for number, low in enumerate(range(0, 4 * len(lines[0]), bits)):
                slices = [word >> low & (1 << bits) - 1 for word in words]
                write_words(table.with_name(f"{table.name}.{number:02}"), slices, bits)
