# SPDX-License-Identifier: Apache-2.0
"""Whether a mutant can be told from its core at all, by anyone who keeps to the core's protocol.

The netlist with all mutants becomes one and-inverter graph, together with a small environment of SystemVerilog that
says which inputs are allowed and which outputs are looked at in which clock. Two copies of it, one without
and one with the mutant, get the same inputs and the same power-up state: registers and memories that are not
initialised start with anything, but with the same in both. The first clock is one of reset. Where the copies are built
alike they are one, so that what is left for the solver is what the mutant can reach. Then yosys-abc: `bmc3` looks for
a difference, `scorr` and `pdr` prove that there is none. Before them comes a proof that knows nothing of reachable
states, and so takes seconds where a whole solver takes them hours: from any state that is the same in both copies, a
few clocks later they are in the same state again, and nothing was seen (`Spans`). And a proof that knows no data: where
a difference can go (`Shadow`), for what is wrong only in places that are overwritten before anyone looks. And one that
has a second copy of those registers alone in which the two are seen to differ (`confined`).
"""

from __future__ import annotations

import heapq
import re
import subprocess
import threading
import time
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from importlib.util import find_spec
from itertools import product
from pathlib import Path

import numpy as np

from commands.verify.mutants import SELECTOR, instance, ports, yosys

EQUIVALENT, DIFFERENT, UNKNOWN = "equivalent", "different", "unknown"


ALWAYS = "1'b1"
HOLDS = "protocol_holds"
ENABLE, RESET = "any_en", "any_rst"
TO_GRAPH = """read_rtlil mutants.il
read_verilog -sv environment.v
hierarchy -top environment
proc
flatten
opt_clean
memory -nomap
memory_map
setundef -undriven -anyseq
opt -fast
dffunmap
techmap -map first_wins.v
techmap
opt -fast
dfflegalize -cell $_DFF_P_ 01
setundef -undriven -anyseq
aigmap
opt_clean
"""
# Of a multiplexer's selects a mutant may have two high: as in what Yosys writes for simulators, the lowest wins.
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
class Protocol:
    """Of a core: how it may be driven, and when its outputs mean something.

    `registers` is SystemVerilog before the rest: declarations with initial values and always blocks. `assume`
    are expressions that hold in every clock, of inputs and those registers; with a reset and zeros elsewhere they must.
    `compare` gives for an output the expression under which it is looked at, always where it is not named. The core's
    ports have their names, outputs being those of the core without a mutant. `given` are the expressions
    that inputs have, of inputs that may be anything, themselves among them; `decides` are inputs of more than one bit
    that are no data.
    """

    registers: str = ""
    assume: Sequence[str] = ()
    compare: Mapping[str, str] = field(default_factory=dict)
    given: Mapping[str, str] = field(default_factory=dict)
    decides: Sequence[str] = ()


@dataclass(frozen=True)
class Graph:
    """An and-inverter graph in AIGER's numbering: literal 2 v is node v, 2 v + 1 its inverse, 0 is false."""

    inputs: dict[str, int]  # name of the bit to its literal
    latches: list[tuple[int, int, int]]  # literal, next, start: 0, 1, or the literal itself for anything
    outputs: dict[str, int]
    ands: list[tuple[int, int, int]]
    decides: frozenset[int]  # literals of inputs that are no data


def across(bits: int) -> str:
    return f"[{bits - 1}:0] " if bits > 1 else ""


def environment(core: str, folder: Path, protocol: Protocol) -> str:
    """The core and its protocol as one module of Verilog.

    Inputs that break an assumption are replaced, in that clock, by zeros and a reset. So every clock of the module is
    allowed, and what holds of the core under its protocol holds of the module under any inputs, which is what
    proofs by induction need.
    """
    sides = ports(core, folder)
    inputs = {name: bits for name, (side, bits) in sides.items() if side == "input" and name != "clk"}
    outputs = {name: bits for name, (side, bits) in sides.items() if side == "output"}
    declared = [f"input wire {across(bits)}any_{name}" for name, bits in inputs.items()]
    declared += [f"output wire [{bits - 1}:0] {name}" for name, bits in outputs.items()]
    declared += [f"output wire looked_at_{name}" for name in outputs] + [f"output wire {HOLDS}"]
    declared += [f"input wire [11:0] {SELECTOR}", "input wire clk"]
    names = re.compile(r"(?<!')\b(" + "|".join(inputs) + r")\b")  # 1'b1 is no input b1
    holds = " & ".join(f"({expression})" for expression in protocol.assume) or ALWAYS
    holds = names.sub(r"any_\1", holds)
    lines = [f"module environment ({', '.join(declared)});"]
    lines += [f"  wire [{bits - 1}:0] {name};" for name, bits in inputs.items()]
    lines += [instance(core, folder), protocol.registers, f"  assign {HOLDS} = {holds};"]
    for name, bits in inputs.items():
        value = names.sub(r"any_\1", protocol.given.get(name, name))
        lines += [f"  assign {name} = {HOLDS} ? ({value}) : {bits}'d{int(name == 'rst')};"]
    lines += [f"  assign looked_at_{name} = {protocol.compare.get(name, ALWAYS)};" for name in outputs]
    return "\n".join([*lines, "endmodule\n"])


