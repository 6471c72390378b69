# SPDX-License-Identifier: Apache-2.0
"""Simulation of the gates of the whole design without delays (gate_sim.cpp): codes, toggles, accesses."""

from __future__ import annotations

import re
import shutil
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from commands.hardware.gates import Bit, Instance, Netlist, state
from commands.hardware.liberty import Cell, boolean
from tactile_depth.errors import InputError

SOURCE = Path(__file__).with_name("gate_sim.cpp")
LARGEST_GATE = 6  # inputs
ALWAYS_READY = ("m_axis_tready", "m_event_tready", "s_axil_bready", "s_axil_rready")


@dataclass(frozen=True)
class Macro:
    """A memory that is a macro: a RAM, or a ROM whose `words` never change.

    Attributes
    ----------
    width, depth : int
    words : str
        Bits at power-up as Yosys has them, the highest of the last word first; x is taken for 0.
    """

    width: int
    depth: int
    words: str


@dataclass(frozen=True)
class Activity:
    """Of the clocks of one frame.

    Attributes
    ----------
    clocks : int
    codes, wrong : int
        Depth codes seen since reset, and those that differ from the model.
    toggles : dict of Bit to float
        Of each net, per clock.
    accesses : list of (float, float)
        Reads and writes of each macro, per clock.
    watched : list of str
        Values of the nets watched, a character each, one string a clock.
    """

    clocks: int
    codes: int
    wrong: int
    toggles: dict[Bit, float]
    accesses: list[tuple[float, float]]
    watched: list[str]


def truth(function: str, inputs: Sequence[str]) -> int:
    """Bit i: value of a Verilog expression when the inputs, first lowest, spell i."""
    code = compile(function.replace("1'b", ""), "function", "eval")
    table = 0
    for i in range(1 << len(inputs)):
        table |= (eval(code, {}, {name: i >> k & 1 for k, name in enumerate(inputs)}) & 1) << i
    return table


class Tables:
    """Truth tables of a cell's outputs, worked out once."""

    def __init__(self) -> None:
        self.known: dict[str, list[tuple[str, list[str], int]]] = {}

    def of(self, cell: Cell) -> list[tuple[str, list[str], int]]:
        if cell.name not in self.known:
            if cell.flip_flop:
                edge, _, following, inverse = state(cell, {name: name for name in cell.inputs})
                if edge != "posedge":
                    raise InputError(f"LIB: the cell {cell.name} was used, a flip-flop for falling edges")
                functions = {pin: f"~({following})" if inverted else following for pin, inverted in inverse.items()}
            else:
                functions = {pin: boolean(cell.pins[pin].function) for pin in cell.outputs}
            self.known[cell.name] = []
            for pin, function in functions.items():
                inputs = sorted(set(re.findall(r"(?<![\w'])[A-Za-z_]\w*", function)))
                if len(inputs) > LARGEST_GATE:
                    raise InputError(f"LIB: the cell {cell.name} was used, with more than {LARGEST_GATE} inputs")
                self.known[cell.name].append((pin, inputs, truth(function, inputs)))
        return self.known[cell.name]


def in_order(netlist: Netlist) -> list[tuple[Instance, Cell]]:
    """Gates without state, each after those that drive it.

    Raises
    ------
    RuntimeError
        They form a loop.
    """
    logic = [(instance, cell) for _, instance, cell in netlist.gates if not cell.flip_flop]
    place = {
        instance.pins[pin][0]: k
        for k, (instance, cell) in enumerate(logic)
        for pin in cell.outputs
        if pin in instance.pins
    }
    waits = [0] * len(logic)
    readers: list[list[int]] = [[] for _ in logic]
    for k, (instance, cell) in enumerate(logic):
        for pin in cell.inputs:
            before = place.get(instance.pins[pin][0])
            if before is not None:
                waits[k] += 1
                readers[before].append(k)
    ready = [k for k, count in enumerate(waits) if not count]
    for k in ready:  # grows on the way
        for reader in readers[k]:
            waits[reader] -= 1
            if not waits[reader]:
                ready.append(reader)
    if len(ready) < len(logic):
        raise RuntimeError(f"{len(logic) - len(ready)} gates form a loop")
    return [logic[k] for k in ready]


