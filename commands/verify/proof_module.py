# SPDX-License-Identifier: Apache-2.0
"""Module around a proof: formal/<unit>/fv_<core>.sv repeats nothing of what the core's header says.

The file has a comment, a paragraph of parameters and of inputs of its own if there are any, and the statements of the
module, which has

- the core's parameters, with the values that the paragraph gives to some of them, and those of the paragraph;
- the core's inputs, but for those that the proof assigns, and those of the paragraph, such as a constant that is any;
- the core's outputs, and the inputs that the proof assigns, as signals, and the core itself as `dut`;
- `offer_stays u_<beginning> (.*);` as a claim on the output stream whose names begin so: what is offered stays;
- the core's protocol as `u_protocol`, unless the proof instantiates it (protocol.py);
- formal/assumed.sv, if the proof uses `started` or `allowed` and declares neither; `allowed` is what the protocol says,
  unless the proof assigns it.
"""

import re

from commands.common import header
from commands.common.repository import ROOT, Core, code
from commands.verify import protocol

OFFERS = re.compile(r"^offer_stays u_(\w+) \(\.\*\);", re.M)
FRONT = re.compile(r"(?://.*\n)*\n((?:(?:parameter|localparam|input) [^;]*;.*\n)*)")


def stays(head: header.Header, beginning: str) -> str:
    """Return the claim that a stream keeps what it offers; but where it does not count."""
    names = [port.name for port in head.of("output") if port.name.startswith(beginning)]
    word = f"{{{', '.join(names)}}}"
    pins = ", ".join(f".{pin}({beginning}{pin})" for pin in ("valid", "ready", "holds"))
    wires = f".clk, .rst(~u_protocol.counts_{beginning}valid), .reset(rst), .word({word}), {pins}"
    stream = f"offer_stays #(.Width($bits({word}))) u_{beginning} ({wires});"
    return f"logic {beginning}holds; {stream} always_comb {beginning}stays: assert ({beginning}holds);"


def module(core: Core) -> str:
    """Return the module fv_<core>; errors in it name file and line of the proof."""
    assert core.proof is not None, core.name
    head, text = header.read(core.hdl), protocol.BODY.sub("", core.proof.read_text())
    front = FRONT.match(text)
    assert front is not None, core.proof
    body, line = text[front.end() :], text.count("\n", 0, front.end()) + 1
    body = OFFERS.sub(lambda found: stays(head, found[1]), body)
    words = re.findall(r"(?<!\.)\b\w+", code(body))
    assigned = re.findall(r"^assign (\w+) =", body, re.M)
    own = header.entries(code(front[1]).replace(";", ","))
    own_inputs = [each for each in own if " = " not in each]
    values = {each.split(" = ")[0].split()[-1]: each for each in own if each not in own_inputs}
    parameters = values | head.parameters | values  # what the core derives comes last
    inputs = [f"input {port.type} {port.name}" for port in head.of("input") if port.name not in assigned]
    signals = [port for port in head.ports if port.side == "output" or port.name in assigned]
    given = [f".{name}({name})" for name, each in head.parameters.items() if each.startswith("parameter")]
    lines = [
        "`default_nettype none",
        f"module {core.proof.stem} {' '.join(f'import {package}::*;' for package in head.imports)}",
        f"#({', '.join(parameters.values())})" if parameters else "",
        f"({', '.join(inputs + own_inputs)});",
        *(f"{port.type} {port.name};" for port in signals),
        f"{core.name} #({', '.join(given)}) dut (.*);",
    ]
    if "u_protocol (" not in body:
        wires = ", ".join(f".{port.name}" for port in head.ports)
        lines.append(f"protocol_{core.name} #({', '.join(given)}) u_protocol ({wires});")
    if {"started", "allowed"} & {*words} and not re.search(r"^logic [^;]*\b(?:started|allowed)\b", body, re.M):
        lines += ["logic allowed, started;", "assumed u_assumed (.*);"]
        if not re.search(r"^assign allowed\b|\(allowed\)", body, re.M):
            lines.append("assign allowed = u_protocol.allowed;")
    lines += [f'`line {line} "{core.proof.relative_to(ROOT)}" 0', f"{body}endmodule", "`default_nettype wire\n"]
    return "\n".join(lines)
