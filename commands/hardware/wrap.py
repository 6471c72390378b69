# SPDX-License-Identifier: Apache-2.0
"""`make wrap NAME=finger`: a module tactile_depth_finger with every parameter of a configuration inside.

Takes NAME, OUT, TABLES (where simulator and synthesis find the table files) and the variables of `make sim` that choose
a configuration. The module has the ports of tactile_depth. It, its table files, a C header that loads the same tables
over the registers, and its IP-XACT component go into the folder OUT; with ZERO the table of the zero offset holds what
a capture of those frames measures. Modules for several configurations fit into one design, if each has its own folder
of tables. With CAMERA, and BAYER and WINDOW, the module is tactile_sensor_finger: its s_axis takes the words of that
camera, and it has the pins of dvp_receive and camera_setup. SHELL=verilog adds tactile_depth_finger_shell, Verilog-2005
with tkeep, which the component then describes.
"""

import os
from pathlib import Path
from typing import Annotated

from commands.common import repository, run_request, wrapper
from commands.common.variables import Name, one
from commands.hardware import ip_xact, registers, wrapped
from tactile_depth.base import files
from tactile_depth.base.errors import InputError
from tactile_depth.chip import c_header
from tactile_depth.chip.hardware_files import PARAMETERS
from tactile_depth.chip.rom_files import table_files

TOPS = ("tactile_depth", "tactile_sensor")


def main(
    request: Annotated[run_request.Request, run_request.chosen((*wrapped.CHOICES, "OUT"), wrapped.PRESET, "")],
    name: Name = "",
    tables: Name = "./",
    shell: Annotated[str, one(("verilog",))] = "",
) -> None:
    wrapped.check_name(name)
    if not tables.endswith("/") or '"' in tables or "\\" in tables:
        raise InputError(
            f"TABLES={tables}: accepted is the folder of the table files, with / between names and at its end"
        )
    out = request.out or repository.ROOT / "build" / "wrap" / name
    if others := {path.name for top in TOPS for path in out.glob(f"{top}_*.sv")} - earlier(out, name):
        raise InputError(
            f"OUT={out}: the tables there are those of {min(others)}", remedy="give each NAME its own folder"
        )
    with files.workspace(out, (PARAMETERS,)) as work:
        written = wrapped.write(request, work, name, tables, with_shell=bool(shell))
        component = described(written, work, out, tables)
        count = len(table_files(work))
        fresh = {path.name for path in work.iterdir()}
        files.replace(work, sorted(fresh), out, earlier(out, name) - fresh)
    names = ", ".join(os.path.relpath(out / path.name) for path in written.modules)
    print(f"wrote {names}, {count} table files, {c_header.FILE} and {component.name} (IP-XACT) beside it")


def earlier(out: Path, name: str) -> set[str]:
    """Return the names of files that an earlier run for NAME may have left in a folder."""
    own = {f"{top}_{name}{end}" for top in TOPS for end in (".sv", ".xml", "_shell.v", "_shell.xml")}
    return own | files.listed(out / PARAMETERS, "tables")


def described(written: wrapped.Written, work: Path, out: Path, tables: str) -> Path:
    """Write the IP-XACT component of the outermost module, and return its path."""
    top = written.modules[-1]
    module = ip_xact.Module(
        name=top.stem,
        language="verilog" if top.suffix == ".v" else "systemverilog",
        ports=(wrapper.shell_ports if top.suffix == ".v" else wrapper.outer_ports)(written.fields),
        maps=registers.components(bool(written.fields["Camera"])),
        sets={
            "rtl": [
                *repository.sources(wrapper.top_of(written.fields)),
                *(out / path.name for path in written.modules),
            ],
            "tables": [out / name for name in table_files(work)],
            ip_xact.SOFTWARE: [out / c_header.FILE],
        },
        tables=tables,
    )
    return ip_xact.write(module, work / f"{top.stem}.xml", out)
