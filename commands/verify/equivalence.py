# SPDX-License-Identifier: Apache-2.0
"""Formal proof that a mutant is equivalent to its core, for every use that the protocol of the core allows.

The netlist with all mutants becomes one and-inverter graph, together with a small environment of SystemVerilog that
states which inputs are allowed and in which cycles an output counts. Two copies of the graph, one without and one with
the mutant, get the same inputs and the same power-up state: registers and memories without an initial value start with
any value, the same in both. The first cycle is a reset. Logic that is alike in both copies is built once, so the
solver works only on the logic that the mutant can reach. Each mutant goes through these steps of yosys-abc:

1. structure: both copies are one graph;
2. search: `bmc3` finds a difference;
3. confinement: only a few registers have a second copy, see `confined`;
4. a longer search.

A mutant that no step settles is open.
"""

import itertools
import re
import subprocess
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from commands.common import repository
from commands.hardware.yosys import in_wheel
from commands.verify import protocol
from commands.verify.mutants import SELECTOR, instance, ports, yosys

EQUIVALENT, DIFFERENT, OPEN = "equivalent", "different", "open"

HOLDS = "protocol_holds"
RESET = "any_rst"
TO_GRAPH = """read_rtlil mutants.il
read_rtlil protocol.il
read_verilog -sv environment.v
hierarchy -top environment
proc
flatten
opt_clean
memory -nomap
memory_map
{steps}setundef -undriven -anyseq
opt -fast
dffunmap
techmap -map first_wins.v
techmap
opt -fast
{legalize}setundef -undriven -anyseq
aigmap
opt_clean
"""
# With two clocks a cycle is a step of time in which each clock may rise.
ONE_CLOCK = {"steps": "", "legalize": "dfflegalize -cell $_DFF_P_ 01\n"}
TWO_CLOCKS = {"steps": "clk2fflogic\nopt_clean\n", "legalize": ""}
# A mutant may have two selects of a multiplexer high: the lowest wins, as in the Verilog that Yosys writes.
FIRST_WINS = """(* techmap_celltype = "$pmux" *)
module first_wins (A, B, S, Y);
  parameter WIDTH = 1;
  parameter S_WIDTH = 1;
  input [WIDTH-1:0] A;
  input [WIDTH*S_WIDTH-1:0] B;
  input [S_WIDTH-1:0] S;
  output [WIDTH-1:0] Y;
  wire [WIDTH*(S_WIDTH+1)-1:0] chain;
  assign chain[WIDTH*S_WIDTH +: WIDTH] = A;
  assign Y = chain[0 +: WIDTH];
  genvar i;
  generate
    for (i = 0; i < S_WIDTH; i = i + 1) begin : g
      assign chain[WIDTH*i +: WIDTH] = S[i] ? B[WIDTH*i +: WIDTH] : chain[WIDTH*(i+1) +: WIDTH];
    end
  endgenerate
endmodule
"""


@dataclass(frozen=True)
class Graph:
    """An and-inverter graph in AIGER's numbering: literal 2 v is node v, 2 v + 1 its inverse, 0 is false."""

    inputs: dict[str, int]  # name of the bit to its literal
    latches: list[tuple[int, int, int]]  # literal, next, start: 0, 1, or the literal itself for any value
    outputs: dict[str, int]
    ands: list[tuple[int, int, int]]

    @cached_property
    def gates_behind(self) -> dict[int, list[int]]:
        """The positions of the gates that read each node."""
        return readers(operands for _, *operands in self.ands)

    @cached_property
    def latches_behind(self) -> dict[int, list[int]]:
        """The positions of the latches that load each node."""
        return readers([following] for _, following, _ in self.latches)

    def reached(self, nodes: Iterable[int]) -> list[tuple[int, int, int]]:
        """Return the gates whose value can depend on nodes without a latch between, in the order of the graph."""
        found: set[int] = set()
        left = list(nodes)
        while left:
            new = set(self.gates_behind.get(left.pop(), ())) - found
            found |= new
            left += [self.ands[position][0] for position in new]
        return [self.ands[position] for position in sorted(found)]

    def loaded(self, nodes: Iterable[int]) -> list[tuple[int, int, int]]:
        """Return the latches that load nodes."""
        return [self.latches[position] for node in nodes for position in self.latches_behind.get(node, ())]


def readers(read_by: Iterable[Iterable[int]]) -> dict[int, list[int]]:
    """Return, for each node, the positions of those that read one of its literals."""
    found: dict[int, list[int]] = {}
    for position, literals in enumerate(read_by):
        for literal in literals:
            found.setdefault(literal & ~1, []).append(position)
    return found


