# SPDX-License-Identifier: Apache-2.0
"""`python -m commands.run.device_sim FOLDER [--pins]`: the RTL of a configuration as a process that speaks the link.

FOLDER holds what `Pipeline.hardware` writes. The process takes the bytes of the line on its standard input and gives
those of the device on its standard output (tb/device_main.cpp); `ready` on standard error says that it runs. With
--pins the device is the top of the ULX3S at the pins of its serial port, otherwise the line carries a byte a clock.
Each configuration is built once for each state of the sources. `tactile_depth.Device("sim", ..)` starts it.
"""

import json
import os
import sys
from collections.abc import Mapping
from pathlib import Path

from commands.common import repository, wrapper
from commands.common import simulator as simulation
from tactile_depth.base.errors import InputError
from tactile_depth.chip.hardware_files import PARAMETERS

BENCH, BOARD = "device_bench", "ulx3s"
MAIN = repository.ROOT / "tb" / "device_main.cpp"
BIT_CLOCKS = 4  # of the serial line, the least that uart_receive takes
CLOCK_MHZ = 100
IDLE_FRAMES, IDLE_CLOCKS = 4, 20_000  # without a byte; then time stands still. An answer takes less


def build(fields: Mapping[str, int], pins: bool) -> Path:
    """Return the simulator for the fields of a configuration, which is built once for each state of the sources.

    Raises RuntimeError if the build fails.
    """
    name = BOARD if pins else "device"
    top = BOARD if pins else BENCH
    bench = repository.BOARDS[BOARD] if pins else [repository.ROOT / "tb" / f"{BENCH}.sv"]

    def make(folder: Path) -> None:
        _verilate(folder, top, [*bench, wrapper.write(folder, name, fields)], fields, pins)

    sources = (*repository.sources(), *bench, MAIN, Path(__file__))
    return simulation.built_once([top, wrapper.wrapper(name, fields)], sources, "the simulator", make) / top


def _verilate(folder: Path, top: str, files: list[Path], fields: Mapping[str, int], pins: bool) -> None:
    """Build the executable, of the name of the top, in a folder. Raises RuntimeError or SystemExit if it fails."""
    parameters = wrapper.linked(fields)
    program = MAIN
    if pins:
        parameters |= {"ClockMhz": CLOCK_MHZ, "Baud": CLOCK_MHZ * 10**6 // BIT_CLOCKS}
        files = [*files, wrapper.write(folder, BOARD, {**fields, "Camera": 1})]  # named in the other branch
        program = folder / "pins.cpp"
        program.write_text(f'#define PINS\n#define BIT_CLOCKS {BIT_CLOCKS}\n#include "{MAIN}"\n')
    simulation.build(
        "verilator",
        top,
        [*repository.sources(), *files],
        parameters,
        folder,
        fast=True,
        program=program,
        log=folder / simulation.LOG,
    )


def main() -> None:
    folder, *options = sys.argv[1:] or [""]
    if not folder or folder.startswith("-") or options not in ([], ["--pins"]):
        sys.exit("usage: python -m commands.run.device_sim FOLDER [--pins]")
    path = Path(folder) / PARAMETERS
    try:
        fields = {**json.loads(path.read_text())["fields"], "TablesCrc": 0}  # one executable for all tables
    except (OSError, ValueError, KeyError, TypeError) as error:
        sys.exit(f"device_sim: {path} is not what Pipeline.hardware writes ({error!r})")
    try:
        built = build(fields, "--pins" in options)
    except (InputError, RuntimeError) as error:
        sys.exit(f"device_sim: {error}")
    os.chdir(folder)  # $readmemh finds the tables there
    idle = IDLE_FRAMES * fields["Rows"] * fields["Columns"] + IDLE_CLOCKS
    os.execv(built, [str(built), str(idle)])


if __name__ == "__main__":
    main()
