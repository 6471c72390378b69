# SPDX-License-Identifier: Apache-2.0
"""Wrappers of the tops with a configuration inside, and the package of the configuration."""

import os
import re
import textwrap
from collections.abc import Mapping
from pathlib import Path

from commands.common import repository
from tactile_depth.chip.tactile_depth import CONSTANTS, default_parameters

DEFAULTS = repository.HDL / "td_config_pkg.sv"
NAME = re.compile(r"[a-z][a-z0-9_]*")
NAMES = "accepted are small letters, digits and _, beginning with a letter"


def top_of(parameters: Mapping[str, int]) -> str:
    """Return the top of hdl/ for the fields of a configuration."""
    return "tactile_sensor" if parameters["Camera"] else "tactile_depth"


def ports(top: str) -> tuple[str, list[str]]:
    """Return the declarations of the ports of a top in hdl/, and their names; those between the two tops are left
    out."""
    text = (repository.HDL / f"{top}.sv").read_text()
    header = re.search(r"^\) \(\n(.*?)(,\n  output register_command_t.*?)?\n\);\n", text, re.DOTALL | re.MULTILINE)
    assert header is not None
    declared = f"{header.group(1)}\n"
    return declared, re.findall(r"(\w+),?(?: *//.*)?$", declared, re.MULTILINE)


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

  // Return the number in a field of a configuration.
  function automatic int value(input logic [ConfigBits-1:0] config_word, input int field);
    value = config_word[32*field+:32];
  endfunction

endpackage

`default_nettype wire
"""


def wrapper(name: str, parameters: Mapping[str, int], tables: str = "./") -> str:
    """Return the text of the module <top>_<name>, which finds its table files in the folder `tables`.

    The top is tactile_sensor for a configuration with a camera, whose words its s_axis takes, otherwise tactile_depth.
    """
    top = top_of(parameters)
    declared, names = ports(top)
    fields = "".join(
        f"    configuration[32*{field}Field+:32] = {literal(number)};\n" for field, number in parameters.items()
    )
    connected = ", ".join(f".{port}" for port in names)
    without = ""
    if not parameters["Camera"]:
        without = "  register_command_t unused_command;\n  register_answer_t no_answer;\n  assign no_answer = '0;\n"
        connected += ", .register_command(unused_command), .register_answer(no_answer)"
    connected = "\n    ".join(textwrap.wrap(connected, 116))
    instance = "u_sensor" if parameters["Camera"] else "u_pipeline"
    depth_bytes = parameters["Lanes"] * -(-parameters["DataWidth"] // 8)
    return f"""// {top}_{name}: {top} with one configuration. Generated: do not edit.

`default_nettype none

module {top}_{name}
  import td_config_pkg::*;
  import td_register_map_pkg::*;
  import td_types_pkg::*;
#(
  parameter TableFolder = "{tables}",  // of its .hex files, with a / at the end
  localparam int DepthBytes = {depth_bytes}
) (
{declared});

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


def write(folder: Path, name: str, parameters: Mapping[str, int], tables: str = "./") -> Path:
    """Write the wrapper into a folder, and return its path; an equal file is left as it is."""
    path, text = folder / f"{top_of(parameters)}_{name}.sv", wrapper(name, parameters, tables)
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
