# SPDX-License-Identifier: Apache-2.0
"""Wrappers of hdl/tactile_depth.sv that set every parameter of a configuration, and its default parameters."""

import re
from collections.abc import Mapping
from pathlib import Path

from commands.common import repository
from tactile_depth.camera.camera_front_end import SETTINGS, camera_front_end_parameters, camera_settings
from tactile_depth.camera_configuration import CameraConfiguration
from tactile_depth.configuration import Configuration
from tactile_depth.tactile_depth import CONSTANTS, top_parameters

TOP = repository.HDL / "tactile_depth.sv"
DEFAULTS = repository.HDL / "td_config_pkg.sv"


def ports() -> tuple[str, list[str]]:
    """Return the port declarations of hdl/tactile_depth.sv, and the names of its ports."""
    header = re.search(r"^\) \(\n(.*?)^\);\n", TOP.read_text(), re.DOTALL | re.MULTILINE)
    assert header is not None
    declared = header.group(1)
    return declared, re.findall(r"(\w+),?(?: *//.*)?$", declared, re.MULTILINE)


def default_parameters() -> dict[str, int]:
    """Return the parameters of the default configuration, and of options that it does not use."""
    tridiagonal = Configuration(solver="tridiagonal")
    flat = [Configuration(flat_field=True, gradient_model=model) for model in ("quadratic", "lut")]
    merged: dict[str, int] = {}
    for config in (*flat, Configuration(zero_offset=True), tridiagonal, Configuration()):
        merged |= top_parameters(config)
    return merged


def package() -> str:
    """Return the text of hdl/td_config_pkg.sv."""
    constants = "".join(f"  localparam int {name} = {value};  // {what}\n" for name, (value, what) in CONSTANTS.items())
    defaults = "".join(f"  localparam int Default{name} = {value};\n" for name, value in default_parameters().items())
    return (
        "// SPDX-License-Identifier: Apache-2.0\n"
        "// td_config_pkg: constants, parameters of the default configuration, and of options that it leaves out.\n"
        "//\n"
        "// Written by `make registers` from models/tactile_depth/configuration.py: change it there.\n\n"
        f"`default_nettype none\n\npackage td_config_pkg;\n\n{constants}\n{defaults}\nendpackage\n\n"
        "`default_nettype wire\n"
    )


def wrapper(
    name: str, parameters: Mapping[str, int], tables: str = "./", camera: CameraConfiguration | None = None
) -> str:
    """Return the text of the module tactile_depth_<name>, which finds its table files in the folder `tables`.

    With a `camera` its s_axis takes the stream of that camera.
    """
    declared, names = ports()
    inside = "".join(f"    .{parameter}({value}),\n" for parameter, value in parameters.items())
    connected = ", ".join(f".{port}" for port in names)
    if camera is not None:
        connected = connected.replace(", .s_axis_", ",\n    .s_axis_", 1)
        for port in (name for name in names if name.startswith("s_axis_")):
            connected = connected.replace(f".{port}", f".{port}({port.replace('s_axis', 'grid')})")
    depth_bytes = parameters["Lanes"] * -(-parameters["DataWidth"] // 8)
    return f"""// tactile_depth_{name}: tactile_depth with the parameters of one configuration. Generated: do not edit.

`default_nettype none

module tactile_depth_{name}
  import td_register_map_pkg::*;
  import td_types_pkg::*;
#(
  parameter TableFolder = "{tables}",  // of its .hex files, with a / at the end
  localparam int DepthBytes = {depth_bytes}
) (
{declared});
{"" if camera is None else front_end(camera)}
  tactile_depth #(
{inside}    .TableFolder(TableFolder)
  ) u_pipeline (
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
        path.write_text(text)
    return path


def grid(parameters: Mapping[str, int]) -> dict[str, int]:
    """Return the parameters that a module around a wrapper needs itself."""
    return {name: parameters[name] for name in ("Rows", "Size", "DataWidth", "Lanes")}