def read(values: Mapping[int, int], literal: int) -> int:
    """Return the value of a literal, given those of the nodes."""
    return values[literal & ~1] ^ (literal & 1)


def environment(core: str, folder: Path) -> str:
    """Return a module of Verilog: the netlist with all mutants behind the protocol of its core.

    Its inputs any_<input> are what is offered; the outputs looked_at_<output> tell in which cycles an output counts.
    """
    sides = {name: (side, f"[{bits - 1}:0]") for name, (side, bits) in ports(core, folder).items() if name != "clk"}
    inputs = {name: bits for name, (side, bits) in sides.items() if side == "input"}
    outputs = {name: bits for name, (side, bits) in sides.items() if side == "output"}
    declared = [f"input wire {bits} any_{name}" for name, bits in inputs.items()]
    declared += [f"output wire {bits} {name}, output wire looked_at_{name}" for name, bits in outputs.items()]
    declared += [f"output wire {HOLDS}", f"input wire [11:0] {SELECTOR}", "input wire clk"]
    wires = [f".{name}(any_{name}), .sees_{name}({name})" for name in inputs]
    wires += [f".{name}({name}), .counts_{name}(looked_at_{name})" for name in outputs]
    wires += [".clk(clk)"] if "clk" in ports(core, folder) else []
    return "\n".join(
        [
            f"module environment ({', '.join(declared)});",
            *(f"  wire {bits} {name};" for name, bits in inputs.items()),
            f"  protocol_{core} protocol ({', '.join(wires)}, .holds({HOLDS}));",
            f"{instance(core, folder)}endmodule\n",
        ]
    )


def clocks(core: str, folder: Path) -> list[str]:
    """Return the inputs of a core that are clocks; a clock that it makes for others, such as a camera, is an output."""
    return [name for name, (side, _) in ports(core, folder).items() if side == "input" and name.endswith("clk")]


def graph(core: str, folder: Path, parameters: Mapping[str, int | str]) -> Graph:
    """Return the graph of the netlist with all mutants and its environment; memories become registers."""
    (folder / "protocol.sv").write_text(protocol.module(core))
    (folder / "environment.v").write_text(environment(core, folder))
    (folder / "first_wins.v").write_text(FIRST_WINS)
    chosen = " ".join(f"-G {name}={value}" for name, value in parameters.items())
    files = " ".join(map(str, [*repository.packages(), *protocol.PARTS.values()]))
    yosys(
        f"read_slang --threads 1 --top protocol_{core} {chosen} {files} protocol.sv\nwrite_rtlil protocol.il\n",
        folder,
        "protocol",
    )
    steps = TO_GRAPH.format(**(TWO_CLOCKS if len(clocks(core, folder)) > 1 else ONE_CLOCK))
    yosys(f"{steps}write_aiger -ascii -symbols graph.aag\n", folder, "graph")
    lines = iter((folder / "graph.aag").read_text().splitlines())
    counts = map(int, next(lines).split()[2:])
    inputs, latches, outputs, ands = ([[*map(int, next(lines).split())] for _ in range(count)] for count in counts)
    symbols = re.findall(r"^([io])(\d+) (\S+)$", "\n".join(lines), re.M)
    names = {(kind, int(number)): name for kind, number, name in symbols}
    # Inputs without a name are undefined values, such as words beyond the end of a memory: any value, the same in both.
    inputs_by_name = {names.get(("i", n), f"undefined{n}"): literal for n, [literal] in enumerate(inputs)}

    return Graph(
        inputs_by_name,
        [(literal, following, start[0] if start else 0) for literal, following, *start in latches],
        {names["o", n]: literal for n, [literal] in enumerate(outputs)},
        sorted((out, a, b) for out, a, b in ands),
    )


class Gates:
    """A growing and-inverter graph without duplicate gates; `first` is the node of its first gate."""

    def __init__(self, first: int):
        self.first = first
        self.ands: list[tuple[int, int]] = []  # of nodes from self.first on
        self.known: dict[tuple[int, int], int] = {}

    def both(self, a: int, b: int) -> int:
        """Return the literal of a and b."""
        if a > b:
            a, b = b, a
        if a == 0 or a ^ b == 1:
            return 0
        if a in (1, b):
            return b
        if (a, b) not in self.known:
            self.known[a, b] = 2 * (self.first + len(self.ands))
            self.ands.append((a, b))
        return self.known[a, b]

    def either(self, literals: Iterable[int]) -> int:
        out = 0
        for literal in literals:
            out = self.both(out ^ 1, literal ^ 1) ^ 1
        return out

    def differ(self, a: int, b: int) -> int:
        return self.either((self.both(a, b ^ 1), self.both(a ^ 1, b)))