def graph(core: str, folder: Path, protocol: Protocol) -> Graph:
    """Of the netlist with all mutants and its environment. Memories become registers."""
    (folder / "environment.v").write_text(environment(core, folder, protocol))
    (folder / "first_wins.v").write_text(FIRST_WINS)
    yosys(f"{TO_GRAPH}write_aiger -ascii -symbols graph.aag\n", folder, "graph")
    lines = iter((folder / "graph.aag").read_text().splitlines())
    _, _, inputs, latches, outputs, ands = next(lines).split()
    in_literals = [int(next(lines)) for _ in range(int(inputs))]
    rows = [[int(word) for word in next(lines).split()] for _ in range(int(latches))]
    out_literals = [int(next(lines)) for _ in range(int(outputs))]
    gates = [tuple(int(word) for word in next(lines).split()) for _ in range(int(ands))]
    names = {}
    for line in lines:
        found = re.fullmatch(r"([io])(\d+) (\S+)", line)
        if found:
            names[found[1], int(found[2])] = found[3]
    # Those without a name are undefined values, such as words beyond the end of a memory: anything, in both copies.
    inputs_by_name = {names.get(("i", n), f"undefined{n}"): literal for n, literal in enumerate(in_literals)}

    def decides(bit: str) -> bool:
        name = bit.split("[")[0].removeprefix("any_")
        return name in protocol.decides or (bit == f"any_{name}" and name not in protocol.given)

    return Graph(
        inputs_by_name,
        [(row[0], row[1], row[2] if len(row) > 2 else 0) for row in rows],
        {names["o", n]: literal for n, literal in enumerate(out_literals)},
        sorted((gate[0], gate[1], gate[2]) for gate in gates),
        frozenset(literal for name, literal in inputs_by_name.items() if decides(name)),
    )


