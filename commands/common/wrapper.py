# SPDX-License-Identifier: Apache-2.0
"""Wrappers of the tops with a configuration inside, and the package of the configuration."""

import os
import re
import textwrap
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

from commands.common import repository
from tactile_depth.chip.registers.device_description import is_arithmetic
from tactile_depth.chip.registers.register_map import ADDRESS_WIDTH
from tactile_depth.chip.tactile_depth import CONSTANTS, default_parameters

DEFAULTS = repository.HDL / "td_config_pkg.sv"
NAME = re.compile(r"[a-z][a-z0-9_]*")
NAMES = "accepted are small letters, digits and _, beginning with a letter"


def top_of(parameters: Mapping[str, int]) -> str:
    """Return the top of hdl/ for the fields of a configuration."""
    return "tactile_sensor" if parameters["Camera"] else "tactile_depth"


@dataclass(frozen=True)
class Port:
    """A port of a top, with its width in bits."""

    direction: str  # input or output
    name: str
    width: int
    note: str = ""

    @property
    def interface(self) -> str:
        """Name of the AXI interface that it belongs to; "" for others."""
        found = re.match(r"[sm]_(axis|axil|event)(?=_)", self.name)
        return found[0] if found else ""

    def declared(self, kind: str = "wire") -> str:
        """Return its declaration."""
        bits = f"[{self.width - 1}:0] " if self.width > 1 else ""
        return f"{self.direction:6} {kind} {bits:8}{self.name}"


PORT = re.compile(
    r"  (?P<direction>input|output) +(?:wire|logic)? *(?P<struct>\w+_t +)?"
    r"(?:\[(?:(?P<factor>\d+)\*)?(?:(?P<parameter>[A-Z]\w+)-1|(?P<high>\d+)):0\] +)?"
    r"(?P<name>\w+),?(?: *// (?P<note>.*))?"
)


def ports(top: str, parameters: Mapping[str, int]) -> list[Port]:
    """Return the ports of a top in hdl/ for the fields of a configuration."""
    header = re.search(r"^\) \(\n(.*?)\n\);\n", (repository.HDL / f"{top}.sv").read_text(), re.DOTALL | re.MULTILINE)
    assert header is not None
    widths = {"DepthBytes": depth_bytes(parameters), "AddressWidth": ADDRESS_WIDTH}
    found = []
    for line in filter(str.strip, header[1].splitlines()):
        each = PORT.fullmatch(line)
        assert each is not None, line
        width = int(each["high"] or 0) + 1
        if each["struct"]:
            width = struct_width(each["struct"].strip())
        elif each["parameter"]:
            width = int(each["factor"] or 1) * widths[each["parameter"]]
        found.append(Port(each["direction"], each["name"], width, each["note"] or ""))
    return found