class Miter(Gates):
    """Two copies of a graph that share equal logic, and the literals that are high where the copies differ.

    The second copy has its own latches where it can differ, limited to `allowed` unless that is None. All other latches
    are assumed to be the same in both copies; `wrong` has a literal for each latch that breaks this assumption and for
    each bit of an output that differs while it counts.
    """

    def __init__(self, source: Graph, number: int, allowed: Collection[int] | None = None):
        self.source, self.number, self.allowed = source, number, allowed
        self.selector = {
            literal: int(name.rpartition("[")[2].removesuffix("]"))
            for name, literal in source.inputs.items()
            if name.split("[")[0] == SELECTOR
        }
        self.inputs = [literal for literal in source.inputs.values() if literal not in self.selector]
        free = [literal for literal, _, start in source.latches if start == literal]
        # Nodes: inputs, power-up values, `started`, latches of the first copy, as many for the second, gates.
        literals = itertools.count(2, 2)
        self.input_of = {literal: next(literals) for literal in self.inputs}
        self.power_up = {literal: next(literals) for literal in free}
        self.started = next(literals)
        self.latch, self.twin = ({latch[0]: next(literals) for latch in source.latches} for _ in range(2))
        super().__init__(next(literals) // 2)
        self.apart: set[int] = set()  # latches with a second copy
        self.next: dict[int, int] = {}  # of the latches of both copies
        self._build()

    def state(self, latch: int, literal: int, start: int) -> int:
        """Return the value of a latch; in the first cycle its power-up value if it has no initial value."""
        if start != literal:
            return latch
        return self.either((self.both(self.started, latch), self.both(self.started ^ 1, self.power_up[literal])))

    def _build(self) -> None:
        value = self._first()
        other = self._second(value)
        outputs = self.source.outputs
        wrong: dict[str | int, int] = {}  # of bits of outputs, and of latches
        for name, literal in outputs.items():
            port = name.split("[")[0]
            if port == HOLDS or port.startswith("looked_at_"):
                continue
            looked_at = read(value, outputs[f"looked_at_{port}"])
            wrong[name] = self.both(looked_at, self.differ(read(value, literal), read(other, literal)))
        for literal, following, _ in self.source.latches:
            if literal not in self.apart:
                wrong[literal] = self.differ(read(value, following), read(other, following))
            else:
                self.next[self.twin[literal]] = read(other, following)
            self.next[self.latch[literal]] = read(value, following)
        self.wrong = {place: different for place, different in wrong.items() if different}
        self.bad = self.either(self.wrong.values())

    def _first(self) -> dict[int, int]:
        """Build the copy without the mutant; return the literal of each node."""
        value = {0: 0} | self.input_of | dict.fromkeys(self.selector, 0)
        if RESET in self.source.inputs:  # the first cycle is a reset
            literal = self.source.inputs[RESET]
            value[literal] = self.either((self.input_of[literal], self.started ^ 1))
        for literal, _, start in self.source.latches:
            value[literal] = self.state(self.latch[literal], literal, start)
        for out, a, b in self.source.ands:
            value[out] = self.both(read(value, a), read(value, b))
        return value

    def _second(self, value: Mapping[int, int]) -> dict[int, int]:
        """Build what differs in the copy with the mutant: logic behind the selector, then what that logic reaches."""
        changed = {literal for literal, bit in self.selector.items() if self.number >> bit & 1}
        other = {**value, **dict.fromkeys(changed, 1)}
        while changed:
            moved = set(changed)
            for out, a, b in self.source.reached(changed):
                if a & ~1 in moved or b & ~1 in moved:
                    new = self.both(read(other, a), read(other, b))
                    if new != other[out]:
                        other[out] = new
                        moved.add(out)
            changed = set()
            for literal, following, start in self.source.loaded(moved):
                may_differ = literal not in self.apart and (self.allowed is None or literal in self.allowed)
                if may_differ and read(other, following) != read(value, following):
                    self.apart.add(literal)
                    other[literal] = self.state(self.twin[literal], literal, start)
                    changed.add(literal)
        return other

    def write(self, path: Path, outputs: Collection[int]) -> None:
        """Write a binary AIGER file with literals as outputs."""
        latches = [(self.started, 1, 0)]
        latches += [
            (table[literal], self.next.get(table[literal], table[literal]), int(start == 1))
            for table in (self.latch, self.twin)
            for literal, _, start in self.source.latches
        ]
        top = self.first - 1 + len(self.ands)
        head = f"aig {top} {len(self.inputs) + len(self.power_up)} {len(latches)} {len(outputs)} {len(self.ands)}\n"
        text = head + "".join(f"{following}{' 1' * start}\n" for _, following, start in latches)
        text += "".join(f"{literal}\n" for literal in outputs)
        coded = bytearray()
        for index, (a, b) in enumerate(self.ands):
            node = 2 * (self.first + index)
            for delta in (node - b, b - a):
                coded += number_of(delta)
        path.write_bytes(text.encode() + coded)

    def differing(self, path: Path, how: str, limit: int) -> list[str | int]:
        """Return the latches and output bits in which yosys-abc finds a difference."""
        self.write(path, self.wrong.values())
        output = abc(f"read_aiger {path.name}; {how}", path.parent, limit)
        places = list(self.wrong)
        return [places[int(number)] for number in re.findall(r"[Oo]utput +(\d+)[^\n]* asserted", output)]


def number_of(value: int) -> bytes:
    """Return a number in AIGER's binary form: seven bits a byte, lowest first."""
    out = bytearray()
    while value >= 128:
        out.append(value & 127 | 128)
        value >>= 7
    return bytes([*out, value])


def abc(commands: str, folder: Path, seconds: int) -> str:
    """Return the text that yosys-abc prints, or "" after a time-out."""
    command = [str(in_wheel("pyosys", "yosys-abc")), "-q", commands]
    try:
        result = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False, timeout=seconds)
    except subprocess.TimeoutExpired:
        return ""
    return result.stdout + result.stderr


