# SPDX-License-Identifier: Apache-2.0
"""Protocol of a core, module protocol_<core>: which inputs the core allows, and in which clocks its outputs count.

PROTOCOL, beside the structures of a core (tb/structures.py), maps names to expressions of SystemVerilog over the core's
ports and parameters, `reset` (rst, or inputs that are not allowed) and `live` (there was a reset):

- `holds`: the inputs are allowed; by default what the parts below ask for;
- `counts`: outputs count; by default always;
- outputs of the core, with spaces between them: these count then, not as `counts` says;
- an input of the core: what it is given in place of what is offered;
- `stays`: beginnings of names, such as `in_` of in_valid, in_ready and other inputs: what is offered stays until taken;
- a module of formal/protocols/: a part, wired by name; the value maps its parameters to others than those of the same
  name. Expressions can use its outputs. PROTOCOL may be the name of a part alone.

A protocol with state of its own is the body of a module instead, which assigns these names, with `counts_` before an
output and `given_` before an input. It stands behind `module protocol_<core>;` at the end of the proof, or in a file of
its own where there is no proof. Without either all inputs are allowed, and all outputs count.
"""

import re
from collections.abc import Mapping
from typing import Any

from commands.common import header, repository
from commands.common.header import Header

FORMAL = repository.ROOT / "formal"
ALONE = ("fv_", "protocol_")  # with the files of one core
SHARED = [
    file for file in sorted(FORMAL.rglob("*.sv")) if not file.name.startswith(ALONE) or file.parent.name == "protocols"
]
PARTS = {file.stem: file for file in sorted((FORMAL / "protocols").glob("*.sv"))}
RULE = re.compile(r"\b(?:holds|counts|(?:counts|given)_\w+)\b(?!\()")
PLAIN = re.compile(r"logic( \[\d+:0\])?")  # types without a parameter
BODY = re.compile(r"^module protocol_(\w+);\n(.*?)^endmodule\n", re.S | re.M)
STATE = "logic reset, live = 1'b0;\nassign reset = rst | ~holds;\nalways_ff @(posedge clk) live <= live | reset;"


def stated(core: str) -> dict[str, Any]:
    """Return PROTOCOL of a core as a mapping."""
    row = repository.stated(core, "PROTOCOL") or {}
    return {row: {}} if isinstance(row, str) else dict(row)


def body(core: str) -> str:
    """Return the body of a protocol with state, "" if there is none."""
    own = repository.cores()[core]
    files = (own.proof, FORMAL / own.block / f"protocol_{core}.sv")
    texts = [file.read_text() for file in files if file and file.is_file()]
    return "".join(found[2] for text in texts for found in BODY.finditer(text))


class Rules:
    """Rules of a core while its protocol is put together: name to expression, "" if a part or the body assigns it."""

    def __init__(self, head: Header, text: str):
        self.head = head
        self.expressions = dict.fromkeys(RULE.findall(repository.code(text)), "")
        self.parts: list[str] = []
        self.asked: list[str] = []  # of the inputs by the parts

    def stream(self, beginning: str) -> None:
        """Add a part that asks of a stream that what is offered stays."""
        names = [port.name for port in self.head.of("input") if port.name.startswith(beginning)]
        word = f"{{{', '.join(name for name in names if name != f'{beginning}valid')}}}"
        pins = {name: f"{beginning}{name}" for name in ("valid", "ready")}
        self.part("offer_stays", {"Width": f"$bits({word})", "word": word} | pins, beginning)

    def part(self, name: str, chosen: Mapping[str, str | int], label: str = "") -> None:
        """Add a module of formal/protocols/; it makes those rules that the core leaves open."""
        own, ports = header.read(PARTS[name]), {port.name for port in self.head.ports}
        known = ports | {"reset", "live", "holds"}
        free = [each for each, text in own.parameters.items() if text.startswith("parameter")]
        values: dict[str, str | int] = {each: each for each in free if each in self.head.parameters}
        wires: dict[str, str | int] = {port.name: port.name for port in own.of("input") if port.name in known}
        for port in own.of("output"):
            if port.name == "holds":
                self.asked.append(f"{label or name}_holds")
                wires["holds"] = self.asked[-1]
                self.parts.append(f"logic {self.asked[-1]};")
            elif not RULE.fullmatch(port.name):
                if PLAIN.fullmatch(port.type):
                    wires[port.name] = port.name
                    self.parts.append(f"{port.type} {port.name};")
            elif port.name not in self.expressions and port.name.partition("_")[2] in ports | {""}:
                wires[port.name] = port.name
                self.expressions[port.name] = ""
        values |= {each: value for each, value in chosen.items() if each in free}
        wires |= {each: value for each, value in chosen.items() if each not in free}
        given, wired = (", ".join(f".{each}({value})" for each, value in of.items()) for of in (values, wires))
        self.parts.append(f"{name} {f'#({given}) ' if given else ''}u_{label or name} ({wired});")

    def row(self, names: str, value: str) -> None:
        """Add what PROTOCOL says of names."""
        inputs = [port.name for port in self.head.of("input")]
        for name in names.split():
            kind = "" if name in ("holds", "counts") else "given_" if name in inputs else "counts_"
            self.expressions[f"{kind}{name}"] = value


def module(core: str) -> str:
    """Return the module of a core's protocol.

    Its inputs are all ports of the core: inputs as they are offered, outputs as the core without a mutant drives them.
    Its outputs are `holds`; `allowed`: what is given is what is offered, too; `counts_<output>` of each output; and
    `sees_<input>` of each input: what is given, but zeros and a reset where the inputs are not allowed. So the protocol
    accepts any inputs, and the core behind it sees only allowed ones. Proofs by induction need that.
    """
    head, text = header.read(repository.cores()[core].hdl), body(core)
    inputs, outputs = head.of("input"), head.of("output")
    row = stated(core)
    rules = Rules(head, text)
    streams, parts = row.pop("stays", "").split(), {name: row.pop(name) for name in PARTS if name in row}
    for names, value in row.items():
        rules.row(names, value)
    for beginning in streams:
        rules.stream(beginning)
    for name, chosen in parts.items():
        rules.part(name, chosen)
    known = {"holds": " & ".join(rules.asked) or "1'b1", "counts": "1'b1"}
    known |= {f"counts_{port.name}": "counts" for port in outputs} | rules.expressions
    given = {port.name: f"given_{port.name}" for port in inputs if f"given_{port.name}" in known}
    same = "".join(f" & {name} == {value}" for name, value in given.items())
    ports = [f"input {port.type} {port.name}" for port in head.ports]
    ports += ["output logic holds, allowed", *(f"output logic counts_{port.name}" for port in outputs)]
    ports += [f"output logic [$bits({port.name})-1:0] sees_{port.name}" for port in inputs]
    lines = [
        "`default_nettype none",
        f"module protocol_{core} {' '.join(f'import {package}::*;' for package in head.imports)}",
        f"#({', '.join(head.parameters.values())})" if head.parameters else "",
        f"({', '.join(ports)});",
        "logic counts;",
        *(f"{port.type} given_{port.name};" for port in inputs if port.name in given),
        STATE if {"clk", "rst"} <= {port.name for port in inputs} else "",
        *rules.parts,
        *(f"assign {name} = {value};" for name, value in known.items() if value),
        f"assign allowed = holds{same};",
        *(f"assign sees_{p.name} = holds ? {given.get(p.name, p.name)} : {int(p.name == 'rst')};" for p in inputs),
        f"{text}endmodule",
        "`default_nettype wire\n",
    ]
    return "\n".join(filter(None, lines))