class Gates:
    """An and-inverter graph that grows; no two of its gates are alike. `first`: its first gate's node."""

    def __init__(self, first: int):
        self.first = first
        self.ands: list[tuple[int, int]] = []  # of nodes from self.first on
        self.known: dict[tuple[int, int], int] = {}

    def both(self, a: int, b: int) -> int:
        """The literal of a and b."""
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
    """Two copies of a graph, made one where they are alike, and whether they differ where it is looked at.

    The second copy has latches of its own where it can differ, or where `allowed` says so: all others are then taken to
    be the same in both, and `wrong` also has the literals of those that are not after all.
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
        count = 1
        self.input_of: dict[int, int] = {}
        self.power_up: dict[int, int] = {}
        self.latch: dict[int, int] = {}
        self.twin: dict[int, int] = {}
        for table, literals in ((self.input_of, self.inputs), (self.power_up, free)):
            for literal in literals:
                table[literal] = 2 * count
                count += 1
        self.input_count = count - 1
        self.started = 2 * count
        count += 1
        for table in (self.latch, self.twin):
            for literal, _, _ in source.latches:
                table[literal] = 2 * count
                count += 1
        super().__init__(count)
        self._build()

    def state(self, latch: int, literal: int, start: int) -> int:
        """What a latch shows: in the first clock its power-up value, where that is not given."""
        if start != literal:
            return latch
        return self.either((self.both(self.started, latch), self.both(self.started ^ 1, self.power_up[literal])))

    def _build(self) -> None:
        source = self.source
        value = {0: 0, 1: 1}

        def read(values: Mapping[int, int], literal: int) -> int:
            return values[literal & ~1] ^ (literal & 1)

        value.update(self.input_of)
        if "any_rst" in source.inputs:  # the first clock is one of reset
            literal = source.inputs["any_rst"]
            value[literal] = self.either((self.input_of[literal], self.started ^ 1))
        value.update(dict.fromkeys(self.selector, 0))
        for literal, _, start in source.latches:
            value[literal] = self.state(self.latch[literal], literal, start)
        for out, a, b in source.ands:
            value[out] = self.both(read(value, a), read(value, b))
        # The second copy, as far as it differs: what depends on the selector's bits, then what that reaches.
        other = dict(value)
        users: dict[int, list[int]] = {}
        for index, (_, a, b) in enumerate(source.ands):
            users.setdefault(a & ~1, []).append(index)
            users.setdefault(b & ~1, []).append(index)
        loaded: dict[int, list[int]] = {}
        for index, (_, following, _) in enumerate(source.latches):
            loaded.setdefault(following & ~1, []).append(index)
        apart: set[int] = set()  # latches of their own
        changed = []
        for literal, bit in self.selector.items():
            if self.number >> bit & 1:
                other[literal] = 1
                changed.append(literal)
        while changed:
            reached: set[int] = set()
            stack = list(changed)
            while stack:  # gates that may change
                for index in users.get(stack.pop(), ()):
                    if index not in reached:
                        reached.add(index)
                        stack.append(source.ands[index][0])
            moved = set(changed)
            for index in sorted(reached):
                out, a, b = source.ands[index]
                if a & ~1 in moved or b & ~1 in moved:
                    new = self.both(read(other, a), read(other, b))
                    if new != other[out]:
                        other[out] = new
                        moved.add(out)
            changed = []
            for node in moved:
                for index in loaded.get(node, ()):
                    literal, following, start = source.latches[index]
                    if literal in apart or (self.allowed is not None and literal not in self.allowed):
                        continue
                    if read(other, following) != read(value, following):
                        apart.add(literal)
                        other[literal] = self.state(self.twin[literal], literal, start)
                        changed.append(literal)
        self.apart = apart
        wrong: dict[str | int, int] = {}  # of bits of outputs, and of latches
        for name, literal in source.outputs.items():
            port = name.split("[")[0]
            if port == HOLDS or port.startswith("looked_at_"):
                continue
            looked_at = read(value, source.outputs[f"looked_at_{port}"])
            wrong[name] = self.both(looked_at, self.differ(read(value, literal), read(other, literal)))
        for literal, following, _ in source.latches:
            if literal not in apart:
                wrong[literal] = self.differ(read(value, following), read(other, following))
        self.wrong = {place: different for place, different in wrong.items() if different}
        self.bad = self.either(self.wrong.values())
        self.next = {self.latch[literal]: read(value, following) for literal, following, _ in source.latches}
        self.next.update(
            {self.twin[literal]: read(other, following) for literal, following, _ in source.latches if literal in apart}
        )
        self.start = {self.latch[literal]: int(start == 1) for literal, _, start in source.latches}
        self.start.update({self.twin[literal]: int(start == 1) for literal, _, start in source.latches})

    def write(self, path: Path, apiece: bool = False) -> None:
        """As a binary AIGER file with one output, a difference; or with `apiece` one for each that is `wrong`."""
        outputs = [*self.wrong.values()] if apiece else [self.bad]
        latches = [(self.started, 1, 0)]
        latches += [
            (latch, self.next.get(latch, latch), self.start[latch])
            for table in (self.latch, self.twin)
            for latch in table.values()
        ]
        top = self.first - 1 + len(self.ands)
        head = f"aig {top} {self.input_count} {len(latches)} {len(outputs)} {len(self.ands)}\n"
        text = head + "".join(
            f"{following} {start}\n" if start else f"{following}\n" for _, following, start in latches
        )
        text += "".join(f"{literal}\n" for literal in outputs)
        coded = bytearray()
        for index, (a, b) in enumerate(self.ands):
            node = 2 * (self.first + index)
            for delta in (node - b, b - a):
                coded += number_of(delta)
        path.write_bytes(text.encode() + bytes(coded))


def number_of(value: int) -> bytes:
    """As AIGER writes one: seven bits a byte, the lowest first."""
    out = bytearray()
    while value >= 128:
        out.append(value & 127 | 128)
        value >>= 7
    return bytes([*out, value])


class Span(Gates):
    """Some clocks of a graph from any state, and of its mutants beside it.

    `before` clocks go by in the core alone, so that its state is one that follows from another. `clocks` more, and a
    mutant shall be in the same state as the core again, with nothing seen on the way. That is the step of an
    induction. Its base, `first`: from power-up, with a reset in the first clock. `enables`: the pin `en` in each of the
    clocks before, where it is not anything; then what that reset leaves as power-up made it may differ.
    """

    def __init__(
        self, source: Graph, before: int, clocks: int, first: bool = False, enables: tuple[int, ...] | None = None
    ):
        chosen = {literal for name, literal in source.inputs.items() if name.split("[")[0] == SELECTOR}
        inputs = {name: literal for name, literal in source.inputs.items() if literal not in chosen}
        self.leaves = len(source.latches) + len(inputs) * (before + clocks)
        super().__init__(1 + self.leaves)
        leaf = iter(range(2, 2 * self.first, 2))
        self.source, self.before = source, before
        self.at_power_up = first and enables == ()
        self.values: list[dict[int, int]] = []  # of the core's nodes, by clock
        state = {latch: next(leaf) if not first or start == latch else start for latch, _, start in source.latches}
        self.states = [state]
        for clock in range(before + clocks):
            value = {0: 0, 1: 1, **state, **dict.fromkeys(chosen, 0)}
            for name, literal in inputs.items():
                node = next(leaf)
                value[literal] = 1 if first and not clock and name == RESET else node
            if enables is not None and clock < before:
                value[inputs[ENABLE]] = enables[clock]
            for out, a, b in source.ands:
                value[out] = self.both(value[a & ~1] ^ (a & 1), value[b & ~1] ^ (b & 1))
            self.values.append(value)
            state = {latch: value[to & ~1] ^ (to & 1) for latch, to, _ in source.latches}
            self.states.append(state)

    def differs(self, number: int, readers: Readers) -> int:
        """The literal of: the mutant is seen, or in another state at the end."""
        source, wrong = self.source, []
        state: dict[int, int] = {}  # of latches in which they differ
        for clock, value in enumerate(self.values[self.before :], self.before):
            other = dict(state)
            for literal, bit in readers.selector.items():
                if number >> bit & 1:
                    other[literal] = 1
            waiting = sorted({index for node in other for index in readers.gates.get(node, ())})
            queued = set(waiting)
            while waiting:  # in the order of the graph
                out, a, b = source.ands[heapq.heappop(waiting)]
                x, y = (other.get(side & ~1, value[side & ~1]) ^ (side & 1) for side in (a, b))
                new = self.both(x, y)
                if new != value[out]:
                    other[out] = new
                    for index in readers.gates.get(out, ()):
                        if index not in queued:
                            queued.add(index)
                            heapq.heappush(waiting, index)
            for looked_at, to in readers.outputs:
                if to & ~1 in other:
                    here, there = (v.get(to & ~1, value[to & ~1]) for v in (value, other))
                    seen = value[looked_at & ~1] ^ (looked_at & 1)
                    wrong.append(self.both(seen, self.differ(here, there)))
            state = {}
            for node, new in other.items():
                for latch, inverse in readers.latches.get(node, ()):
                    state[latch] = new ^ inverse
            following = self.states[clock + 1]
            state = {latch: new for latch, new in state.items() if new != following[latch]}
        last = self.states[-1]
        wrong += [
            self.differ(last[latch], new) for latch, new in state.items() if last[latch] < 2 or not self.at_power_up
        ]
        return self.either(wrong)


def write_formula(gates: Span | Idling, bad: int, path: Path) -> None:
    """What decides a literal, as a binary AIGER file with it for its output."""
    needed: set[int] = set()
    stack = [bad >> 1]
    while stack:
        node = stack.pop()
        if node >= gates.first and node not in needed:
            needed.add(node)
            stack += [literal >> 1 for literal in gates.ands[node - gates.first]]
    order = sorted(needed)
    place = {node: gates.first + index for index, node in enumerate(order)}

    def moved(literal: int) -> int:
        return 2 * place.get(literal >> 1, literal >> 1) + (literal & 1)

    coded = bytearray()
    for node in order:
        low, high = sorted(moved(literal) for literal in gates.ands[node - gates.first])
        coded += number_of(2 * place[node] - high) + number_of(high - low)
    head = f"aig {gates.leaves + len(order)} {gates.leaves} 0 1 {len(order)}\n{moved(bad)}\n"
    path.write_bytes(head.encode() + bytes(coded))


class Readers:
    """Of a graph: what reads each of its nodes."""

    def __init__(self, source: Graph):
        self.selector = {
            literal: int(name.split("[")[1][:-1])
            for name, literal in source.inputs.items()
            if name.split("[")[0] == SELECTOR
        }
        self.gates: dict[int, list[int]] = {}
        for index, (_, a, b) in enumerate(source.ands):
            self.gates.setdefault(a & ~1, []).append(index)
            self.gates.setdefault(b & ~1, []).append(index)
        self.latches: dict[int, list[tuple[int, int]]] = {}
        for latch, to, _ in source.latches:
            self.latches.setdefault(to & ~1, []).append((latch, to & 1))
        self.outputs = [
            (source.outputs[f"looked_at_{name.split('[')[0]}"], to)
            for name, to in source.outputs.items()
            if name != HOLDS and not name.startswith("looked_at_")
        ]


LINGERS = 2  # clocks without `en` after which nothing moves: a count of clipped values has two registers without it
ENABLED = 2  # clocks with `en` before, at most
LARGEST = 3_000_000  # gates that may take
# Clocks (before, then) of the tries: what a state can never be takes some before, what passes on and dies some then.
SPANS = ((0, 1), (2, 3), (3, 8))


class Spans:
    """The proof by induction over a few clocks, for all mutants of a graph."""

    def __init__(self, source: Graph):
        self.source, self.readers = source, Readers(source)
        self.made: dict[tuple, Span] = {}
        self.idles: bool | None = None
        self.lock = threading.Lock()  # the formulas of all mutants share their gates

    def formula(
        self, number: int, before: int, clocks: int, first: bool, path: Path, enables: tuple[int, ...] | None = None
    ) -> int:
        """Write it; its literal: 0 is never, 1 is always."""
        with self.lock:
            key = before, clocks, first, enables
            if key not in self.made:
                self.made[key] = Span(self.source, *key)
            bad = self.made[key].differs(number, self.readers)
            if bad > 1:
                write_formula(self.made[key], bad, path)
        return bad

    def prove(self, number: int, folder: Path, seconds: int) -> bool:
        """Whether core and mutant, in the same state, are so again some clocks later, with nothing seen."""
        name = f"span{number}.aig"
        for before, clocks in SPANS:
            step = (before, clocks, False)
            for part in (step, (0, before, True)) if before else (step,):
                bad = self.formula(number, *part, folder / name)
                if bad and (bad == 1 or "UNSATISFIABLE" not in abc(f"read_aiger {name}; dc2; iprove", folder, seconds)):
                    break
            else:
                return True
        return False

    def prove_between_pauses(self, number: int, folder: Path, seconds: int) -> bool:
        """The same from states that follow from others in clocks with `en`.

        Any number of the clocks before may be without it, in which nothing follows from anything. But where longer
        pauses make no other states (`Idling`), each state is one in which so many clocks with `en` ended, each with a
        short pause behind it; or, close to power-up, fewer of them. What the first reset leaves in registers that it
        does not set counts as power-up: that no output depends on it is proven elsewhere (commands/verify/formal.py).
        """
        source = self.source
        size = len(source.ands) * sum((LINGERS + 2) ** count * (count + LINGERS) for count in range(1, ENABLED + 1))
        if not {ENABLE, RESET} <= source.inputs.keys() or size > LARGEST:
            return False
        name = f"pause{number}.aig"
        lengths = range(LINGERS + 2)  # of pauses

        def patterns(count: int) -> list[tuple[int, ...]]:
            """So many clocks with `en`, a pause behind each."""
            every = product(lengths, repeat=count)
            return [tuple(en for pause in pauses for en in (1, *[0] * pause)) for pauses in every]

        for count in range(1, ENABLED + 1):
            before = [(False, pattern) for pattern in patterns(count)]
            for early, lead in product(range(count), lengths):
                before += [(True, (0,) * lead + pattern) for pattern in patterns(early)]
            for first, enables in before:
                part = (len(enables), 1, first)
                bad = self.formula(number, *part, folder / name, enables)
                if bad and (bad == 1 or "UNSATISFIABLE" not in abc(f"read_aiger {name}; dc2; iprove", folder, seconds)):
                    break
            else:
                with self.lock:
                    if self.idles is None:
                        self.idles = Idling(source, self.readers).proven(folder, seconds)
                return self.idles
        return False


class Idling(Gates):
    """What clocks without `en` do to the state of a core: after some, one more before them is nothing.

    `fails` is the literal of the contrary: from some state, with a protocol that holds throughout, LINGERS clocks
    without `en` leave another state than they do behind one more, which is no reset; or one in reset leaves another
    than it does behind one more in reset. Where it is never true, every state is one that a sequence of clocks without
    more than LINGERS + 1 in a row without `en` leads to: others may be left out, one by one.
    """

    def __init__(self, source: Graph, readers: Readers):
        names = {name: literal for name, literal in source.inputs.items() if literal not in readers.selector}
        self.leaves = len(source.latches) + len(names) * (LINGERS + 1)
        super().__init__(1 + self.leaves)
        leaf = iter(range(2, 2 * self.first, 2))
        begun = {latch: next(leaf) for latch, _, _ in source.latches}
        clocks = [{literal: next(leaf) for literal in names.values()} for _ in range(LINGERS + 1)]
        chosen = dict.fromkeys(readers.selector, 0)

        def after(row: Sequence[Mapping[int, int]]) -> tuple[dict[int, int], int]:
            """The state behind clocks, and whether the protocol holds in all of them."""
            state, holds = begun, 1
            for given in row:
                value = {0: 0, 1: 1, **state, **chosen, **given}
                for out, a, b in source.ands:
                    value[out] = self.both(value[a & ~1] ^ (a & 1), value[b & ~1] ^ (b & 1))
                state = {latch: value[to & ~1] ^ (to & 1) for latch, to, _ in source.latches}
                held = source.outputs[HOLDS]
                holds = self.both(holds, value[held & ~1] ^ (held & 1))
            return state, holds

        self.fails = 0
        for in_reset, count in ((0, LINGERS + 1), (1, 2)):
            row = [given | {names[ENABLE]: 0} for given in clocks[:count]]
            row[0][names[RESET]] = in_reset
            if in_reset:
                row[1][names[RESET]] = 1
            longer, holds = after(row)
            shorter, _ = after(row[1:])
            apart = self.either(self.differ(longer[latch], shorter[latch]) for latch in begun)
            self.fails = self.either((self.fails, self.both(holds, apart)))

    def proven(self, folder: Path, seconds: int) -> bool:
        if self.fails < 2:
            return not self.fails
        write_formula(self, self.fails, folder / "idling.aig")
        return "UNSATISFIABLE" in abc("read_aiger idling.aig; dc2; iprove", folder, seconds)


Kind = tuple[int, int]  # literals: a node can be 1, it can be 0


class Shadow(Gates):
    """Where a mutant's difference can go, whatever the data are.

    Of each node it is known whether it can be 1 and whether it can be 0, in the core and in the mutant, and whether the
    two may differ there. Inputs of one bit, and what else decides, are what they are, all others, and what is not
    initialised, unknown: what is left is simple, and has few states (`never`). A difference passes a gate whose
    other side may be 1, unless the gate is known to be the same in both; so more is reached than in truth, and where
    nothing that is looked at is reached there is no difference. (Three values: R. E. Bryant, "A switch-level model",
    1984; differences that are followed through gates: M. Tiwari et al., "Complete information flow tracking from the
    gates up", ASPLOS 2009.)
    """

    def __init__(self, source: Graph, number: int, readers: Readers):
        exact = sorted(source.decides)
        self.inputs = len(exact)
        started = 2 * (1 + self.inputs)
        super().__init__(2 + self.inputs + 5 * len(source.latches))
        core: dict[int, Kind] = {}  # of nodes: whether they can be 1, and 0
        mutant: dict[int, Kind] = {}
        differs: dict[int, int] = {}

        def give(literal: int, here: Kind, there: Kind, apart: int) -> None:
            core[literal], mutant[literal], differs[literal] = here, there, apart

        for literal in source.inputs.values():
            give(literal, (1, 1), (1, 1), 0)
        give(0, (0, 1), (0, 1), 0)
        for literal, bit in readers.selector.items():
            set_there = number >> bit & 1
            give(literal, (0, 1), (set_there, 1 - set_there), set_there)
        for place, literal in enumerate(exact, 1):
            value = 2 * place
            if literal == source.inputs.get(RESET):  # the first clock is one of reset
                value = self.either((value, started ^ 1))
            give(literal, (value, value ^ 1), (value, value ^ 1), 0)
        # AIGER's latches start at 0, so that what a latch of the core can be is kept inverted where it can be that.
        inverted = []
        for place, (latch, _, start) in enumerate(source.latches):
            one, zero, one_there, zero_there, apart = range(started + 2 + 10 * place, started + 12 + 10 * place, 2)
            inverted.append((int(start != 0), int(start != 1)))
            at_one, at_zero = inverted[-1]
            give(latch, (one ^ at_one, zero ^ at_zero), (one_there ^ at_one, zero_there ^ at_zero), apart)

        def side(kinds: Mapping[int, Kind], literal: int) -> Kind:
            can_be_one, can_be_zero = kinds[literal & ~1]
            return (can_be_zero, can_be_one) if literal & 1 else (can_be_one, can_be_zero)

        holds = source.outputs[HOLDS]
        for out, a, b in source.ands:
            kinds = []
            for table in (core, mutant):
                (a_one, a_zero), (b_one, b_zero) = side(table, a), side(table, b)
                kinds.append([self.both(a_one, b_one), self.either((a_zero, b_zero))])
            opens = [self.either((side(core, x)[0], side(mutant, x)[0])) for x in (a, b)]
            passes = self.either((self.both(differs[a & ~1], opens[1]), self.both(differs[b & ~1], opens[0])))
            (one, zero), (one_there, zero_there) = kinds
            alike = self.either((self.both(one ^ 1, one_there ^ 1), self.both(zero ^ 1, zero_there ^ 1)))
            apart = self.both(passes, alike ^ 1)
            if out == holds & ~1:
                # Where data decide that, it holds: a clock in which it does not is one of reset, which comes as well.
                broken = 1 - (holds & 1)  # what of a kind says that it does not hold
                for kind in kinds:
                    kind[broken] = self.both(kind[broken], self.both(kind[1 - broken], apart ^ 1) ^ 1)
            give(out, (kinds[0][0], kinds[0][1]), (kinds[1][0], kinds[1][1]), apart)
        self.latches = [1]  # of `started`, then of what a latch can be in both copies, and whether it differs
        for (_, to, _), at in zip(source.latches, inverted, strict=True):
            self.latches += [
                can ^ kept for table in (core, mutant) for can, kept in zip(side(table, to), at, strict=True)
            ]
            self.latches.append(differs[to & ~1])
        wrong = []
        for looked_at, to in readers.outputs:
            seen = self.either((side(core, looked_at)[0], differs[looked_at & ~1]))
            wrong.append(self.both(seen, differs[to & ~1]))
        self.bad = self.either(wrong)

    def write(self, path: Path) -> None:
        """As a binary AIGER file with one output."""
        top = self.first - 1 + len(self.ands)
        head = f"aig {top} {self.inputs} {len(self.latches)} 1 {len(self.ands)}\n"
        coded = bytearray()
        for index, sides in enumerate(self.ands):
            node, (low, high) = 2 * (self.first + index), sorted(sides)
            coded += number_of(node - high) + number_of(high - low)
        path.write_bytes((head + "".join(f"{to}\n" for to in [*self.latches, self.bad])).encode() + bytes(coded))

    def never(self, folder: Path, name: str, seconds: int) -> bool:
        """Whether no difference is ever seen: abc makes the graph small, then looks for a proof and for the contrary;
        where it finds neither, all states are visited."""
        if self.bad < 2:
            return self.bad == 0
        self.write(folder / name)
        small = folder / f"small-{name}"
        small.unlink(missing_ok=True)
        make = f"read_aiger {name}; scleanup; scorr; dc2; write_aiger {small.name}; pdr -T {2 * seconds}"
        said = abc(make, folder, 6 * seconds + 20)
        if "Property proved" in said or "was asserted" in said:
            return "Property proved" in said
        return small.is_file() and self.inputs <= MOST_EXACT and unreachable(small, 6 * seconds)


MOST_EXACT = 11  # bits of inputs that are not left unknown
MOST_STATES = 2_000_000
CHUNK = 1 << 28  # bytes for all nodes of the states looked at together


def unreachable(path: Path, seconds: int) -> bool:
    """Whether the output of a binary AIGER file stays low in every state that its latches can reach from 0."""
    data = path.read_bytes()
    lines = data.split(b"\n", 1)
    _, inputs, latches, _, ands = (int(word) for word in lines[0].split()[1:6])
    *rows, data = lines[1].split(b"\n", latches + 1)
    following, bad = [int(row.split()[0]) for row in rows[:-1]], int(rows[-1])
    numbers: list[int] = []
    value = shift = 0
    for byte in data:
        if len(numbers) == 2 * ands:  # behind that, names and a comment
            break
        value |= (byte & 127) << shift
        shift += 7
        if byte < 128:
            numbers.append(value)
            value = shift = 0
    gates = []
    for index, (far, near) in enumerate(zip(numbers[::2], numbers[1::2], strict=True)):
        high = 2 * (1 + inputs + latches + index) - far
        gates.append((high, high - near))
    given = (np.arange(1 << inputs)[:, None] >> np.arange(inputs) & 1).astype(np.uint8)
    most = max(1, (CHUNK * 8 // (1 + inputs + latches + ands)) >> inputs)
    frontier, visited = np.zeros((1, latches), np.uint8), set()
    end = time.monotonic() + seconds
    while len(frontier):
        found = []
        for begin in range(0, len(frontier), most):
            states = np.repeat(frontier[begin : begin + most], len(given), axis=0)
            count = len(states)
            inputs_now = np.tile(given, (count // len(given), 1))
            leaves = np.concatenate((np.zeros((count, 1), np.uint8), inputs_now, states), axis=1)
            nodes = list(np.packbits(leaves, axis=0).T.copy())

            def read(literal: int, nodes: list[np.ndarray] = nodes) -> np.ndarray:
                return ~nodes[literal >> 1] if literal & 1 else nodes[literal >> 1]

            for a, b in gates:
                nodes.append(read(a) & read(b))
            if np.unpackbits(read(bad), count=count).any() or time.monotonic() > end:
                return False
            if not latches:
                continue
            # As bytes, a state each.
            after = np.stack([np.unpackbits(read(literal), count=count) for literal in following], 1)
            packed = np.packbits(after, axis=1)
            words = packed.view(np.dtype((np.void, packed.shape[1]))).ravel()
            for word in np.unique(words).tolist():
                if word not in visited:
                    visited.add(word)
                    found.append(word)
        if len(visited) > MOST_STATES:
            return False
        states = np.frombuffer(b"".join(found), np.uint8).reshape(len(found), -(-latches // 8))
        frontier = np.unpackbits(states, axis=1, count=latches)
    return True


def abc(commands: str, folder: Path, seconds: int) -> str:
    """What yosys-abc prints, or nothing if it takes too long."""
    package = find_spec("pyosys")
    assert package is not None
    assert package.submodule_search_locations
    program = str(Path(package.submodule_search_locations[0]) / "yosys-abc")
    try:
        result = subprocess.run(
            [program, "-q", commands], cwd=folder, capture_output=True, text=True, check=False, timeout=seconds
        )
    except subprocess.TimeoutExpired:
        return ""
    return result.stdout + result.stderr


def proved(name: str, folder: Path, seconds: int) -> bool:
    """Whether the output of a miter is never high."""
    limit = 6 * seconds + 20
    left = re.findall(
        r"lat *= *(\d+)", abc(f"read_aiger {name}; scleanup; scorr; dc2; write_aiger left-{name}; ps", folder, limit)
    )
    if left and not int(left[-1]):
        return "UNSATISFIABLE" in abc(f"read_aiger left-{name}; iprove", folder, limit)
    if left and "Property proved" in abc(f"read_aiger left-{name}; pdr -T {seconds}", folder, limit):
        return True
    return "Property proved" in abc(f"read_aiger {name}; scleanup; pdr -T {seconds}", folder, limit)


CONFINING = 20  # seconds, where more were given


def confined(source: Graph, number: int, folder: Path, seconds: int) -> bool:
    """Whether a difference is confined to a few registers, where it is never seen.

    All others are taken to be the same in both copies, and that they are is what is proven, with the outputs: so until
    the first clock in which it fails, the copies are what they were taken to be. What it has to know of data, such as a
    memory's words, is then there once. The few are those in which a search finds a difference, again and again.
    (Speculative reduction: H. Mony et al., "Exploiting suspected redundancy without proving it", DAC 2005.)
    """
    name = f"confined{number}.aig"
    apart: set[int] = set()
    while True:
        miter = Miter(source, number, apart)
        if miter.bad == 0:
            return True
        places = list(miter.wrong)

        def met(how: str, limit: int, places: Sequence[str | int] = places, miter: Miter = miter) -> list[str | int]:
            """What is wrong, after all."""
            miter.write(folder / name, apiece=True)
            said = abc(f"read_aiger {name}; {how}", folder, limit)
            return [places[int(found)] for found in re.findall(r"[Oo]utput +(\d+)[^\n]* asserted", said)]

        found = met(f"bmc3 -a -T {max(2, seconds // 8)}", seconds + 20)
        if not found:
            miter.write(folder / name)
            if proved(name, folder, seconds):
                return True
            found = met(f"pdr -a -T {seconds}", 2 * seconds + 20)
        new = {place for place in found if isinstance(place, int)}
        if not new:
            return False
        apart |= new


def settle(source: Graph, spans: Spans, number: int, folder: Path, seconds: int) -> tuple[str, str]:
    """(verdict, how): whether the mutant can be told apart, within about so many seconds for each step."""
    miter = Miter(source, number)
    if miter.bad == 0:
        return EQUIVALENT, "by structure"
    name = f"miter{number}.aig"
    miter.write(folder / name)

    def looked(search: int, proof: int) -> tuple[str, str] | None:
        """A search and a proof of so many seconds; None: neither came to an end."""
        frame = None
        if search:
            found = abc(f"read_aiger {name}; bmc3 -T {search}", folder, 4 * search + 20)
            frame = re.search(r"asserted in frame (\d+)", found)
        if frame:
            return DIFFERENT, f"after {frame[1]} clocks"
        if proof and proved(name, folder, proof):
            return EQUIVALENT, "by proof"
        return None

    # Most are told apart in a few clocks, or proven by what is alike in both copies.
    if quick := looked(1, 2):
        return quick
    if confined(source, number, folder, min(seconds, CONFINING)):
        return EQUIVALENT, "by a difference confined to a few registers"
    if Shadow(source, number, spans.readers).never(folder, f"shadow{number}.aig", seconds):
        return EQUIVALENT, "by where a difference can go"
    if spans.prove_between_pauses(number, folder, seconds):
        return EQUIVALENT, "by induction between pauses"
    if spans.prove(number, folder, seconds):
        return EQUIVALENT, "by induction over a few clocks"
    return looked(seconds // 10, seconds) or looked(seconds, 0) or (UNKNOWN, f"in {seconds} s")
