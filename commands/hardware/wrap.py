# SPDX-License-Identifier: Apache-2.0
"""`make wrap NAME=finger`: a module tactile_depth_finger with every parameter of a configuration inside.

Takes NAME, OUT, TABLES (where simulator and synthesis find the table files) and the variables of `make sim` that choose
a configuration. The module has the ports of tactile_depth. It, its table files, a C header that loads the same tables
over the registers, and the registers in IP-XACT go into the folder OUT; with ZERO the table of the zero offset holds
what a capture of those frames measures. Modules for several configurations fit into one design, if each has its own
folder of tables. With CAMERA, and BAYER and WINDOW, the module is tactile_sensor_finger: its s_axis takes the words of
that camera, and it has the pins of dvp_receive and camera_setup.
"""

import os
from typing import Annotated

from commands.common import repository, run_request
from commands.common.variables import Name
from commands.hardware import registers, wrapped
from tactile_depth.base import files
from tactile_depth.base.errors import InputError
from tactile_depth.chip import c_header
from tactile_depth.chip.hardware_files import PARAMETERS


def main(
    request: Annotated[run_request.Request, run_request.chosen((*wrapped.CHOICES, "OUT"), wrapped.PRESET, "")],
    name: Name = "",
    tables: Name = "./",
) -> None:
    wrapped.check_name(name)
    if not tables.endswith("/") or '"' in tables:
        raise InputError(f"TABLES={tables}: accepted is the folder of the table files, with a / at its end")
    out = request.out or repository.ROOT / "build" / "wrap" / name
    with files.new_files(out, PARAMETERS) as work:
        path = wrapped.write(request, work, name, tables)
        count = len(list(work.glob("*.hex")))
        for of in registers.MAPS if request.camera else (registers.PIPELINE,):
            registers.ip_xact(of, work)
    print(f"wrote {os.path.relpath(out / path.name)}, {count} table files, {c_header.FILE} and IP-XACT beside it")