def depth_bytes(parameters: Mapping[str, int]) -> int:
    """Return the bytes of a beat of depth."""
    return parameters["Lanes"] * -(-parameters["DataWidth"] // 8)


def struct_width(name: str) -> int:
    """Return the bits of a packed struct of hdl/td_types_pkg.sv."""
    text = (repository.HDL / "td_types_pkg.sv").read_text()
    struct = re.search(rf"struct packed {{([^}}]*)}} {name};", text)
    assert struct is not None
    return sum(int(high or 0) + 1 for high in re.findall(r"^ +logic +(?:\[(\d+):0\] )?\w+;", struct[1], re.MULTILINE))


def outer_ports(parameters: Mapping[str, int]) -> list[Port]:
    """Return the ports of a wrapper: those of its top, without those between the two tops."""
    return [port for port in ports(top_of(parameters), parameters) if not port.name.startswith("register_")]


def literal(number: int) -> str:
    """Return a number of 32 bits as SystemVerilog writes it."""
    return f"-32'sd{-number}" if number < 0 else f"32'd{number}"


def package() -> str:
    """Return the text of hdl/td_config_pkg.sv."""
    fields = default_parameters()
    constants = "".join(f"  localparam int {name} = {value};  // {what}\n" for name, (value, what) in CONSTANTS.items())
    numbers = "".join(f"  localparam int {name}Field = {position};\n" for position, name in enumerate(fields))
    listed = [(literal(number), name) for name, number in fields.items()][::-1]
    words = "".join(f"    {word},  // {name}\n" for word, name in listed[:-1])
    last, name = listed[-1]
    arithmetic = "".join(str(int(is_arithmetic(name))) for _, name in listed)
    return f"""// SPDX-License-Identifier: Apache-2.0
// td_config_pkg: the configuration of a pipeline as one value, and constants that no configuration changes.
//
// Written by `make registers` from models/tactile_depth/chip/tactile_depth.py: change it there.

`default_nettype none

package td_config_pkg;

{constants}
  // A configuration is one vector: 32 bits for each number, by its field.
  localparam int ConfigBits = {32 * len(fields)};
{numbers}
  // The default configuration; options that it leaves out have the numbers of a configuration with the option.
  localparam logic [ConfigBits-1:0] DefaultConfig = {{
{words}    {last}  // {name}
  }};

  // The fields that the register ARITHMETIC holds.
  localparam logic [ConfigBits/32-1:0] ArithmeticFields = {len(fields)}'h{int(arithmetic, 2):x};

  // Return the number in a field of a configuration.
  function automatic int value(input logic [ConfigBits-1:0] config_word, input int field);
    value = config_word[32*field+:32];
  endfunction

endpackage

`default_nettype wire
"""


def port_list(declared: Iterable[Port]) -> str:
    """Return the port list of a module, a line each with the note of the port."""
    lines = [(port.declared(), port.note) for port in declared]
    last = len(lines) - 1
    width = max(len(text) for text, _ in lines) + 1
    texts = [f"{text}{'' if number == last else ','}" for number, (text, _) in enumerate(lines)]
    notes = [f"  // {note}" if note else "" for _, note in lines]
    return "".join(f"  {text:{width if note else 0}}{note}\n" for text, note in zip(texts, notes, strict=True))


def wrapper(name: str, parameters: Mapping[str, int], tables: str = "./") -> str:
    """Return the text of the module <top>_<name>, which finds its table files in the folder `tables`.

    The top is tactile_sensor for a configuration with a camera, whose words its s_axis takes, otherwise tactile_depth.
    The port list has numbers alone, so that it can be read without the packages of hdl/.
    """
    top, outer = top_of(parameters), outer_ports(parameters)
    fields = "".join(
        f"    configuration[32*{field}Field+:32] = {literal(number)};\n" for field, number in parameters.items()
    )
    connected = ", ".join(f".{port.name}" for port in outer)
    without = ""
    if not parameters["Camera"]:
        without = "  register_command_t unused_command;\n  register_answer_t no_answer;\n  assign no_answer = '0;\n"
        connected += ", .register_command(unused_command), .register_answer(no_answer)"
    connected = "\n    ".join(textwrap.wrap(connected, 116))
    instance = "u_sensor" if parameters["Camera"] else "u_pipeline"
    types = "" if parameters["Camera"] else "  import td_types_pkg::*;\n"
    return f"""// {top}_{name}: {top} with one configuration. Generated: do not edit.

`default_nettype none

module {top}_{name} #(
  parameter TableFolder = "{tables}"  // of its .hex files, with a / at the end
) (
{port_list(outer)});

  import td_config_pkg::*;
{types}
  function automatic logic [ConfigBits-1:0] configuration();
{fields}  endfunction
  localparam logic [ConfigBits-1:0] Config = configuration();
{without}
  {top} #(.TableFolder(TableFolder), .Config(Config)) {instance} (
    {connected}
  );

endmodule

`default_nettype wire
"""


def shell_ports(parameters: Mapping[str, int]) -> list[Port]:
    """Return the ports of a shell: those of the wrapper, and tkeep beside the tdata of each stream that leaves."""
    found = []
    for port in outer_ports(parameters):
        found.append(port)
        if port.name in ("m_axis_tdata", "m_event_tdata"):
            found.append(Port("output", port.name.replace("tdata", "tkeep"), port.width // 8, "all ones"))
    return found


def shell(name: str, parameters: Mapping[str, int], tables: str = "./") -> str:
    """Return the text of the module <top>_<name>_shell: Verilog-2005 around the wrapper of the same arguments.

    Its attributes tell AMD's tools clock, reset and interrupt.
    """
    module, outer = f"{top_of(parameters)}_{name}", shell_ports(parameters)
    inside = [port.name for port in outer_ports(parameters)]
    streams = ":".join(dict.fromkeys(port.interface for port in outer if port.interface))
    attributes = {
        "clk": ("clock:1.0 clk CLK", f"ASSOCIATED_BUSIF {streams}, ASSOCIATED_RESET rst"),
        "rst": ("reset:1.0 rst RST", "POLARITY ACTIVE_HIGH"),
        "irq": ("interrupt:1.0 irq INTERRUPT", "SENSITIVITY LEVEL_HIGH"),
    }
    listed = port_list(outer)
    for port, (kind, detail) in attributes.items():
        text = f'  (* X_INTERFACE_INFO = "xilinx.com:signal:{kind}", X_INTERFACE_PARAMETER = "{detail}" *)\n'
        listed = re.sub(rf"^(?=.* {port}(,|$))", text, listed, count=1, flags=re.MULTILINE)
    keeps = "".join(f"  assign {port.name} = {{{port.width}{{1'b1}}}};\n" for port in outer if port.name not in inside)
    connected = "\n    ".join(textwrap.wrap(", ".join(f".{port}({port})" for port in inside), 116))
    return f"""// {module}_shell: {module} for tools whose top is Verilog. Generated: do not edit.

`default_nettype none

module {module}_shell #(
  parameter TableFolder = "{tables}"  // of the .hex files, with a / at the end
) (
{listed});

{keeps}
  {module} #(.TableFolder(TableFolder)) u_module (
    {connected}
  );

endmodule

`default_nettype wire
"""


def write(folder: Path, name: str, parameters: Mapping[str, int], tables: str = "./") -> Path:
    """Write the wrapper into a folder, and return its path; an equal file is left as it is."""
    return _written(folder / f"{top_of(parameters)}_{name}.sv", wrapper(name, parameters, tables))


def write_shell(folder: Path, name: str, parameters: Mapping[str, int], tables: str = "./") -> Path:
    """Write the shell into a folder, and return its path."""
    return _written(folder / f"{top_of(parameters)}_{name}_shell.v", shell(name, parameters, tables))


def _written(path: Path, text: str) -> Path:
    folder = path.parent
    folder.mkdir(parents=True, exist_ok=True)
    if not path.is_file() or path.read_text() != text:
        draft = path.with_suffix(f".{os.getpid()}")
        draft.write_text(text)
        draft.replace(path)  # another process may read it
    return path


def grid(parameters: Mapping[str, int]) -> dict[str, int]:
    """Return the parameters that a module around a wrapper needs itself."""
    return {name: parameters[name] for name in ("Rows", "Columns", "DataWidth", "Lanes")}


def linked(parameters: Mapping[str, int]) -> dict[str, int]:
    """Return the parameters that a module with a host link around a wrapper needs itself."""
    return grid(parameters) | {"BottomFirst": parameters["Tridiagonal"]}