def proved(name: str, folder: Path, seconds: int) -> bool:
    """Return True if yosys-abc proves that the output of a miter is never high."""
    limit = 6 * seconds + 20
    left = re.findall(
        r"lat *= *(\d+)", abc(f"read_aiger {name}; scleanup; scorr; dc2; write_aiger left-{name}; ps", folder, limit)
    )
    if left and not int(left[-1]):
        return "UNSATISFIABLE" in abc(f"read_aiger left-{name}; iprove", folder, limit)
    if left and "Property proved" in abc(f"read_aiger left-{name}; pdr -T {seconds}", folder, limit):
        return True
    return "Property proved" in abc(f"read_aiger {name}; scleanup; pdr -T {seconds}", folder, limit)


def confined(source: Graph, number: int, folder: Path, seconds: int) -> bool:
    """Return True if a difference stays in a few registers and never reaches an output that counts.

    All other registers are assumed to be the same in both copies. The proof covers this assumption and the outputs:
    until the first cycle in which it fails, the copies are as assumed. Memories and data paths are then built once. A
    search finds the registers that differ; they get a second copy, and the proof starts again.
    (Speculative reduction: H. Mony et al., "Exploiting suspected redundancy without proving it", DAC 2005.)
    """
    name = f"confined{number}.aig"
    apart: set[int] = set()
    while True:
        miter = Miter(source, number, apart)
        if miter.bad == 0:
            return True
        differing = miter.differing(folder / name, f"bmc3 -a -T {max(2, seconds // 8)}", seconds + 20)
        if not differing:
            miter.write(folder / name, [miter.bad])
            if proved(name, folder, seconds):
                return True
            differing = miter.differing(folder / name, f"pdr -a -T {seconds}", 2 * seconds + 20)
        new = {place for place in differing if isinstance(place, int)}
        if not new:
            return False
        apart |= new


SEARCH = 1  # seconds of the first search


def settle(source: Graph, number: int, folder: Path, seconds: int) -> tuple[str, str]:
    """Return the verdict on a mutant and the step that settles it; each step takes about `seconds`."""
    miter = Miter(source, number)
    if miter.bad == 0:
        return EQUIVALENT, "structure"
    name = f"miter{number}.aig"
    miter.write(folder / name, [miter.bad])

    def search(limit: int) -> bool:
        return "asserted in frame" in abc(f"read_aiger {name}; bmc3 -T {limit}", folder, 4 * limit + 20)

    if search(SEARCH):
        return DIFFERENT, "search"
    if confined(source, number, folder, seconds):
        return EQUIVALENT, "confinement"
    return (DIFFERENT, "longer search") if search(seconds) else (OPEN, f"open after {seconds} s")
