# SPDX-License-Identifier: Apache-2.0
"""What the flows of make synth, make fpga and make asic share: the design, read by Yosys."""

from __future__ import annotations

import shutil
from collections.abc import Mapping, Sequence
from pathlib import Path

from commands.common import repository
from tactile_depth.configuration import Configuration
from tactile_depth.sensor import Sensor, load
from tactile_depth.tactile_depth import top_parameters, write_roms

# Small ROMs are LUTs. Vivado says "distributed", which Yosys takes for a RAM of LUTs and finds none to read alone.
SMALL_ROMS = 'setattr -set rom_style "logic" m:* a:rom_style=distributed %i'


def read(
    folder: Path,
    config: Configuration,
    *,
    calibration: str | Sensor = "synthetic",
    top: str = "tactile_depth",
    parameters: Mapping[str, int] | None = None,
    extra: Sequence[Path] = (),
    options: str = "",
) -> list[str]:
    """Write the sources and the ROMs of a configuration into a folder; lines of Yosys that read them there.

    `parameters` are those of `top`, by default of the whole design; `extra` are sources beside hdl/, and in place of
    those of the same name there; `options` go to the front end.
    """
    folder.mkdir(parents=True, exist_ok=True)
    write_roms(folder, load(calibration) if isinstance(calibration, str) else calibration, config)
    names = list({source.name: shutil.copy(source, folder) for source in [*repository.sources(), *extra]})
    given = top_parameters(config) if parameters is None else parameters
    values = " ".join(f"-G {name}={value}" for name, value in given.items())
    return [
        f"read_slang --threads 1 -DSYNTHESIS --top {top} {options} {values} {' '.join(names)}",
        f"hierarchy -top {top}",
        "proc",
        SMALL_ROMS,
    ]
