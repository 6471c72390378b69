# SPDX-License-Identifier: Apache-2.0
"""Simulation of a mapped netlist of the design (gate_sim.cpp): codes, accesses, toggles without and with delays."""

import itertools
import subprocess
from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import numpy as np

from commands.hardware.gates import Bit, Instance, Netlist, clock_pin
from commands.hardware.liberty import LARGEST_GATE, Cell, functions

SOURCE = Path(__file__).with_name("gate_sim.cpp")
ALWAYS_READY = ("m_axis_tready", "m_event_tready", "s_axil_bready", "s_axil_rready")
MEMORY_PINS = ("write_en", "write_address", "write_data", "read_en", "read_address", "read_data")
ROM_PINS = {"read_en": "en", "read_address": "address", "read_data": "data"}
Gate = tuple[int, Instance, Cell]
# Of each instance: rise and fall in ns from an input pin to an output pin.
Delays = Mapping[int, Mapping[tuple[str, str], tuple[float, float]]]


@dataclass(frozen=True)
class Macro:
    """A memory macro: a RAM, or a ROM whose words never change.

    `words` are the bits at power-up as Yosys has them, the highest of the last word first; x counts as 0.
    """

    width: int
    depth: int
    words: str


@dataclass(frozen=True)
class Stimulus:
    """A frame that enters `frames` times without a pause.

    `pixels` are words of s_axis_tdata, `codes` the depth codes in the order in which they leave (of one frame, if all
    are equal), and `window` the clocks of the last frame, from 1, that are simulated with delays too.
    """

    pixels: np.ndarray
    codes: np.ndarray
    columns: int
    frames: int
    window: range


@dataclass(frozen=True)
class Activity:
    """Activity in the clocks of the last frame; accesses and toggles are per clock."""

    codes: int  # since reset
    wrong: int  # codes that differ from the model
    wrong_with_delays: int  # clocks of the window that settled otherwise with delays
    accesses: list[tuple[float, float]]  # reads and writes of each macro
    toggles: dict[Bit, float]
    window: dict[Bit, float]
    window_with_delays: dict[Bit, float]


def in_order(netlist: Netlist) -> list[Gate]:
    """Return the gates without state, each after those that drive it."""
    gates = {gate[0]: gate for gate in netlist.gates if not gate[2].flip_flop}
    driver = {gate.pins[pin][0]: i for i, gate, cell in gates.values() for pin in cell.outputs if pin in gate.pins}
    before = {
        i: [driver[gate.pins[pin][0]] for pin in cell.inputs if gate.pins[pin][0] in driver]
        for i, gate, cell in gates.values()
    }
    try:
        return [gates[i] for i in TopologicalSorter(before).static_order()]
    except CycleError as error:
        raise RuntimeError(f"gates form a loop of {len(error.args[1]) - 1}") from error


class Encoder:
    """Words for gate_sim.cpp: lists begin with their length; net 0 is zero, net 1 is one."""

    def __init__(self, delays: Delays, ones: Iterable[Bit]) -> None:
        self.delays = delays
        self.net = defaultdict[Bit, int](
            itertools.count(2).__next__, {"0": 0, "x": 0, "1": 1, **dict.fromkeys(ones, 1)}
        )
        self.known: dict[str, dict[str, tuple[list[str], int]]] = {}

    def bits(self, values: Sequence[Bit]) -> list[int]:
        """Return a list of nets."""
        return [len(values), *(self.net[bit] for bit in values)]

    def gates(self, gates: Iterable[Gate]) -> list[int]:
        """Return gates, one for each output."""
        count, words = 0, []
        for index, gate, cell in gates:
            if cell.name not in self.known:
                self.known[cell.name] = functions(cell)
            delays = self.delays.get(index, {})
            for pin, (inputs, table) in self.known[cell.name].items():
                if pin not in gate.pins:
                    continue
                nets = [self.net[gate.pins[name][0]] for name in inputs]
                causes = [clock_pin(cell)] if cell.flip_flop else inputs
                pairs = [delays.get((name, pin), (0.0, 0.0)) for name in causes]
                words += [table & 0xFFFFFFFF, table >> 32, self.net[gate.pins[pin][0]], len(nets)]
                for row in (nets, *([round(1000 * pair[edge]) for pair in pairs] for edge in (0, 1))):
                    words += row + [0] * (LARGEST_GATE - len(row))
                count += 1
        return [count, *words]

    def macro(self, instance: Instance, macro: Macro) -> list[int]:
        """Return a memory; a ROM has no write port."""
        words = [macro.width]
        for name in MEMORY_PINS:
            words += self.bits(instance.pins.get(name) or instance.pins.get(ROM_PINS.get(name, ""), []))
        size = macro.width * macro.depth
        return [*words, size, *(int(bit == "1") for bit in macro.words[::-1][:size].ljust(size, "x"))]


def simulate(
    netlist: Netlist, macros: Sequence[Macro], stimulus: Stimulus, delays: Delays, other_ns: float, folder: Path
) -> Activity:
    """Simulate a netlist with its macros; memories and inputs follow the edge by `other_ns`."""
    ports = {name: port[1] for name, port in netlist.ports.items()}
    encoder = Encoder(delays, [ports[name][0] for name in ALWAYS_READY])
    pixels, codes = stimulus.pixels.ravel(), stimulus.codes.ravel()
    mask = (1 << len(ports["m_axis_tdata"])) - 1
    words = encoder.gates(in_order(netlist))
    words += encoder.gates(gate for gate in netlist.gates if gate[2].flip_flop)
    words.append(len(macros))
    for instance, macro in zip(netlist.macros, macros, strict=True):
        words += encoder.macro(instance, macro)
    words += [encoder.net[ports[name][0]] for name in ("rst", "s_axis_tvalid", "s_axis_tlast", "s_axis_tuser")]
    words += encoder.bits(ports["s_axis_tdata"])
    words += [encoder.net[ports[name][0]] for name in ("s_axis_tready", "m_axis_tvalid")]
    words += encoder.bits(ports["m_axis_tdata"])
    words += [stimulus.columns, stimulus.frames, pixels.size, *map(int, pixels)]
    words += [codes.size, *(int(code) & mask for code in codes)]
    words += [stimulus.window.start, len(stimulus.window), round(1000 * other_ns), *encoder.bits(netlist.high)]
    nets = max(encoder.net.values()) + 1
    content = np.array([nets, *words], dtype=np.int64).astype(np.uint32).tobytes()
    program = folder / "gate_sim"
    subprocess.run(["c++", "-O2", "-o", program, SOURCE], capture_output=True, check=True)
    result = subprocess.run([program], input=content, cwd=folder, capture_output=True, check=False)
    if result.returncode:
        raise RuntimeError(f"the gates take no pixels (status {result.returncode}): see {folder}")

    received, wrong, clocks, unsettled, *counts = np.frombuffer(result.stdout, dtype="<i8").tolist()
    accesses = [(reads / clocks, writes / clocks) for reads, writes in zip(counts[::2], counts[1::2], strict=False)]
    spans = ((-3 * nets, clocks), (-2 * nets, len(stimulus.window)), (-nets, len(stimulus.window)))
    frame, window, window_with_delays = (
        {bit: counts[start + place] / max(number, 1) for bit, place in encoder.net.items()} for start, number in spans
    )
    return Activity(received, wrong, unsettled, accesses[: len(macros)], frame, window, window_with_delays)