def program(folder: Path) -> Path:
    """The simulator, compiled.

    Raises
    ------
    InputError
    """
    compiler = shutil.which("c++")
    if compiler is None:
        raise InputError("no C++ compiler is installed: run `apt-get install g++`")
    binary = folder / "gate_sim"
    result = subprocess.run([compiler, "-O2", "-o", binary, SOURCE], capture_output=True, text=True, check=False)
    if result.returncode:
        raise RuntimeError(f"{SOURCE.name} does not compile: {result.stderr.splitlines()[0]}")
    return binary


def simulate(
    netlist: Netlist,
    macros: Sequence[Macro],
    pixels: np.ndarray,
    codes: np.ndarray,
    columns: int,
    frames: int,
    watched: Sequence[Bit],
    sample: range,
    folder: Path,
) -> Activity:
    """Send a frame several times without a pause; toggles are those of the clocks in which the last one enters.

    Parameters
    ----------
    macros : of the netlist's macros, in their order
    pixels : int array, words of s_axis_tdata of one frame
    codes : int array, depth codes of it in the order in which they leave
    watched : nets to be seen in the clocks `sample` of the last frame
    """
    number: dict[Bit, int] = {"0": 0, "x": 0, "1": 1}

    def net(bit: Bit) -> int:
        return number.setdefault(bit, len(number) - 1)  # "x" shares 0

    tables = Tables()
    words: list[int] = []

    def gates(all_gates: Sequence[tuple[Instance, Cell]]) -> list[int]:
        count, encoded = 0, []
        for instance, cell in all_gates:
            for pin, inputs, table in tables.of(cell):
                if pin in instance.pins:
                    ins = [net(instance.pins[name][0]) for name in inputs]
                    encoded += [table & 0xFFFFFFFF, table >> 32, net(instance.pins[pin][0]), len(ins)]
                    encoded += ins + [0] * (LARGEST_GATE - len(ins))
                    count += 1
        return [count, *encoded]

    def bits(values: Sequence[Bit]) -> list[int]:
        return [len(values), *map(net, values)]

    words += gates(in_order(netlist))
    words += gates([(instance, cell) for _, instance, cell in netlist.flip_flops()])
    words.append(len(macros))
    for (_, instance), macro in zip(netlist.macros, macros, strict=True):
        pins = instance.pins
        words.append(macro.width)
        for writes, reads in (("write_en", ""), ("write_address", ""), ("write_data", ""), ("read_en", "en")):
            words += bits(pins.get(writes) or pins.get(reads) or [])
        words += bits(pins.get("read_address") or pins["address"]) + bits(pins.get("read_data") or pins["data"])
        size = macro.width * macro.depth
        initial = macro.words[::-1][:size].ljust(size, "x")
        words += [size, *(int(bit == "1") for bit in initial)]
    ports = {name: port[1] for name, port in netlist.ports.items()}
    words += bits([bit for name in ALWAYS_READY for bit in ports[name]])
    words += [net(ports[name][0]) for name in ("rst", "s_axis_tvalid", "s_axis_tlast", "s_axis_tuser")]
    words += bits(ports["s_axis_tdata"])
    words += [net(ports["s_axis_tready"][0]), net(ports["m_axis_tvalid"][0])]
    words += bits(ports["m_axis_tdata"])
    mask = (1 << len(ports["m_axis_tdata"])) - 1
    words += [columns, frames]
    words += [pixels.size, *map(int, pixels.ravel())]
    words += [codes.size, *(int(code) & mask for code in codes.ravel())]
    words += [sample.start, len(sample)]
    words += bits(watched)
    given = np.array([max(number.values()) + 1, *words], dtype=np.int64).astype(np.uint32).tobytes()

    result = subprocess.run([program(folder)], input=given, cwd=folder, capture_output=True, check=False)
    if result.returncode:
        raise RuntimeError(f"the gates take no pixels (status {result.returncode}): see {folder}")
    seen, wrong, clocks = map(int, result.stdout.split())
    counted = np.fromfile(folder / "toggles.bin", dtype="<u4")
    accesses = counted[: 2 * len(macros)].reshape(-1, 2) / clocks
    toggles = counted[2 * len(macros) :] / clocks
    return Activity(
        clocks,
        seen,
        wrong,
        {bit: float(toggles[place]) for bit, place in number.items() if isinstance(bit, int)},
        [(float(reads), float(writes)) for reads, writes in accesses],
        (folder / "watched.txt").read_text().split(),
    )
