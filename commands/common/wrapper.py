# SPDX-License-Identifier: Apache-2.0
"""Wrappers of hdl/tactile_depth.sv with a configuration inside, and the package of the configuration."""

import os
import re
from collections.abc import Mapping
from pathlib import Path

from commands.common import repository
from tactile_depth.camera.camera_front_end import SETTINGS, camera_front_end_parameters, camera_settings
from tactile_depth.camera_configuration import CameraConfiguration
from tactile_depth.tactile_depth import CONSTANTS, default_parameters

TOP = repository.HDL / "tactile_depth.sv"
DEFAULTS = repository.HDL / "td_config_pkg.sv"
NAME = re.compile(r"[a-z][a-z0-9_]*")
NAMES = "accepted are small letters, digits and _, beginning with a letter"


def ports() -> tuple[str, list[str]]:
    """Return the port declarations of hdl/tactile_depth.sv, and the names of its ports."""
    header = re.search(r"^\) \(\n(.*?)^\);\n", TOP.read_text(), re.DOTALL | re.MULTILINE)
    assert header is not None
    declared = header.group(1)
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
// Written by `make registers` from models/tactile_depth/tactile_depth.py: change it there.

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


def wrapper(
    name: str, parameters: Mapping[str, int], tables: str = "./", camera: CameraConfiguration | None = None
) -> str:
    """Return the text of the module tactile_depth_<name>, which finds its table files in the folder `tables`.

    With a `camera` its s_axis takes the stream of that camera.
    """
    declared, names = ports()
    fields = "".join(
        f"    configuration[32*{field}Field+:32] = {literal(number)};\n" for field, number in parameters.items()
    )
    connected = ", ".join(f".{port}" for port in names)
    if camera is not None:
        connected = connected.replace(", .s_axis_", ",\n    .s_axis_", 1)
        for port in (name for name in names if name.startswith("s_axis_")):
            connected = connected.replace(f".{port}", f".{port}({port.replace('s_axis', 'grid')})")
    depth_bytes = parameters["Lanes"] * -(-parameters["DataWidth"] // 8)
    return f"""// tactile_depth_{name}: tactile_depth with one configuration. Generated: do not edit.

`default_nettype none

module tactile_depth_{name}
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
{"" if camera is None else front_end(camera)}
  tactile_depth #(.TableFolder(TableFolder), .Config(Config)) u_pipeline (
    {connected}
  );

endmodule

`default_nettype wire
"""


def front_end(camera: CameraConfiguration) -> str:
    """Return the instance of camera_front_end between s_axis and the signals grid_*."""
    inside = ",\n".join(f"    .{name}({value})" for name, value in camera_front_end_parameters(camera).items())
    settings = camera_settings(camera)
    values = ", ".join(f"{width}'d{settings[name]}" for name, width in SETTINGS.items())
    return f"""
  logic [23:0] grid_tdata;
  logic grid_tvalid, grid_tready, grid_tlast, grid_tuser;
  camera_settings_t camera_settings;
  camera_faults_t unused_faults;
  assign camera_settings = {{{values}}};
  camera_front_end #(
{inside}
  ) u_camera (
    .clk, .rst, .settings(camera_settings), .faults(unused_faults),
    .s_axis_tdata, .s_axis_tvalid, .s_axis_tready, .s_axis_tlast, .s_axis_tuser,
    .m_axis_tdata(grid_tdata), .m_axis_tvalid(grid_tvalid), .m_axis_tready(grid_tready), .m_axis_tlast(grid_tlast),
    .m_axis_tuser(grid_tuser)
  );
"""


def write(
    folder: Path,
    name: str,
    parameters: Mapping[str, int],
    tables: str = "./",
    camera: CameraConfiguration | None = None,
) -> Path:
    """Write the wrapper into a folder, and return its path; an equal file is left as it is."""
    path, text = folder / f"tactile_depth_{name}.sv", wrapper(name, parameters, tables, camera)
    folder.mkdir(parents=True, exist_ok=True)
    if not path.is_file() or path.read_text() != text:
        draft = path.with_suffix(f".{os.getpid()}")
        draft.write_text(text)
        draft.replace(path)  # another process may read it
    return path


def grid(parameters: Mapping[str, int]) -> dict[str, int]:
    """Return the parameters that a module around a wrapper needs itself."""
    return {name: parameters[name] for name in ("Rows", "Columns", "DataWidth", "Lanes")}
